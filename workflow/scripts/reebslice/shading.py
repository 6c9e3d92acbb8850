"""Translucent pictures of a triangle mesh, drawn without a graphics card.

An orthographic view, an exact software rasteriser and a shading. The
rasteriser works on integers (pixels in 256ths), so faces that share a mesh
edge neither overlap nor leave a gap: seen from anywhere, a closed surface
covers every pixel by as many front faces as back faces.

Reference: J. Pineda, A parallel algorithm for polygon rasterization,
SIGGRAPH 1988, doi:10.1145/54852.378457 (edge functions).
"""

from typing import NamedTuple

import numba
import numpy as np

SUBPIXELS = 256
_LIGHT = np.array([-0.45, 0.55, 0.70]) / np.linalg.norm([-0.45, 0.55, 0.70])
_BODY = np.array([0.66, 0.73, 0.80])
_SHADOW = np.array([0.33, 0.40, 0.49])
_OUTLINE = np.array([0.17, 0.21, 0.27])
_FLAT_VALENCE = 64


class View(NamedTuple):
    """An orthographic view: rows of `axes` are right, up and toward the eye.

    A point p is seen at pixel ((p . right - centre_x) scale + width / 2,
    height / 2 - (p . up - centre_y) scale), rows counted from the top.
    """

    axes: np.ndarray
    centre: np.ndarray
    scale: float
    width: int
    height: int


class Layers(NamedTuple):
    """What every pixel of a picture sees, arrays of shape (height, width).

    `depth`: of the front-most face, larger is nearer, -inf where there is
    none. `normal`: (height, width, 3), of that face in axes of the view, not
    of unit length. `slant`: summed over all faces behind the pixel, 0 for a
    face seen head-on and 1 for one seen edge-on. `winding`: front faces minus
    back faces.
    """

    depth: np.ndarray
    normal: np.ndarray
    slant: np.ndarray
    winding: np.ndarray


def view_axes(azimuth, elevation):
    """Rotation (3, 3) from the tilted frame to right, up, toward the eye.

    Angles in degrees. At azimuth 0 the eye is on the +x axis, at 90 on +y;
    a positive elevation looks down. Height points up in the picture.
    """
    a, e = np.radians([azimuth, elevation])
    right = [-np.sin(a), np.cos(a), 0.0]
    up = [-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e)]
    toward = [np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)]
    return np.array([right, up, toward])


def fit_view(points, azimuth, elevation, width, height, margin=0.06):
    """The view in which `points` (n, 3) fill a picture of width x height pixels.

    `margin` is the empty part at each side. A single point, or none, is
    put in the middle.
    """
    axes = view_axes(azimuth, elevation)
    if len(points) == 0:
        return View(axes, np.zeros(2), 1.0, width, height)
    seen = points @ axes[:2].T
    low, high = seen.min(axis=0), seen.max(axis=0)
    room = np.array([width, height]) * (1 - 2 * margin)
    extent = high - low
    scale = float(np.min(room / np.where(extent > 0, extent, np.inf), initial=np.inf, where=extent > 0))
    return View(axes, (low + high) / 2, scale if np.isfinite(scale) else 1.0, width, height)


def project_points(points, view):
    """Pixel column, pixel row and depth, shape (n, 3), of `points` (n, 3)."""
    seen = np.asarray(points, dtype=float).reshape(-1, 3) @ view.axes.T
    column = (seen[:, 0] - view.centre[0]) * view.scale + view.width / 2
    row = view.height / 2 - (seen[:, 1] - view.centre[1]) * view.scale
    return np.column_stack([column, row, seen[:, 2]])


@numba.njit(cache=True)
def find_corner_normals(points, faces, crease):
    """Unit normals, shape (n_faces, 3, 3), smooth except across creases.

    A corner's normal is the area-weighted mean over those faces around its
    vertex whose normals lie within `crease` degrees of the face's own.
    Vertices with more than 64 faces (tips, centres of caps) are left flat,
    and faces without area get the normal 0.
    """
    n = len(faces)
    normals, areas = np.zeros((n, 3)), np.zeros(n)
    start = np.zeros(len(points) + 1, dtype=np.int64)
    for f in range(n):
        u = points[faces[f, 1]] - points[faces[f, 0]]
        v = points[faces[f, 2]] - points[faces[f, 0]]
        w = np.cross(u, v)
        areas[f] = np.sqrt(w[0] ** 2 + w[1] ** 2 + w[2] ** 2)
        if areas[f] > 0:
            normals[f] = w / areas[f]
        for i in range(3):
            start[faces[f, i] + 1] += 1
    start = np.cumsum(start)
    around, fill = np.empty(3 * n, dtype=np.int64), start.copy()
    for f in range(n):
        for i in range(3):
            around[fill[faces[f, i]]] = f
            fill[faces[f, i]] += 1
    bound = np.cos(np.radians(crease))
    corners = np.zeros((n, 3, 3))
    for f in range(n):
        for i in range(3):
            first, last = start[faces[f, i]], start[faces[f, i] + 1]
            x = y = z = 0.0
            if last - first <= _FLAT_VALENCE:
                for k in range(first, last):
                    g = around[k]
                    m = normals[g]
                    if m[0] * normals[f, 0] + m[1] * normals[f, 1] + m[2] * normals[f, 2] >= bound:
                        x, y, z = x + areas[g] * m[0], y + areas[g] * m[1], z + areas[g] * m[2]
            length = np.sqrt(x * x + y * y + z * z)
            if length > 0:
                corners[f, i, 0], corners[f, i, 1], corners[f, i, 2] = x / length, y / length, z / length
            else:
                corners[f, i] = normals[f]
    return corners


@numba.njit(cache=True)
def _fill_faces(grid, depths, faces, normals, depth, normal, slant, winding):
    height, width = depth.shape
    half = SUBPIXELS // 2
    ids, weights = np.empty(3, np.int64), np.empty(3)
    x, y = np.empty(3, np.int64), np.empty(3, np.int64)
    dx, dy, bias, value = np.empty(3, np.int64), np.empty(3, np.int64), np.empty(3, np.int64), np.empty(3, np.int64)
    for f in range(len(faces)):
        ax, ay = grid[faces[f, 0], 0], grid[faces[f, 0], 1]
        area = (grid[faces[f, 1], 0] - ax) * (grid[faces[f, 2], 1] - ay)
        area -= (grid[faces[f, 1], 1] - ay) * (grid[faces[f, 2], 0] - ax)
        if area == 0:
            continue
        # Rows run downward, so a face seen from its front has negative area.
        ids[0], ids[1], ids[2] = (0, 1, 2) if area > 0 else (0, 2, 1)
        sign = -1 if area > 0 else 1
        area = abs(area)
        for i in range(3):
            x[i], y[i] = grid[faces[f, ids[i]], 0], grid[faces[f, ids[i]], 1]
        for i in range(3):
            # Edge i lies opposite corner i. A pixel centre exactly on it goes
            # to the one of its two faces for which the edge points down (or right).
            p, q = (i + 1) % 3, (i + 2) % 3
            dx[i], dy[i] = x[q] - x[p], y[q] - y[p]
            bias[i] = 0 if dy[i] > 0 or (dy[i] == 0 and dx[i] > 0) else 1
        top = max(0, (min(y[0], y[1], y[2]) - half) // SUBPIXELS)
        bottom = min(height - 1, (max(y[0], y[1], y[2]) - half) // SUBPIXELS + 1)
        for row in range(top, bottom + 1):
            left, right = 0, width - 1
            for i in range(3):
                p = (i + 1) % 3
                value[i] = dx[i] * (row * SUBPIXELS + half - y[p]) - dy[i] * (half - x[p])
                step = SUBPIXELS * dy[i]
                if step > 0:
                    right = min(right, (value[i] - bias[i]) // step)
                elif step < 0:
                    left = max(left, -((value[i] - bias[i]) // -step))
                elif value[i] < bias[i]:
                    right = -1
            for column in range(left, right + 1):
                d = slope = 0.0
                for i in range(3):
                    weights[i] = (value[i] - SUBPIXELS * dy[i] * column) / area
                    d += weights[i] * depths[faces[f, ids[i]]]
                    slope += weights[i] * normals[f, ids[i], 2]
                winding[row, column] += sign
                slant[row, column] += max(0.0, 1.0 - abs(slope)) ** 2
                if d > depth[row, column]:
                    depth[row, column] = d
                    for k in range(3):
                        normal[row, column, k] = (
                            weights[0] * normals[f, ids[0], k]
                            + weights[1] * normals[f, ids[1], k]
                            + weights[2] * normals[f, ids[2], k]
                        )


def rasterize_mesh(points, faces, view, crease=40.0):
    """The :class:`Layers` of a mesh: points (n, 3), faces (m, 3), as seen in `view`.

    Faces are counter-clockwise seen from outside. A pixel is covered when its
    centre is. Faces seen exactly edge-on cover nothing. An empty mesh gives
    empty layers.
    """
    framed = np.ascontiguousarray(points @ view.axes.T)
    return _rasterize(points, faces, find_corner_normals(framed, np.ascontiguousarray(faces), crease), view)


def _rasterize(points, faces, normals, view):
    shape = (view.height, view.width)
    layers = Layers(
        np.full(shape, -np.inf), np.zeros((*shape, 3)), np.zeros(shape), np.zeros(shape, dtype=np.int32)
    )
    seen = project_points(points, view)
    grid = np.rint(seen[:, :2] * SUBPIXELS).astype(np.int64)
    _fill_faces(grid, seen[:, 2].copy(), np.ascontiguousarray(faces), normals, *layers)
    return layers


def widest_azimuth(points, faces, elevation):
    """The azimuth, a multiple of 15 degrees, from which the mesh shows the largest silhouette.

    Parts then hide each other least. Of large meshes only every k-th face is
    looked at. 0 for an empty mesh.
    """
    faces = faces[:: 1 + len(faces) // 50_000]
    best, largest = 0.0, 0.0
    for azimuth in range(-180, 180, 15):
        view = fit_view(points, azimuth, elevation, 96, 96, margin=0)
        seen = np.isfinite(_rasterize(points, faces, np.zeros((len(faces), 3, 3)), view).depth)
        if seen.sum() / view.scale**2 > largest:
            best, largest = float(azimuth), seen.sum() / view.scale**2
    return best


@numba.njit(cache=True)
def find_outlines(depth, jump):
    """Where the front-most surface breaks off: (height, width), True on the nearer side.

    A pixel is on an outline when one of its four neighbours lies more than
    `jump` (mesh units) behind it, or is empty.
    """
    height, width = depth.shape
    outline = np.zeros((height, width), dtype=np.bool_)
    for row in range(height):
        for column in range(width):
            bound = depth[row, column] - jump
            if bound > -np.inf:
                outline[row, column] = (
                    (row > 0 and depth[row - 1, column] < bound)
                    or (row + 1 < height and depth[row + 1, column] < bound)
                    or (column > 0 and depth[row, column - 1] < bound)
                    or (column + 1 < width and depth[row, column + 1] < bound)
                )
    return outline


@numba.njit(cache=True)
def _shade_pixels(depth, normal, slant, outline, image):
    for row in range(depth.shape[0]):
        for column in range(depth.shape[1]):
            if depth[row, column] == -np.inf:
                continue
            x, y, z = normal[row, column]
            length = max(np.sqrt(x * x + y * y + z * z), 1e-300)
            if z < 0:
                length = -length
            light = max(0.0, (x * _LIGHT[0] + y * _LIGHT[1] + z * _LIGHT[2]) / length)
            rim = (1 - z / length) ** 2
            tone = min(1.0, max(0.0, 0.30 + 0.70 * light - 0.25 * rim))
            opacity = 0.50 + 0.25 * rim
            behind = 0.75 * (1 - np.exp(-0.32 * max(0.0, slant[row, column] - rim)))
            line = 0.55 if outline[row, column] else 0.0
            for k in range(3):
                value = 1 - opacity * (1 - _SHADOW[k] - (_BODY[k] - _SHADOW[k]) * tone)
                value += behind * (_SHADOW[k] - value)
                image[row, column, k] = value + line * (_OUTLINE[k] - value)


def shade_layers(layers, jump):
    """Opaque RGB image (height, width, 3), values 0 to 1, of a translucent body on white.

    The front-most surface is lit from above left; surfaces behind it shine
    through where they turn edge-on. `jump`: depth step, in mesh units, that
    is outlined.
    """
    image = np.ones(layers.normal.shape)
    outline = find_outlines(layers.depth, float(jump))
    _shade_pixels(layers.depth, layers.normal, layers.slant, outline, image)
    return image


def shrink_image(image, factor):
    """Mean over blocks of factor x factor pixels of an image (height, width, channels)."""
    height, width, channels = image.shape
    blocks = image.reshape(height // factor, factor, width // factor, factor, channels)
    return blocks.mean(axis=(1, 3))
