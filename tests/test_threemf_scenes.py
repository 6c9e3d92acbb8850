"""All ways to write one 3MF scene give one mesh: that of placement by hand, and of lib3mf."""

import re
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reebslice.formats import threemf_model
from reebslice.formats.attribute_numbers import cut_runs
from reebslice.formats.threemf import read_3mf
from threemf_files import BOX_FACES, CORNERS, HEAD, box, group, model_xml, relationships, write

# --------------------------------------------------------------------------
# The quick way to read runs of elements agrees with the XML parser

PLAIN = {
    "spaces": lambda xml: xml.replace("<vertex ", "\n\t <vertex \n").replace("/>", " />"),
    "apostrophes": lambda xml: re.sub(r'([xyz])="([^"]*)"', r"\1 = '\2'", xml),
    "order": lambda xml: re.sub(r'(x="\S+) (y="\S+) (z="[^"]+")', r"\3 \1 \2", xml),
    "more attributes": lambda xml: xml.replace("v1=", 'pid="1" p:paint="4C" p1="2" v1=').replace("x=", 'p:x="7" x='),
    "end tags": lambda xml: re.sub(r"<(vertex|triangle) ([^>]*)/>", r"<\1 \2 >\n</\1 >", xml),
    "prefix": lambda xml: _prefix(xml),  # noqa: PLW0108, defined below
    "exponents": lambda xml: xml.replace('x="1"', 'x="+1.0e0"').replace('y="0"', 'y="-0."'),
}
NOT_PLAIN = {
    "comment": lambda xml: xml.replace("<vertex ", "<!-- a --><vertex ", 3),
    "hidden run": lambda xml: xml.replace("<mesh>", '<mesh><!--<vertices><vertex x="9" y="9" z="9"/></vertices>-->'),
    "open comment": lambda xml: xml.replace("<mesh>", "<mesh><!-- <vertices> -->"),
    "character references": lambda xml: xml.replace('x="1"', 'x="&#49;"'),
    "other elements": lambda xml: xml.replace("<triangle ", "<p:a/><triangle ", 1),
    "blanks in numbers": lambda xml: xml.replace('x="1"', 'x=" 1 "'),
    "attributes of the run": lambda xml: xml.replace("<vertices>", '<vertices p:a="1">'),
    "the mark": lambda xml: xml.replace("<mesh>", f"<mesh><!-- {threemf_model.MARK.decode()} -->"),
}


def _prefix(xml):
    """The model with a prefix on all elements of the core."""
    xml = re.sub(r"<(/?)(?=[a-z])(?!p:)", r"<\1c:", xml)
    return xml.replace("xmlns=", "xmlns:c=")


@pytest.mark.parametrize("change", [*PLAIN.values(), *NOT_PLAIN.values()], ids=[*PLAIN, *NOT_PLAIN])
def test_all_ways_to_write_a_mesh_give_the_same_mesh(tmp_path, change, monkeypatch):
    xml = model_xml(box(1, (1, 2, 3)) + box(2), '<item objectid="1"/><item objectid="2"/>')
    changed = change(xml)
    assert changed != xml
    expected = read_3mf(write(tmp_path, xml))
    assert _same(read_3mf(write(tmp_path, changed)), expected)
    if change in PLAIN.values():
        assert len(cut_runs(changed.encode(), threemf_model.RUNS)[1]) == 4
    monkeypatch.setattr(threemf_model, "cut_runs", lambda data, runs: (data, []))
    assert _same(read_3mf(write(tmp_path, changed)), expected)


def _same(one, other):
    return np.array_equal(one.points, other.points) and np.array_equal(one.faces, other.faces)


@settings(deadline=None, max_examples=60)
@given(st.lists(st.tuples(*[st.floats(allow_nan=False, allow_infinity=False)] * 3), min_size=1, max_size=20))
def test_numbers_are_correctly_rounded(rows):
    text = "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in rows)
    _, (table,) = cut_runs(f"<vertices>{text}</vertices>".encode(), threemf_model.RUNS)
    assert np.array_equal(table, np.array(rows))


# --------------------------------------------------------------------------
# Random scenes against placement by hand

TURNS = [
    np.array(rows)
    for rows in (
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
        [[0, 1, 0], [-1, 0, 0], [0, 0, 1]],
        [[-1, 0, 0], [0, 1, 0], [0, 0, 1]],
        [[0, 0, 2], [1, 0, 0], [0, 1, 0]],
        [[1, 1, 0], [0, 1, 0], [0, 0, -1]],
    )
]
PLACES = st.tuples(st.sampled_from(range(len(TURNS))), st.tuples(*[st.integers(-9, 9)] * 3))
SOURCES = st.lists(st.tuples(st.integers(0, 30), PLACES), max_size=3)
SCENES = st.tuples(
    st.lists(st.tuples(st.integers(0, 2), st.tuples(*[st.integers(1, 5)] * 3), SOURCES), min_size=1, max_size=7),
    st.lists(st.tuples(st.integers(0, 30), PLACES), min_size=1, max_size=4),
)


def build(scene):
    """The parts of a random scene as XML, and the triangles that it places, found by recursion."""
    things, items = scene
    part_of = [part for part, _, _ in things]
    objects, shapes = ["", "", ""], []

    def refer(index, part, place):
        turn, offset = place
        numbers = [*TURNS[turn].ravel(), *offset]
        path = f'p:path="/3D/{part_of[index]}.model"' if part == 0 and part_of[index] else ""
        return f'objectid="{index + 1}" {path} transform="{" ".join(map(str, numbers))}"'

    for index, (part, size, uses) in enumerate(things):
        seen = [k for k in range(index) if part in (0, part_of[k])]  # parts other than the root see themselves alone
        uses = [(seen[choice % len(seen)], place) for choice, place in uses] if seen else []
        if uses:
            objects[part] += group(index + 1, *(refer(k, part, place) for k, place in uses))
            shapes.append([triangle for k, place in uses for triangle in put(shapes[k], place)])
        else:
            objects[part] += box(index + 1, size)
            shapes.append([tuple(map(tuple, triangle)) for triangle in (CORNERS * size)[BOX_FACES].tolist()])
    items = [(choice % len(things), place) for choice, place in items]
    placed = [triangle for k, place in items for triangle in put(shapes[k], place)]
    rows = "".join(f"<item {refer(k, 0, place)}/>" for k, place in items)
    return [model_xml(objects[0], rows), *(model_xml(text, "") for text in objects[1:])], placed


def put(triangles, place):
    """Triangles moved by a turn and an offset, turned over where the turn mirrors."""
    turn, offset = TURNS[place[0]], place[1]
    moved = [
        tuple(tuple(int(sum(p[i] * turn[i][j] for i in range(3)) + offset[j]) for j in range(3)) for p in triangle)
        for triangle in triangles
    ]
    return [triangle[::-1] if np.linalg.det(turn) < 0 else triangle for triangle in moved]


def count(triangles):
    """Triangles as a multiset, whichever corner they begin at."""
    return Counter(min(t[k:] + t[:k] for k in range(3)) for t in triangles)


def placed_by(mesh):
    """The triangles of a mesh of whole coordinates."""
    return [tuple(tuple(int(x) for x in point) for point in face) for face in mesh.points[mesh.faces].tolist()]


@settings(deadline=None, max_examples=80)
@given(SCENES)
def test_a_random_scene_is_placed_as_by_hand(tmp_path_factory, scene):
    parts, placed = build(scene)
    folder = tmp_path_factory.mktemp("scene")
    path = write(folder, parts[0], {f"3D/{k}.model": text for k, text in enumerate(parts) if k})
    assert count(placed_by(read_3mf(path))) == count(placed)


# --------------------------------------------------------------------------
# Against the consortium's own reader, where it is installed


@settings(deadline=None, max_examples=40)
@given(SCENES)
def test_a_random_scene_is_what_lib3mf_reads(tmp_path_factory, scene):
    lib3mf = pytest.importorskip("lib3mf", reason="lib3mf is not installed; its outcome is kept in the docs")
    parts, placed = build(scene)
    folder = tmp_path_factory.mktemp("scene")
    texts = {f"3D/{k}.model": text for k, text in enumerate(parts) if k}
    rels = relationships(*(f"/3D/{k}.model" for k in range(1, len(parts))))
    types = f'{HEAD}<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    types += '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    types += '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
    path = write(folder, parts[0], texts | {"3D/_rels/3dmodel.model.rels": rels, "[Content_Types].xml": types})
    assert count(read_by_lib3mf(lib3mf, path)) == count(placed) == count(placed_by(read_3mf(path)))


def read_by_lib3mf(lib3mf, path):
    """The triangles that lib3mf's build items place; faces are turned over where a transform mirrors."""
    model = lib3mf.get_wrapper().CreateModel()
    model.QueryReader("3mf").ReadFromFile(str(path))
    triangles = []

    def place(thing, matrix):
        if thing.IsMeshObject():
            mesh = model.GetMeshObjectByID(thing.GetUniqueResourceID())
            points = [[*vertex.Coordinates, 1] @ matrix for vertex in mesh.GetVertices()]
            for face in mesh.GetTriangleIndices():
                corners = tuple(tuple(int(x) for x in points[k]) for k in face.Indices)
                triangles.append(corners[::-1] if np.linalg.det(matrix[:3]) < 0 else corners)
            return
        group_ = model.GetComponentsObjectByID(thing.GetUniqueResourceID())
        for number in range(group_.GetComponentCount()):
            component = group_.GetComponent(number)
            inner = _matrix_of(component.GetTransform())
            place(component.GetObjectResource(), np.column_stack([inner, [0, 0, 0, 1]]) @ matrix)

    items = model.GetBuildItems()
    while items.MoveNext():
        item = items.GetCurrent()
        place(item.GetObjectResource(), _matrix_of(item.GetObjectTransform()))
    return triangles


def _matrix_of(transform):
    """lib3mf's transform as a (4, 3) matrix."""
    return np.array([[transform.Fields[row][column] for column in range(3)] for row in range(4)])
