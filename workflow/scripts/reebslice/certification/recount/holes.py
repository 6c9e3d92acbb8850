"""Which contour lies in which at its level, counted again.

Only what no rank can decide is done here with coordinates. What rounding
leaves open is decided in rational numbers, or the answer is "open", never a
guess.
"""

import numpy as np
import shapely

from ...kernels import njit
from .curves import look


class ContourNesting:
    """The contours and what is known of them: closed curves, their boxes, signed area, its error, level.

    noise : how far a curve may be from its contour; exact : what tells of the
    contours in exact numbers, :class:`exact_levels.ExactLevels`
    """

    def __init__(self, curves, boxes, area, slack, level, noise, exact):
        self.curves, self.level, self.noise, self.exact = curves, level, noise, exact
        self.size, self.slack = np.abs(area), slack
        order = np.lexsort((boxes[:, 0], level))
        one, other = _find_near(order, boxes, level, self.size, slack, noise)
        order = np.lexsort((other, self.size[other], one))
        one, other = one[order], other[order]
        starts = np.flatnonzero(np.diff(one, prepend=-1))
        # of each contour those of its level that may be around it or cross it, the smallest first
        self.near = {k: run.tolist() for k, run in zip(one[starts].tolist(), np.split(other, starts[1:]))}
        self.shares = {}

    def innermost(self, contour, members):
        """Find the smallest contour around another.

        Parameters
        ----------
        contour : int
        members : list of int
            What may be around it, the smallest first.

        Returns
        -------
        best : int
            -1 for none. A member that touches counts only if no other is around.
        crosses : bool
            Whether `contour` has parts on both sides of some member.
        touches : bool
            Whether it runs along with one, so that exact numbers differ from point to point.
        """
        best, crosses, touching = -1, False, []
        for other in members:
            if best >= 0 and self.size[other] > self.size[best] + self.slack[other] + self.slack[best]:
                break
            share, clear = self._share(contour, other)
            if 0 < share < 1:
                crosses |= clear
                touching += [] if clear else [other]
            elif share == 1 and (best < 0 or self.exact.share_around(best, other) > 0.5):
                best = other
        return best if best >= 0 or not touching else touching[0], crosses, bool(touching)

    def meet(self, contour, others):
        """Tell whether a contour comes as near to one of some others as rounding.

        Parameters
        ----------
        contour : int
        others : list of int

        Returns
        -------
        bool
        """
        curve, *around = self.curves.lines([contour, *others])
        return bool(shapely.dwithin(curve, around, 2 * self.noise).any())

    def crosses_itself(self, body):
        """Tell whether two contours of one body were seen to cross.

        Parameters
        ----------
        body : (C,) int

        Returns
        -------
        bool
        """
        return any(
            clear and 0 < share < 1 and body[contour] == body[other]
            for (contour, other), (share, clear) in self.shares.items()
        )

    def most(self, hole, members):
        """Choose the member that holds most of a hole that crosses them, of equal ones the smallest.

        Parameters
        ----------
        hole : int
        members : list of int

        Returns
        -------
        int
        """
        members = sorted(members, key=self.size.__getitem__)
        hole, *others = self.curves.lines([hole, *members])
        shares = [_area_share(hole, _polygon(other)) for other in others]
        return members[int(np.argmax(shares))]

    def _share(self, contour, other):
        """Share of a contour inside another, and whether it is that of points further from it than rounding.

        Where there are none, it is that of points in exact numbers.
        """
        if (contour, other) not in self.shares:
            inside, clear = _count_inside(*self.curves, contour, other, 2 * self.noise)
            share = inside / clear if clear else self.exact.share_around(other, contour)
            self.shares[contour, other] = share, clear > 0
        return self.shares[contour, other]


def find_hosts(nest, inner, body):
    """Find the outer contour that each hole lies in.

    The host is the smallest outer contour of the same level and body around
    the hole. A host without rival needs no geometry: material is bounded.

    Parameters
    ----------
    nest : ContourNesting
    inner, body : (C,) bool and int

    Returns
    -------
    host : (C,) int
        -1 for outer contours, and for holes of a level and body without any outer one.
    is_open : (C,) bool
        Holes that a surface that crosses itself leaves between two regions;
        theirs is the one that holds most of them.
    """
    host, is_open = np.full(len(inner), -1), np.zeros(len(inner), bool)
    groups = {}
    for contour, key in enumerate(zip(nest.level.tolist(), body.tolist())):
        groups.setdefault(key, ([], []))[int(inner[contour])].append(contour)
    for outers, holes in groups.values():
        if len(outers) == 1:
            host[holes] = outers[0]
        elif outers:
            for hole in holes:
                near = [k for k in nest.near.get(hole, []) if not inner[k] and body[k] == body[hole]]
                host[hole], is_open[hole], _ = nest.innermost(hole, near)
                if host[hole] < 0:
                    host[hole], is_open[hole] = nest.most(hole, outers), True
    return host, is_open


def find_parents(nest):
    """Find the smallest contour around each one.

    Parameters
    ----------
    nest : ContourNesting

    Returns
    -------
    parent : (C,) int
        -1 for none.
    unsure : (C,) bool
        Where a contour crosses or touches another that may be its parent.
    """
    parent, unsure = np.full(len(nest.size), -1), np.zeros(len(nest.size), bool)
    for contour, near in nest.near.items():
        parent[contour], *seen = nest.innermost(contour, near)
        unsure[contour] = any(seen)
    return parent, unsure


@njit
def _find_near(order, boxes, level, size, slack, room):
    """Pairs (contour, other) of one level, other not smaller, with boxes no further apart than `room`.

    order : the contours by level and then by the lower x of their boxes
    """
    one, two = [0 for _ in range(0)], [0 for _ in range(0)]
    for place in range(len(order)):
        for following in range(place + 1, len(order)):
            i, j = order[place], order[following]
            if level[j] != level[i] or boxes[j, 0] > boxes[i, 2] + room:
                break
            if boxes[j, 1] > boxes[i, 3] + room or boxes[i, 1] > boxes[j, 3] + room:
                continue
            for a, b in ((i, j), (j, i)):
                if size[b] >= size[a] - slack[b] - slack[a]:
                    one.append(a)
                    two.append(b)
    return np.array(one), np.array(two)


@njit
def _count_inside(points, first, contour, other, room):
    """Of the middles of some 64 segments of a closed curve further than `room` from another: (inside it, all).

    Rounding cannot move any of those to the other side.
    """
    begin, end = first[contour], first[contour + 1] - 1
    some = np.arange(begin, end, max(1, (end - begin) // 64))
    inside, near = look(points, first, np.full(len(some), other), (points[some] + points[some + 1]) / 2, room)
    return (inside & (near == room)).sum(), (near == room).sum()


def _polygon(curve):
    """A closed curve as a polygon, empty if it does not span one."""
    points = shapely.get_coordinates(curve)
    return shapely.Polygon(points if len(points) >= 4 else None)


def _area_share(hole, ring):
    """Share of a hole's area, or of its length if it has none, within a ring."""
    shape = shapely.make_valid(_polygon(hole)) if shapely.get_num_points(hole) >= 4 else hole
    ring = ring if shapely.is_valid(ring) else shapely.make_valid(ring)
    inside = shapely.intersection(shape, ring)
    if shapely.area(shape) > 0:
        return float(shapely.area(inside) / shapely.area(shape))
    length = float(shapely.length(shape))
    return float(shapely.length(inside)) / length if length > 0 else float(shapely.intersects(shape, ring))
