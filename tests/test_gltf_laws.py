"""Random glTF scenes: what is read is what a slow reading by the letter of the specification gives."""

import numpy as np
from gltf_files import BYTE, FLOAT, SHORT, SIDES, UBYTE, UINT, USHORT, Builder
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment
from scipy.spatial.transform import Rotation

from reebslice.formats.gltf import read_gltf

SPANS = {BYTE: (-128, 127), UBYTE: (0, 255), SHORT: (-32768, 32767), USHORT: (0, 65535)}
HALF = st.integers(-8, 8).map(lambda k: k / 2)
VECTORS = st.tuples(HALF, HALF, HALF).map(list)
SCALES = st.tuples(*[st.sampled_from([-2.0, -1.0, 0.5, 1.0, 3.0])] * 3).map(list)
# Not shrunk: scenes are small, and that can take minutes.
CALM = {"deadline": None, "derandomize": True, "database": None, "phases": (Phase.explicit, Phase.generate)}
TURNS = st.tuples(*[st.integers(-3, 3)] * 4).filter(any).map(lambda q: (np.array(q) / np.linalg.norm(q)).tolist())


def decode(stored, kind, normalized):
    """The equations of the specification, number by number."""
    if not normalized:
        return [[float(c) for c in row] for row in stored]
    divisor = {BYTE: 127, UBYTE: 255, SHORT: 32767, USHORT: 65535}[kind]
    return [[max(c / divisor, -1.0) for c in row] for row in stored]


def cut(ids, mode):
    """The equations of triangles, strips and fans, triangle by triangle."""
    if mode == 4:
        return [ids[3 * i : 3 * i + 3] for i in range(len(ids) // 3)]
    if mode == 5:
        return [[ids[i], ids[i + 1 + i % 2], ids[i + 2 - i % 2]] for i in range(len(ids) - 2)]
    return [[ids[i + 1], ids[i + 2], ids[0]] for i in range(len(ids) - 2)]


def local_matrix(translation, rotation, scale):
    """T R S, by another library's rotation."""
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_quat(rotation).as_matrix() @ np.diag(scale)
    matrix[:3, 3] = translation
    return matrix


@st.composite
def meshes(draw, build):
    """A mesh of one box, and of each primitive its triangles as lists of points in its own frame."""
    kind = draw(st.sampled_from([FLOAT, BYTE, UBYTE, SHORT, USHORT]))
    normalized = kind != FLOAT and draw(st.booleans())
    low, high = SPANS.get(kind, (-50, 50))
    spans = [sorted(draw(st.lists(st.integers(low, high), min_size=2, max_size=2, unique=True))) for _ in range(3)]
    stored = [
        [x, y, z] for z in spans[2] for x, y in zip(spans[0] + spans[0][::-1], np.repeat(spans[1], 2), strict=True)
    ]
    layout = {
        "gap": draw(st.sampled_from([0, 4, 12])),
        "before": draw(st.sampled_from([0, 4])),
        "sparse": draw(st.none() | st.lists(st.integers(0, 7), min_size=1, max_size=8, unique=True).map(sorted)),
    }
    if normalized or kind == FLOAT or layout["sparse"] is None:
        layout["gap"] += -(layout["gap"] + 3 * np.dtype({BYTE: "i1", UBYTE: "u1"}.get(kind, "i2")).itemsize) % 4
    points, primitives, triangles = decode(stored, kind, normalized), [], []
    shared = build.accessor(stored, kind, normalized, **layout)
    for side in SIDES:
        mode = draw(st.sampled_from([4, 5, 6]))
        order = [side[k] for k in {4: (0, 1, 2, 0, 2, 3), 5: (0, 1, 3, 2), 6: (0, 1, 2, 3)}[mode]]
        primitive = {"mode": mode} if mode != 4 or draw(st.booleans()) else {}
        if draw(st.booleans()):
            indices = build.accessor(order, draw(st.sampled_from([UBYTE, USHORT, UINT])))
            primitive |= {"attributes": {"POSITION": shared}, "indices": indices}
        else:
            alone = build.accessor([stored[k] for k in order], kind, normalized)
            primitive |= {"attributes": {"POSITION": alone}}
        primitives.append(primitive)
        triangles.append([[points[k] for k in triangle] for triangle in cut(order, mode)])
    return build.add("meshes", primitives=primitives), triangles


@st.composite
def scenes(draw):
    """A document, and its placed triangles in the order of a walk from the roots down."""
    build = Builder()
    drawn = [draw(meshes(build)) for _ in range(draw(st.integers(1, 3)))]
    count = draw(st.integers(1, 6))
    parents = [draw(st.integers(-1, k - 1)) for k in range(count)]
    matrices, triangles = [], [[] for _ in range(count)]
    for k in range(count):
        parts = draw(VECTORS), draw(TURNS), draw(SCALES)
        local = local_matrix(*parts)
        node = dict(zip(("translation", "rotation", "scale"), parts, strict=True))
        if draw(st.booleans()):
            node = {"matrix": local.T.ravel().tolist()}
        matrices.append(local if parents[k] < 0 else matrices[parents[k]] @ local)
        places = [matrices[k]]
        if draw(st.booleans()) or k == 0:
            mesh, own = draw(st.sampled_from(drawn))
            node["mesh"] = mesh
            if draw(st.integers(0, 3)) == 0:
                extension, instances = draw(instancing(build))
                node["extensions"] = {"EXT_mesh_gpu_instancing": extension}
                places = [matrices[k] @ instance for instance in instances]
            triangles[k] = [place(triangle, matrix) for part in own for matrix in places for triangle in part]
        build.node(root=parents[k] < 0, **node)
    for k, parent in enumerate(parents):
        if parent >= 0:
            build.document["nodes"][parent].setdefault("children", []).append(k)
    order, waiting = [], [k for k in range(count) if parents[k] < 0][::-1]
    while waiting:
        order.append(waiting.pop())
        waiting += build.document["nodes"][order[-1]].get("children", [])[::-1]
    return build, [triangle for k in order for triangle in triangles[k]]


@st.composite
def instancing(draw, build):
    """The extension of a node, and the matrices of its instances."""
    rows = draw(st.lists(st.tuples(VECTORS, TURNS, SCALES), min_size=1, max_size=3))
    kept = draw(st.sets(st.sampled_from([0, 1, 2]), min_size=1))
    rest = ([0, 0, 0], [0, 0, 0, 1], [1, 1, 1])
    names = ("TRANSLATION", "ROTATION", "SCALE")
    attributes = {names[c]: build.accessor([row[c] for row in rows], gap=draw(st.sampled_from([0, 4]))) for c in kept}
    stored = [[np.array(row[c], np.float32).astype(float) if c in kept else rest[c] for c in range(3)] for row in rows]
    return {"attributes": attributes}, [local_matrix(*row) for row in stored]


def place(triangle, matrix):
    """A triangle moved, turned over if the matrix mirrors."""
    moved = [(matrix @ [*point, 1])[:3].tolist() for point in triangle]
    return moved[::-1] if np.linalg.det(matrix[:3, :3]) < 0 else moved


@settings(max_examples=150, **CALM)
@given(scenes(), st.sampled_from([None, "data", "a b.bin"]))
def test_random_scenes(tmp_path_factory, scene, uri):
    build, expected = scene
    path = build.write(tmp_path_factory.mktemp("scene") / ("a.glb" if uri is None else "a.gltf"), uri)
    points, faces, *_ = read_gltf(path)
    found, expected = points[faces], np.array(expected)
    assert found.shape == expected.shape
    # A triangle begins at any corner; which one answers which is found by least distance.
    turned = np.stack([np.roll(expected, k, axis=1) for k in range(3)])
    far = np.abs(found[:, None, None] - turned.transpose(1, 0, 2, 3)).max(axis=(3, 4)).min(axis=2)
    assert far[linear_sum_assignment(far)].max() < 1e-6 * (1 + np.abs(expected).max())


@settings(max_examples=30, **CALM)
@given(scenes())
def test_same_bytes_every_time(tmp_path_factory, scene):
    path = scene[0].write(tmp_path_factory.mktemp("scene") / "a.glb")
    first, second = read_gltf(path), read_gltf(path)
    assert first.points.tobytes() == second.points.tobytes() and first.faces.tobytes() == second.faces.tobytes()
