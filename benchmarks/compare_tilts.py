"""Compare tilts on a folder of meshes: none, random directions, and what `auto` selects.

    python benchmarks/compare_tilts.py MESH_FOLDER [--table FILE] [--page FILE] [--figure FILE]

Writes one row per model and direction to a Parquet table, and puts the tables
of docs/tilts.md in place and its figure beside it. The configuration is that
of config/config.yaml; the random directions are drawn in the same cone with a
seed of their own, so that none of them is a candidate of `auto`.
"""

import argparse
import os
import re
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
import yaml

from reebslice.errors import MeshFormatError

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "workflow" / "scripts"))

from corpus.code_digest import compiled_code_folder

os.environ.setdefault("NUMBA_CACHE_DIR", str(compiled_code_folder(ROOT / "workflow" / "scripts" / "reebslice")))

from corpus.discovery import find_models
from reebslice.formats.meshes import read_mesh
from reebslice.mesh.half_edges import find_twins
from reebslice.mesh.inspection import inspect_surface
from reebslice.morse.height_mesh import order_by_height
from reebslice.morse.unfolding import unfold_saddles
from reebslice.tilt.choice import (
    ANGLE_COST,
    assess_directions,
    candidate_directions,
    rotation_to_vertical,
    select_tilt,
)
from reebslice.tilt.cone import survey_surface
from reebslice.tilt.scan import find_critical_points
from reebslice.tilt.score import fewest_levels

RANDOM_DIRECTIONS, RANDOM_SEED = 5, 2026
# A model is CAD if at least this share of its area lies in flats: faces with
# a neighbour in the same plane, to within this angle in radians.
CAD_SHARE, COPLANAR = 0.1, 1e-4
FIGURES = ("angle", "margin", "morse", "persistent", "fewest_levels", "fewest_levels_exact")
# What a choice could go by; the last is what `auto` does.
SCORES = {
    "persistent critical points + 0.2 x angle": lambda t: t.persistent + 0.2 * t.angle,
    "levels, significant + 0.1 x angle": lambda t: t.fewest_levels + ANGLE_COST * t.angle,
    "levels, all + 0.1 x angle": lambda t: t.fewest_levels_exact + ANGLE_COST * t.angle,
    "geometric mean of both + 0.1 x angle": lambda t: (
        np.sqrt(t.fewest_levels * t.fewest_levels_exact) + ANGLE_COST * t.angle
    ),
}
MARKS = "<!-- {} begins -->\n", "<!-- {} ends -->"


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("meshes", help="folder of meshes, searched recursively")
    parser.add_argument("--table", type=Path, default=Path("results/benchmarks/tilts.parquet"))
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "tilts.md")
    parser.add_argument("--figure", type=Path, default=ROOT / "docs" / "tilts.svg")
    options = parser.parse_args(arguments)
    config = yaml.safe_load((ROOT / "config" / "config.yaml").read_text())
    table = compare_folder(options.meshes, config)
    options.table.parent.mkdir(parents=True, exist_ok=True)
    table.to_parquet(options.table, index=False)
    write_page(options.page, table)
    draw_levels(options.figure, table)


def compare_folder(folder, config):
    """One row per accepted model and direction, as a data frame."""
    models, _ = find_models(folder)
    rows, warm = [], False
    for model, file in models.items():
        try:
            tables, _ = inspect_surface(*read_mesh(file.path)[:2], config["inspect"])
        except MeshFormatError:
            continue
        if tables is None:
            continue
        points = np.column_stack([tables["vertices"][axis].to_numpy() for axis in "xyz"])
        faces = np.column_stack([tables["faces"][corner].to_numpy() for corner in "abc"]).astype(np.int32)
        if not warm:  # compiles
            compare_tilts(points, faces, config["tilt"], True)
            warm = True
        share = flat_share(points, faces)
        for row in compare_tilts(points, faces, config["tilt"], share >= CAD_SHARE):
            rows.append({"model": model, "faces": len(faces), "flat_share": share, "cad": share >= CAD_SHARE, **row})
        print(model, flush=True)
    return pd.DataFrame(rows)


def compare_tilts(points, faces, options, all_arcs):
    """A dict for the input's z, for each random direction and for the selected one."""
    rows = []
    for way, draw in [("none", 0), *(("random", k) for k in range(1, RANDOM_DIRECTIONS + 1)), ("auto", 0)]:
        start = time.process_time()
        if way == "random":
            directions = candidate_directions(RANDOM_DIRECTIONS + 1, options["cone"], RANDOM_SEED)
            record = assess_directions(points, faces, directions[draw : draw + 1])[0]
        else:
            record = select_tilt(points, faces, **{**options, "mode": way})
        seconds = time.process_time() - start
        height = float(np.ptp(points @ np.array(record["direction"])))
        arcs = levels_of_all_arcs(points, faces, record["direction"]) if all_arcs else None
        rows.append(
            {"way": way, "draw": draw, **{name: record[name] for name in FIGURES}, "all_levels": arcs}
            | {"margin_share": record["margin"] / height, "seconds": seconds}
        )
    tried = enumerate(record["candidates"])
    return rows + [{"way": "candidate", "draw": k, **{name: tilt[name] for name in FIGURES}} for k, tilt in tried]


def levels_of_all_arcs(points, faces, direction):
    """The fewest levels that pierce every arc of the surface's Reeb graph, those inside flats as well."""
    mesh = unfold_saddles(order_by_height(points, faces, rotation_to_vertical(direction)))
    rank = np.arange(len(mesh.points), dtype=float)
    surface = survey_surface(mesh.points, mesh.faces, np.array([[0.0, 0.0, 1.0]]), rounding=0.0)
    found = find_critical_points(surface, rank)
    return fewest_levels(surface, rank, found, found.index != 0)


def flat_share(points, faces):
    """Share of the area that lies in faces with a neighbour in the same plane."""
    points = (points - points.min(axis=0)) / np.ptp(points, axis=0).max()
    a, b, c = points[faces.T]
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1)
    unit = normal / np.maximum(area, 1e-300)[:, None]
    beside = unit[find_twins(faces, len(points)).reshape(-1, 3) // 3]
    flat = (np.linalg.norm(np.cross(unit[:, None], beside), axis=2) < COPLANAR).any(axis=1)
    return float(area[flat].sum() / area.sum())


# --------------------------------------------------------------------------
# The page


def write_page(path, table):
    """Put the tables between the marks of the page."""
    text = path.read_text()
    parts = {"sums": sums_lines, "scores": scores_lines, "levels": levels_lines, "costs": costs_lines}
    for name, lines in parts.items():
        first, last = (mark.format(name) for mark in MARKS)
        pattern = re.escape(first) + ".*?" + re.escape(last)
        text = re.sub(pattern, lambda _: first + "\n".join(lines(table)) + "\n" + last, text, flags=re.DOTALL)
    path.write_text(text)


def spread(group, column):
    """Figures of one model: none, random median (worst), auto."""
    none, random, auto = (group[group.way == way][column] for way in ("none", "random", "auto"))
    return [f"{none.iloc[0]:.0f}", f"{random.median():.0f} ({random.max():.0f})", f"{auto.iloc[0]:.0f}"]


def levels_lines(table):
    """Persistent critical points and fewest levels of every CAD model."""
    yield "| model | critical points | | | levels, significant | | | levels, all arcs | | |"
    yield "| --- |" + " ---: |" * 9
    yield "| | none | random | auto |" + " none | random | auto |" * 2
    for model, group in table[table.cad].groupby("model"):
        cells = [spread(group, column) for column in ("persistent", "fewest_levels", "all_levels")]
        yield f"| {model} | " + " | ".join(sum(cells, [])) + " |"


def costs_lines(table):
    """Margin, angle and seconds of every CAD model."""
    yield "| model | faces | margin / height, none | random, median | auto | angle, auto | seconds, none | auto |"
    yield "| --- |" + " ---: |" * 7
    for model, group in table[table.cad].groupby("model"):
        none, auto = (group[group.way == way].iloc[0] for way in ("none", "auto"))
        random = group[group.way == "random"].margin_share.median()
        shares = none.margin_share, random, auto.margin_share
        margins = " | ".join(f"{share:.1e}" if share else "0" for share in shares)
        yield f"| {model} | {none.faces} | {margins} | {auto.angle:.1f} | {none.seconds:.3f} | {auto.seconds:.2f} |"


def sums_lines(table):
    """Sums over the models, CAD and others."""
    names = "models direction proven_Morse critical_points levels,_significant levels,_all_arcs mean_angle seconds"
    yield "| " + " | ".join(names.split()).replace("_", " ") + " |"
    yield "| --- | --- |" + " ---: |" * 6
    for cad, name in ((True, "CAD"), (False, "others")):
        part = table[table.cad == cad]
        for way in ("none", "random", "auto"):
            rows = part[part.way == way]
            share = rows.groupby("draw").size().size  # random: sums are means over the draws
            arcs = f"{rows.all_levels.sum() / share:.0f}" if cad else ""
            yield (
                f"| {name} ({part.model.nunique()}) | {way} | {(rows.morse == 'proven').sum() / share:.0f} |"
                f" {rows.persistent.sum() / share:.0f} | {rows.fewest_levels.sum() / share:.0f} | {arcs} |"
                f" {rows.angle.mean():.1f} | {rows.seconds.sum() / share:.1f} |"
            )


def scores_lines(table):
    """What other scores, and fewer candidates, would have chosen."""
    yield "| models | score | candidates | levels, significant | levels, all | above the random median | mean angle |"
    yield "| --- | --- |" + " ---: |" * 5
    runs = [(name, 64) for name in SCORES] + [(list(SCORES)[-1], count) for count in (32, 16, 8)]
    for cad, models in ((True, "CAD"), (False, "others")):
        part = table[table.cad == cad]
        medians = part[part.way == "random"].groupby("model")[["fewest_levels", "fewest_levels_exact"]].median()
        for name, count in runs:
            tried = part[(part.way == "candidate") & (part.draw < count)].assign(cost=SCORES[name])
            tried = tried.sort_values(["model", "morse", "cost", "angle"], ascending=[True, False, True, True])
            chosen = tried.groupby("model").first()
            above = [int((chosen[column] > medians[column]).sum()) for column in medians]
            yield (
                f"| {models} | {name} | {count} | {chosen.fewest_levels.sum()} | {chosen.fewest_levels_exact.sum()} |"
                f" {above[0]}, {above[1]} | {chosen.angle.mean():.1f} |"
            )


def draw_levels(path, table):
    """Fewest levels of every CAD model: the range of the random directions, none, auto."""
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "tilts", "svg.fonttype": "none", "font.size": 9})
    import matplotlib.pyplot as plt

    part = table[table.cad]
    by_way = {way: rows.groupby("model").fewest_levels for way, rows in part.groupby("way")}
    auto, none = by_way["auto"].first(), by_way["none"].first()
    low, high = by_way["random"].min(), by_way["random"].max()
    names = auto.sort_values(kind="stable").index
    place = np.arange(len(names))
    figure, axes = plt.subplots(figsize=(7, 0.19 * len(names) + 0.9), layout="constrained")
    axes.hlines(place, low[names], high[names], color="#9ecae1", linewidth=5, label="random: range of 5")
    axes.plot(none[names], place, "|", color="black", markersize=9, label="none")
    axes.plot(auto[names], place, "o", color="#d6604d", markersize=4.5, label="auto")
    axes.set_yticks(place, names)
    axes.set_xscale("log")
    axes.set_xticks([1, 2, 5, 10, 20, 50, 100, 200], [1, 2, 5, 10, 20, 50, 100, 200])
    axes.minorticks_off()
    axes.set_xlabel("fewest levels that tell the significant critical points apart")
    axes.set_ylim(-0.7, len(names) - 0.3)
    axes.legend(loc="lower right", frameon=False)
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    main()
