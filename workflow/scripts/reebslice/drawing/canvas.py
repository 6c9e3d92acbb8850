"""Lines, marks and words on a picture of bytes, antialiased, and the picture as PNG.

Positions are (column, row) in pixels, the middle of the top left pixel being
(0.5, 0.5). Widths of lines and sizes of marks and words are in points, of
which the canvas knows the pixels, so that all of them scale with the picture.
"""

import struct
import zlib
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from ..kernels import njit


class Canvas(NamedTuple):
    """A picture `image` (height, width, 3) of bytes, drawn on in place; `unit`: pixels in a point.

    `cover` (height, width) and `touched` are room for strokes to be drawn. Where `strokes` is a list, lines, marks and
    words are appended to it, as (what, arguments), and not drawn, for :mod:`.vectors`.
    """

    image: np.ndarray
    unit: float
    cover: np.ndarray
    touched: np.ndarray
    strokes: list | None = None


class Words(NamedTuple):
    """A line of text that starts, is centred or ends (`anchor` l, m or r, then s for baseline or m for middle)."""

    text: str
    place: tuple
    size: float
    colour: str
    anchor: str = "lm"
    bold: bool = False
    halo: float = 0.0


def new_canvas(width, height, unit):
    """An all white canvas."""
    shape = (height, width)
    image = np.full((*shape, 3), 255, np.uint8)
    return Canvas(image, unit, np.zeros(shape, np.float32), np.empty(width * height, np.int32))


def rgb(colour):
    """The bytes (3,) of a colour such as #0072B2."""
    return np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)], float)


def draw_lines(canvas, lines, colours, widths, opacity=1.0):
    """Draw polylines, arrays (k, 2), one over the other, with round ends and corners.

    colours : (3,) or (n, 3) bytes; widths : points, one for all or (n,).
    """
    pairs = [np.hstack([line[:-1], line[1:]]) for line in lines]
    draw_segments(canvas, pairs, colours, widths, opacity)


def draw_segments(canvas, groups, colours, widths, opacity=1.0):
    """As :func:`draw_lines`, of groups (k, 4) of segments; where those of a group overlap, they are drawn once."""
    count = len(groups)
    if count and canvas.strokes is not None:
        canvas.strokes.append(("segments", (groups, colours, widths, opacity)))
    elif count:
        starts = np.concatenate([[0], np.cumsum([len(group) for group in groups])])
        radii = np.broadcast_to(np.asarray(widths, float) * canvas.unit / 2, count).copy()
        inks = np.broadcast_to(np.asarray(colours, float), (count, 3)).copy()
        segments = np.concatenate(groups).astype(float)
        _stroke(canvas.image, canvas.cover, canvas.touched, segments, starts, inks, radii, float(opacity))


@njit
def _stroke(image, cover, touched, segments, starts, inks, radii, opacity):
    """Blend every group of segments once, by how much of a pixel it covers."""
    height, width = cover.shape
    for group in range(len(radii)):
        radius, count = radii[group], 0
        reach = radius + 1
        for k in range(starts[group], starts[group + 1]):
            ax, ay, bx, by = segments[k]
            if ay > by:
                ax, ay, bx, by = bx, by, ax, ay
            dx, dy = bx - ax, by - ay
            square = max(dx * dx + dy * dy, 1e-12)
            for row in range(max(0, int(ay - reach)), min(height, int(max(by + reach, 0)) + 1)):
                y = row + 0.5
                # the part of the segment that comes near the row
                first = min(max((y - reach - ay) / dy, 0.0), 1.0) if dy > 0 else 0.0
                last = min(max((y + reach - ay) / dy, 0.0), 1.0) if dy > 0 else 1.0
                left, right = min(ax + first * dx, ax + last * dx), max(ax + first * dx, ax + last * dx)
                for column in range(max(0, int(left - reach)), min(width, int(max(right + reach, 0)) + 1)):
                    x = column + 0.5
                    t = min(max(((x - ax) * dx + (y - ay) * dy) / square, 0.0), 1.0)
                    distance = np.sqrt((x - ax - t * dx) ** 2 + (y - ay - t * dy) ** 2)
                    part = min(distance + 0.5, radius) - max(distance - 0.5, -radius)
                    if part > cover[row, column]:
                        if cover[row, column] == 0:
                            touched[count] = row * width + column
                            count += 1
                        cover[row, column] = part
        for k in range(count):
            row, column = touched[k] // width, touched[k] % width
            for i in range(3):
                value = image[row, column, i]
                image[row, column, i] = int(value + opacity * cover[row, column] * (inks[group, i] - value) + 0.5)
            cover[row, column] = 0


def draw_marks(canvas, places, shape, size, edge, edge_width, face=None):
    """Draw marks of one shape at `places` (n, 2), one over the other.

    shape : "o", "^", "v", "D" or "s"; size : points across; edge, face : bytes
    (3,), a mark without a face is a mere outline; edge_width : points.
    """
    if canvas.strokes is not None:
        canvas.strokes.append(("marks", (places, shape, size, edge, edge_width, face)))
        return
    sides = SIDES[shape] * [1, 1, size * canvas.unit / 2]
    places = np.asarray(places, float).reshape(-1, 2)
    fill, hollow = (edge, True) if face is None else (face, False)
    _mark(canvas.image, places, sides, edge, fill, edge_width * canvas.unit / 2, hollow)


def _polygon(angles, distances):
    """Sides (k, 3) of a convex shape of half size 1: the outward normal and its distance from the middle."""
    angles = np.radians(angles)
    return np.column_stack([np.cos(angles), np.sin(angles), np.broadcast_to(distances, len(angles))])


_SLOPE = np.degrees(np.arctan2(1, 2))  # of a triangle as high as wide
SIDES = {
    "o": _polygon(np.arange(0, 360, 15), 1.0),
    "s": _polygon([0, 90, 180, 270], 1.0),
    "D": _polygon([45, 135, 225, 315], 1.0),
    "^": _polygon([90, -_SLOPE, 180 + _SLOPE], [1, 5**-0.5, 5**-0.5]),
    "v": _polygon([-90, _SLOPE, 180 - _SLOPE], [1, 5**-0.5, 5**-0.5]),
}


@njit
def _mark(image, places, sides, edge, face, half, hollow):
    """Blend the outlines, `half` to both sides of the sides, and what is inside of them."""
    height, width = image.shape[:2]
    reach = 1.5 * sides[:, 2].max() + 2 * half + 1
    for x, y in places:
        for row in range(max(0, int(y - reach)), min(height, int(max(y + reach, 0)) + 1)):
            for column in range(max(0, int(x - reach)), min(width, int(max(x + reach, 0)) + 1)):
                distance = -np.inf
                for k in range(len(sides)):
                    across = sides[k, 0] * (column + 0.5 - x) + sides[k, 1] * (row + 0.5 - y)
                    distance = max(distance, across - sides[k, 2])
                outer, inner = min(max(0.5 + half - distance, 0), 1), min(max(0.5 - half - distance, 0), 1)
                opacity = outer - inner if hollow else outer
                share = 0.0 if hollow or inner == 0 else inner / outer
                for k in range(3):
                    ink, value = edge[k] + share * (face[k] - edge[k]), image[row, column, k]
                    image[row, column, k] = int(value + opacity * (ink - value) + 0.5)


def write_words(canvas, words):
    """Write all `words`, :class:`Words`."""
    if canvas.strokes is not None:
        canvas.strokes.append(("words", words))
        return
    picture = Image.fromarray(canvas.image)
    pen = ImageDraw.Draw(picture)
    for line in words:
        pen.text(line.place, line.text, line.colour, _font(line.bold, line.size * canvas.unit), line.anchor,
                 stroke_width=line.halo * canvas.unit, stroke_fill="white")  # fmt: skip
    canvas.image[:] = np.asarray(picture)


def measure_text(canvas, text, size, bold=False):
    """Width of a text in pixels."""
    return _font(bold, size * canvas.unit).getlength(text)


@lru_cache
def _font(bold, size):
    """DejaVu Sans, which matplotlib brings along; matplotlib itself, slow to import, is not needed."""
    folder = Path(find_spec("matplotlib").origin).parent / "mpl-data/fonts/ttf"
    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    return ImageFont.truetype(folder / name, size, layout_engine=ImageFont.Layout.BASIC)


def encode_png(image):
    """The bytes of a PNG file of an image (height, width, 3) of bytes; nothing in it but the pixels.

    Every row is stored as differences to the pixel on the left (filter type 1), which
    makes an image of soft shades small at a low level of compression.
    """
    height, width, _ = image.shape
    rows = np.empty((height, 1 + 3 * width), np.uint8)
    rows[:, 0], rows[:, 1:4] = 1, image[:, 0]
    np.subtract(image[:, 1:], image[:, :-1], out=rows[:, 4:].reshape(height, width - 1, 3))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows, 2)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)) for name, data in chunks
    )
