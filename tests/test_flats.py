"""Flats, ties and sheets closer than rounding: geometry stays sensible, and the graphs exact."""

import json
import tempfile
import warnings
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

import certify
import pipeline
import solids
from corpus.storage import read_json, read_table
from reebslice.planar.outlines import outline_polygons
from reebslice.slicing.exact_contours import encloses, exact_tilt, turns_clockwise
from reebslice.slicing.tables import contour_curves, region_outlines
from test_laws import cases, check_all

FAMILIES = {
    "boxes on a grid": solids.boxes_on_grid(),
    "plateaus": solids.plateau_solids(),
    "combs": solids.combs(),
    "stretched": solids.stretched(),
    "jittered": solids.jittered(),
    "thin shells": solids.thin_shells(),
}
EXACT = {
    **FAMILIES,
    "machined parts": solids.machined_parts(),
    "turned parts": solids.turned(solids.machined_parts()),
    "cones": solids.cones(),
    "wedges": solids.wedge_solids(),
}
# Rational ones, under which many vertices of a grid come to one height, but for rounding.
directions = st.sampled_from([[0, 0, 1], [0, 0, -1], [1, 0, 0], [1, 1, 0], [3, 0, 4], [1, 2, 2], [2, 3, 6], [1, 1, 1]])
samplers = st.sampled_from(["inscribed", "representative", "centroid"])


@pytest.mark.parametrize("family", EXACT)
def test_exact_levels_show_the_reference_graphs(family):
    @cases(6)
    @given(EXACT[family], st.sampled_from([1.0, 0.25]), directions)
    def check(solid, distance, direction):
        check_all(solid, "exact", levels={"distance": distance}, tilt={"mode": "direction", "direction": direction})

    check()


@pytest.mark.parametrize("family", FAMILIES)
def test_geometry_stays_sensible(family):
    @cases(4)
    @given(FAMILIES[family], directions, samplers)
    def check(solid, direction, sampler):
        with tempfile.TemporaryDirectory() as folder:
            run_strictly(solid, folder, direction, sampler)
            check_geometry(folder, np.abs(solid.points).max())

    check()


def run_strictly(solid, folder, direction, sampler):
    """Run all stages so that a warning, or a number that is no number, is an error."""
    with warnings.catch_warnings(), np.errstate(divide="raise", over="raise", invalid="raise"):
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", ResourceWarning)
        tilt = {"mode": "direction", "direction": direction}
        pipeline.run_stages(solid, folder, tilt=tilt, nodes={"sampler": sampler})


def check_geometry(folder, reach):
    tables = {name: read_table(f"{folder}/{name}.parquet", name) for name in ("contours", "nodes", "edges", "arcs")}
    for table in tables.values():
        for field in table.schema:
            if str(field.type) == "double":
                values = table[field.name].drop_null().to_numpy()
                assert np.isfinite(values).all(), field.name
    rounding = 64 * np.finfo(float).eps * reach
    contours = tables["contours"]
    polygons = outline_polygons(region_outlines(contours, contour_curves(contours, contours["geometry"].chunks)))
    assert shapely.is_valid(polygons).all()
    nodes = {name: tables["nodes"][name].to_numpy() for name in ("x", "y", "z", "height", "inscribed_radius", "area")}
    tilted = np.column_stack([nodes[axis] for axis in "xyz"]) @ np.array(read_json(f"{folder}/tilt.json")["rotation"]).T
    assert np.abs(tilted[:, 2] - nodes["height"]).max(initial=0) <= rounding
    assert (nodes["inscribed_radius"] >= 0).all()
    points = shapely.points(tilted[:, :2])
    curves = shapely.from_wkb(tables["contours"]["geometry"].to_numpy(zero_copy_only=False))
    outer = ~tables["contours"]["inner"].to_numpy(zero_copy_only=False)
    boundary = np.empty(len(points), object)
    boundary[tables["contours"]["region"].to_numpy()[outer]] = curves[outer]
    off = np.where(shapely.intersects(polygons, points), 0.0, shapely.distance(boundary, points))
    assert off.max(initial=0) <= rounding, "a node outside its region"
    assert (nodes["area"] > -rounding * (shapely.length(boundary) + rounding)).all()
    assert (nodes["inscribed_radius"] <= np.sqrt(np.maximum(nodes["area"], 0) / np.pi) + rounding).all()


@pytest.mark.parametrize("family", ["boxes on a grid", "jittered", "thin shells", "wedges"])
def test_certified_without_a_tilt(family):
    @cases(4)
    @given(EXACT[family])
    def check(solid):
        with tempfile.TemporaryDirectory() as folder:
            pipeline.run_stages(solid, folder)
            certify.main(Path(folder), Path(folder), pipeline.OPTIONS["levels"])
            certificate = json.loads(Path(folder, "certificate.json").read_text())
            assert [name for name, found in certificate["checks"].items() if not found["holds"]] == []
            assert certificate["verdict"] == "exact"

    check()


@pytest.mark.parametrize("solid, word", [(solids.cube(1), "by_sos"), (solids.blob(1, 1), "proven")])
def test_the_certificate_says_whether_ties_were_broken(solid, word, tmp_path):
    pipeline.run_stages(solid, tmp_path)
    certify.main(tmp_path, tmp_path, pipeline.OPTIONS["levels"])
    certificate = read_json(tmp_path / "certificate.json")
    assert certificate["morse"] == word and certificate["verdict"] == "exact"
    assert ("simulation of simplicity" in certificate["height_interpretation"]) == (word == "by_sos")


# --------------------------------------------------------------------------
# Exact numbers


@cases(50)
@given(st.lists(st.tuples(*[st.integers(-3, 3)] * 3), min_size=4, max_size=12, unique=True), solids.SEEDS)
def test_the_tilt_orders_points_by_their_coordinates(points, seed):
    """Whole ones and such that differ from whole ones by rounding."""
    points = np.array(points, float)
    points += np.random.default_rng(seed).integers(-2, 3, points.shape) * np.finfo(float).eps
    assume((np.ptp(points, axis=0) > 0).all())
    tilt = exact_tilt(points)
    exact = [tuple(map(Fraction, point)) for point in points.tolist()]
    heights = [z + tilt * x + tilt**2 * y for x, y, z in exact]
    by_height = sorted(range(len(points)), key=lambda k: heights[k])
    assert by_height == sorted(range(len(points)), key=lambda k: (exact[k][2], exact[k][0], exact[k][1]))


def test_orientation_and_inclusion_of_polygons_that_touch_themselves():
    bow = [(0, 0), (2, 1), (2, 2), (0, 0), (-2, 2), (-2, 1)]  # two triangles, both counter-clockwise
    assert not turns_clockwise(bow) and turns_clockwise(bow[::-1])
    assert encloses(bow, (Fraction(3, 2), 1)) and encloses(bow, (-1, Fraction(3, 4))) and not encloses(bow, (0, 1))
    tiny = Fraction(1, 2**200)
    sliver = [(0, 0), (1, 0), (1, tiny)]
    assert not turns_clockwise(sliver) and encloses(sliver, (Fraction(1, 2), tiny / 4))
    assert not encloses(sliver, (Fraction(1, 2), tiny))
