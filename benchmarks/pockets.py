"""Pockets by pixels: what slicers' checks find on layers of pixels, beside the exact pockets.

    python benchmarks/pockets.py MESH ... [--pixels 200] [--layers 200]

Each mesh is cut into layers, each layer is filled with pixels, and floods from layer to layer find what does not
drain or vent: two areas of consecutive layers hang together where they share at least `--overlap` pixels. Matched are
pockets of one kind that begin and end within two layers of each other; what has fewer layers than `--depth` is left
out on both sides, in the exact pockets as half a layer less. The table tells how many are found by both, missed and
invented by pixels, and the seconds of both (processor time, the exact ones after a first call).
"""

import argparse
import time

import numpy as np
from PIL import Image, ImageDraw
from scipy import ndimage

from reebslice import find_pockets, height_mesh, inspect_surface, nested_contours, read_mesh


def fill_layers(mesh, layers, pixels):
    """Material at the middle of each layer, (layers, rows, columns) bool, with two empty pixels around."""
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    step = (high[2] - low[2]) / layers
    contours, regions = nested_contours(mesh, low[2] + step * (np.arange(layers) + 0.5))
    scale = pixels / (high - low)[:2].max()
    columns, rows = (np.ceil((high - low)[:2] * scale).astype(int) + 5).tolist()
    sheets = [Image.new("1", (columns, rows)) for _ in range(layers)]
    for c in np.lexsort((-np.abs(regions.area), contours.level)).tolist():  # the larger first, what lies inside over it
        outline = (contours.points[contours.start[c] : contours.start[c + 1]] - low[:2]) * scale + 2
        if len(outline) > 2:
            ImageDraw.Draw(sheets[contours.level[c]]).polygon(list(map(tuple, outline)), fill=int(not regions.inner[c]))
    return np.array([np.asarray(sheet) for sheet in sheets])


def flood(empty, overlap):
    """(begin, end) layers of all empty areas, upward, that meet an elder one; the outside is eldest."""
    ended, floods = [], {}
    before = np.zeros(empty.shape[1:], int)
    for layer, sheet in enumerate(empty):
        labels, count = ndimage.label(sheet)
        pairs, shared = np.unique(np.stack([labels, before]).reshape(2, -1), axis=1, return_counts=True)
        met = {label: set() for label in range(1, count + 1)}
        for (label, old), n in zip(pairs.T.tolist(), shared.tolist()):
            if label and old and n >= overlap:
                met[label].add(floods[old])
        parts = merge([{label, *{("flood", one) for one in olds}} for label, olds in met.items()])
        now = {}
        for part in parts:
            olds = sorted(one[1] for one in part if isinstance(one, tuple))
            own = [label for label in part if not isinstance(label, tuple)]
            outside = labels[0, 0] in own
            birth = (-1, 0) if outside else olds[0] if olds else (layer, min(own))
            ended += [(one[0], layer) for one in olds if one not in (birth, (-1, 0))]
            now |= dict.fromkeys(own, birth)
        before, floods = labels, now
    return ended


def merge(sets):
    """Unite the sets that share members."""
    united = []
    for one in sets:
        for other in [other for other in united if other & one]:
            united.remove(other)
            one = one | other
        united.append(one)
    return united


def match(exact, pixel, slack):
    """Pairs that begin and end within `slack` layers of each other; each is taken once."""
    left, both = list(pixel), 0
    for low, high in exact:
        near = [one for one in left if abs(one[0] - low) <= slack and abs(one[1] - high) <= slack]
        if near:
            left.remove(min(near, key=lambda one: abs(one[0] - low) + abs(one[1] - high)))
            both += 1
    return both


def compare(path, arguments):
    """Count basins and bells found by both, by one, and measure seconds."""
    read = read_mesh(path)
    tables, _ = inspect_surface(read.points, read.faces)
    if tables is None:
        return None
    points = np.column_stack([tables["vertices"][axis].to_numpy() for axis in "xyz"])
    faces = np.column_stack([tables["faces"][corner].to_numpy() for corner in "abc"])
    layers = arguments.layers
    base, step = points[:, 2].min(), np.ptp(points[:, 2]) / layers
    find_pockets(points, faces, least_depth=(arguments.depth - 0.5) * step)
    start = time.process_time()
    pockets = find_pockets(points, faces, least_depth=(arguments.depth - 0.5) * step)
    middle = time.process_time()
    empty = np.pad(
        ~fill_layers(height_mesh(points, faces), layers, arguments.pixels),
        ((1, 1), (0, 0), (0, 0)),
        constant_values=True,
    )
    found = {"basin": [(low - 1, high - 1) for low, high in flood(empty, arguments.overlap)]}
    found["bell"] = [(layers + 1 - low, layers + 1 - high) for low, high in flood(empty[::-1], arguments.overlap)]
    end = time.process_time()
    counts = np.zeros(3, int)
    for kind, pixel in found.items():
        chosen = pockets.kind == kind
        exact = list(zip((pockets.begin_height[chosen] - base) / step, (pockets.end_height[chosen] - base) / step))
        pixel = [pair for pair in pixel if abs(pair[1] - pair[0]) >= arguments.depth]
        both = match(exact, pixel, 2.5)
        counts += [both, len(exact) - both, len(pixel) - both]
    return (*counts.tolist(), middle - start, end - middle)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--pixels", type=int, default=200, help="along the longer side of a layer")
    parser.add_argument("--layers", type=int, default=200)
    parser.add_argument("--overlap", type=int, default=1, help="pixels")
    parser.add_argument("--depth", type=int, default=4, help="layers")
    arguments = parser.parse_args()
    print(
        "| mesh | both | missed by pixels | invented by pixels | exact, s | pixels, s |\n"
        "| --- | ---: | ---: | ---: | ---: | ---: |"
    )
    for path in arguments.meshes:
        found = compare(path, arguments)
        if found:
            both, missed, invented, exact, pixels = found
            print(
                f"| {path.rsplit('/')[-1]} | {both} | {missed} | {invented} | {exact:.3f} | {pixels:.2f} |", flush=True
            )


if __name__ == "__main__":
    main()
