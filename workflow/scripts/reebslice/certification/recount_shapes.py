"""Geometry held against the tables: curves, regions, similarities, sides.

Only what no rank can decide is done here with coordinates, and where rounding
leaves a question open the answer is "open", never a guess.
"""

import numpy as np
import shapely

from .recount import sign_changes

# Openings smaller than this (radians) leave the order of directions open.
ANGLE = 1e-9
# Tilts tried around a vertex where heights tie, rise per length.
TILTS = (0.0, 1e-9, 1e-6, 1e-3)
# Of a hole, the share that must lie in a region to be inside without doubt.
INSIDE = 0.99


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


def find_hosts(curves, area, level, inner, body):
    """The outer contours that each hole may lie in: (host, open), (C,) int and bool.

    The host is the smallest outer contour of the same level and body that
    holds most of the hole; -1 for outer contours, and for holes of a level
    and body without any outer one. A host without rival needs no geometry:
    material is bounded. `open` marks holes that rounding, or a surface that
    crosses itself, leaves between two regions.
    """
    host, is_open = np.full(len(curves), -1), np.zeros(len(curves), bool)
    groups = {}
    for contour, key in enumerate(zip(level.tolist(), body.tolist())):
        groups.setdefault(key, ([], []))[int(inner[contour])].append(contour)
    for outers, holes in groups.values():
        if len(outers) == 1:
            host[holes] = outers[0]
        elif outers and holes:
            outers = np.array(outers)[np.argsort(np.abs(area[outers]), kind="stable")]
            rings = _as_polygons(curves[outers])
            for hole in holes:
                fits = np.abs(area[outers]) >= INSIDE * abs(area[hole])  # an island in the hole cannot hold it
                host[hole], is_open[hole] = _host_of(curves[hole], outers, rings, fits)
    return host, is_open


def find_parents(curves, area, level, inner):
    """The smallest contour around each one, (C,) int or -1, and where that is unsure (C,) bool."""
    parent, unsure = np.full(len(curves), -1), np.zeros(len(curves), bool)
    order = np.argsort(level, kind="stable")
    runs = np.split(order, np.flatnonzero(np.diff(level[order])) + 1)
    for run in runs:
        run = run[np.argsort(np.abs(area[run]), kind="stable")]
        rings = _as_polygons(curves[run]) if len(run) > 1 else ()
        boxes = shapely.bounds(curves[run])
        for k in range(len(run) - 1):
            parent[run[k]], unsure[run[k]] = _parent_of(curves[run[k]], k, run, rings, boxes)
    return parent, unsure


def _parent_of(curve, k, run, rings, boxes):
    points = shapely.get_coordinates(curve)
    points = (points[:-1] + points[1:]) / 2
    points = points[:: max(1, len(points) // 64)]
    box = boxes[k]
    reach = (boxes[:, 0] <= box[0]) & (boxes[:, 2] >= box[2]) & (boxes[:, 1] <= box[1]) & (boxes[:, 3] >= box[3])
    meets = (boxes[:, 0] <= box[2]) & (boxes[:, 2] >= box[0]) & (boxes[:, 1] <= box[3]) & (boxes[:, 3] >= box[1])
    for place in np.flatnonzero(meets[k + 1 :]) + k + 1:
        share = shapely.contains_xy(rings[place], points).mean()
        if share == 1 and reach[place]:
            return int(run[place]), False
        if share > 0 or shapely.distance(curve, rings[place].exterior) == 0:
            return int(run[place]), True
    return -1, False


def _as_polygons(curves):
    big = shapely.get_num_points(curves) >= 4
    out = np.full(len(curves), shapely.Polygon(), object)
    points, index = shapely.get_coordinates(curves[big], return_index=True)
    out[big] = shapely.polygons(shapely.linearrings(points, indices=index))
    shapely.prepare(out)
    return out


def _host_of(hole, outers, rings, fits):
    """(host, open) of one hole among outer contours in ascending order of area."""
    box, boxes = shapely.bounds(hole), shapely.bounds(rings)
    meets = (boxes[:, 0] <= box[2]) & (boxes[:, 2] >= box[0]) & (boxes[:, 1] <= box[3]) & (boxes[:, 3] >= box[1])
    meets &= fits
    points = shapely.get_coordinates(hole)
    points = (points[:-1] + points[1:]) / 2
    points = points[:: max(1, len(points) // 64)]
    core = shapely.point_on_surface(shapely.Polygon(hole) if shapely.get_num_points(hole) >= 4 else hole)
    is_open = False
    for place in np.flatnonzero(meets).tolist():
        share = shapely.contains_xy(rings[place], points).mean()
        # segments that two contours share, as cuts inside a flat have, tell nothing
        if 0 < share < 1 or (share == 0 and shapely.contains(rings[place], core)):
            share = _area_share(hole, rings[place])
        if share >= INSIDE:
            return int(outers[place]), is_open
        if share > 1 - INSIDE:
            is_open = True
    # no region holds it: the one that holds most of it, and the question is open
    shares = np.zeros(len(rings))
    shares[meets] = [_area_share(hole, ring) for ring in rings[meets]]
    return int(outers[np.argmax(shares)]), True


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


def count_enclosing(points, faces, shell, target, others):
    """How many times a ray along +x from a vertex of shell `target` meets each other shell.

    Returns {other: crossings}; odd means inside.
    """
    inside = {}
    corners = points[faces]
    own = corners[shell == target].reshape(-1, 3)
    start = own[np.argmax(own[:, 0])]
    span = np.ptp(own, axis=0)
    # off the vertex by a little, so that the ray meets no mesh edge
    y, z = start[1] + 1e-7 * 0.618 * span[1], start[2] - 1e-7 * 0.414 * span[2]
    for other in others:
        inside[other] = len(_hits(corners[shell == other], start[0], y, z))
    return inside


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
