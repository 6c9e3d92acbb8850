"""Shading of rasterised meshes: a translucent body on white."""

import numpy as np

from ..kernels import njit

_LIGHT = np.array([-0.45, 0.55, 0.70]) / np.linalg.norm([-0.45, 0.55, 0.70])
_BODY = np.array([0.66, 0.73, 0.80])
_SHADOW = np.array([0.33, 0.40, 0.49])
_OUTLINE = np.array([0.17, 0.21, 0.27])


def shade_layers(layers, jump, factor=1):
    """Shade a translucent body on white.

    The front-most surface is lit from above left; surfaces behind it shine
    through where they turn edge-on.

    Parameters
    ----------
    layers : Layers
    jump : float
        Step of depth, mesh units, that is outlined, on its nearer side.
    factor : int
        So many pixels each way are averaged into one.

    Returns
    -------
    (height / factor, width / factor, 3) uint8
        Opaque RGB image.
    """
    height, width = layers.depth.shape
    image = np.empty((height // factor, width // factor, 3), np.uint8)
    _shade_blocks(layers, float(jump), factor, image)
    return image


@njit
def _shade_blocks(layers, jump, factor, image):
    """Shade the mean surface of every block once; how much is covered, and on an outline, counts pixel by pixel."""
    depth, normal, slant = layers.depth, layers.normal, layers.slant
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


@njit(inner=True)
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
