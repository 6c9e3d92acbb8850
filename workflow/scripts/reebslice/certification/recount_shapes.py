"""Geometry held against the tables: curves, regions, similarities, rays."""

import numpy as np
import shapely
from numba import njit


def read_curves(wkb):
    """Curves of WKB blobs (C,), None where a blob is no closed plane line string."""
    curves = shapely.from_wkb(np.asarray(wkb, object), on_invalid="ignore")
    closed = shapely.is_closed(curves) & ~shapely.has_z(curves) & (shapely.get_type_id(curves) == 1)
    return np.where(closed, curves, None)


def measure_curves(curves):
    """Signed area and perimeter, two (C,), and centre of gravity (C, 2) of closed line strings."""
    first = np.concatenate([[0], np.cumsum(shapely.get_num_coordinates(curves))])
    return _measure_curves(shapely.get_coordinates(curves), first)


@njit(cache=True)
def _measure_curves(points, first):
    n = len(first) - 1
    area, perimeter, centre = np.zeros(n), np.zeros(n), np.zeros((n, 2))
    for c in range(n):
        x, y = points[first[c], 0], points[first[c], 1]  # seen from here, nothing cancels far from the origin
        for k in range(first[c], first[c + 1] - 1):
            px, py, qx, qy = points[k, 0] - x, points[k, 1] - y, points[k + 1, 0] - x, points[k + 1, 1] - y
            length = np.hypot(qx - px, qy - py)
            area[c] += 0.5 * (px * qy - py * qx)
            perimeter[c] += length
            centre[c, 0] += length * (px + qx) / 2
            centre[c, 1] += length * (py + qy) / 2
        whole = perimeter[c] if perimeter[c] > 0 else 1.0
        centre[c, 0], centre[c, 1] = x + centre[c, 0] / whole, y + centre[c, 1] / whole
    return area, perimeter, centre


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
