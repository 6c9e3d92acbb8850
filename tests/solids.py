"""Small closed meshes of known topology, and hypothesis strategies over them.

Every maker returns a `Solid`: `points` (n, 3) float64, `faces` (m, 3) int64,
counter-clockwise seen from outside the material, each mesh edge in exactly two
faces, no two vertices at one position; and, where theory gives them, the number
of shells, of voids (shells around no material) and the sum of the genera.
"""

from dataclasses import dataclass, replace
from functools import cache

import manifold3d
import numpy as np
from hypothesis import strategies as st

from reebslice.arrays.components import connected_items


@dataclass(frozen=True)
class Solid:
    points: np.ndarray
    faces: np.ndarray
    shells: int | None = None
    voids: int | None = None
    genus: int | None = None

    def __repr__(self):
        """The mesh in full when it is small, so that a failing example can be pasted."""
        if len(self.points) > 40:
            return f"Solid({len(self.points)} vertices, {len(self.faces)} faces)"
        return f"Solid(np.array({self.points.tolist()}), np.array({self.faces.tolist()}))"


def connected_vertices(mesh):
    """Component of every vertex, (n,) int32, numbered by lowest vertex."""
    low, high = mesh.faces[:, :2].ravel(), mesh.faces[:, 1:].ravel()
    return connected_items(low, high, len(mesh.points)).astype(np.int32)


# --------------------------------------------------------------------------
# Making solids out of solids


def unite(*solids):
    """Disjoint union: the caller sees to it that the surfaces do not meet."""
    shifts = np.cumsum([0] + [len(solid.points) for solid in solids])
    known = all(solid.genus is not None for solid in solids)
    return Solid(
        np.concatenate([solid.points for solid in solids]),
        np.concatenate([solid.faces + shift for solid, shift in zip(solids, shifts)]),
        *(sum(getattr(s, name) for s in solids) if known else None for name in ("shells", "voids", "genus")),
    )


def carve(solid):
    """The same surface with its material outside: a void, to be united with what surrounds it."""
    return replace(solid, faces=solid.faces[:, ::-1], voids=solid.shells)


def move(solid, by):
    return replace(solid, points=solid.points + np.asarray(by, float))


def scale(solid, by):
    return replace(solid, points=solid.points * np.asarray(by, float))


def transform(solid, matrix):
    """`matrix` is 3 x 3; a mirroring one turns the faces over, so that they look outside again."""
    faces = solid.faces if np.linalg.det(matrix) > 0 else solid.faces[:, ::-1]
    return replace(solid, points=solid.points @ np.asarray(matrix, float).T, faces=faces)


def permute(solid, seed):
    """The same solid with vertices, faces and corners of faces in another order."""
    random = np.random.default_rng(seed)
    order = random.permutation(len(solid.points))
    faces = np.argsort(order)[solid.faces][random.permutation(len(solid.faces))]
    turns = (random.integers(3, size=len(faces))[:, None] + np.arange(3)) % 3
    return replace(solid, points=solid.points[order], faces=np.take_along_axis(faces, turns, axis=1))


def subdivide(solid, times=1):
    """Each face into four, at the midpoints of its sides: flats become flats of many vertices."""
    for _ in range(times):
        sides = np.sort(solid.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unique, side = np.unique(sides, axis=0, return_inverse=True)
        middles = solid.points[unique].mean(axis=1)
        d, e, f = (side.reshape(-1, 3) + len(solid.points)).T
        a, b, c = solid.faces.T
        faces = np.stack([a, d, f, d, b, e, f, e, c, d, e, f], axis=1).reshape(-1, 3)
        solid = replace(solid, points=np.concatenate([solid.points, middles]), faces=faces)
    return solid


def rotation(seed):
    """A random rotation matrix."""
    basis, upper = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    basis *= np.sign(np.diag(upper))
    return basis if np.linalg.det(basis) > 0 else -basis


# --------------------------------------------------------------------------
# Textbook solids


def tetrahedron():
    points = np.array([[0, 0, 0], [1, 0, 0.1], [0.2, 1, 0.2], [0.3, 0.4, 1]], float)
    return Solid(points, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), 1, 0, 0)


def cube(subdivisions=0):
    """The unit cube: two faces flat, four upright, so heights tie everywhere."""
    return subdivide(voxels(np.ones((1, 1, 1), bool)), subdivisions)


def icosphere(subdivisions=1, radius=1.0):
    golden = (1 + 5**0.5) / 2
    points = np.array(
        [[-1, golden, 0], [1, golden, 0], [-1, -golden, 0], [1, -golden, 0], [0, -1, golden], [0, 1, golden]]
        + [[0, -1, -golden], [0, 1, -golden], [golden, 0, -1], [golden, 0, 1], [-golden, 0, -1], [-golden, 0, 1]]
    )
    faces = [[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2]]
    faces += [[10, 7, 6], [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5]]
    faces += [[2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1]]
    solid = Solid(points, np.array(faces), 1, 0, 0)
    for _ in range(subdivisions):
        solid = subdivide(replace(solid, points=solid.points / np.linalg.norm(solid.points, axis=1)[:, None]))
    return replace(solid, points=radius * solid.points / np.linalg.norm(solid.points, axis=1)[:, None])


def torus(major=2.0, minor=0.7, around=12, across=7, upright=False):
    """Lying it has flat circles of minima and maxima; upright, two saddles one above the other."""
    turn, roll = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    u, v = 2 * np.pi * turn.ravel() / around, 2 * np.pi * roll.ravel() / across
    reach = major + minor * np.cos(v)
    points = np.stack([reach * np.cos(u), reach * np.sin(u), minor * np.sin(v)], axis=1)

    def at(i, j):
        return (i % around * across + j % across).ravel()

    a, b, c, d = at(turn, roll), at(turn + 1, roll), at(turn + 1, roll + 1), at(turn, roll + 1)
    solid = Solid(points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]), 1, 0, 1)
    return transform(solid, [[1, 0, 0], [0, 0, -1], [0, 1, 0]]) if upright else solid


def plate(holes, upright=False):
    """A plate with `holes` square windows side by side: genus = holes."""
    filled = np.ones((2 * holes + 1, 3, 1), bool)
    filled[1::2, 1, 0] = False
    solid = replace(voxels(filled), genus=holes)
    return transform(solid, [[1, 0, 0], [0, 0, -1], [0, 1, 0]]) if upright else solid


def hollow_ball(subdivisions=1):
    return unite(icosphere(subdivisions, 2.0), carve(icosphere(subdivisions, 1.0)))


def nested_shells(count, subdivisions=1):
    """Concentric spheres, material and void in turn from the outside in."""
    spheres = [icosphere(subdivisions, float(count - k)) for k in range(count)]
    return unite(*(carve(sphere) if k % 2 else sphere for k, sphere in enumerate(spheres)))


def ball_in_hollow_ball():
    return nested_shells(3)


def linked_rings():
    return unite(torus(), move(torus(upright=True), [2, 0, 0]))


def monkey_saddle(petals=3):
    """A prism whose top rises and falls `petals` times around its middle: one saddle of that multiplicity.

    The middle is vertex 0. One minimum (at the bottom), `petals` maxima.
    """
    count = 4 * petals
    angle = 2 * np.pi * np.arange(count) / count + 0.1
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    top = np.column_stack([ring, np.cos(petals * (angle - 0.1)) + 0.01 * np.arange(count)])
    bottom = np.column_stack([ring, np.full(count, -3.0)])
    points = np.concatenate([[[0, 0, 0]], top, bottom, [[0, 0, -3]]])
    i, j = np.arange(count), (np.arange(count) + 1) % count
    lid = np.stack([0 * i, i + 1, j + 1], 1)
    base = np.stack([0 * i + 2 * count + 1, j + 1 + count, i + 1 + count], 1)
    wall = [np.stack([i + 1, i + 1 + count, j + 1 + count], 1), np.stack([i + 1, j + 1 + count, j + 1], 1)]
    return Solid(points, np.concatenate([lid, base, *wall]), 1, 0, 0)


def arch():
    """Two legs under a beam: two minima, one join."""
    return voxels(np.array([[[1, 1, 1]], [[0, 0, 1]], [[1, 1, 1]]], bool))


def bowl_shape():
    """A letter U, the arch upside down: two maxima, one split."""
    return voxels(np.array([[[1, 1, 1]], [[1, 0, 0]], [[1, 1, 1]]], bool))


def overhang():
    """A hook whose tip hangs below its arm, leaning over so far that nothing is above its own foot."""
    filled = np.zeros((4, 1, 4), bool)
    filled[0, 0, :], filled[:, 0, 3], filled[3, 0, 1:] = True, True, True
    return transform(voxels(filled), [[1, 0, 2.5], [0, 1, 0.5], [0, 0, 1]])


def staircase(steps=3):
    """Every step a flat: no critical point but the lowest and the highest."""
    x, _, z = np.indices((steps, 1, steps))
    return voxels(z <= x)


def cup():
    """A blind hole from above: a pocket opens (side B) in growing material."""
    filled = np.ones((3, 3, 2), bool)
    filled[1, 1, 1] = False
    return voxels(filled)


def tunnel():
    """A bar with a square hole along y: the hole is seen as a split and a join."""
    filled = np.ones((3, 2, 3), bool)
    filled[1, :, 1] = False
    return replace(voxels(filled), genus=1)


# --------------------------------------------------------------------------
# Solids from numbers


def fill_pinches(filled):
    """Add voxels until no two of them meet in a mere edge or corner, inside or out.

    Around each grid edge and grid vertex both the filled and the empty cells
    have to be connected through faces; where they are not, everything there is filled.
    """
    grid, changed = np.pad(np.asarray(filled, bool), 1), True
    while changed:
        changed = False
        for shape in [(2, 2, 1), (2, 1, 2), (1, 2, 2), (2, 2, 2)]:
            cells, places = int(np.prod(shape)), np.subtract(grid.shape, shape) + 1
            windows = np.lib.stride_tricks.sliding_window_view(grid, shape).reshape(*places, cells)
            codes = windows @ (1 << np.arange(cells))
            for corner in np.argwhere(_pinched_windows(shape)[codes]):
                grid[tuple(slice(c, c + s) for c, s in zip(corner, shape))] = changed = True
        grid = np.pad(grid, 1) if changed else grid
    return grid


@cache
def _pinched_windows(shape):
    """For every filling of a window, as a binary number, whether it is to be filled: (2^cells,) bool."""
    cells = int(np.prod(shape))
    fillings = (np.arange(2**cells)[:, None] >> np.arange(cells) & 1).astype(bool).reshape(-1, *shape)
    return np.array([_count_parts(w) > 1 or _count_parts(~w) > 1 for w in fillings])


def _count_parts(window):
    """Number of face-connected components of a 2 x 2 x 2 window, or a part of one."""
    left = {tuple(cell) for cell in np.argwhere(window)}
    parts = 0
    while left:
        parts, reached = parts + 1, [left.pop()]
        while reached:
            here = np.array(reached.pop())
            near = {cell for cell in left if np.abs(here - cell).sum() == 1}
            left -= near
            reached += near
    return parts


def voxels(filled, diagonals=0):
    """The boundary of unit cells; `filled` is a 3d bool array without pinches.

    `diagonals` seeds the choice of diagonal of each square.
    """
    grid, random = np.pad(np.asarray(filled, bool), 1), np.random.default_rng(diagonals)
    quads = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        unit = np.eye(3, dtype=int)
        step = np.diff(grid.astype(int), axis=axis)
        for sign in (1, -1):
            cells = np.argwhere(step == sign)
            corner = cells + unit[axis] - 1
            square = np.stack([corner, corner + unit[u], corner + unit[u] + unit[v], corner + unit[v]], axis=1)
            quads.append(square if sign == -1 else square[:, ::-1])
    quads = np.concatenate(quads)
    points, index = np.unique(quads.reshape(-1, 3), axis=0, return_inverse=True)
    quads = index.reshape(-1, 4)
    flip = random.integers(2, size=len(quads)) * bool(diagonals)
    quads = np.take_along_axis(quads, (np.arange(4) + flip[:, None]) % 4, axis=1)
    faces = quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
    return Solid(points.astype(float), faces, 1, 0, 0)


def voxels_from_bits(shape, bits, diagonals=0, inverted=False):
    """Voxels filled where `bits`, in binary, says so, pinches filled, topology counted from the cells.

    Inverted, they are caves in a block that they do not reach the outside of.
    """
    filled = np.array([bits >> k & 1 for k in range(np.prod(shape))], bool).reshape(shape)
    grid = fill_pinches(filled)
    if inverted:
        grid = ~np.pad(grid[tuple(slice(c.min(), c.max() + 1) for c in np.nonzero(grid))], 1)
    return replace(voxels(grid, diagonals), **count_topology(grid))


def truss(shape, bits, diagonals=0, inverted=False):
    """Bars along some edges of a lattice of `shape` nodes: as many loops as the lattice graph keeps."""
    filled = np.zeros([2 * n - 1 for n in shape], bool)
    bars = [c for c in np.ndindex(*filled.shape) if sum(k % 2 for k in c) == 1]
    for k, bar in enumerate(bars):
        if bits >> k & 1:
            axis = [c % 2 for c in bar].index(1)
            filled[tuple(slice(c - (a == axis), c + (a == axis) + 1) for a, c in enumerate(bar))] = True
    bits = sum(1 << k for k, cell in enumerate(filled.ravel()) if cell) or 1
    return voxels_from_bits(filled.shape, bits, diagonals, inverted)


def count_topology(grid):
    """Shells, voids and genus of a pinch-free voxel solid, from its cubical complex alone.

    chi(solid) = b0 - b1 + b2, with b0 and b2 from flood fill; genus = b1 and shells = b0 + b2.
    """
    cells = np.argwhere(grid)
    parts = {tuple(2 * cell + np.array(step)) for cell in cells for step in np.ndindex(3, 3, 3)}
    chi = sum((-1) ** sum(coordinate % 2 for coordinate in part) for part in parts)
    b0 = _count_cells(grid)
    b2 = _count_cells(~np.pad(grid, 1)) - 1
    return {"shells": b0 + b2, "voids": b2, "genus": int(b0 + b2 - chi)}


def _count_cells(grid):
    left = {tuple(map(int, cell)) for cell in np.argwhere(grid)}
    count = 0
    while left:
        count, reached = count + 1, [left.pop()]
        while reached:
            x, y, z = reached.pop()
            near = {(x + 1, y, z), (x - 1, y, z), (x, y + 1, z), (x, y - 1, z), (x, y, z + 1), (x, y, z - 1)} & left
            left -= near
            reached += near
    return count


def terrain(top, bottom=None):
    """A slab between two height fields on an integer grid; `top` (a, b) above 0, `bottom` below.

    Whole heights tie, and grid vertices become saddles of every multiplicity. Genus 0.
    """
    top = np.asarray(top, float)
    low = -1 - np.abs(np.zeros_like(top) if bottom is None else np.asarray(bottom, float))
    (a, b), n = top.shape, top.size
    x, y = np.indices((a, b))
    points = np.concatenate([np.stack([x, y, z], axis=-1).reshape(-1, 3) for z in (np.abs(top), low)])
    ids = np.arange(n).reshape(a, b)
    p, q, r, s = (ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:])
    odd = ((x + y) % 2)[:-1, :-1, None] == 1
    one = np.where(odd, np.stack([p, q, r], -1), np.stack([p, q, s], -1)).reshape(-1, 3)
    two = np.where(odd, np.stack([p, r, s], -1), np.stack([q, r, s], -1)).reshape(-1, 3)
    lid = np.concatenate([one, two])
    rim = np.concatenate([ids[:-1, 0], ids[-1, :-1], ids[:0:-1, -1], ids[0, :0:-1]])
    i, j = rim, np.roll(rim, -1)
    wall = np.concatenate([np.stack([i + n, j + n, j], 1), np.stack([i + n, j, i], 1)])
    return Solid(points.astype(float), np.concatenate([lid, lid[:, ::-1] + n, wall]), 1, 0, 0)


def blob(seed, subdivisions=2, roughness=0.3):
    """A sphere with independently scaled radii: star-shaped, so it never meets itself."""
    random = np.random.default_rng(seed)
    sphere = icosphere(subdivisions)
    points = transform(sphere, rotation(seed)).points
    return replace(sphere, points=points * np.exp(random.normal(0, roughness, len(points)))[:, None])


def nested_blobs(seed, count=3, subdivisions=1):
    """Rough spheres, one inside the other, material and void in turn."""
    radii = [3.0 ** (count - k) for k in range(count)]
    shells = [scale(blob(seed + k, subdivisions, 0.15), radius) for k, radius in enumerate(radii)]
    return unite(*(carve(shell) if k % 2 else shell for k, shell in enumerate(shells)))


def csg(seed, steps=4, balls=True):
    """Boxes with whole corners, and low balls, added and taken away; None when nothing is left.

    Topology from manifold3d, without a promise that no two vertices coincide.
    """
    random, solid = np.random.default_rng(seed), manifold3d.Manifold()
    for step in range(steps):
        if balls and random.random() < 0.5:
            part = manifold3d.Manifold.sphere(random.uniform(0.8, 2), 8)
            part = part.rotate(tuple(random.uniform(0, 360, 3))).translate(tuple(random.uniform(1, 5, 3)))
        else:
            part = manifold3d.Manifold.cube(tuple(map(float, random.integers(1, 5, 3))))
            part = part.translate(tuple(map(float, random.integers(0, 4, 3))))
        solid = solid - part if step and random.random() < 0.4 else solid + part
    mesh = solid.to_mesh64()
    points, faces = np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts, dtype=np.int64)
    if not len(faces) or len(np.unique(points, axis=0)) < len(points):
        return None
    return Solid(points, faces, genus=sum(part.genus() for part in solid.decompose()))


# --------------------------------------------------------------------------
# Strategies

SEEDS = st.integers(0, 10**6)


def voxel_solids(shape=(3, 3, 3)):
    """Voxel solids with every kind of tie; shrinks to few voxels."""
    bits = st.integers(1, 2 ** int(np.prod(shape)) - 1)
    return st.builds(voxels_from_bits, st.just(shape), bits, st.integers(0, 3), st.booleans())


def trusses(shape=(3, 2, 2)):
    """Voxel solids of high genus; inverted, caves of high genus."""
    return st.builds(truss, st.permutations(shape), st.integers(1, 2**20 - 1), st.integers(0, 3), st.booleans())


def terrains(size=5, height=3):
    """Height fields of whole numbers, above and below."""
    row = st.lists(st.integers(0, height), min_size=size, max_size=size)
    field = st.lists(row, min_size=size, max_size=size)
    return st.builds(terrain, field, field)


def blobs():
    return st.builds(blob, SEEDS, st.just(1) | st.just(2), st.sampled_from([0.1, 0.3, 0.6]))


def nests():
    return st.builds(nested_blobs, SEEDS, st.integers(1, 4))


def csgs(balls=True):
    return st.builds(csg, SEEDS, st.integers(2, 6), st.just(balls)).filter(lambda solid: solid is not None)


def turned(solids):
    """The same solids under random rotations: no ties left."""
    return st.builds(lambda solid, seed: transform(solid, rotation(seed)), solids, SEEDS)


def any_solids():
    return st.one_of(voxel_solids(), trusses(), terrains(), blobs(), nests(), csgs(False), csgs())


# --------------------------------------------------------------------------
# Solids for flats, ties and multiple saddles


def grid_boxes(boxes, diagonals=0, size=6):
    """The union of boxes with whole corners, given as ((x0, y0, z0), (x1, y1, z1)) within 0..size."""
    grid = np.zeros((size,) * 3, bool)
    for low, high in boxes:
        grid[tuple(slice(min(a, b, size - 1), max(a, b, min(a, b, size - 1) + 1)) for a, b in zip(low, high))] = True
    grid = fill_pinches(grid)
    return replace(voxels(grid, diagonals), **count_topology(grid))


def plateaus(heights, feet=None, diagonals=0):
    """Columns of whole heights (a, b) on a plate, and feet below it: staircases, combs, plateaus at equal heights."""
    heights = np.asarray(heights, int)
    feet = np.zeros_like(heights) if feet is None else np.asarray(feet, int)
    level = np.arange(-feet.max(), heights.max() + 1)
    grid = fill_pinches((level <= heights[..., None]) & (level >= -feet[..., None]))
    return replace(voxels(grid, diagonals), **count_topology(grid))


def stretch(solid, seed, thin=0.0, share=0.4):
    """Its whole coordinates put at increasing numbers, a `share` of the steps as small as `thin`.

    With 0 these lead to the next float. The faces stay parallel to the axes and keep their order, so nothing meets
    that did not meet before.
    """
    random, points = np.random.default_rng(seed), solid.points.copy()
    for axis in range(3):
        whole = np.unique(points[:, axis])
        place = [random.random()]
        for k in range(1, len(whole)):
            small = random.random() < share and k < len(whole) - 1
            place.append(max(place[-1] + (thin if small else random.uniform(0.1, 1)), np.nextafter(place[-1], np.inf)))
        points[:, axis] = np.array(place)[np.searchsorted(whole, points[:, axis])]
    return replace(solid, points=points)


def jitter(solid, seed, ulps=2):
    """Every coordinate moved by a few units in its last place: flats that are flat but for rounding."""
    random = np.random.default_rng(seed)
    steps = random.integers(-ulps, ulps + 1, solid.points.shape)
    unit = np.spacing(np.abs(solid.points).max())
    return replace(solid, points=solid.points + steps * unit)


def thin_shell(solid, thickness, core=False):
    """A star-shaped solid, hollow: its surface shrunk towards the origin is the void's.

    With a core the void is what is thin, between the wall and another copy of the solid.
    """
    inner = scale(solid, 1 - thickness)
    return unite(scale(solid, 2), carve(solid), inner) if core else unite(solid, carve(inner))


def machined(seed, steps=5):
    """A block with round and square holes, grooves and closed cavities; None when nothing is left."""
    random = np.random.default_rng(seed)
    solid = manifold3d.Manifold.cube((6.0, 5.0, 4.0))
    for _ in range(steps):
        kind, place = random.integers(4), random.uniform(0.5, 4.5, 3)
        if kind == 0:
            part = manifold3d.Manifold.cylinder(8.0, random.uniform(0.2, 0.8), circular_segments=7)
            part = part.translate((0, 0, -4)).rotate([(0, 0, 0), (90, 0, 0), (0, 90, 0)][random.integers(3)])
        elif kind == 1:
            part = manifold3d.Manifold.sphere(random.uniform(0.3, 0.9), 8)
        else:
            part = manifold3d.Manifold.cube(tuple(random.integers(1, 8, 3) * 0.5), True)
            place = np.round(2 * place) / 2
        part = part.translate(tuple(place))
        solid = solid + part if kind == 3 else solid - part
    return from_manifold(solid)


def from_manifold(solid):
    """The surface of a manifold3d solid; None where it is empty or vertices coincide."""
    mesh = solid.to_mesh64()
    points, faces = np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts, dtype=np.int64)
    if not len(faces) or len(np.unique(points, axis=0)) < len(points):
        return None
    return Solid(points, faces, genus=sum(part.genus() for part in solid.decompose()))


def cone(seed, size=24, subdivisions=1):
    """All segments from the origin to a patch of a sphere with a winding rim: genus 0.

    Vertex 0 is the tip. Its link is the rim, a closed curve that may cross the horizontal plane many times and
    in any order around the tip.
    """
    random, sphere = np.random.default_rng(seed), icosphere(subdivisions)
    faces = sphere.faces.tolist()
    points = transform(sphere, rotation(seed)).points * random.uniform(1, 2, len(sphere.points))[:, None]
    patch = _grow_disk(faces, random, size)
    rim = {(a, b) for f in patch for a, b in zip(faces[f], faces[f][1:] + faces[f][:1])}
    rim = [(a, b) for a, b in rim if (b, a) not in rim]
    used = sorted({v for f in patch for v in faces[f]})
    name = {v: k + 1 for k, v in enumerate(used)}
    lid = [[name[v] for v in faces[f]] for f in patch]
    wall = [[0, name[b], name[a]] for a, b in rim]
    return Solid(np.concatenate([[[0, 0, 0]], points[used]]), np.array(lid + wall), 1, 0, 0)


def _grow_disk(faces, random, size):
    """Faces of a sphere that form a disk, added one by one so that it stays one, mostly at its newest end."""
    owner = {side: f for f, face in enumerate(faces) for side in zip(face, face[1:] + face[:1])}
    near = [[owner[b, a] for a, b in zip(face, face[1:] + face[:1])] for face in faces]
    patch = [int(random.integers(len(faces)))]
    seen = set(faces[patch[0]])

    def keeps_disk(f):
        shared, fresh = sum(g in patch for g in near[f]), len(set(faces[f]) - seen)
        return f not in patch and (shared, fresh) in ((1, 1), (2, 0))

    while len(patch) < size:
        ends = patch[::-1] if random.random() < 0.9 else random.permutation(patch).tolist()
        f = next((f for end in ends for f in random.permutation(near[end]).tolist() if keeps_disk(f)), None)
        if f is None:
            break
        patch.append(f)
        seen.update(faces[f])
    return patch


def wedges(signs, seed):
    """A prism whose top goes up and down around its middle (vertex 0) as `signs` say; angles and heights vary."""
    random, count = np.random.default_rng(seed), len(signs)
    angle = 2 * np.pi * (np.arange(count) + random.uniform(-0.35, 0.35, count)) / count
    reach = random.uniform(0.5, 2, count)
    ring = np.stack([reach * np.cos(angle), reach * np.sin(angle)], axis=1)
    top = np.column_stack([ring, np.asarray(signs) * random.integers(1, 3, count)])
    bottom = np.column_stack([ring, np.full(count, -3.0)])
    points = np.concatenate([[[0, 0, 0]], top, bottom, [[0, 0, -3]]])
    i, j = np.arange(count), (np.arange(count) + 1) % count
    lid = np.stack([0 * i, i + 1, j + 1], 1)
    base = np.stack([0 * i + 2 * count + 1, j + 1 + count, i + 1 + count], 1)
    wall = [np.stack([i + 1, i + 1 + count, j + 1 + count], 1), np.stack([i + 1, j + 1 + count, j + 1], 1)]
    return Solid(points, np.concatenate([lid, base, *wall]), 1, 0, 0)


def boxes_on_grid(most=8, size=6):
    """Unions of 2 to `most` boxes with whole corners, which touch and share planes as a rule."""
    corner = st.tuples(*[st.integers(0, size)] * 3)
    return st.builds(grid_boxes, st.lists(st.tuples(corner, corner), min_size=2, max_size=most), st.integers(0, 3))


def plateau_solids(size=4, height=3):
    row = st.lists(st.integers(0, height), min_size=size, max_size=size)
    field = st.lists(row, min_size=size, max_size=size)
    return st.builds(plateaus, field, st.one_of(st.none(), field), st.integers(0, 3))


def combs(teeth=5):
    """Rows of teeth of few heights, up and down."""
    row = st.lists(st.integers(0, 2), min_size=2 * teeth - 1, max_size=2 * teeth - 1)
    gaps = row.map(lambda heights: [[h * (k % 2 == 0) for k, h in enumerate(heights)]])
    return st.builds(plateaus, gaps, gaps, st.integers(0, 3))


def flat_solids():
    return st.one_of(boxes_on_grid(5, 4), plateau_solids(3), combs(), voxel_solids())


def stretched():
    """Flat solids with walls and gaps down to the spacing of floats."""
    return st.builds(stretch, flat_solids(), SEEDS, st.sampled_from([0.1, 1e-3, 1e-9, 1e-14, 0.0]))


def jittered():
    return st.builds(jitter, flat_solids(), SEEDS, st.integers(1, 4))


def thin_shells():
    """Hollow solids with thin walls, and such with a core that nearly fills them."""
    stars = st.one_of(blobs(), st.just(move(cube(1), [-0.5, -0.5, -0.5])))
    thickness = st.sampled_from([0.1, 1e-3, 1e-6, 1e-9, 1e-12])
    return st.builds(thin_shell, stars, thickness, st.booleans())


def machined_parts():
    return st.builds(machined, SEEDS, st.integers(2, 7)).filter(lambda solid: solid is not None)


def cones():
    return st.builds(cone, SEEDS, st.integers(20, 120), st.just(2))


def wedge_solids():
    """Saddles of multiplicity 2 to 5, made of neighbouring slopes of any width."""
    runs = st.lists(st.integers(1, 2), min_size=6, max_size=12).map(lambda runs: runs[: len(runs) // 2 * 2])
    signs = runs.map(lambda runs: [(-1) ** k for k, run in enumerate(runs) for _ in range(run)])
    return st.builds(wedges, signs, SEEDS)


# --------------------------------------------------------------------------
# Cavities, and solids in them


def nest(*shells):
    """Shells one inside the other, material and void in turn from the outside in."""
    return unite(*(carve(shell) if k % 2 else shell for k, shell in enumerate(shells)))


def box(width, depth, height, centre=(0.0, 0.0, 0.0)):
    return move(scale(move(cube(), [-0.5, -0.5, -0.5]), [width, depth, height]), centre)


def tube(curve, radius=0.4, around=36, across=5):
    """A tube about a closed curve: `curve` maps (k,) parameters of period 2 pi to (k, 3) points, nowhere straight.

    The cross sections stand in the plane of normal and binormal. The caller
    sees to it that the tube does not meet itself.
    """
    t, step = 2 * np.pi * np.arange(around) / around, 1e-3
    before, here, after = curve(t - step), curve(t), curve(t + step)
    tangent = after - before
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    binormal = np.cross(tangent, after - 2 * here + before)
    binormal /= np.linalg.norm(binormal, axis=1)[:, None]
    normal = np.cross(binormal, tangent)
    roll = 2 * np.pi * np.arange(across) / across
    points = here[:, None] + radius * (
        np.sin(roll)[:, None] * binormal[:, None] - np.cos(roll)[:, None] * normal[:, None]
    )
    return replace(torus(around=around, across=across), points=points.reshape(-1, 3))


def trefoil(radius=0.4, around=36, across=5):
    """A knotted ring."""

    def curve(t):
        return np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], axis=1)

    return tube(curve, radius, around, across)


def winding_voids():
    """Caves side by side in a bar, whose holes open, part, meet and close: most of it without a branch of the solid."""
    caves = [move(arch(), [-11, -0.5, -1.5]), move(bowl_shape(), [-6, -0.5, -1.6]), move(tunnel(), [0, -1, -1.4])]
    return unite(box(30, 9, 9), *map(carve, [*caves, move(torus(1.2, 0.4, upright=True), [8, 0, 0.1])]))
