"""The configuration: what is accepted, and the sentence for everything else."""

import copy
from pathlib import Path

import pytest
import yaml

from corpus.configuration import ConfigError, check_config

ROOT = Path(__file__).parent.parent
SCHEMA = yaml.safe_load((ROOT / "workflow" / "schemas" / "config.schema.yaml").read_text())
SHIPPED = yaml.safe_load((ROOT / "config" / "config.yaml").read_text())


def changed(**sections):
    """The shipped configuration with some keys altered."""
    config = copy.deepcopy(SHIPPED)
    for name, value in sections.items():
        config[name] = {**config.get(name, {}), **value} if isinstance(value, dict) else value
    return config


def faults(**sections):
    with pytest.raises(ConfigError) as caught:
        check_config(changed(**sections), SCHEMA)
    return str(caught.value)


def test_shipped_configuration_is_the_defaults():
    assert check_config(SHIPPED, SCHEMA) == check_config({}, SCHEMA)


def test_true_and_false_may_come_as_texts_from_the_command_line():
    assert [check_config({"verify": word}, SCHEMA)["verify"] for word in ("true", "false", True)] == [True, False, True]
    assert "verify is 'yes': must be true or false" in faults(verify="yes")


def test_every_key_is_described_in_schema_and_readme():
    readme = (ROOT / "config" / "README.md").read_text()
    for name, part in SCHEMA["properties"].items():
        assert f"`{name}" in readme
        for key, leaf in part.get("properties", {name: part}).items():
            assert leaf["description"], f"{name}.{key}"
            assert f"`{key}`" in readme or f"`{name}`" in readme, f"{name}.{key}"


@pytest.mark.parametrize(
    "sections, sentence",
    [
        ({"levls": {}}, "levls is not a key; did you mean levels?"),
        ({"levels": {"distanse": 1}}, "levels.distanse is not a key; did you mean levels.distance?"),
        ({"levels": {"distance": -0.1}}, "levels.distance is -0.1: must be more than 0"),
        ({"levels": {"distance": "fine"}}, "levels.distance is 'fine': must be a number or null"),
        ({"levels": {"distance": 2}}, "levels.distance is 2.0: with units: relative it is a part"),
        ({"levels": {"distance": float("inf"), "units": "absolute"}}, "levels.distance is inf: must be a finite"),
        ({"levels": {"distance": None}}, "levels.distance and levels.feature_size are both null"),
        ({"levels": 3}, "levels is 3: must be a group of keys"),
        (
            {"tilt": {"mode": "atuo"}},
            "tilt.mode is 'atuo': must be 'auto', 'none' or 'direction'; did you mean 'auto'?",
        ),
        ({"tilt": {"mode": "direction"}}, "tilt.direction is missing"),
        ({"tilt": {"direction": [0, 0, 1]}}, "tilt.direction is given, but tilt.mode is 'auto'"),
        ({"tilt": {"mode": "direction", "direction": [0, 0, 0]}}, "tilt.direction is the zero vector"),
        ({"tilt": {"mode": "direction", "direction": [0, 1]}}, "must have at least 3 entries"),
        ({"tilt": {"cone": 15}}, "tilt.cone is not a key; "),
        ({"nodes": {"sampler": "center"}}, "nodes.sampler is 'center'"),
        ({"inspect": {"repair": ["mrege"]}}, "inspect.repair[0] is 'mrege'"),
        ({"inspect": {"merge_tolerance": 1}}, "inspect.merge_tolerance is 1.0: must be at most 0.01"),
        ({"draw": {"width": 12.5}}, "draw.width is 12.5: must be a whole number"),
        ({"batches": {"size": True}}, "batches.size is true: must be a whole number"),
        ({"meshes": ""}, "meshes is '': must not be empty"),
    ],
)
def test_each_fault_is_named(sections, sentence):
    assert sentence in faults(**sections)


def test_all_faults_are_told_at_once():
    text = faults(levels={"distance": -1}, edges={"method": "exactly"})
    assert "levels.distance" in text and "edges.method" in text


def test_distance_and_feature_size_follow_from_each_other():
    levels = check_config(changed(levels={"distance": 0.1}), SCHEMA)["levels"]
    assert (levels["distance"], levels["feature_size"]) == (0.1, 0.2)
    levels = check_config(changed(levels={"distance": None, "feature_size": 0.1}), SCHEMA)["levels"]
    assert (levels["distance"], levels["feature_size"]) == (0.05, 0.1)
    levels = check_config(changed(levels={"distance": 0.01, "feature_size": 0.3}), SCHEMA)["levels"]
    assert (levels["distance"], levels["feature_size"]) == (0.01, 0.3)


def test_values_of_the_command_line_are_read_as_in_the_file():
    given = changed(levels={"distance": "null", "feature_size": "1e-1"}, draw={"width": "300"}, meshes=2024)
    config = check_config(given, SCHEMA)
    assert config["levels"]["distance"] == 0.05
    assert config["draw"]["width"] == 300
    assert config["meshes"] == "2024"


def test_whole_numbers_and_reals_of_one_value_are_one_option():
    given = changed(tilt={"mode": "direction", "direction": [0, 0, 1]}, draw={"elevation": 15})
    config = check_config(given, SCHEMA)
    assert repr(config["tilt"]["direction"]) == "[0.0, 0.0, 1.0]"
    assert repr(config["draw"]["elevation"]) == "15.0"
