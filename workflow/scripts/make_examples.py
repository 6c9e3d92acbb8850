"""Write the example meshes: shapes that are known by their holes, voids and parts.

Usage: python make_examples.py FOLDER

Every file is a closed surface; together they cover six formats and the events
of a Reeb graph: loops that stand and lie, a void with a ball in it, parts that
link without touching, holes through flat plates, branches.
"""

import sys
import zipfile
from pathlib import Path

import manifold3d
import numpy as np
import trimesh
from numba import njit

# name: (genus, voids, shells), known from how the shape is made.
EXPECTED = {
    "torus_upright.stl": (1, 0, 1),
    "torus_lying.ply": (1, 0, 1),
    "double_torus.off": (2, 0, 1),
    "ball_in_hollow_ball.glb": (0, 1, 3),
    "bracket.stl": (7, 0, 1),
    "linked_rings.3mf": (3, 0, 3),
    "vase.obj": (1, 0, 1),
    "trefoil_knot.ply": (1, 0, 1),
    "tree.off": (0, 0, 1),
}


def main(folder):
    """Write every file of `EXPECTED` into `folder`, made if it is not there."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    shapes = {
        "torus_upright.stl": make_torus(30, 11, stands=True),
        "torus_lying.ply": make_torus(30, 11, stands=False),
        "double_torus.off": make_double_torus(),
        "ball_in_hollow_ball.glb": make_ball_in_hollow_ball(),
        "bracket.stl": make_bracket(),
        "linked_rings.3mf": make_linked_rings(),
        "vase.obj": make_vase(),
        "trefoil_knot.ply": make_trefoil(),
        "tree.off": make_tree(),
    }
    for name, parts in shapes.items():
        write_parts(folder / name, parts if isinstance(parts, list) else [parts])


# --------------------------------------------------------------------------
# Shapes


def sweep_tube(centres, radius, n_around=40):
    """Return a closed tube around the closed curve `centres` (n, 3).

    radius : number or (n,). The frame is carried along without twist; what it
    lacks to close is spread over the whole length.
    """
    n = len(centres)
    ahead = np.roll(centres, -1, axis=0) - np.roll(centres, 1, axis=0)
    tangents = ahead / np.linalg.norm(ahead, axis=1)[:, None]
    frame = np.empty((n + 1, 3))
    frame[0] = np.cross(tangents[0], np.eye(3)[np.argmin(np.abs(tangents[0]))])
    for i in range(n):
        carried = frame[i] - tangents[(i + 1) % n] * (frame[i] @ tangents[(i + 1) % n])
        frame[i + 1] = carried / np.linalg.norm(carried)
    frame[0] /= np.linalg.norm(frame[0])
    side = np.cross(tangents[0], frame[0])
    lack = np.arctan2(frame[n] @ side, frame[n] @ frame[0])
    across = np.cross(tangents, frame[:n])
    angle = 2 * np.pi * np.arange(n_around) / n_around - lack * np.arange(n)[:, None] / n
    ring = np.cos(angle)[..., None] * frame[:n, None] + np.sin(angle)[..., None] * across[:, None]
    points = centres[:, None] + np.broadcast_to(radius, n)[:, None, None] * ring
    return trimesh.Trimesh(points.reshape(-1, 3), _grid_faces(n, n_around), process=False)


def _grid_faces(n, m):
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    a, b = i * m + j, (i + 1) % n * m + j
    c, d = (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m
    return np.stack([a, b, c, a, c, d], axis=-1)[..., [0, 2, 1, 3, 5, 4]].reshape(-1, 3)


def circle(radius, n, axis=2):
    """Return (n, 3) points on a circle about the given coordinate axis."""
    angle = 2 * np.pi * np.arange(n) / n
    points = np.zeros((n, 3))
    points[:, (axis + 1) % 3] = radius * np.cos(angle)
    points[:, (axis + 2) % 3] = radius * np.sin(angle)
    return points


def make_torus(radius, tube, stands):
    """A ring that lies flat, or one that stands on its rim."""
    return sweep_tube(circle(radius, 72, axis=1 if stands else 2), tube, 36)


def make_trefoil():
    """A trefoil knot that breathes: its tube thickens and thins along the way."""
    t = 2 * np.pi * np.arange(240) / 240
    x = np.sin(t) + 2 * np.sin(2 * t)
    y = np.cos(t) - 2 * np.cos(2 * t)
    z = -1.3 * np.sin(3 * t)
    return sweep_tube(10 * np.column_stack([x, z, y]), 4.2 + 0.9 * np.cos(3 * t), 32)


def make_linked_rings():
    """Three rings of a chain, linked without touching, tilted each its own way."""
    rings = []
    for k in range(3):
        roll = trimesh.transformations.rotation_matrix(np.pi / 2 * k + 0.35, [1, 0, 0])
        turn = trimesh.transformations.rotation_matrix(0.15 * (k - 1), [0, 0.4, 1])
        shift = trimesh.transformations.translation_matrix([36 * k, 0, 3 * k])
        oval = circle(24, 72) * [1.15, 0.9, 1]
        rings.append(sweep_tube(oval, 4.6 + 0.7 * k, 24).apply_transform(shift @ turn @ roll))
    return rings


def make_ball_in_hollow_ball():
    """A ball that lies in the void of a hollow ball, a little off its centre."""
    outer, void, ball = (trimesh.creation.icosphere(subdivisions=4) for _ in range(3))
    outer.apply_scale(30)
    void.apply_scale(22)
    void.invert()
    ball.apply_scale(9).apply_translation([3, -2, -8])
    return [outer, void, ball]


def make_bracket():
    """An angle bracket with a gusset: four holes in its foot, three in its back.

    Each goes right through, which makes the genus seven.
    """
    box, drill = manifold3d.Manifold.cube, manifold3d.Manifold.cylinder
    foot = box([80, 50, 8])
    back = box([8, 50, 70])
    gusset = manifold3d.CrossSection([[(4, 4), (60, 4), (4, 56)]]).extrude(8)
    gusset = gusset.rotate([90, 0, 0]).translate([0, 29, 0])
    solid = foot + back + gusset
    hole = drill(20, 4.0, circular_segments=48)
    for x, y in [(28, 11), (64, 11), (28, 39), (64, 39)]:
        solid -= hole.translate([x, y, -5])
    for y, z, wide in [(11, 28, 1), (39, 28, 1), (25, 64, 0.6)]:
        solid -= hole.scale([wide, wide, 1]).rotate([0, 90, 0]).translate([-5, y, z])
    return _to_trimesh(solid.refine_to_length(4.0))


def make_vase():
    """A vase, open at the top, with one handle."""
    z = np.linspace(0, 60, 49)
    outside = 13 + 9 * np.sin(z / 60 * 2.6 + 0.35) ** 2 + 3.5 * np.exp(-(((z - 60) / 6) ** 2))
    profile = np.column_stack([outside, z])
    inside = np.column_stack([outside - 2.6, z])[::-1]
    outline = np.concatenate([[[0, 0]], profile, inside[inside[:, 1] > 3], [[0, 3]]])
    body = manifold3d.CrossSection([outline]).revolve(72)
    t = 2 * np.pi * np.arange(96) / 96
    ear = np.column_stack([15 * np.cos(t) + 21, 0 * t, 14 * np.sin(t) * (1 + 0.2 * np.sin(t)) + 33])
    handle = _to_manifold(sweep_tube(ear, 2.3 + 0.5 * np.cos(t), 24))
    cavity = manifold3d.CrossSection([np.concatenate([[[0, 3]], inside[::-1] + [0.3, 0], [[0, 60]]])])
    return _to_trimesh(body + (handle - cavity.revolve(72)))


def make_double_torus():
    """Two rings that melt into each other, standing like an eight."""

    def distance(x, y, z):
        rings = [np.hypot(np.hypot(x, z - c) - 15, 0.9 * y) - 6.5 for c in (-16.5, 16.5)]
        return -_melt(rings, 4.0)

    return _trace(distance, [-26, -12, -42], [26, 12, 42], 1.9)


def make_tree():
    """A trunk with five boughs that fork into twigs, all melted together."""
    limbs = [((0, 0, 0), (1, -1, 26), 5.5, 3.9)]
    for k in range(5):
        turn, rise = 2.4 * k + 0.4, 17 + 2.6 * k
        start = np.array([0.03 * rise, -0.03 * rise, rise - 1])
        along = np.array([np.cos(turn), np.sin(turn), 0.75 + 0.12 * k])
        fork = start + 15 * along
        limbs.append((start, fork, 2.9, 2.0))
        for lean in (-0.55, 0.5):
            twig = np.array([np.cos(turn + lean), np.sin(turn + lean), 0.9 + lean / 3])
            limbs.append((fork, fork + 9 * twig, 2.0, 1.4))
    limbs = np.array([[*start, *end, thick, thin] for start, end, thick, thin in limbs])
    return _trace(lambda x, y, z: -_limb_distance(x, y, z, limbs), [-28, -28, -8], [28, 28, 60], 1.35)


@njit(cache=True)
def _limb_distance(x, y, z, limbs):
    # A smooth minimum as in `_melt`, over rods that taper from start to end.
    point = np.array([x, y, z])
    total = 0.0
    for limb in limbs:
        span, away = limb[3:6] - limb[0:3], point - limb[0:3]
        along = min(max(np.sum(away * span) / np.sum(span * span), 0.0), 1.0)
        gap = np.sqrt(np.sum((away - along * span) ** 2))
        total += np.exp((limb[6] + along * (limb[7] - limb[6]) - gap) / 0.9)
    return -0.9 * np.log(total + 1e-300)


def _melt(distances, softness):
    """Smooth minimum of distances: parts near each other flow together."""
    distances = np.asarray(distances)
    nearest = distances.min()
    return nearest - softness * np.log(np.sum(np.exp((nearest - distances) / softness)))


def _trace(distance, low, high, step):
    return _to_trimesh(manifold3d.Manifold.level_set(distance, [*low, *high], step))


def _to_manifold(mesh):
    return manifold3d.Manifold(manifold3d.Mesh(mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32)))


def _to_trimesh(solid):
    mesh = solid.to_mesh()
    return trimesh.Trimesh(mesh.vert_properties[:, :3], mesh.tri_verts, process=False)


# --------------------------------------------------------------------------
# Files


def write_parts(path, parts):
    """Write parts as one file; a 3MF keeps them apart, other formats join them."""
    if path.suffix == ".3mf":
        write_3mf(path, parts)
        return
    whole = trimesh.util.concatenate(parts)
    whole.vertices = whole.vertices.astype(np.float32)
    trimesh.Trimesh(whole.vertices, whole.faces, process=False).export(path)


def write_3mf(path, parts):
    """Write a 3MF whose bytes depend on the meshes only (no time stamps)."""
    objects, items = [], []
    for k, part in enumerate(parts, 1):
        corners = "".join(f'<vertex x="{x:.7g}" y="{y:.7g}" z="{z:.7g}"/>' for x, y, z in part.vertices)
        faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in part.faces)
        objects.append(
            f'<object id="{k}" type="model"><mesh><vertices>{corners}</vertices>'
            f"<triangles>{faces}</triangles></mesh></object>"
        )
        items.append(f'<item objectid="{k}"/>')
    core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    package = "http://schemas.openxmlformats.org/package/2006"
    model = (
        f'<model unit="millimeter" xml:lang="en-US" xmlns="{core}"><resources>{"".join(objects)}'
        f"</resources><build>{''.join(items)}</build></model>"
    )
    types = (
        f'<Types xmlns="{package}/content-types"><Default Extension="rels" ContentType='
        '"application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model"'
        ' ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
    )
    links = (
        f'<Relationships xmlns="{package}/relationships"><Relationship Target="/3D/3dmodel.model"'
        ' Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
    )
    files = {"[Content_Types].xml": types, "_rels/.rels": links, "3D/3dmodel.model": model}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, '<?xml version="1.0" encoding="UTF-8"?>\n' + text)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
