"""The configuration: what is accepted, and the sentence for everything else."""

import copy
import importlib
import math
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
import yaml
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import pipeline
from corpus.configuration import ConfigError, check_config
from corpus.contradictions import LARGEST_LENGTH, SMALLEST_LENGTH
from corpus.layout import ASKED_FOR, STAGES
from corpus.stages import Rejected
from corpus.workers import Limits, map_apart
from reebslice.errors import TooManyCrossingsError
from reebslice.mesh.faults import LARGEST, SMALLEST
from reebslice.slicing.levels import uniform_heights
from reebslice.slicing.sampling_rule import MOST_LEVELS
from small_corpus import write_prism

ROOT = Path(__file__).parent.parent
SCHEMA = yaml.safe_load((ROOT / "workflow" / "schemas" / "config.schema.yaml").read_text())
SECTIONS = pipeline.STAGES | {
    "certify": "levels", "draw": "draw", "view": "view", "find_pockets": "pockets", "find_loops": "loops",
    "cut_pockets": "draw", "draw_loops": "draw", "draw_figures": "draw", "label_faces": "faces",
    "colour_faces": "colours", "decompose_solid": "parts", "export_model": "export", "compare_links": "compare",
    "rate_directions": "directions", "graph_functions": "functions", "describe_shape": "descriptors",
    "trace_centrelines": "centrelines", "build_graphs": None, "certify_graphs": None,
}  # fmt: skip
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
        ({"pockets": {"find": False, "cut": True}}, "pockets.cut is true, but pockets.find is false"),
        ({"loops": {"find": False, "draw": True}}, "loops.draw is true, but loops.find is false"),
        (
            {"functions": ["geodesics"]},
            "functions[0] is 'geodesics': must be geodesic, barycentre, directions: and a number up to 999, or file:",
        ),
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


@pytest.mark.parametrize(
    "sections, sentence",
    [
        ({"tilt": {"mode": "direction", "direction": [0, 0, 1e-320]}}, "tilt.direction is [0.0, 0.0, 1e-320]: "),
        ({"tilt": {"mode": "direction", "direction": [1e308, 1e308, 1e308]}}, "tilt.direction is [1e+308, "),
        ({"levels": {"distance": 1e-300}}, "levels.distance is 1e-300: no mesh is so small"),
        ({"levels": {"distance": 1e-300, "units": "absolute"}}, "levels.distance is 1e-300: no mesh is so small"),
        (
            {"levels": {"distance": 1e300, "units": "absolute"}},
            "levels.distance is 1e+300: no mesh is so small or so large",
        ),
        (
            {"levels": {"distance": 0.9e-6}},
            "would have more than the 1000000 levels that can be held; it must be at least 1e-06",
        ),
        (
            {"levels": {"distance": None, "feature_size": 1.9e-6}},
            "levels.feature_size is 1.9e-06: every model would have",
        ),
        ({"levels": {"feature_size": 5e-324}}, "levels.feature_size is 5e-324: no mesh is so small"),
        ({"limits": {"memory": 10}}, "limits.memory is 10.0: must be at least 500"),
        ({"limits": {"memory": 1e300}}, "limits.memory is 1e+300: must be at most 1000000000"),
        ({"limits": {"minutes": 0.1}}, "limits.minutes is 0.1: must be at least 1"),
    ],
)
def test_what_would_fail_every_model_is_told_at_the_start(sections, sentence):
    assert sentence in faults(**sections)


def test_the_checker_knows_the_bounds_of_the_library():
    assert (LARGEST_LENGTH, SMALLEST_LENGTH) == (LARGEST, SMALLEST)
    assert check_config(changed(levels={"distance": 1 / MOST_LEVELS}), SCHEMA)
    assert len(uniform_heights(0.0, 1.0, 1 / MOST_LEVELS)) == MOST_LEVELS
    with pytest.raises(TooManyCrossingsError):
        uniform_heights(0.0, 1.0, 0.99 / MOST_LEVELS)


def test_whole_numbers_with_a_point_are_whole_numbers():
    config = check_config(changed(draw={"width": 400.0}, compare={"levels": [16.0]}, batches={"size": 8.0}), SCHEMA)
    for number in (config["draw"]["width"], *config["compare"]["levels"], config["batches"]["size"]):
        assert type(number) is int


# Numbers at which something overflows, vanishes or rounds, beside those of the schema.
EDGES = [
    0.0,
    5e-324,
    1e-308,
    1e-162,
    1e-81,
    1e-75,
    1e-16,
    1e-9,
    1e-6,
    0.3,
    1.0,
    2.0,
    1e9,
    1e16,
    1e75,
    1e154,
    1e300,
    1.7e308,
]
MODULES = {stage: importlib.import_module(stage) for stage in (*STAGES, *ASKED_FOR)}


def values_of(part):
    """Values of a leaf of the schema, of the right type, in its range and beside it."""
    kinds = part.get("type", "enum")
    if "enum" in part:
        return st.sampled_from(part["enum"])
    if "array" in kinds:
        length = {"min_size": part.get("minItems", 0), "max_size": part.get("maxItems", 3)}
        lists = st.lists(values_of(part["items"]), unique=part.get("uniqueItems", False), **length)
        return lists | st.none() if "null" in kinds else lists
    if "integer" in kinds:
        whole = st.integers(part["minimum"], part["minimum"] + 50)
        return whole | whole.map(float) | whole.map(str)
    edges = EDGES + [part[rule] for rule in ("minimum", "maximum", "exclusiveMinimum") if rule in part]
    numbers = st.sampled_from(edges).flatmap(lambda edge: st.sampled_from([edge, -edge, math.nextafter(edge, 1)]))
    numbers |= st.floats(part.get("minimum", -2), min(part.get("maximum", 2), 1e4))
    return numbers | numbers.map(repr) | (st.none() if "null" in kinds else numbers)


GROUPS = {name: part for name, part in SCHEMA["properties"].items() if part["type"] == "object"}
CONFIGS = st.fixed_dictionaries(
    {},
    optional={
        name: st.fixed_dictionaries({}, optional={key: values_of(leaf) for key, leaf in part["properties"].items()})
        for name, part in GROUPS.items()
    },
)


@settings(deadline=None, max_examples=30, derandomize=True)
@given(CONFIGS)
def test_a_configuration_that_is_accepted_fails_no_model(given_config):
    """Every stage, on one small mesh; only lengths in mesh units may turn out to be too small for it."""
    try:
        config = check_config(given_config, SCHEMA)
    except ConfigError:
        return
    levels = config["levels"]
    assume(levels["distance"] > 1e-3 or levels["distance"] < 1e-9)  # not so many levels that they take long
    options = {stage: config.get(section, {}) for stage, section in SECTIONS.items()}
    options["synthesize_edges"] = config["edges"] | {"levels": levels}
    for stage in ("label_faces", "colour_faces", "decompose_solid", "export_model"):
        options[stage] = options[stage] | config["edges"]
    options["graph_functions"] = {"functions": ["geodesic", "barycentre"]}
    with TemporaryDirectory() as folder:
        folder = Path(folder)
        write_prism(folder / "mesh.off", 4, 1.0)
        try:
            for stage, module in MODULES.items():
                module.main(folder / "mesh.off" if stage == "inspect_mesh" else folder, folder, options[stage])
        except Rejected as rejection:
            if stage == "slice_mesh" and levels["refine"] == "graphs":
                return
            told = "arcs of faces take edges: {method: exact}"
            guessed = config["edges"]["method"] != "exact" and told in str(rejection)
            if not guessed and (levels["units"] != "absolute" or "Take a larger distance" not in str(rejection)):
                raise


@pytest.mark.parametrize("limits", [{"memory": 500, "minutes": 1}, {"memory": 1e9, "minutes": 10000}, {}])
def test_limits_that_are_accepted_can_be_set(limits):
    limits = Limits(**check_config(changed(limits=limits), SCHEMA)["limits"])
    assert list(map_apart(lambda item: (item + 1, True), [1, 2], limits)) == [2, 3]
