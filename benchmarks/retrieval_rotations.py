"""How far the descriptors of a model come from themselves when it is turned: the table of docs/retrieval.md."""

import json
from concurrent.futures import ProcessPoolExecutor

import numpy as np

from reebslice.descriptors.comparison import COMPARED, compare_descriptors
from reebslice.descriptors.persistence import pool_persistences, rank_persistences, take_pairs
from reebslice.descriptors.surface import describe_surface
from reebslice.descriptors.surface_points import face_areas
from retrieval_models import NUMBER, PER_CLASS, clean_surface, graph_functions

NUMBERS, TURNS, DIRECTIONS = range(2, NUMBER + 1, PER_CLASS), 20, (1, 8, 32)


def describe_turned(path, target, turn):
    """Write what is compared of a model as it is, or turned, by the number of directions, unless it is there."""
    file = target / f"{path.stem}_{turn}.json"
    if file.exists():
        return
    points, faces = clean_surface(path, None if turn is None else 1000 * int(path.stem) + turn)
    found = {"any": describe_surface(points, faces, graph_functions(points, faces, directions=0))}
    for number in DIRECTIONS:
        graphs = graph_functions(points, faces, intrinsic=False, directions=number)
        unit = np.sqrt(face_areas(points, faces).sum())
        ranks = [rank_persistences(*take_pairs(nodes)) / unit for _, nodes, _ in graphs.values()]
        pooled = pool_persistences(np.array(ranks)).tolist()
        found[number] = {"descriptor": ["persistences"], "function": ["height"], "values": [pooled]}
    written = file.with_suffix(".part")
    written.write_text(json.dumps(found))
    written.rename(file)


def tell_rotations(folder, target, workers):
    """The table: of every list of numbers the distance from a model to itself turned, over that to other models."""
    target.mkdir(parents=True, exist_ok=True)
    cases = [(number, turn) for number in NUMBERS for turn in (None, *range(TURNS))]
    with ProcessPoolExecutor(workers) as pool:
        for job in [pool.submit(describe_turned, folder / f"{k}.off", target, turn) for k, turn in cases]:
            job.result()
    found = [json.loads((target / f"{number}_{turn}.json").read_text()) for number, turn in cases]
    owner = np.array([number for number, _ in cases])
    lines = ["| list | directions | mean | largest |", "| --- | ---: | ---: | ---: |"]
    for count in found[0]:
        tables = [one[count] for one in found]
        for key in zip(tables[0]["descriptor"], tables[0]["function"]):
            if key[0] in COMPARED:
                shares = _shares([_rows_of(table, key) for table in tables], owner)
                name = " of ".join(filter(None, key))
                lines.append(f"| {name} | {count} | {100 * shares.mean():.2g} % | {100 * shares.max():.2g} % |")
    return [*lines, *_tell_invariants([one["any"] for one in found])]


def _rows_of(table, key):
    """The one row of a table's columns with this key."""
    row = list(zip(table["descriptor"], table["function"])).index(key)
    return {name: [column[row]] for name, column in table.items()}


def _shares(tables, owner):
    """Distances between each model as it is and turned, over the median distance between two of the models."""
    distances, first = compare_descriptors(tables), np.arange(0, len(owner), TURNS + 1)
    between = distances[np.ix_(first, first)][np.triu_indices(len(first), 1)]
    own = np.array([distances[start, start + 1 : start + TURNS + 1] for start in first])
    return own / np.median(between)


def _tell_invariants(tables):
    """Rows on what rotation must not change: Betti numbers, area and volume."""
    lines = []
    for name in ("betti_numbers", "area", "volume"):
        values = np.array([table["values"][table["descriptor"].index(name)] for table in tables])
        own = values[:: TURNS + 1].repeat(TURNS + 1, axis=0)
        change = np.abs(values - own).max(axis=1) / np.abs(own).max(axis=1)
        lines.append(f"| {name}, relative change | any | {change.mean():.1g} | {change.max():.1g} |")
    return lines
