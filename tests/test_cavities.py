"""Cavities and nested solids: known answers, nesting by brute force, and which surface arcs bound which solid arc."""

import itertools
from fractions import Fraction
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import networkx as nx
import numpy as np
import pytest
import shapely

import certify
import solids
from corpus.storage import read_json
from pipeline import run_stages
from reference import count_loops
from solids import box, carve, icosphere, move, nest, torus, transform, unite

OBLIQUE = [0.31, 0.23, 0.92]
DIRECTIONS = {"upright": {"mode": "none"}, "oblique": {"mode": "direction", "direction": OBLIQUE}}
ANYHOW = transform(torus(2.0, 0.5), solids.rotation(3))


class Case(NamedTuple):
    """A solid and what theory says: the parent of each of its shells as listed (-1: none), b0, b1, b2.

    loops : of the solid's graph along z, where theory gives them.
    """

    solid: solids.Solid
    parents: list
    betti: list
    loops: int | None = None


CASES = {
    "hollow ball": Case(solids.hollow_ball(), [-1, 0], [1, 0, 1], 0),
    "five balls": Case(solids.nested_shells(5), [-1, 0, 1, 2, 3], [3, 0, 2], 0),
    "five boxes": Case(nest(*(box(k, k, k) for k in (9, 7, 5, 3, 1))), [-1, 0, 1, 2, 3], [3, 0, 2], 0),
    "five rings": Case(nest(*(torus(3.0, r) for r in (1.8, 1.4, 1.0, 0.6, 0.3))), [-1, 0, 1, 2, 3], [3, 5, 2]),
    "ring void in a ball": Case(nest(icosphere(1, 6.0), torus()), [-1, 0], [1, 1, 1], 1),
    "standing ring void in a ball": Case(nest(icosphere(1, 6.0), torus(upright=True)), [-1, 0], [1, 1, 1], 0),
    "linked ring voids in a ball": Case(
        unite(icosphere(1, 9.0), carve(solids.linked_rings())), [-1, 0, 0], [1, 2, 2], 1
    ),
    "knotted void in a box": Case(nest(box(9, 9, 5), solids.trefoil()), [-1, 0], [1, 1, 1]),
    "ring void in a ring": Case(nest(torus(3.0, 1.2), move(torus(3.0, 0.5), [0, 0, 0.1])), [-1, 0], [1, 2, 1]),
    "knot in a void": Case(nest(box(10, 10, 6), box(9, 9, 5), solids.trefoil()), [-1, 0, 1], [2, 1, 1]),
    "hollow bodies in a hollow body": Case(
        unite(
            box(12, 12, 12), carve(box(11, 11, 5, [0, 0, -3])), carve(box(8, 8, 4, [0, 0, 3.5])),
            move(icosphere(1, 2.0), [-3, -3, -3]), carve(move(icosphere(1, 1.0), [-3, -3, -3.1])),
            move(ANYHOW, [2, 2, -3]), box(1, 1, 3, [0, 0, 3.5]), carve(box(0.5, 0.5, 1, [0, 0, 3.6])),
        ),
        [-1, 0, 0, 1, 3, 1, 2, 6], [4, 1, 4],
    ),
    "flat void": Case(nest(box(4, 4, 10), box(1, 1, 0.01, [0.2, 0.3, 0.33])), [-1, 0], [1, 0, 1], 0),
    "tall thin void": Case(nest(box(4, 4, 10), box(0.01, 0.01, 9, [0.7, 0.2, 0.1])), [-1, 0], [1, 0, 1], 0),
    "many small voids at one height": Case(
        unite(
            box(9, 9, 3), carve(icosphere(1, 0.2)),
            *(carve(move(icosphere(0, 0.3), [2 * i, 2 * j, 0.01 * i])) for i in (-1, 1) for j in (-1, 1)),
        ),
        [-1, 0, 0, 0, 0, 0], [1, 0, 5], 0,
    ),
    "winding voids side by side": Case(solids.winding_voids(), [-1, 0, 0, 0, 0], [1, 2, 4], 0),
    "side by side": Case(
        unite(
            nest(*(box(k, k, k + 1, [-5, 0, 0.5]) for k in (7, 5, 3, 1))), move(solids.nested_shells(4), [5, 1, 0.3])
        ),
        [-1, 0, 1, 2, -1, 4, 5, 6], [4, 0, 4], 0,
    ),
    "bodies that overlap, each hollow": Case(
        unite(*(icosphere(1, r) for r in (10.0, 8.0)), *(carve(icosphere(1, r)) for r in (6.0, 4.0))),
        [-1, 0, 1, 2], [2, 0, 2], 0,
    ),
}  # fmt: skip


class Outcome(NamedTuple):
    result: object
    certificate: dict
    row: list  # of the table shells, for each shell as the case lists them


@cache
def outcome(name, direction="upright", refine="exact", distance=0.1):
    levels = {"refine": refine, "distance": distance, "feature_size": 2 * distance}
    with TemporaryDirectory() as folder:
        result = run_stages(CASES[name].solid, folder, tilt=DIRECTIONS[direction], levels=levels)
        certify.main(Path(folder), Path(folder), {**levels, "units": "relative"})
        return Outcome(result, read_json(f"{folder}/certificate.json"), list_rows(CASES[name].solid, result))


def list_rows(solid, result):
    """The number in the table `shells` of each shell of a solid, in the order of their vertices."""
    position = {tuple(row[axis] for axis in "xyz"): place for place, row in enumerate(result.vertices)}
    shell = {row[corner]: row["shell"] for row in result.tables["faces"] for corner in "abc"}
    return list(dict.fromkeys(shell[position[tuple(point)]] for point in solid.points.tolist()))


EVERY = [(name, direction, refine) for name in CASES for direction in DIRECTIONS for refine in ("exact", "feature")]


@pytest.fixture(params=EVERY, ids=" ".join)
def made(request):
    return request.param[0], outcome(*request.param)


# --------------------------------------------------------------------------
# Known answers


def test_shells_are_nested_as_they_were_made(made):
    name, (result, _, row) = made
    parents = CASES[name].parents
    assert [result.shells[k]["parent"] for k in row] == [None if p < 0 else row[p] for p in parents]
    assert sum(r["void"] for r in result.shells) == CASES[name].betti[2]
    for shell in result.shells:
        assert result.shells[shell["body"]]["void"] is False
        assert shell["body"] == shell["shell"] or shell["void"]


def test_betti_numbers_and_loops(made):
    name, (result, certificate, _) = made
    case = CASES[name]
    assert certificate["betti_solid"] == case.betti
    bodies = [r["shell"] for r in result.shells if not r["void"]]
    own = [[r for r in result.shells if r["body"] == body] for body in bodies]
    assert [len(bodies), sum(r["genus"] for rows in own for r in rows), sum(len(r) - 1 for r in own)] == case.betti
    if certificate["verdict"] == "exact":
        assert certificate["loops_surface"] == count_loops(result.graphs["surface"]) == case.betti[1]
    assert certificate["loops_solid"] == count_loops(result.graphs["solid"]) <= case.betti[1]


@pytest.mark.parametrize("name", [name for name in CASES if CASES[name].loops is not None])
def test_loops_of_the_solid_along_z(name):
    assert outcome(name).certificate["loops_solid"] == CASES[name].loops


def test_every_verdict_is_earned(made):
    _, (_result, certificate, _) = made
    assert [name for name, check in certificate["checks"].items() if not check["holds"]] == []
    assert certificate["verdict"] in ("exact", "exact_at_feature_size")


@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize("name", CASES)
def test_exact_levels_leave_nothing_open(name, direction):
    found = outcome(name, direction).certificate
    assert found["verdict"] == "exact"
    assert found["unseen"] == found["compound"] == found["hidden_genus"] == found["suppressed_loops"] == 0


def test_a_void_between_two_levels_is_told():
    result, certificate, _ = outcome("flat void", refine="none", distance=0.03)
    assert certificate["unseen"] == 1 and certificate["betti_solid"] == [1, 0, 1]
    assert certificate["verdict"] == "exact_at_feature_size"
    (void,) = [row for row in result.pieces if row["kind"] == "unseen"]
    events = {row["handle"] for row in result.handles if row["piece"] == void["piece"]}
    assert len(events) == 2
    # the solid's block around the void holds its two events, and one node stands for both
    counts = nx.get_node_attributes(result.graphs["solid"], "n_handles")
    assert sorted(counts.values()) == [1, 1, 2]
    assert counts[f"h{min(events)}"] == 2
    assert all(row["inner"] is False for row in result.contours)


# --------------------------------------------------------------------------
# Nesting by brute force


def is_inside(point, corners):
    """Whether `point` is inside closed faces (m, 3, 3), all Fractions: parity of a ray that meets no mesh edge."""
    towards = (Fraction(1), Fraction(1, 97), Fraction(1, 8191))
    y0, z0 = (point[k] - point[0] * towards[k] for k in (1, 2))
    crossings = 0
    for face in corners:
        flat = [(c[1] - c[0] * towards[1] - y0, c[2] - c[0] * towards[2] - z0) for c in face]
        turns = [p[0] * q[1] - p[1] * q[0] for p, q in zip(flat, flat[1:] + flat[:1])]
        assert 0 not in turns
        if len({turn > 0 for turn in turns}) == 1:
            x = sum(turn * face[k - 1][0] for k, turn in enumerate(turns)) / sum(turns)
            crossings += x > point[0]
    return crossings % 2 == 1


@pytest.mark.parametrize("name", CASES)
def test_shells_around_each_shell_by_exact_rays(name):
    result = outcome(name).result
    exact = [tuple(Fraction(row[axis]) for axis in "xyz") for row in result.vertices]
    faces = [[] for _ in result.shells]
    for row in result.tables["faces"]:
        faces[row["shell"]].append([exact[row[corner]] for corner in "abc"])
    for own, shell in zip(faces, result.shells):
        weights = Fraction(1, 7), Fraction(2, 7), Fraction(4, 7)
        start = tuple(sum(corner[k] * weight for corner, weight in zip(own[0], weights)) for k in range(3))
        around = [n for n, other in enumerate(faces) if other is not own and is_inside(start, other)]
        sizes = {n: abs(result.shells[n]["volume"]) for n in around}
        assert shell["parent"] == min(around, key=sizes.get, default=None)
        winding = sum(-1 if result.shells[n]["void"] else 1 for n in around)
        assert winding >= 1 if shell["void"] else winding in (0, 1)


def test_contours_around_each_contour_by_parity(made):
    _, (result, _, _) = made
    rings = [np.array(shapely.from_wkb(row["geometry"]).coords)[:-1] for row in result.contours]
    at = {}
    for row in result.contours:
        at.setdefault(row["level"], []).append(row["contour"])
    bodies = [row for row in result.shells if not row["void"] and row["parent"] is not None]
    overlapping = any(not result.shells[body["parent"]]["void"] for body in bodies)
    depth = {}
    for members in at.values():
        around = {c: {d for d in members if d != c and encloses(rings[d], rings[c])} for c in members}
        depth |= {c: len(others) for c, others in around.items()}
        for c in members:
            smallest = min(around[c], key=lambda d: abs(result.contours[d]["signed_area"]), default=None)
            assert result.contours[c]["parent"] == smallest
            assert smallest is None or depth[smallest] + 1 == depth[c] or smallest > c
            if not overlapping:
                assert result.contours[c]["inner"] == (depth[c] % 2 == 1)
                head = smallest if depth[c] % 2 else c
                assert result.contours[c]["region"] == result.contours[head]["region"]


def encloses(ring, other):
    """Whether all vertices of `other` (k, 2) are inside `ring` by the even-odd rule; they agree."""
    (px, py), (qx, qy) = ring.T[:, :, None], np.roll(ring, -1, axis=0).T[:, :, None]
    x, y = other.T[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        hits = ((py > y) != (qy > y)) & (px + (y - py) / (qy - py) * (qx - px) > x)
    inside = hits.sum(axis=0) % 2 == 1
    assert inside.all() or not inside.any()
    return bool(inside.all())


# --------------------------------------------------------------------------
# Which surface arcs bound which arc of the solid


def arcs_of(result, graph):
    return [row for row in result.arcs if row["graph"] == graph]


def test_arcs_bound_what_their_contours_bound(made):
    _, (result, _, _) = made
    solid, surface = arcs_of(result, "solid"), arcs_of(result, "surface")
    wall = {contour: row["arc"] for row in surface for contour in row["nodes"]}
    of_region = [[] for _ in result.nodes]
    for row in result.contours:
        of_region[row["region"]].append((row["inner"], wall[row["contour"]]))
    for row in solid:
        for node in row["nodes"]:
            assert [arc for _, arc in sorted(of_region[node])] == row["bounds"], "at every level of the arc"
        holes = [result.contours[surface[arc]["nodes"][0]]["inner"] for arc in row["bounds"]]
        assert holes == [False] + [True] * (len(holes) - 1)
    assert sorted((s["arc"], c) for s in solid for c in s["bounds"]) == sorted(
        (s, c["arc"]) for c in surface for s in c["bounds"]
    )


def test_a_surface_arc_bounds_a_path_between_its_own_events(made):
    _, (result, certificate, _) = made
    solid = arcs_of(result, "solid")
    assert set(result.graphs["solid"]) <= set(result.graphs["surface"])
    for row in arcs_of(result, "surface"):
        path = [solid[arc] for arc in row["bounds"]]
        assert path and all(low["target"] == high["source"] for low, high in itertools.pairwise(path))
        if certificate["verdict"] == "exact":
            assert (path[0]["source"], path[-1]["target"]) == (row["source"], row["target"])


def test_nodes_tell_how_many_handles_they_stand_for(made):
    _, (result, certificate, _) = made
    for name in ("solid", "surface", "augmented"):
        counts = [n for node, n in result.graphs[name].nodes(data="n_handles") if str(node).startswith("h")]
        assert sum(counts) == len(result.handles), name
        if certificate["verdict"] == "exact":
            assert set(counts) == {1}


def label(result):
    """Every arc by the vertices at its ends and its bounds, whatever the levels: {graph: sorted list}."""
    vertex = [row["vertex"] for row in result.handles]
    ends = {g: [(vertex[r["source"]], vertex[r["target"]]) for r in arcs_of(result, g)] for g in ("solid", "surface")}
    other = {"solid": "surface", "surface": "solid"}
    return {
        g: sorted((ends[g][r["arc"]], sorted(ends[other[g]][k] for k in r["bounds"])) for r in arcs_of(result, g))
        for g in ends
    }


@pytest.mark.parametrize("name", ["winding voids side by side"])
def test_arcs_between_levels_are_bounded_as_levels_between_them_show(name):
    coarse, fine = (outcome(name, "oblique", "exact", distance).result for distance in (1.0, 0.002))
    empty, few = ([row for row in arcs_of(r, "solid") if not row["nodes"]] for r in (coarse, fine))
    assert len(empty) > len(few), "the coarse levels leave arcs of the solid without a level"
    assert label(coarse) == label(fine)
