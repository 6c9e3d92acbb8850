"""A picture of the worst retrievals: a query a row, then what was found first, and the first right one."""

import numpy as np
from PIL import Image

from reebslice.drawing.canvas import Words, new_canvas, write_words
from reebslice.drawing.marks import INK
from reebslice.drawing.rasters import rasterize_mesh
from reebslice.drawing.shading import shade_layers
from reebslice.drawing.views import fit_view
from retrieval_models import class_of, clean_surface

WIDTH, HEIGHT, SHOWN = 190, 165, 5
WRONG = "#b3361e"


def draw_worst(folder, numbers, distances, order, path, names):
    """Draw the queries of these rows of a matrix of distances, the numbers of whose models are given."""
    distances = distances.copy()
    np.fill_diagonal(distances, np.inf)
    rows, cache = [], {}

    def draw(row, words, colour=INK):
        number = numbers[row]
        if number not in cache:
            cache[number] = _draw_model(folder / f"{number}.off")
        canvas = new_canvas(WIDTH, HEIGHT, 1.0)
        canvas.image[: HEIGHT - 25] = cache[number]
        write_words(canvas, [Words(f"{number} {words}", (6, HEIGHT - 12), 8.5, colour)])
        return canvas.image

    for query in order:
        found = np.argsort(distances[query], kind="stable")[:-1]
        right = [class_of(numbers[row]) == class_of(numbers[query]) for row in found]
        first = right.index(True)
        cells = [draw(query, f"{names[class_of(numbers[query])]}, query")]
        for row, good in zip(found[:SHOWN], right):
            cells.append(draw(row, names[class_of(numbers[row])], INK if good else WRONG))
        cells.append(draw(found[first], f"first right, place {first + 1}"))
        rows.append(np.hstack(cells))
    Image.fromarray(np.vstack(rows)).quantize(64).save(path, optimize=True)


def _draw_model(path):
    """The picture of a model, its longest axes in view."""
    points, faces = clean_surface(path)
    points = points - points.mean(axis=0)
    axes = np.linalg.svd(points[:: max(1, len(points) // 2000)], full_matrices=False)[2]
    turned = points @ (axes * [[1], [1], [np.linalg.det(axes)]]).T
    view = fit_view(turned[:, [0, 2, 1]] * [1, -1, 1], -65, 20, 2 * WIDTH, 2 * (HEIGHT - 25), margin=0.08)
    layers = rasterize_mesh(turned[:, [0, 2, 1]] * [1, -1, 1], faces, view)
    return shade_layers(layers, 0.01 * np.ptp(points), 2)
