"""Whether two faces cross, exactly: what is a crossing, and what is only a touch.

Two sheets that touch, in a point, along a line or over an area, do not cross:
they could be drawn apart by next to nothing. Two faces cross

- if they lie in different planes and share a stretch of the line in which
  these meet, where the sheets run through one another: inside both faces, or
  along a side of one of them with its neighbour there beyond the other sheet;
- if they overlap in one plane and face the same way, so that the material under
  both counts twice, or are neighbours across a mesh edge, so that the surface
  is folded there. Others that overlap and face opposite ways are walls that
  touch, and so are the sides of a slot of no width, folded at its bottom, which
  `crossing_places` tells from other folds by the material around.

Where surfaces cross, some pair of faces does so along a stretch or over an
area; what meets in a point alone needs no look. A face without area lies in
the sides of its neighbours, and is passed over.
"""

from ..kernels import njit
from .exact_signs import side_sign, turn_sign

APART, ALONG_SIDE, THROUGH, OVERLAP, FOLD = range(5)


@njit(inner=True)
def judge_pair(points, f, g, work):
    """Judge two faces by themselves.

    Parameters
    ----------
    points : (n, 3) float64
        Of `exact_signs.scale_points`.
    f, g : (3,) int32
        The vertices of each.
    work : (exact_signs.ROOM,) float64
        Overwritten.

    Returns
    -------
    int
        `THROUGH`, `OVERLAP` or `FOLD` if they cross, `APART` if not; `ALONG_SIDE` if they share a stretch along
        a side of one, so that its neighbour there decides.
    """
    n_shared = _count_shared(f, g)
    sides_f, sides_g = _find_sides(points, g, f, work), _find_sides(points, f, g, work)
    if not any_sign(sides_f) or not any_sign(sides_g):
        return _judge_in_plane(points, f, g, n_shared, work)
    if n_shared > 1:
        return APART
    p, q = _find_tip(sides_f), _find_tip(sides_g)
    if p < 0 or q < 0 or not _share_stretch(points, f, g, (p, q, sides_f[p], sides_g[q]), work):
        return APART
    return THROUGH if _is_through(sides_f) and _is_through(sides_g) else ALONG_SIDE


@njit(inner=True)
def any_sign(sides):
    """Whether some of three signs is not 0."""
    return sides[0] != 0 or sides[1] != 0 or sides[2] != 0


@njit
def _count_shared(f, g):
    count = 0
    for v in f:
        count += v == g[0] or v == g[1] or v == g[2]
    return count


@njit
def _find_sides(points, plane, f, work):
    """On which side of the plane of one face each vertex of another is."""
    corners = (plane[0], plane[1], plane[2])
    return (
        side_sign(points, corners, f[0], work),
        side_sign(points, corners, f[1], work),
        side_sign(points, corners, f[2], work),
    )


@njit(inner=True)
def _find_tip(sides):
    """The corner that is off a plane on a side on which the others are not, if they meet it in two points; or -1."""
    for k in range(3):
        if sides[k] != 0 and sides[k] * sides[(k + 1) % 3] <= 0 and sides[k] * sides[(k + 2) % 3] <= 0:
            return k
    return -1


@njit(inner=True)
def _is_through(sides):
    """Whether there are corners on both sides of the plane."""
    return min(sides) < 0 < max(sides)


@njit(inner=True)
def _share_stretch(points, f, g, tips, work):
    """Whether the stretches in which two faces meet the line of their planes overlap by more than a point.

    tips : the tip of f, that of g, and on which side of the other plane each
    is. The ends of a stretch are on the sides that go out from its tip; of two
    ends, one on either face, the sign of a determinant tells the order (Guigue
    and Devillers 2003, doi:10.1080/10867651.2003.10487580).
    """
    p, q, side_f, side_g = tips
    a, b, c = f[p], f[(p + 1) % 3], f[(p + 2) % 3]
    d, e, h = g[q], g[(q + 1) % 3], g[(q + 2) % 3]
    if side_f < 0:
        e, h = h, e
    if side_g < 0:
        b, c = c, b
    return side_sign(points, (a, b, d), e, work) < 0 and side_sign(points, (a, c, h), d, work) < 0


@njit(inner=True)
def _judge_in_plane(points, f, g, n_shared, work):
    """Judge two faces in one plane, or of which one has no area."""
    axis = 0
    while axis < 3 and turn_sign(points, (f[0], f[1], f[2]), axis, work) == 0:
        axis += 1
    if axis == 3:
        return APART
    way_f, way_g = (
        turn_sign(points, (f[0], f[1], f[2]), axis, work),
        turn_sign(points, (g[0], g[1], g[2]), axis, work),
    )
    if way_g == 0 or _is_cut_off(points, f, g, (axis, way_f), work) or _is_cut_off(points, g, f, (axis, way_g), work):
        return APART
    if n_shared > 1:
        return FOLD
    return OVERLAP if way_f == way_g else APART


@njit(inner=True)
def _is_cut_off(points, f, g, seen, work):
    """Whether no vertex of g is inside the line of some side of f; seen : the axis of view, and the way f turns."""
    axis, way = seen
    for k in range(3):
        inside = False
        for v in g:
            inside |= turn_sign(points, (f[k], f[(k + 1) % 3], v), axis, work) == way
        if not inside:
            return True
    return False


@njit(inner=True)
def judge_along_side(points, faces, twins, pair, work):
    """Judge two faces that share a stretch along a side of one of them, or of both.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int32
    twins : (3 m,) int32
        The other half-edge of each mesh edge.
    pair : tuple of 2 int
        Faces of which `judge_pair` says `ALONG_SIDE`.
    work : (exact_signs.ROOM,) float64
        Overwritten.

    Returns
    -------
    bool
        Whether the sheets run through one another there.
    """
    f, g = faces[pair[0]], faces[pair[1]]
    sides_f, sides_g = _find_sides(points, g, f, work), _find_sides(points, f, g, work)
    p, q = _find_tip(sides_f), _find_tip(sides_g)
    beyond_f, beyond_g = _apex_beyond(faces, twins, pair[0], p), _apex_beyond(faces, twins, pair[1], q)
    if _is_through(sides_f):
        return side_sign(points, (f[0], f[1], f[2]), beyond_g, work) * sides_g[q] < 0
    if _is_through(sides_g):
        return side_sign(points, (g[0], g[1], g[2]), beyond_f, work) * sides_f[p] < 0
    axis = f[(p + 1) % 3], f[(p + 2) % 3]
    if not _is_proper(points, axis, beyond_f, f[p], g[q], work):
        return False
    one = _is_between(points, axis, (f[p], beyond_f, g[q]), work)
    two = _is_between(points, axis, (f[p], beyond_f, beyond_g), work)
    return one != 0 and two != 0 and one != two


@njit(inner=True)
def _apex_beyond(faces, twins, f, k):
    """The vertex of the neighbour across the side of f opposite its corner k."""
    twin = twins[3 * f + (k + 1) % 3]
    return faces[twin // 3, (twin % 3 + 2) % 3]


@njit(inner=True)
def _is_proper(points, axis, one, other, beside, work):
    """Whether half-planes through two vertices are not one; `beside` is a vertex in the plane of neither."""
    turn = side_sign(points, (axis[0], axis[1], one), beside, work)
    if side_sign(points, (axis[0], axis[1], one), other, work) != 0:
        return True
    return turn == -side_sign(points, (axis[0], axis[1], other), beside, work)


@njit(inner=True)
def _is_between(points, axis, vertices, work):
    """Whether a half-plane is between two others: +1 if so, going around the axis from the one to the other.

    vertices : of the one, the other and the third, one each. -1 if it is
    between the other and the one; 0 if it is one of them.
    """
    x, y, z = vertices
    width = side_sign(points, (axis[0], axis[1], x), y, work)
    left, right = (
        side_sign(points, (axis[0], axis[1], x), z, work),
        side_sign(points, (axis[0], axis[1], z), y, work),
    )
    if left == 0 or right == 0:  # it is one of them, or opposite to one
        if width == 0 or left + right != -width:
            return 0
        return -width
    if width == 0:
        return left
    if width > 0:
        return 1 if left > 0 and right > 0 else -1
    return -1 if left < 0 and right < 0 else 1
