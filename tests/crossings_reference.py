"""Crossings of faces by brute force in rational numbers: every pair, cut by the line in which their planes meet.

Shares nothing with the library. Where two faces have a stretch of that line
in common, each sheet is seen as two rays in the plane across the line: those
of one sheet must part those of the other.
"""

from fractions import Fraction
from itertools import combinations


def crossing_pairs(points, faces):
    """All pairs of faces (lower, higher) that cross, a set; points (n, 3) and faces (m, 3) of a closed surface."""
    exact = [tuple(map(Fraction, map(float, point))) for point in points]
    unit = max(x.denominator for point in exact for x in point)  # a power of two, as all of them are
    exact = [tuple(int(x * unit) for x in point) for point in exact]  # whole numbers are faster
    corners = [tuple(map(int, face)) for face in faces]
    across = {(a, b): c for face in corners for a, b, c in _turns(face)}
    return {pair for pair in combinations(range(len(corners)), 2) if _cross(exact, corners, across, *pair)}


def _turns(face):
    a, b, c = face
    return (a, b, c), (b, c, a), (c, a, b)


def _cross(points, faces, across, i, j):
    f, g = ([points[v] for v in faces[k]] for k in (i, j))
    if any(max(x) < min(y) or max(y) < min(x) for x, y in zip(zip(*f), zip(*g))):
        return False
    n, m = _normal(f), _normal(g)
    if not any(n) or not any(m):
        return False
    line = _outer(n, m)
    shared = len(set(faces[i]) & set(faces[j]))
    if not any(line):
        if _dot(n, _minus(g[0], f[0])) != 0 or not _overlap(f, g, n):
            return False
        return shared > 1 or _dot(n, m) > 0
    if shared > 1:
        return False
    one, two = _stretch(f, g, m, line), _stretch(g, f, n, line)
    if one is None or two is None or max(one[0], two[0]) >= min(one[1], two[1]):
        return False
    u, v = n, _outer(line, n)  # two directions across the line
    sheets = ((faces[i], [_dot(m, _minus(p, g[0])) for p in f]), (faces[j], [_dot(n, _minus(p, f[0])) for p in g]))
    return _part(*([(_dot(r, u), _dot(r, v)) for r in _rays(points, *sheet, across, line)] for sheet in sheets))


def _stretch(f, g, normal, line):
    """The interval of `line` in which the triangle f meets the plane of g, or None if it is empty or a point."""
    heights = [_dot(normal, _minus(p, g[0])) for p in f]
    ends = [_dot(line, p) for p, h in zip(f, heights) if h == 0]
    for (p, h), (q, k) in combinations(list(zip(f, heights)), 2):
        if h * k < 0:
            ends.append(Fraction(_dot(line, p) * k - _dot(line, q) * h, k - h))
    return (min(ends), max(ends)) if len(ends) > 1 and min(ends) < max(ends) else None


def _rays(points, face, heights, across, line):
    """Directions in which a sheet leaves the line; heights : of the corners over the other plane."""
    if sorted(map(bool, heights)) == [False, False, True]:  # a side in the line: to the apexes on both sides of it
        k = next(k for k in range(3) if heights[k])
        c, a, b = _turns(face)[k]
        return [_minus(points[w], points[a]) for w in (c, across[b, a])]
    p, q, r = (points[v] for v in face)
    within = _outer(_outer(_minus(q, p), _minus(r, p)), line)
    return [within, tuple(-x for x in within)]


def _part(one, two):
    """Whether two rays of the plane part two others strictly; those of a face without area part none."""
    if not all(any(ray) for ray in (*one, *two)):
        return False
    places = [_place(ray, *one) for ray in two]
    return sorted(places) == [-1, 1]


def _place(ray, start, end):
    """+1 strictly between start and end, counter-clockwise, -1 strictly between end and start, 0 on one of them."""
    if _same(ray, start) or _same(ray, end) or _same(start, end):
        return 0
    return 1 if _turn(start, ray) < _turn(start, end) else -1


def _turn(one, two):
    """A number that grows with the angle from one ray to another, in [0, 4)."""
    x, y = one[0] * two[0] + one[1] * two[1], one[0] * two[1] - one[1] * two[0]
    size = abs(x) + abs(y)
    share = Fraction(y, size)
    return share if x >= 0 and y >= 0 else (2 - share if x < 0 else 4 + share)


def _same(one, two):
    return one[0] * two[1] == one[1] * two[0] and one[0] * two[0] + one[1] * two[1] > 0


def _overlap(f, g, normal):
    """Whether two triangles of one plane overlap in an area: neither has a side that the other is beyond."""
    for one, two in ((f, g), (g, f)):
        for a, b, c in _turns(one):
            out = _outer(_minus(b, a), normal)
            inward = _dot(out, _minus(c, a))
            if all(_dot(out, _minus(p, a)) * inward <= 0 for p in two):
                return False
    return True


def _normal(f):
    return _outer(_minus(f[1], f[0]), _minus(f[2], f[0]))


def _minus(p, q):
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


def _outer(p, q):
    return p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]


def _dot(p, q):
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
