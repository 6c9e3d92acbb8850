"""The comparison of rules that guess links: counted by hand, on known solids, and as a target of the workflow."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import networkx as nx
import numpy as np
import pandas as pd
import pytest
import shapely

import solids
from compare_links import main as compare_links
from compare_methods import main as gather
from corpus.storage import read_table
from pipeline import run_stages, write_off
from reebslice.links.comparison import (
    EVERY,
    KINDS,
    METHODS,
    count_links,
    count_loops,
    link_by_groups,
    link_by_overlap,
    model_half,
    rates,
)
from reebslice.links.similarity import near_pairs

ROOT = Path(__file__).parent.parent
OPTIONS = {"levels": [8, 40], "tilts": ["none", "random"]}

# Region 0 at level 0 splits into 1 and 2, which go on as 3 and 4 and merge into 5; 6 is new beside it.
LEVEL = np.array([0, 1, 1, 2, 2, 3, 3])
BELOW = [[], [0], [1], [2], [3, 4], [], [5], [6]]
ABOVE = [[0], [1, 2], [3], [4], [5], [6], [], []]
BLOCKS = ["->o", "o->o,o", "continuation", "continuation", "o,o->o", "->o", "o->", "o->"]
TRUE = [(0, 1), (0, 2), (1, 3), (2, 4), (3, 5), (4, 5)]


def counted(links):
    return {row["kind"]: row for row in count_links(LEVEL, BELOW, ABOVE, BLOCKS, links)}


def test_the_links_of_the_mesh_are_right():
    rows = counted(TRUE)
    assert set(rows) == {EVERY, "o->o,o", "continuation", "o,o->o", "->o"}  # outside the levels nothing is linked
    assert rows[EVERY] == {
        "kind": EVERY, "links": 6, "links_missed": 0, "links_false": 0, "blocks": 5, "blocks_right": 5,
        "slabs": 3, "slabs_right": 3, "loops": 1, "loops_found": 1,
    }  # fmt: skip
    assert (rows["->o"]["links"], rows["->o"]["blocks"], rows["->o"]["loops"]) == (0, 1, None)


def test_a_missed_link_counts_with_its_block():
    rows = counted([link for link in TRUE if link != (1, 3)])
    assert (rows[EVERY]["links_missed"], rows[EVERY]["slabs_right"], rows[EVERY]["blocks_right"]) == (1, 2, 4)
    assert rows["continuation"]["links_missed"] == 1 and rows["o,o->o"]["links_missed"] == 0
    assert (rows["continuation"]["blocks"], rows["continuation"]["blocks_right"]) == (2, 1)
    assert rows[EVERY]["loops_found"] == 0


def test_a_false_link_counts_where_something_happens():
    rows = counted([*TRUE, (4, 6)])
    assert [rows[kind]["links_false"] for kind in (EVERY, "continuation", "o,o->o", "->o")] == [1, 0, 1, 0]
    assert [rows[kind]["blocks_right"] for kind in ("o,o->o", "->o")] == [0, 0]
    rows = counted([*TRUE, (1, 4)])
    assert rows["continuation"]["links_false"] == 1 and rows["continuation"]["blocks_right"] == 0
    assert (rows["continuation"]["slabs_right"], rows["o,o->o"]["slabs_right"]) == (0, 1)


def test_loops_are_those_of_the_graph_of_parts():
    random = np.random.default_rng(1)
    level = np.sort(random.integers(0, 5, 30))
    links = [(a, b) for a in range(30) for b in range(30) if level[b] == level[a] + 1 and random.random() < 0.2]
    # a region as two ends joined by an edge; ends that are linked, one point
    ends = nx.Graph([(("up", a), ("down", b)) for a, b in links])
    ends.add_nodes_from((side, region) for side in ("up", "down") for region in range(30))
    part = {end: n for n, members in enumerate(nx.connected_components(ends)) for end in members}
    graph = nx.MultiGraph([(part["down", region], part["up", region]) for region in range(30)])
    expected = graph.number_of_edges() - graph.number_of_nodes() + nx.number_connected_components(graph)
    assert count_loops(level, links) == expected > 0


def test_plain_rules_by_their_definition():
    box = shapely.box
    level = np.array([0, 0, 1, 1])
    shapes = np.array([box(0, 0, 4, 1), box(5, 0, 6, 1), box(0, 0, 3, 1), box(3.9, 0, 6, 1)])
    pairs = near_pairs(level, level.astype(float), shapes)
    assert link_by_overlap(pairs) == [(0, 2), (0, 3), (1, 3)]
    # 0 and 3 share too little for a pair; the group of 0, 2 and 3 covers 3.1 of 5.1, the union
    assert link_by_groups(shapes, pairs) == [(0, 2), (0, 3), (1, 3)]
    shapes[3] = box(3.9, 0, 12, 1)
    assert link_by_groups(shapes, near_pairs(level, level.astype(float), shapes)) == [(0, 2), (1, 3)]


def test_rates_are_sums_over_sums():
    counted_twice = (count_links(LEVEL, BELOW, ABOVE, BLOCKS, links) for links in (TRUE, TRUE[1:]))
    rows = [{"method": "m", **row} for counts in counted_twice for row in counts]
    found = rates(pd.DataFrame(rows), ("method", "kind"))
    assert found.loc[("m", EVERY)].to_dict() == {
        "links": 12, "missed": 1000 / 12, "false": 0, "blocks": 10, "blocks_right": 9 / 10,
        "slabs": 6, "slabs_right": 5 / 6, "loop_error": 1,
    }  # fmt: skip
    assert np.isnan(found.loc[("m", "->o"), "missed"])


def test_halves_are_fixed_and_even():
    halves = [model_half(f"model{n}") for n in range(1000)]
    assert 450 < halves.count("tuning") < 550 and set(halves) == {"tuning", "report"}
    assert [model_half(model) for model in ("bunny", "torus_upright", "ä b")] == ["tuning", "report", "tuning"]


def compared(solid, folder):
    """The table `comparison` of a solid, as DataFrame."""
    run_stages(solid, folder)
    compare_links(folder, folder, OPTIONS)
    return read_table(folder / "comparison.parquet", "comparison").to_pandas()


def test_comparison_of_an_upright_torus(tmp_path):
    table = compared(solids.torus(2.0, 0.7, 32, 16, upright=True), tmp_path)
    assert set(table["method"]) == set(METHODS) and set(table["kind"]) <= {EVERY, *KINDS}
    assert set(table["tilt"]) == {"none", "random"} and set(table["n_levels"]) == {8, 40}
    every = table[(table["kind"] == EVERY) & (table["n_levels"] == 40)]
    assert set(every["loops"]) == {1}
    similar = every[every["method"] == "similarity"]
    assert (similar["links_missed"] == 0).all() and (similar["links_false"] == 0).all()
    assert (similar["slabs_right"] == 39).all() and (similar["loops_found"] == 1).all()
    upright = table[(table["tilt"] == "none") & (table["n_levels"] == 40) & (table["method"] == "similarity")]
    upright = upright.set_index("kind")
    # 20 levels meet the hole, so 21 slabs have two links each, those of the saddles included
    assert upright["links"].to_dict() == {EVERY: 60, "continuation": 56, "o->o,o": 2, "o,o->o": 2}
    for column in ("links_missed", "links_false", "blocks", "blocks_right"):
        assert upright[column].drop(EVERY).sum() == upright.loc[EVERY, column]


def brick(width, height, foot=0.0):
    """A square prism that stands on the level `foot`."""
    return solids.move(solids.scale(solids.cube(), [width, width, height]), [0, 0, foot])


def wrong_links(table):
    """Missed and false links of every rule on 8 levels without a tilt: {method: (missed, false)}."""
    every = table[(table["kind"] == EVERY) & (table["tilt"] == "none") & (table["n_levels"] == 8)].set_index("method")
    return {method: (every.loc[method, "links_missed"], every.loc[method, "links_false"]) for method in METHODS}


def test_no_rule_sees_a_gap_between_two_levels(tmp_path):
    gap = solids.unite(brick(1, 1), brick(1, 1, foot=1.01))
    assert wrong_links(compared(gap, tmp_path)) == dict.fromkeys(METHODS, (0, 1))


def test_an_oblique_rod_needs_distance_as_well_as_overlap(tmp_path):
    # each level shows the rod moved by 2.4 times its width
    rod = solids.transform(brick(0.1, 2.0), [[1, 0, 0.96], [0, 1, 0], [0, 0, 1]])
    wrong = wrong_links(compared(rod, tmp_path))
    assert wrong == {"similarity": (0, 0), "groups": (7, 0), "overlap": (7, 0), "proximity": (0, 0)}


def run_workflow(folder):
    """Run Snakemake in `folder`, return (exit code, what it said)."""
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile"), "--directory", str(folder)]
    command += ["--cores", "1", "compare_methods", "--config", "meshes=meshes", "compare={levels: [4], tilts: [none]}"]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=folder, check=False)
    return done.returncode, done.stdout


def test_the_target_leaves_a_table_and_a_figure(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("meshes").mkdir()
    write_off("meshes/rod.off", brick(1, 3))
    write_off("meshes/torn.off", replace(solids.cube(), faces=solids.cube().faces[1:]))
    code, said = run_workflow(tmp_path)
    assert code == 0, said
    table = read_table("results/corpus/comparison.parquet", "comparison").to_pandas()
    assert set(table["model"]) == {"rod"} and set(table["links"]) == {3}
    assert Path("results/corpus/comparison.png").stat().st_size > 10_000
    # a status table that promises what is gone or altered is withdrawn, so the next run makes it again
    tables, one = sorted(Path("results/status/compare_links").iterdir()), Path("results/models/rod/comparison.parquet")
    kept = {path: path.read_bytes() for path in tables}
    for content in (one.read_bytes()[:-1], None):
        one.unlink()
        if content:
            one.write_bytes(content)
        with pytest.raises(RuntimeError, match="rod: its table is gone or altered"):
            gather(tables)
        assert len(tables) - 1 == len(list(Path("results/status/compare_links").iterdir()))
        for path, status in kept.items():
            path.write_bytes(status)
