"""An exact software rasteriser of triangle meshes.

It works on integers
(pixels in 256ths), so faces that share a mesh edge neither overlap nor leave a
gap: seen from anywhere, a closed surface covers every pixel by as many front
faces as back faces.

Reference: J. Pineda, A parallel algorithm for polygon rasterization,
SIGGRAPH 1988, doi:10.1145/54852.378457 (edge functions).
"""

from typing import NamedTuple

import numpy as np

from ..kernels import njit
from .normals import corner_normals, find_vertex_normals
from .views import choose_elevation, view_axes

SUBPIXELS = 256
_HALF = SUBPIXELS // 2
_SILHOUETTE = 96  # pixels


class Layers(NamedTuple):
    """What every pixel of a picture sees, arrays of shape (height, width).

    `depth`: of the front-most face, larger is nearer, -inf where there is
    none. `normal`: (height, width, 3), of that face in axes of the view, not
    of unit length, 0 where there is none. `slant`: summed over all faces
    behind the pixel, 0 for a face seen head-on and 1 for one seen edge-on.
    `winding`: front faces minus back faces.
    """

    depth: np.ndarray
    normal: np.ndarray
    slant: np.ndarray
    winding: np.ndarray


@njit
def _box(x, y, width, height):
    """First and last column, first and last row of the pixels with centres in the box around a triangle."""
    left, right = max(0, (min(x) + _HALF - 1) // SUBPIXELS), min(width - 1, (max(x) - _HALF) // SUBPIXELS)
    top, bottom = max(0, (min(y) + _HALF - 1) // SUBPIXELS), min(height - 1, (max(y) - _HALF) // SUBPIXELS)
    return left, right, top, bottom


@njit
def _span(x, y, row, left, right):
    """Those of the columns `left` to `right` whose pixels' centres lie in a triangle of positive area."""
    for p in range(3):
        q = (p + 1) % 3
        # A pixel centre exactly on a side goes to the one of its two faces
        # for which the side points down (or right).
        dx, dy = x[q] - x[p], y[q] - y[p]
        value = dx * (row * SUBPIXELS + _HALF - y[p]) - dy * (_HALF - x[p])
        if dy > 0:
            right = min(right, value // (SUBPIXELS * dy))
        elif dy < 0:
            left = max(left, -((value - 1) // (-SUBPIXELS * dy)))
        elif value < 0 or (value == 0 and dx < 0):
            right = left - 1
    return left, right


class _Affine(NamedTuple):
    """A quantity over a face: at corner a, and its steps to corners b and c."""

    a: float
    b: float
    c: float


class _Projected(NamedTuple):
    """A face on the grid: columns and rows of its corners, twice its area, and -1 if it is seen from its front."""

    x: tuple
    y: tuple
    area: int
    sign: int


@njit(inline="always")
def _project_face(grid, faces, f):
    """The face f as :class:`_Projected`, and the places of its second and third corner.

    Rows run downward: a face seen from its front has negative area, and its corners are taken backward.
    """
    sign, j, k = -1, 1, 2
    a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
    ax, ay = np.int64(grid[a, 0]), np.int64(grid[a, 1])
    area = (grid[b, 0] - ax) * (grid[c, 1] - ay) - (grid[b, 1] - ay) * (grid[c, 0] - ax)
    if area < 0:
        sign, j, k, b, c, area = 1, 2, 1, c, b, -area
    x = ax, np.int64(grid[b, 0]), np.int64(grid[c, 0])
    y = ay, np.int64(grid[b, 1]), np.int64(grid[c, 1])
    return _Projected(x, y, area, sign), j, k


@njit
def _fill_faces(grid, points, faces, scale, normals, layers):
    """Enter all faces into the layers; grid, points : of :func:`_project_finely`; scale : pixels in a mesh unit."""
    height, width = layers.depth.shape
    corners = np.empty((3, 3))
    for f in range(len(faces)):
        seen, j, k = _project_face(grid, faces, f)
        first, last, top, bottom = _box(seen.x, seen.y, width, height)
        if seen.area == 0 or first > last or top > bottom:
            continue
        corner_normals(points, faces, f, normals, corners)
        a, b, c = points[faces[f, 0], 2], points[faces[f, j], 2], points[faces[f, k], 2]
        depth = _Affine(a / scale, (b - a) / scale, (c - a) / scale)
        u = _Affine(corners[0, 0], corners[j, 0] - corners[0, 0], corners[k, 0] - corners[0, 0])
        v = _Affine(corners[0, 1], corners[j, 1] - corners[0, 1], corners[k, 1] - corners[0, 1])
        w = _Affine(corners[0, 2], corners[j, 2] - corners[0, 2], corners[k, 2] - corners[0, 2])
        for row in range(top, bottom + 1):
            left, right = _span(seen.x, seen.y, row, first, last)
            _fill_row(layers, row, left, right, seen, (depth, u, v, w))


@njit(inline="always")
def _fill_row(layers, row, left, right, seen, quantities):
    """Enter a face into the pixels `left` to `right` of a row; quantities : its depth and the axes of its normal."""
    d, u, v, w = quantities
    area, ax, ay = seen.area, seen.x[0], seen.y[0]
    bx, by, cx, cy = seen.x[1] - ax, seen.y[1] - ay, seen.x[2] - ax, seen.y[2] - ay
    # weights of the steps to corners b and c, at the first pixel and from one pixel to the next
    px, py = left * SUBPIXELS + _HALF - ax, row * SUBPIXELS + _HALF - ay
    s, t = (px * cy - py * cx) / area, (py * bx - px * by) / area
    step_b, step_c = SUBPIXELS * cy / area, -SUBPIXELS * by / area
    step_d, step_w = step_b * d.b + step_c * d.c, step_b * w.b + step_c * w.c
    deep, slope, y = d.a + s * d.b + t * d.c, w.a + s * w.b + t * w.c, np.uint64(row)
    for i in range(right + 1 - left):
        x = np.uint64(left + i)
        edge_on = max(0.0, 1.0 - abs(slope + i * step_w))
        layers.winding[y, x] += seen.sign
        layers.slant[y, x] += edge_on * edge_on
    for i in range(right + 1 - left):
        x = np.uint64(left + i)
        if deep + i * step_d > layers.depth[y, x]:
            p, q = s + i * step_b, t + i * step_c
            layers.depth[y, x] = deep + i * step_d
            layers.normal[y, x, 0] = u.a + p * u.b + q * u.c
            layers.normal[y, x, 1] = v.a + p * v.b + q * v.c
            layers.normal[y, x, 2] = w.a + p * w.b + q * w.c


def rasterize_mesh(points, faces, view, crease=40.0):
    """Rasterise a mesh.

    Parameters
    ----------
    points : (n, 3) float
    faces : (m, 3) int
        Counter-clockwise seen from outside.
    view : View
    crease : float
        Degrees; normals are smooth across mesh edges at which faces meet at less.

    Returns
    -------
    Layers
        A pixel is covered when its centre is. Faces seen exactly edge-on cover
        nothing. An empty mesh gives empty layers.
    """
    shape = (view.height, view.width)
    slant, winding = np.zeros(shape, np.float32), np.zeros(shape, np.int16)
    layers = Layers(np.full(shape, -np.inf), np.zeros((*shape, 3), np.float32), slant, winding)
    faces = np.ascontiguousarray(faces)
    seen, grid = _project_finely(np.asarray(points, float).reshape(-1, 3), view)
    _fill_faces(grid, seen, faces, view.scale, find_vertex_normals(seen, faces, crease), layers)
    return layers


@njit
def _project_finely(points, view):
    """Points (n, 3) as seen: right, up and depth in pixels; column and row in the parts that the rasteriser counts in.

    The first, (n, 3) float64, in a frame in which angles are right; the second (n, 2) int32.
    """
    axes, centre, scale = view.axes, view.centre, view.scale
    seen, grid = np.empty((len(points), 3)), np.empty((len(points), 2), np.int32)
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        column = (x * axes[0, 0] + y * axes[0, 1] + z * axes[0, 2] - centre[0]) * scale + view.width / 2
        row = view.height / 2 - (x * axes[1, 0] + y * axes[1, 1] + z * axes[1, 2] - centre[1]) * scale
        grid[i, 0], grid[i, 1] = np.rint(column * SUBPIXELS), np.rint(row * SUBPIXELS)
        seen[i, 0], seen[i, 1] = column, -row
        seen[i, 2] = (x * axes[2, 0] + y * axes[2, 1] + z * axes[2, 2]) * scale
    return seen, grid


def choose_angles(points, faces, options):
    """Choose from where a model is seen.

    Parameters
    ----------
    points, faces
        As for :func:`widest_azimuth`.
    options : dict
        azimuth and elevation, degrees; None for the largest silhouette, and for what suits the model.

    Returns
    -------
    dict
        azimuth and elevation, degrees.
    """
    azimuth, elevation = options.get("azimuth"), options.get("elevation")
    elevation = choose_elevation(points) if elevation is None else float(elevation)
    azimuth = widest_azimuth(points, faces, elevation) if azimuth is None else float(azimuth)
    return {"azimuth": azimuth, "elevation": elevation}


def widest_azimuth(points, faces, elevation):
    """Find the azimuth from which a mesh shows the largest silhouette, so that its parts hide each other least.

    Parameters
    ----------
    points : (n, 3) float
    faces : (m, 3) int
        Of large meshes only every k-th is looked at.
    elevation : float
        Degrees.

    Returns
    -------
    float
        Degrees, a multiple of 15; 0 for an empty mesh.
    """
    if len(faces) == 0:
        return 0.0
    corners = points[faces[:: 1 + len(faces) // 50_000]]
    azimuths = np.arange(-180.0, 180.0, 15.0)
    areas = _measure_silhouettes(corners, np.array([view_axes(azimuth, elevation) for azimuth in azimuths]))
    return float(azimuths[areas.argmax()]) if areas.any() else 0.0


@njit
def _measure_silhouettes(corners, axes):
    """Area (k,) that the front ones of the triangles `corners` (m, 3, 3) cover, seen along each of `axes` (k, 3, 3)."""
    areas, seen = np.zeros(len(axes)), np.empty((len(corners), 3, 2))
    for view in range(len(axes)):
        low, high = np.full(2, np.inf), np.full(2, -np.inf)
        for f in range(len(corners)):
            for i in range(3):
                for j in range(2):
                    p, right = corners[f, i], axes[view, j]
                    seen[f, i, j] = p[0] * right[0] + p[1] * right[1] + p[2] * right[2]
                    low[j], high[j] = min(low[j], seen[f, i, j]), max(high[j], seen[f, i, j])
        scale = _SILHOUETTE / max(high[0] - low[0], high[1] - low[1], 1e-300)
        grid = ((seen - low) * (scale * SUBPIXELS)).astype(np.int64)
        covered = np.zeros((_SILHOUETTE, _SILHOUETTE), np.bool_)
        for f in range(len(corners)):
            x, y = (grid[f, 0, 0], grid[f, 1, 0], grid[f, 2, 0]), (grid[f, 0, 1], grid[f, 1, 1], grid[f, 2, 1])
            # of faces below a pixel most cover none, and a large mesh's neighbours may not be looked at
            covered[min(y[0] // SUBPIXELS, _SILHOUETTE - 1), min(x[0] // SUBPIXELS, _SILHOUETTE - 1)] = True
            if (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]) > 0:
                first, last, top, bottom = _box(x, y, _SILHOUETTE, _SILHOUETTE)
                for row in range(top, bottom + 1 if first <= last else top):
                    left, right = _span(x, y, row, first, last)
                    covered[row, left : right + 1] = True
        areas[view] = covered.sum() / scale**2
    return areas
