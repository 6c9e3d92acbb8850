"""One solid through every format, unit and transform that it can express has one and the same graph."""

from collections import Counter

import numpy as np
import pytest

import gltf_files
import mesh_writers
import solids
import threemf_files
from reebslice import exact_graphs, inspect_surface, read_mesh

SOLIDS = {
    "ball": solids.icosphere(2),
    "plate": solids.plate(2),
    "upright plate": solids.plate(3, upright=True),
    "torus": solids.torus(),
    "upright torus": solids.torus(upright=True),
    "linked rings": solids.linked_rings(),
    "hollow ball": solids.ball_in_hollow_ball(),
    "cup": solids.cup(),
    "nested shells": solids.nested_shells(3),
    "wedges": solids.wedges([1, -1, 1, 1, -1, 1, -1, -1], 5),
} | {f"blob {seed}": solids.blob(seed, 1) for seed in range(20)}
"""Thirty of them."""


def arrays(solid):
    """Points that single precision holds exactly, as some formats hold no more, and faces."""
    return np.asarray(solid.points, np.float32).astype(float), np.asarray(solid.faces)


def summary(points, faces):
    """What is the same whatever the order of vertices and faces: counts, measures, both graphs."""
    tables, record = inspect_surface(points, faces)
    assert tables is not None, record["reason"]
    points = np.column_stack([tables["vertices"][axis] for axis in "xyz"])
    faces = np.column_stack([tables["faces"][corner] for corner in "abc"])
    figures = [record[name] for name in ("components", "genus", "voids", "n_vertices", "n_faces")]
    graphs = [
        Counter((tuple(points[graph.vertex[a]]), tuple(points[graph.vertex[b]])) for a, b in graph.arcs)
        for graph in exact_graphs(points, faces)
    ]
    return figures, graphs, (record["area"], record["volume"])


def assert_same(file, expected, scale=1.0, shift=(0, 0, 0)):
    figures, graphs, measures = summary(file.points, file.faces)
    assert figures == expected[0]
    for found, wanted in zip(graphs, expected[1], strict=True):
        moved = Counter()
        for (low, high), count in wanted.items():
            moved[tuple(np.array(low) * scale + shift), tuple(np.array(high) * scale + shift)] += count
        assert found == moved
    assert measures == pytest.approx((expected[2][0] * scale**2, expected[2][1] * scale**3), rel=1e-5)


@pytest.mark.parametrize("name", SOLIDS)
def test_a_solid_is_the_same_in_every_format(name, tmp_path):
    points, faces = arrays(SOLIDS[name])
    expected = summary(points, faces)
    for end in mesh_writers.FORMATS:
        file = read_mesh(mesh_writers.write_mesh(tmp_path / f"a.{end}", points, faces.tolist()))
        assert file.unit is None
        assert_same(file, expected)
    document = gltf_files.Builder()
    indices = document.accessor(faces.ravel(), gltf_files.UINT)
    mesh = document.add(
        "meshes", primitives=[{"attributes": {"POSITION": document.accessor(points)}, "indices": indices}]
    )
    document.node(mesh=mesh, scale=[2, 2, 2], translation=[8, 0, -4])
    for ending, uri in (("glb", None), ("gltf", "data"), ("gltf", "my part.bin")):
        path = tmp_path / f"b.{ending}"
        document.write(path, uri)
        file = read_mesh(path)
        assert file.unit == "metre"
        assert_same(file, expected, scale=2.0, shift=(8, 0, -4))
    for unit in ("millimeter", "inch"):
        file = read_mesh(write_3mf(tmp_path, points, faces, unit))
        assert file.unit == {"millimeter": "millimetre"}.get(unit, unit)
        assert_same(file, expected, scale=2.0, shift=(8, 0, -4))


def write_3mf(folder, points, faces, unit):
    """A package whose object is reached through a component, moved by half by it and by half by the item."""
    vertices = "".join('<vertex x="{!r}" y="{!r}" z="{!r}"/>'.format(*map(float, point)) for point in points)
    triangles = "".join('<triangle v1="{}" v2="{}" v3="{}"/>'.format(*face) for face in faces.tolist())
    mesh = f'<object id="1"><mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh></object>'
    group = threemf_files.group(2, 'objectid="1" transform="2 0 0 0 2 0 0 0 2 8 0 0"')
    item = '<item objectid="2" transform="1 0 0 0 1 0 0 0 1 0 0 -4"/>'
    return threemf_files.write(
        folder, threemf_files.model_xml(mesh + group, item, f'unit="{unit}"'), name=f"{unit}.3mf"
    )
