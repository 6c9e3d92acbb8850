"""Linking numbers of closed curves with loops beside a surface: the slow way to tell handles from tunnels.

A closed curve on a surface bounds in the material if and only if it links no
closed curve in the void (Alexander duality), and every curve in the void is
homologous there to one just outside the surface; likewise for the void. So it
takes a basis of the first homology of the surface, pushed off on either side.
"""

import numpy as np

from reebslice.arrays.components import find


def loops_of_faces(faces):
    """A basis of the first homology as closed runs of half-edges, each crossed from its face into the next one.

    Tree and cotree: a spanning forest of the faces; one of the vertices that crosses none of its mesh edges; every
    mesh edge in neither closes a run of faces.
    """
    half_edge = {(int(a), int(b)): 3 * f + k for f, face in enumerate(faces) for k, (a, b) in enumerate(_sides(face))}
    twin = [half_edge[int(b), int(a)] for face in faces for a, b in _sides(face)]
    came, depth, crossed = [None] * len(faces), [-1] * len(faces), set()
    for first in range(len(faces)):
        queue = [first] if depth[first] < 0 else []
        depth[first] = max(depth[first], 0)
        for f in queue:
            for h in range(3 * f, 3 * f + 3):
                g = twin[h] // 3
                if depth[g] < 0:
                    depth[g], came[g] = depth[f] + 1, h
                    crossed |= {h, twin[h]}
                    queue.append(g)
    root, loops = np.arange(int(faces.max()) + 1), []
    for h in range(3 * len(faces)):
        a, b = find(root, int(faces[h // 3, h % 3])), find(root, int(faces[h // 3, (h % 3 + 1) % 3]))
        if h in crossed or h > twin[h]:
            continue
        if a != b:
            root[a] = b
            continue
        there, back, f, g = [], [], h // 3, twin[h] // 3
        while f != g:
            if depth[f] >= depth[g]:
                back.append(came[f])
                f = came[f] // 3
            else:
                there.append(twin[came[g]])
                g = came[g] // 3
        loops.append([h, *there, *back[::-1]])
    return loops, twin


def _sides(face):
    return zip(face, np.roll(face, -1))


def push_off(points, faces, loops, by):
    """Closed curves through the middles of faces and of mesh edges, at a distance `by` on the outer side."""
    runs, twin = loops
    a, b, c = (points[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    middle = points[faces].mean(axis=1)
    curves = []
    for run in runs:
        curve = []
        for h in run:
            f, g = h // 3, twin[h] // 3
            edge = (points[faces[f, h % 3]] + points[faces[f, (h % 3 + 1) % 3]]) / 2
            curve += [middle[f] + by * normal[f], edge + by * (normal[f] + normal[g]) / 2]
        curves.append(np.array(curve))
    return curves


def linking_number(one, other):
    """Of two closed polygons, by the solid angles of Gauss' integral."""
    a, b = one[:, None], np.roll(one, -1, axis=0)[:, None]
    c, d = other[None], np.roll(other, -1, axis=0)[None]
    corners = [a - c, b - c, b - d, a - d]
    corners = [p / np.linalg.norm(p, axis=2)[..., None] for p in corners]
    angle = _solid_angle(corners[0], corners[1], corners[2]) + _solid_angle(corners[2], corners[3], corners[0])
    total = angle.sum() / (4 * np.pi)
    assert abs(total - round(total)) < 1e-3, "the curves touch"
    return round(total)


def _solid_angle(a, b, c):
    """Signed, of spherical triangles (Van Oosterom and Strackee 1983)."""
    return 2 * np.arctan2(
        np.einsum("ijk,ijk->ij", a, np.cross(b, c)),
        1 + np.einsum("ijk,ijk->ij", a, b) + np.einsum("ijk,ijk->ij", b, c) + np.einsum("ijk,ijk->ij", c, a),
    )


def kinds_by_linking(points, faces, circles, by=1e-6):
    """Whether each closed curve on a surface bounds in its material and in its void."""
    loops, by = loops_of_faces(faces), by * np.ptp(points, axis=0).max()
    sides = [push_off(points, faces, loops, step) for step in (by, -by)]
    return [tuple(not any(linking_number(circle, curve) for curve in side) for side in sides) for circle in circles]
