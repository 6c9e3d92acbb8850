"""The sheet of models: what a row makes of the configuration, and what is said of faults."""

from pathlib import Path

import pytest
import yaml

from corpus.configuration import ConfigError, check_config
from corpus.sample_sheet import COLUMNS, read_sheet

ROOT = Path(__file__).parent.parent
SCHEMA = yaml.safe_load((ROOT / "workflow" / "schemas" / "config.schema.yaml").read_text())
MODELS = ["bracket1", "bracket2", "gear", "hand [2]"]


def read(folder, text, config=None):
    """Configurations by a sheet of which | stands for a tab."""
    path = folder / "models.tsv"
    path.write_text(text.replace("|", "\t"))
    return read_sheet(str(path), MODELS, config or {}, SCHEMA)


def test_no_sheet_says_nothing(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert read_sheet(None, MODELS, {}, SCHEMA) == read_sheet("config/models.tsv", MODELS, {}, SCHEMA) == {}
    with pytest.raises(
        ConfigError, match=r"mine.tsv cannot be used:\n  it cannot be read \(No such file or directory\)"
    ):
        read_sheet("mine.tsv", MODELS, {}, SCHEMA)


def test_a_row_is_keys_of_the_configuration_of_its_models(tmp_path):
    text = "# ours\nmodel|up|distance|unit\n\nbracket*|y||inch\nbracket2||0.05|\nhand [2]|-x||\ngear|||\n"
    found = read(tmp_path, text, {"draw": {"width": 300}})
    expected = {
        "bracket1": {"tilt": {"up": "y"}, "inspect": {"unit": "inch"}},
        "bracket2": {"tilt": {"up": "y"}, "inspect": {"unit": "inch"}, "levels": {"distance": 0.05}},
        "hand [2]": {"tilt": {"up": "-x"}},
    }
    assert found == {model: check_config(keys | {"draw": {"width": 300}}, SCHEMA) for model, keys in expected.items()}


@pytest.mark.parametrize("written", ["0 1 0.5", "0,1,0.5", "[0, 1, 0.5]"])
def test_direction_and_up_replace_one_another(tmp_path, written):
    text = f"model|direction|up\nbracket1|{written}|\nbracket2||y\n"
    found = read(tmp_path, text, {"tilt": {"mode": "direction", "direction": [1, 0, 0]}})
    assert found["bracket1"]["tilt"] == {"mode": "direction", "direction": [0.0, 1.0, 0.5], "up": "z"}
    assert found["bracket2"]["tilt"] == {"mode": "auto", "direction": None, "up": "y"}
    found = read(tmp_path, text, {"tilt": {"mode": "none", "up": "x"}})
    assert found["bracket1"]["tilt"] == {"mode": "direction", "direction": [0.0, 1.0, 0.5], "up": "z"}
    assert found["bracket2"]["tilt"] == {"mode": "none", "direction": None, "up": "y"}


def test_of_distance_and_feature_size_one_gives_the_other(tmp_path):
    text = "model|distance|feature_size\nbracket1|0.1|\nbracket2||0.1\ngear|0.1|0.7\n"
    found = read(tmp_path, text, {"levels": {"distance": 0.01, "feature_size": 0.3}})
    lengths = [(found[model]["levels"]["distance"], found[model]["levels"]["feature_size"]) for model in MODELS[:3]]
    assert lengths == [(0.1, 0.2), (0.05, 0.1), (0.1, 0.7)]


FAULTY = """model|directoin|distance|up|distance
gear||-1|
braket1||0.1|y
gear||0.2|q
bracket*||2|||x
|||z
bracket1|0 0|0.1
"""


def test_all_faults_are_told_at_once_with_their_lines(tmp_path):
    with pytest.raises(ConfigError) as caught:
        read(tmp_path, FAULTY)
    head, *faults = str(caught.value).splitlines()
    assert head == f"{tmp_path}/models.tsv cannot be used:"
    assert faults[0].startswith("  line 1: 'directoin' is not a column; did you mean 'direction'? allowed, with tabs")
    for sentence in (
        "line 1: the column 'distance' is there twice",
        "line 3: 'braket1' matches none of 4 models; did you mean 'bracket1' or 'bracket2'?",
        "line 4: 'gear' has a row already, line 2",
        "line 4: tilt.up is 'q': must be 'z', 'y', 'x', '-z', '-y' or '-x'",
        "line 5: has 6 cells for 5 columns",
        "line 6: the model is not named",
    ):
        assert any(fault.startswith(f"  {sentence}") for fault in faults), sentence
    lines = [int(fault.split()[1].rstrip(":")) for fault in faults]
    assert lines == sorted(lines)


@pytest.mark.parametrize(
    "row, sentence",
    [
        ("gear|0 0|||||", "line 2: tilt.direction is [0.0, 0.0]: must have at least 3 entries"),
        ("gear|0 0 b|||||", "line 2: tilt.direction[2] is 'b': must be a number"),
        ("gear|0 0 1||||y|", "line 2: tilt.up is 'y', but tilt.mode is 'direction'"),
        ("gear||2||||", "line 2: levels.distance is 2.0: with units: relative it is a part"),
        ("gear|||x|||", "line 2: levels.feature_size is 'x': must be a number or null"),
        ("gear||||mm||", "line 2: inspect.unit is 'mm': must be 'micrometre', 'millimetre',"),
    ],
)
def test_values_are_checked_like_those_of_the_configuration(tmp_path, row, sentence):
    with pytest.raises(ConfigError) as caught:
        read(tmp_path, f"model|direction|distance|feature_size|unit|up|\n{row}".replace("|\n", "\n").rstrip("|"))
    assert any(fault.startswith(sentence) for fault in caught.value.faults), caught.value.faults


def test_a_table_of_another_kind_is_told(tmp_path):
    with pytest.raises(ConfigError, match=r"line 1: 'model,up' is not a column; .*allowed, with tabs between: model,"):
        read(tmp_path, "model,up\ngear,y\n")
    with pytest.raises(ConfigError, match="there is no column 'model'"):
        read(tmp_path, "")
    (tmp_path / "models.tsv").write_bytes(b"model\n\xff\n")
    with pytest.raises(ConfigError, match="it is no text in UTF-8"):
        read_sheet(str(tmp_path / "models.tsv"), MODELS, {}, SCHEMA)


def test_every_column_is_described():
    readme = (ROOT / "config" / "README.md").read_text()
    assert all(f"| `{column}` |" in readme for column in COLUMNS)
