"""Translucent pictures of a triangle mesh, drawn without a graphics card.

An exact software rasteriser and a shading. The rasteriser works on integers
(pixels in 256ths), so faces that share a mesh edge neither overlap nor leave a
gap: seen from anywhere, a closed surface covers every pixel by as many front
faces as back faces.

Reference: J. Pineda, A parallel algorithm for polygon rasterization,
SIGGRAPH 1988, doi:10.1145/54852.378457 (edge functions).
"""

from typing import NamedTuple

import numba
import numpy as np

from .normals import corner_normals, find_vertex_normals
from .views import view_axes

SUBPIXELS = 256
_LIGHT = np.array([-0.45, 0.55, 0.70]) / np.linalg.norm([-0.45, 0.55, 0.70])
_BODY = np.array([0.66, 0.73, 0.80])
_SHADOW = np.array([0.33, 0.40, 0.49])
_OUTLINE = np.array([0.17, 0.21, 0.27])
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


@numba.njit(cache=True)
def _box(x, y, width, height):
    """First and last column, first and last row of the pixels with centres in the box around a triangle."""
    left, right = max(0, (min(x) + _HALF - 1) // SUBPIXELS), min(width - 1, (max(x) - _HALF) // SUBPIXELS)
    top, bottom = max(0, (min(y) + _HALF - 1) // SUBPIXELS), min(height - 1, (max(y) - _HALF) // SUBPIXELS)
    return left, right, top, bottom


@numba.njit(cache=True)
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


@numba.njit(cache=True)
def _fill_faces(grid, points, faces, scale, crease, smooth, around, start, depth, normal, slant, winding):
    height, width = depth.shape
    corners = np.empty((3, 3))
    for f in range(len(faces)):
        # Rows run downward: a face seen from its front has negative area, and its corners are taken backward.
        sign, j, k = -1, 1, 2
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        ax, ay = np.int64(grid[a, 0]), np.int64(grid[a, 1])
        area = (grid[b, 0] - ax) * (grid[c, 1] - ay) - (grid[b, 1] - ay) * (grid[c, 0] - ax)
        if area < 0:
            sign, j, k, b, c, area = 1, 2, 1, c, b, -area
        x, y = (ax, np.int64(grid[b, 0]), np.int64(grid[c, 0])), (ay, np.int64(grid[b, 1]), np.int64(grid[c, 1]))
        first, last, top, bottom = _box(x, y, width, height)
        if area == 0 or first > last or top > bottom:
            continue
        # Over a face everything is affine: its value at corner a and weights of the steps to corners b and c.
        corner_normals(points, faces, f, crease, smooth, around, start, corners)
        bx, by, cx, cy = x[1] - ax, y[1] - ay, x[2] - ax, y[2] - ay
        step_b, step_c = SUBPIXELS * cy / area, -SUBPIXELS * by / area
        d, db, dc = points[a, 2] / scale, (points[b, 2] - points[a, 2]) / scale, (points[c, 2] - points[a, 2]) / scale
        u, ub, uc = corners[0, 0], corners[j, 0] - corners[0, 0], corners[k, 0] - corners[0, 0]
        v, vb, vc = corners[0, 1], corners[j, 1] - corners[0, 1], corners[k, 1] - corners[0, 1]
        w, wb, wc = corners[0, 2], corners[j, 2] - corners[0, 2], corners[k, 2] - corners[0, 2]
        step_d, step_w = step_b * db + step_c * dc, step_b * wb + step_c * wc
        for row in range(top, bottom + 1):
            left, right = _span(x, y, row, first, last)
            px, py = left * SUBPIXELS + _HALF - ax, row * SUBPIXELS + _HALF - ay
            s, t = (px * cy - py * cx) / area, (py * bx - px * by) / area
            deep, slope = d + s * db + t * dc, w + s * wb + t * wc
            for i in range(right + 1 - left):
                column = np.uint64(left + i)
                edge_on = max(0.0, 1.0 - abs(slope + i * step_w))
                winding[np.uint64(row), column] += sign
                slant[np.uint64(row), column] += edge_on * edge_on
            for i in range(right + 1 - left):
                column = np.uint64(left + i)
                if deep + i * step_d > depth[np.uint64(row), column]:
                    p, q = s + i * step_b, t + i * step_c
                    depth[np.uint64(row), column] = deep + i * step_d
                    normal[np.uint64(row), column, 0] = u + p * ub + q * uc
                    normal[np.uint64(row), column, 1] = v + p * vb + q * vc
                    normal[np.uint64(row), column, 2] = w + p * wb + q * wc


def rasterize_mesh(points, faces, view, crease=40.0):
    """The :class:`Layers` of a mesh: points (n, 3), faces (m, 3), as seen in `view`.

    Faces are counter-clockwise seen from outside; normals are smooth across mesh edges of less than `crease`
    degrees. A pixel is covered when its centre is. Faces seen exactly edge-on cover nothing. An empty mesh gives
    empty layers.
    """
    shape = (view.height, view.width)
    slant, winding = np.zeros(shape, np.float32), np.zeros(shape, np.int16)
    layers = Layers(np.full(shape, -np.inf), np.zeros((*shape, 3), np.float32), slant, winding)
    faces = np.ascontiguousarray(faces)
    seen, grid = _project_finely(np.asarray(points, float).reshape(-1, 3), *view)
    _fill_faces(grid, seen, faces, view.scale, crease, *find_vertex_normals(seen, faces, crease), *layers)
    return layers


@numba.njit(cache=True)
def _project_finely(points, axes, centre, scale, width, height):
    """Points (n, 3) as seen: right, up and depth in pixels; column and row in the parts that the rasteriser counts in.

    The first, (n, 3) float64, in a frame in which angles are right; the second (n, 2) int32.
    """
    seen, grid = np.empty((len(points), 3)), np.empty((len(points), 2), np.int32)
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        column = (x * axes[0, 0] + y * axes[0, 1] + z * axes[0, 2] - centre[0]) * scale + width / 2
        row = height / 2 - (x * axes[1, 0] + y * axes[1, 1] + z * axes[1, 2] - centre[1]) * scale
        grid[i, 0], grid[i, 1] = np.rint(column * SUBPIXELS), np.rint(row * SUBPIXELS)
        seen[i, 0], seen[i, 1] = column, -row
        seen[i, 2] = (x * axes[2, 0] + y * axes[2, 1] + z * axes[2, 2]) * scale
    return seen, grid


def widest_azimuth(points, faces, elevation):
    """The azimuth, a multiple of 15 degrees, from which the mesh shows the largest silhouette.

    Parts then hide each other least. Only what is seen from its front counts,
    and of large meshes only every k-th face. 0 for an empty mesh.
    """
    if len(faces) == 0:
        return 0.0
    corners = points[faces[:: 1 + len(faces) // 50_000]]
    azimuths = np.arange(-180.0, 180.0, 15.0)
    areas = _measure_silhouettes(corners, np.array([view_axes(azimuth, elevation) for azimuth in azimuths]))
    return float(azimuths[areas.argmax()]) if areas.any() else 0.0


@numba.njit(cache=True)
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


def shade_layers(layers, jump, factor=1):
    """Opaque RGB image (height / factor, width / factor, 3), in bytes, of a translucent body on white.

    The front-most surface is lit from above left; surfaces behind it shine
    through where they turn edge-on. `jump`: depth step, in mesh units, that
    is outlined, on its nearer side. `factor`: so many pixels each way are averaged.
    """
    height, width = layers.depth.shape
    image = np.empty((height // factor, width // factor, 3), np.uint8)
    _shade_blocks(layers.depth, layers.normal, layers.slant, float(jump), factor, image)
    return image


@numba.njit(cache=True)
def _shade_blocks(depth, normal, slant, jump, factor, image):
    """Shade the mean surface of every block once; how much is covered, and on an outline, counts pixel by pixel."""
    outlined = np.empty((factor, depth.shape[1]), np.bool_)
    for row in range(image.shape[0]):
        for y in range(factor):
            _find_outline(depth, row * factor + y, jump, outlined[y])
        for column in range(image.shape[1]):
            covered = lines = 0
            u = v = w = through = 0.0
            for j in range(factor):
                for i in range(factor):
                    y, x = np.uint64(row * factor + j), np.uint64(column * factor + i)
                    if depth[y, x] > -np.inf:
                        u, v, w = u + normal[y, x, 0], v + normal[y, x, 1], w + normal[y, x, 2]
                        through += slant[y, x]
                        covered += 1
                        lines += outlined[np.uint64(j), x]
            if covered == 0:
                image[row, column, 0] = image[row, column, 1] = image[row, column, 2] = 255
                continue
            length = max(np.sqrt(u * u + v * v + w * w), 1e-30) * (1 if w >= 0 else -1)
            light = max(0.0, (u * _LIGHT[0] + v * _LIGHT[1] + w * _LIGHT[2]) / length)
            rim = (1 - w / length) ** 2
            tone = min(1.0, max(0.0, 0.30 + 0.70 * light - 0.25 * rim))
            opacity = 0.50 + 0.25 * rim
            behind = 0.75 * (1 - np.exp(-0.32 * max(0.0, through / covered - rim)))
            line, part = 0.55 * lines / covered, covered / factor**2
            for k in range(3):
                value = 1 - opacity * (1 - _SHADOW[k] - (_BODY[k] - _SHADOW[k]) * tone)
                value += behind * (_SHADOW[k] - value)
                value += line * (_OUTLINE[k] - value)
                image[row, column, k] = int(255.5 - 255 * part * (1 - value))


@numba.njit(cache=True)
def _find_outline(depth, row, jump, outlined):
    """Whether one of the four neighbours of each pixel of a row lies more than `jump` behind it, or is empty."""
    here, width = depth[row], depth.shape[1]
    above, below = depth[max(row - 1, 0)], depth[min(row + 1, len(depth) - 1)]
    for x in range(width):
        outlined[x] = min(above[x], below[x]) < here[x] - jump
    for x in range(width - 1):
        outlined[x] |= here[x + 1] < here[x] - jump
    for x in range(1, width):
        outlined[x] |= here[x - 1] < here[x] - jump
