"""Score the search for similar models on the watertight track of SHREC'07: the tables of docs/retrieval.md.

    python benchmarks/score_retrieval.py SHREC_FOLDER [--results FOLDER] [--workers N] [--page FILE]

SHREC_FOLDER holds 1.off to 400.off, twenty of a class after each other. It is for academic use, and read only. What
was found for a model stays in the folder of results, and is not looked for again. Odd numbers are what choices were
made on, even ones what counts.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

from pages import put_table
from reebslice.descriptors.comparison import COMPARED, compare_descriptors, rank_by_neighbourhood
from retrieval_models import NUMBER, ROOT, class_of, describe_models
from retrieval_pictures import draw_worst
from retrieval_rotations import tell_rotations
from retrieval_scores import MEASURES, compare_plainly, score_queries

NAMES = (
    "human cup glasses airplane ant chair octopus table teddy hand pliers fish bird spring armadillo bust mechanic"
    " bearing vase four-legged"
).split()
SPLITS = {"even": range(2, NUMBER + 1, 2), "odd": range(1, NUMBER + 1, 2), "all": range(1, NUMBER + 1)}
BASELINES = {"D2 histogram": ("d2",), "D2, compactness, eccentricities": ("d2", "compactness", "eccentricities")}
OURS, STILL, RANKED = "descriptors", "descriptors, no heights", "descriptors, ranked by neighbourhood"


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("shrec", type=Path)
    parser.add_argument("--results", type=Path, default=Path("results/benchmarks/retrieval"))
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "retrieval.md")
    options = parser.parse_args(arguments)
    described = describe_models(options.shrec, options.results / "plain", SPLITS["all"], False, options.workers)
    turned = describe_models(options.shrec, options.results / "turned", SPLITS["even"], True, options.workers)
    put_table(options.page, "scores", tell_scores(described, turned))
    put_table(options.page, "classes", tell_classes(described))
    put_table(options.page, "ablation", tell_ablation(described))
    put_table(options.page, "worst", tell_worst(options.shrec, described, options.page.with_name("retrieval.png")))
    rotations = tell_rotations(options.shrec, options.results / "rotations", options.workers)
    put_table(options.page, "rotations", rotations)


def choose(described, numbers):
    """Tables and plain descriptors of these numbers, from those of all."""
    return tuple([part[number - 1] for number in numbers] for part in described)


def matrices(tables, plain):
    """Distances by every way, by its name."""
    distances = compare_descriptors(tables)
    ways = {name: compare_plainly(plain, parts) for name, parts in BASELINES.items()}
    still = compare_descriptors([keep(table.to_pydict(), lambda key: key[1] != "height") for table in tables])
    return ways | {STILL: still, OURS: distances, RANKED: rank_by_neighbourhood(distances)}


def classes_of(numbers):
    return np.array([class_of(number) for number in numbers])


def tell_scores(described, turned):
    """The table of scores by split, way and measure; the even models turned beside."""
    lines = [f"| models | distance | {' | '.join(MEASURES)} |", "| --- | --- |" + " ---: |" * len(MEASURES)]
    splits = {name: (choose(described, numbers), numbers) for name, numbers in SPLITS.items()}
    splits["even, each turned at random"] = turned, SPLITS["even"]
    for split, (chosen, numbers) in splits.items():
        for way, distances in matrices(*chosen).items():
            scores = score_queries(distances, classes_of(numbers)).mean(axis=0)
            lines.append(f"| {split} | {way} | " + " | ".join(f"{score:.1f}" for score in scores) + " |")
    return lines


def tell_classes(described):
    """The table of scores of the even models by class."""
    classes = classes_of(SPLITS["even"])
    found = matrices(*choose(described, SPLITS["even"]))
    plain, ranked = (score_queries(found[way], classes) for way in (OURS, RANKED))
    lines = [f"| class | {' | '.join(MEASURES)} | ranked: {' | '.join(MEASURES)} |", "| --- |" + " ---: |" * 8]
    for number, name in enumerate(NAMES):
        cells = np.concatenate([part[classes == number].mean(axis=0) for part in (plain, ranked)])
        lines.append(f"| {name} | " + " | ".join(f"{cell:.0f}" for cell in cells) + " |")
    return lines


def tell_ablation(described):
    """What each list of numbers is worth on the odd models: alone, and what is lost without it."""
    tables, _ = choose(described, SPLITS["odd"])
    classes, columns = classes_of(SPLITS["odd"]), [table.to_pydict() for table in tables]
    keys = list(zip(columns[0]["descriptor"], columns[0]["function"]))

    def score(kept):
        chosen = [keep(table, kept.__contains__) for table in columns]
        return score_queries(compare_descriptors(chosen), classes).mean(axis=0)

    compared = [key for key in keys if key[0] in COMPARED]
    lines = [
        f"| list | alone: {' | '.join(MEASURES)} | all but it: {' | '.join(MEASURES)} |",
        "| --- |" + " ---: |" * 8,
    ]
    for key in compared:
        cells = np.concatenate([score([key]), score([one for one in compared if one != key])])
        lines.append(f"| {' of '.join(filter(None, key))} | " + " | ".join(f"{cell:.1f}" for cell in cells) + " |")
    cells = " | ".join(f"{cell:.1f}" for cell in score(compared))
    return [*lines, f"| all | {cells} | | | | |"]


def keep(columns, kept):
    """The rows of a table's columns whose keys (descriptor, function) are kept."""
    rows = [row for row, key in enumerate(zip(columns["descriptor"], columns["function"])) if kept(key)]
    return {name: [column[row] for row in rows] for name, column in columns.items()}


def tell_worst(folder, described, path):
    """Draw the ten even models with the least gain, and list them."""
    numbers, found = list(SPLITS["even"]), matrices(*choose(described, SPLITS["even"]))[OURS]
    scores = score_queries(found, classes_of(numbers))
    order = np.lexsort((scores[:, 1], scores[:, 3]))[:10]
    draw_worst(folder, numbers, found, order, path, NAMES)
    lines = ["| model | class | FT | DCG |", "| ---: | --- | ---: | ---: |"]
    for row in order:
        name = NAMES[class_of(numbers[row])]
        lines.append(f"| {numbers[row]} | {name} | {scores[row, 1]:.0f} | {scores[row, 3]:.0f} |")
    return lines


if __name__ == "__main__":
    sys.exit(main())
