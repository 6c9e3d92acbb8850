"""Geometry held against the tables: curves, regions, similarities, sides.

Only what no rank can decide is done here with coordinates. What rounding leaves
open is decided in rational numbers, or the answer is "open", never a guess.
"""

from typing import NamedTuple

import numpy as np
import shapely

from .recount import sign_changes

ANGLE = 1e-9  # openings smaller than this (radians) leave the order of directions open
# Tilts tried around a vertex where heights tie, rise per length.
TILTS = (0.0, 1e-9, 1e-6, 1e-3)


def read_curves(wkb):
    """Curves of WKB blobs (C,), None where a blob is no closed plane line string."""
    curves = shapely.from_wkb(np.asarray(wkb, object), on_invalid="ignore")
    closed = shapely.is_closed(curves) & ~shapely.has_z(curves) & (shapely.get_type_id(curves) == 1)
    return np.where(closed, curves, None)


def measure_curves(curves):
    """Signed area and perimeter of closed line strings, two (C,) float64."""
    points, curve = shapely.get_coordinates(curves, return_index=True)
    areas, perimeters = np.zeros(len(curves)), np.zeros(len(curves))
    if len(points) == 0:
        return areas, perimeters
    first = np.searchsorted(curve, np.arange(len(curves)))
    points = points - points[np.minimum(first, len(points) - 1)][curve]
    p, q, same = points[:-1], points[1:], curve[:-1] == curve[1:]
    areas += np.bincount(curve[:-1], same * 0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]), len(curves))
    perimeters += np.bincount(curve[:-1], same * np.hypot(*(q - p).T), len(curves))
    return areas, perimeters


def build_polygons(curves, area, region, inner, n_regions):
    """Region polygons (R,) and whether each had to be mended (R,) bool.

    Curves that do not span a triangle are left out; a region without an outer
    curve is empty.
    """
    usable = (shapely.get_num_points(curves) >= 4) & (area != 0)
    rings = np.full(len(curves), None)
    points, index = shapely.get_coordinates(curves[usable], return_index=True)
    rings[usable] = shapely.linearrings(points, indices=index)
    polygons = np.full(n_regions, shapely.Polygon(), object)
    outer = np.flatnonzero(usable & ~inner)
    polygons[region[outer]] = shapely.polygons(rings[outer])
    holes = {}
    for contour in np.flatnonzero(usable & inner).tolist():
        holes.setdefault(int(region[contour]), []).append(rings[contour])
    outer_of = dict(zip(region[outer].tolist(), outer.tolist()))
    for place, inside in holes.items():
        if place in outer_of:
            polygons[place] = shapely.polygons(rings[outer_of[place]], holes=inside)
    broken = ~shapely.is_valid(polygons)
    polygons[broken] = shapely.buffer(shapely.make_valid(polygons[broken]), 0)
    return polygons, broken


def compare_polygons(lower, upper):
    """Areas of polygons pair by pair: dict area_source, area_target, area_intersection."""
    return {
        "area_source": shapely.area(lower),
        "area_target": shapely.area(upper),
        "area_intersection": shapely.area(shapely.intersection(lower, upper)),
    }


class Nest(NamedTuple):
    """The contours and what is known of them: (C,) closed curves, signed area, its error, level.

    noise : how far a curve may be from its contour; exact : what tells of the
    contours in exact numbers, :class:`recount_exact.ExactLevels`
    """

    curves: np.ndarray
    area: np.ndarray
    slack: np.ndarray
    level: np.ndarray
    noise: float
    exact: object


def find_hosts(nest, inner, body):
    """The outer contours that each hole lies in: (host, open), (C,) int and bool.

    The host is the smallest outer contour of the same level and body around
    the hole; -1 for outer contours, and for holes of a level and body without
    any outer one. A host without rival needs no geometry: material is bounded.
    `open` marks holes that a surface that crosses itself leaves between two
    regions; theirs is the one that holds most of them.
    """
    host, is_open = np.full(len(inner), -1), np.zeros(len(inner), bool)
    groups = {}
    for contour, key in enumerate(zip(nest.level.tolist(), body.tolist())):
        groups.setdefault(key, ([], []))[int(inner[contour])].append(contour)
    for outers, holes in groups.values():
        if len(outers) == 1:
            host[holes] = outers[0]
        elif outers and holes:
            finder = _Finder(nest, np.array(outers))
            for hole in holes:
                host[hole], is_open[hole] = finder.innermost(hole)
                if host[hole] < 0:
                    host[hole], is_open[hole] = finder.most(hole), True
    return host, is_open


def find_parents(nest):
    """The smallest contour around each one, (C,) int or -1, and where that is unsure (C,) bool."""
    parent, unsure = np.full(len(nest.area), -1), np.zeros(len(nest.area), bool)
    order = np.argsort(nest.level, kind="stable")
    for run in np.split(order, np.flatnonzero(np.diff(nest.level[order])) + 1):
        if len(run) > 1:
            finder = _Finder(nest, run)
            for contour in run.tolist():
                parent[contour], unsure[contour] = finder.innermost(contour)
    return parent, unsure


class _Finder:
    """Finds, among some contours of one level, the one right around another."""

    def __init__(self, nest, members):
        self.nest, self.members = nest, members[np.argsort(np.abs(nest.area[members]), kind="stable")]
        self.rings = _as_polygons(nest.curves[self.members])
        self.boxes = shapely.bounds(nest.curves[self.members])
        shapely.prepare(nest.curves[self.members])

    def innermost(self, contour):
        """(the smallest contour around `contour` or -1, whether some contour crosses it)."""
        nest, members = self.nest, self.members
        box, room = shapely.bounds(nest.curves[contour]), nest.noise
        near = (self.boxes[:, :2] <= box[:2] + room).all(axis=1) & (self.boxes[:, 2:] >= box[2:] - room).all(axis=1)
        meets = (self.boxes[:, :2] <= box[2:]).all(axis=1) & (self.boxes[:, 2:] >= box[:2]).all(axis=1)
        large = np.abs(nest.area[members]) >= abs(nest.area[contour]) - nest.slack[members] - nest.slack[contour]
        best, crosses = -1, False
        for place in np.flatnonzero((near | meets) & large & (members != contour)).tolist():
            other = int(members[place])
            if best >= 0 and abs(nest.area[other]) > abs(nest.area[best]) + nest.slack[other] + nest.slack[best]:
                break
            share = self._share(contour, place)
            crosses |= 0 < share < 1
            if share == 1 and (best < 0 or nest.exact.winds_around(best, other)):
                best = other
        return best, crosses

    def _share(self, contour, place):
        """Share of a contour inside a ring: of its points further from that than rounding, or in exact numbers."""
        nest, other = self.nest, int(self.members[place])
        points = shapely.get_coordinates(nest.curves[contour])
        points = (points[:-1] + points[1:]) / 2
        points = points[:: max(1, len(points) // 64)]
        points = points[~shapely.dwithin(nest.curves[other], shapely.points(points), 2 * nest.noise)]
        if len(points) == 0:
            return float(nest.exact.winds_around(other, contour))
        return float(shapely.contains_xy(self.rings[place], points).mean())

    def most(self, hole):
        """The member that holds most of a hole that crosses them."""
        shares = [_area_share(self.nest.curves[hole], ring) for ring in self.rings]
        return int(self.members[np.argmax(shares)])


def _as_polygons(curves):
    big = shapely.get_num_points(curves) >= 4
    out = np.full(len(curves), shapely.Polygon(), object)
    points, index = shapely.get_coordinates(curves[big], return_index=True)
    out[big] = shapely.polygons(shapely.linearrings(points, indices=index))
    shapely.prepare(out)
    return out


def _area_share(hole, ring):
    """Share of a hole's area, or of its length if it has none, within a ring."""
    shape = shapely.make_valid(shapely.Polygon(hole)) if shapely.get_num_points(hole) >= 4 else hole
    ring = ring if shapely.is_valid(ring) else shapely.make_valid(ring)
    inside = shapely.intersection(shape, ring)
    if shapely.area(shape) > 0:
        return float(shapely.area(inside) / shapely.area(shape))
    length = float(shapely.length(shape))
    return float(shapely.length(inside)) / length if length > 0 else float(shapely.intersects(shape, ring))


def local_sides(surface, vertices):
    """Side of critical vertices from the geometry around them: list of "A", "B" or "".

    Extrema: the sign of the area of the link, that is, whether the outside is
    up. Saddles: of the sector of the horizontal plane that an upper wedge of
    the link cuts off, whether it is void (A) or material (B). Empty where the
    saddle is multiple or the directions are too close to tell.
    """
    changes = sign_changes(surface)
    links = _links(surface, vertices)
    return [
        _side_of_extremum(surface, v, links[v]) if changes[v] == 0
        else _side_of_saddle(surface, v, links[v]) if changes[v] == 4
        else ""
        for v in np.asarray(vertices).tolist()
    ]  # fmt: skip


def _links(surface, vertices):
    """The link of each vertex as a cycle, counter-clockwise from outside."""
    wanted = np.zeros(len(surface.points), bool)
    wanted[vertices] = True
    after = {}
    rows = np.flatnonzero(wanted[surface.corners].any(axis=1))
    for (a, b, c), even in zip(surface.corners[rows].tolist(), surface.even[rows].tolist()):
        b, c = (b, c) if even else (c, b)
        for v, p, q in ((a, b, c), (b, c, a), (c, a, b)):
            if wanted[v]:
                after.setdefault(v, {})[p] = q
    links = {}
    for v, following in after.items():
        cycle = [next(iter(following))]
        while following[cycle[-1]] != cycle[0]:
            cycle.append(following[cycle[-1]])
        links[v] = cycle
    return links


def _rises(surface, vertex, link):
    """Arms to the link and their rises under ever larger tilts that keep the order of ranks.

    Where heights tie, ranks are those of an infinitesimal tilt; any real one
    under which each neighbour is on its side of the vertex shows the same.
    """
    arms = surface.points[link] - surface.points[vertex]
    above = np.array(link) > vertex
    for tilt in TILTS:
        rise = arms[:, 2] + tilt * arms[:, 0] + tilt * tilt * arms[:, 1]
        if (rise[above] > 0).all() and (rise[~above] < 0).all():
            yield arms[:, :2], rise


def _side_of_extremum(surface, vertex, link):
    for arms, rise in _rises(surface, vertex, link):
        flat = arms * (np.abs(rise).min() / np.abs(rise) / np.abs(arms).max())[:, None]
        terms = flat[:, 0] * np.roll(flat[:, 1], -1) - flat[:, 1] * np.roll(flat[:, 0], -1)
        if abs(terms.sum()) > ANGLE * np.abs(terms).sum():
            return "B" if terms.sum() > 0 else "A"
    return ""


def _side_of_saddle(surface, vertex, link):
    """The side by the two sectors that the upper wedges of a simple saddle cut off."""
    for arms, rise in _rises(surface, vertex, link):
        turns = _zero_directions(arms, rise)
        gaps = np.diff(np.sort(turns), append=turns.min() + 2 * np.pi)
        if gaps.min() < ANGLE:
            continue
        found = set()
        for (enters, leaves), others in ((turns[:2], turns[2:]), (turns[2:], turns[:2])):
            # The contour above runs in where the link leaves the wedge and out
            # where it enters; the material is left of it, from `enters` to `leaves`.
            within = (others - enters) % (2 * np.pi) < (leaves - enters) % (2 * np.pi)
            found.add("A" if within.all() else "" if within.any() else "B")
        return found.pop() if len(found) == 1 else ""
    return ""


def _zero_directions(arms, rise):
    """Angles at which the link enters and leaves each upper wedge, in the order of the link."""
    above = rise > 0
    first = int(np.flatnonzero(above & ~np.roll(above, 1))[0])
    arms, rise, above = (np.roll(values, -first, axis=0) for values in (arms, rise, above))
    change = np.flatnonzero(above != np.roll(above, 1))
    p, q = arms[change - 1], arms[change]
    share = (rise[change - 1] / (rise[change - 1] - rise[change]))[:, None]
    x, y = (p + share * (q - p)).T
    return np.arctan2(y, x)


def first_face_along_x(corners, x, y, z):
    """The first face, of (m, 3, 3) corners, that a ray along +x meets; -1 for none."""
    hits = _hits(corners, x, y, z)
    return min(hits, key=lambda hit: hit[0])[1] if hits else -1


def _hits(corners, x, y, z):
    low, high = corners.min(axis=1), corners.max(axis=1)
    near = np.flatnonzero(
        (low[:, 1] <= y) & (y <= high[:, 1]) & (low[:, 2] <= z) & (z <= high[:, 2]) & (high[:, 0] >= x)
    )
    a, b, c = corners[near].transpose(1, 0, 2)

    def part(p, q):
        return (p[:, 1] - y) * (q[:, 2] - z) - (p[:, 2] - z) * (q[:, 1] - y)

    u, v, w = part(b, c), part(c, a), part(a, b)
    total = u + v + w
    met = ((u > 0) == (v > 0)) & ((v > 0) == (w > 0)) & (total != 0)
    where = np.divide(u * a[:, 0] + v * b[:, 0] + w * c[:, 0], total, out=np.zeros(len(u)), where=met)
    met &= where > x
    return list(zip(where[met].tolist(), near[met].tolist()))
