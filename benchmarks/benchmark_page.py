"""The tables of docs/benchmarks.md and its figure, from the table of all runs."""

import numpy as np

from entrants import ENTRANTS
from pages import put_table

CELL = ["shape", "nominal", "levels", "bumps"]
OURS = "reebslice"
# Seconds of an earlier comparison with VTK on such meshes, as these do not install from PyPI; VTK took 10 s on the
# torus of 100,000 faces, by which they are scaled.
QUOTED_VTK = 10.0
QUOTED = {
    "TTK": {("upright", 10_000): 0.055, ("upright", 100_000): 0.36, ("upright", 1_000_000): 3.7,
            ("upright", 4_000_000): 15.0, ("noise", 1_000_000): 27.0},
    "Recon": {("upright", 10_000): 0.04, ("upright", 100_000): 0.30, ("upright", 1_000_000): 1.9,
              ("upright", 4_000_000): 5.3, ("noise", 1_000_000): 11.0},
}  # fmt: skip
REMARKS = {"not installed": "not installed", "over the limit": "over the limit", "too large": "not tried"}
COLOURS = {
    "reebslice": "#0b6e99", "manifold3d": "#d97706", "VTK": "#7c3aed", "meshlib": "#15803d", "trimesh": "#be123c",
    "open3d": "#78716c", "ceREEBerus": "#15803d", "copy": "#a8a29e",
}  # fmt: skip


def write_page(path, table):
    """Replace what stands between the marks of every table on the page."""
    runs = summarize(table)
    for name, lines in TABLES.items():
        put_table(path, name, lines(runs))


def summarize(table):
    """One row per program, task and cell: medians over the runs, and the status of the first."""
    wanted = ["raw", "warm", "copy", "peak", "faces", "contours", "points", "regions", "area", "absolute_area"]
    wanted += ["nodes", "loops"]
    table = table.reindex(columns=[*table.columns, *(name for name in wanted if name not in table)])
    groups = table.groupby(["program", "task", *CELL], sort=False)
    return groups[wanted].median().join(groups[["status", "version"]].first()).reset_index()


def programs_of(runs, task):
    """Programs with a task, in the order of the entrants, ours first."""
    return [one.program for one in ENTRANTS if one.task == task and one.program in set(runs.program)]


def find_run(runs, program, task, cell):
    """The row of a program on a cell, None if there is none."""
    found = runs[(runs.program == program) & (runs.task == task) & (runs[CELL] == list(cell)).all(axis=1)]
    return found.iloc[0] if len(found) else None


def cells_of(runs, task):
    return list(runs[runs.task == task][CELL].drop_duplicates().itertuples(index=False, name=None))


def seconds(run, column, ours):
    """Seconds of a run, and in brackets how many times ours they are; else why there are none."""
    if run is None:
        return ""
    if run.status != "ok" or np.isnan(run[column]):
        return REMARKS.get(run.status, "over the limit" if run.status == "ok" else "failed")
    return figure(run[column]) + ("" if run.program == OURS else f" ({figure(run[column] / ours)}x)")


def figure(value):
    """Two significant digits, without an exponent."""
    if value == 0 or not np.isfinite(value):
        return f"{value:g}"
    digits = max(0, 1 - int(np.floor(np.log10(abs(value)))))
    return f"{value:.{digits}f}"


def count(number):
    return f"{int(number):,}".replace(",", " ")


def row(*columns):
    return "| " + " | ".join(map(str, columns)) + " |"


def head(*columns, texts=1):
    return [row(*columns), row(*(["---"] * texts + ["---:"] * (len(columns) - texts)))]


# --------------------------------------------------------------------------
# Tables


def programs_lines(runs):
    lines = head("program", "version", "is asked for", "note", texts=4)
    for program in dict.fromkeys(one.program for one in ENTRANTS):
        mine = [one for one in ENTRANTS if one.program == program]
        versions = runs[runs.program == program].version.dropna()
        version = "" if program == OURS else versions.iloc[0] if len(versions) else "not installed"
        notes = "; ".join(dict.fromkeys(one.remark for one in mine if one.remark))
        lines.append(row(program, version, ", ".join(one.task for one in mine), notes))
    return lines


def slices_lines(task, column):
    def lines(runs):
        programs = programs_of(runs, task)
        limit = ["reebslice / copy"] if task == "contours" else []
        table = head("faces", "levels", *programs, *limit, texts=0)
        for cell in cells_of(runs, task):
            found = {program: find_run(runs, program, task, cell) for program in programs}
            ours = found[OURS][column]
            ratio = [figure(ours / found[OURS]["copy"])] if limit else []
            times = [seconds(found[program], column, ours) for program in programs]
            table.append(row(count(cell[1]), count(cell[2]), *times, *ratio))
        return table

    return lines


def agreement_lines(runs):
    """For every program, on how many cells it counts as we do, and the largest relative difference of areas."""
    lines = head("program", "answer", "cells", "same contours", "same regions", "total area differs by", texts=2)
    for task in ("contours", "regions"):
        for program in programs_of(runs, task)[1:]:
            pairs = [[find_run(runs, name, task, cell) for name in (program, OURS)] for cell in cells_of(runs, task)]
            pairs = [(theirs, ours) for theirs, ours in pairs if theirs is not None and np.isfinite(theirs.points)]
            same = {name: sum(theirs[name] == ours[name] for theirs, ours in pairs) for name in ("contours", "regions")}
            area = [area_difference(theirs, ours) for theirs, ours in pairs]
            joined = any(np.isfinite(theirs.contours) for theirs, _ in pairs)
            worst = f"{max(area):.0e}" if joined else "none, but as many points" if same_points(pairs) else "none"
            regions = same["regions"] if task == "regions" else ""
            lines.append(row(program, task, len(pairs), same["contours"] if joined else "", regions, worst))
    return lines


def area_difference(theirs, ours):
    """Relative difference of the total signed area or, of curves that run either way, of the sum of areas."""
    if np.isfinite(theirs.area):
        return abs(abs(theirs.area) - ours.area) / ours.area
    return abs(theirs.absolute_area - ours.absolute_area) / ours.absolute_area


def same_points(pairs):
    return all(theirs.points == ours.points for theirs, ours in pairs)


def graphs_lines(runs):
    peers = programs_of(runs, "surface graph")[1:]
    lines = head("mesh", "faces", "nodes", "loops", "reebslice, raw", "warm", "bytes per face",
                 *(f"{program}, raw" for program in peers), *(f"{name}, quoted" for name in QUOTED))  # fmt: skip

    def order(cell):
        return cell[0] == "noise", cell[0], cell[3], cell[1]

    for cell in sorted(cells_of(runs, "surface graph"), key=order):
        ours = find_run(runs, OURS, "surface graph", cell)
        theirs = [answer_with_graph(find_run(runs, program, "surface graph", cell), ours) for program in peers]
        name = "white noise" if cell[0] == "noise" else f"{cell[0]}, {cell[3]} bumps"
        quoted = [quote_peer(runs, name, cell) for name in QUOTED]
        figures = figure(ours.raw), figure(ours.warm), round(ours.peak / ours.faces)
        lines.append(row(name, count(cell[1]), count(ours.nodes), count(ours.loops), *figures, *theirs, *quoted))
    return lines


def answer_with_graph(run, ours):
    """Seconds of a run and, where its graph is not ours, what it says."""
    text = seconds(run, "raw", ours.raw)
    if run is None or run.status != "ok" or (run.nodes, run.loops) == (ours.nodes, ours.loops):
        return text
    return f"{text}, {count(run.nodes)} nodes, {count(run.loops)} loops"


def quote_peer(runs, name, cell):
    """Seconds that were measured elsewhere, scaled by those of VTK there and here."""
    reference = find_run(runs, "VTK", "surface graph", ("upright", 100_000, 0, 12))
    elsewhere = QUOTED[name].get(cell[:2])
    if reference is None or not reference.raw > 0 or elsewhere is None or cell[3] != 12:
        return ""
    return figure(elsewhere * reference.raw / QUOTED_VTK)


def solid_lines(runs):
    lines = head("mesh", "faces", "nodes", "loops", "raw", "warm", "bytes per face")
    for cell in sorted(cells_of(runs, "solid graph")):
        ours = find_run(runs, OURS, "solid graph", cell)
        if ours.status == "ok":
            figures = count(ours.nodes), count(ours.loops), figure(ours.raw), figure(ours.warm)
            lines.append(row(cell[0], count(cell[1]), *figures, round(ours.peak / ours.faces)))
    return lines


def memory_lines(runs):
    """Peak memory of every program in MiB beyond what it holds before it sees the mesh."""
    lines = head("task", "faces", "levels", *(names := programs_of(runs, "contours")))
    for task in ("contours", "regions"):
        for cell in cells_of(runs, task):
            found = [find_run(runs, program, task, cell) for program in names]
            sizes = ["" if run is None or not np.isfinite(run.peak) else round(run.peak / 2**20) for run in found]
            lines.append(row(task, count(cell[1]), count(cell[2]), *sizes))
    return lines


def skeleton_lines(runs):
    """What finds a skeleton of the upright torus, whose solid has one loop."""
    lines = head("program", "faces", "seconds, raw", "nodes", "loops")
    for _, run in runs[runs.task == "skeleton"].iterrows():
        told = (figure(run.raw), count(run.nodes), count(run.loops)) if run.status == "ok" else (run.status, "", "")
        lines.append(row(run.program, count(run.nominal), *told))
    return lines


TABLES = {
    "programs": programs_lines,
    "contours warm": slices_lines("contours", "warm"),
    "contours raw": slices_lines("contours", "raw"),
    "regions warm": slices_lines("regions", "warm"),
    "regions raw": slices_lines("regions", "raw"),
    "agreement": agreement_lines,
    "graphs": graphs_lines,
    "solid": solid_lines,
    "memory": memory_lines,
    "skeletons": skeleton_lines,
}


# --------------------------------------------------------------------------
# Figure


def draw_growth(path, table):
    """Seconds against faces, levels and critical points, both axes logarithmic."""
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = "reebslice"
    from matplotlib import pyplot

    runs = summarize(table)
    runs = runs[runs.raw > 0]
    canvas, axes = pyplot.subplots(1, 3, figsize=(12, 3.9), layout="constrained")
    graphs = runs[(runs.task == "surface graph") & (runs["shape"] != "lying")]
    _draw(axes[0], graphs[(graphs.bumps == 12) & (graphs["shape"] == "upright")], "faces", "raw")
    for name, mark in zip(QUOTED, ("^:", "v:")):
        cells = [(shape, faces, 0, 12) for shape, faces in QUOTED[name] if shape == "upright"]
        quoted = [(cell[1], float(text)) for cell in cells if (text := quote_peer(runs, name, cell))]
        if quoted:
            axes[0].plot(*zip(*quoted), mark, color=COLOURS["copy"], label=f"{name}, quoted", markersize=5)
    large = runs[(runs.task == "contours") & (runs.nominal == runs[runs.task == "contours"].nominal.max())]
    _draw(axes[1], large, "levels", "warm")
    copied = large[large.program == OURS].sort_values("levels")
    if len(copied):
        axes[1].plot(copied.levels, copied["copy"], "s--", color=COLOURS["copy"], label="memory copy", markersize=4)
    million = graphs[(graphs.nominal == 1_000_000) & (graphs.program == OURS)]
    _draw(axes[2], million, "nodes", "raw")
    _draw(axes[2], million, "nodes", "warm", "o--", ", warm")
    titles = ("Surface graph, raw", "Contours of the largest mesh, warm", "Surface graph, 1 000 000 faces, raw")
    for axis, title, label in zip(axes, titles, ("faces", "levels", "critical points")):
        if not axis.lines:
            axis.set_axis_off()
            continue
        axis.set(title=title, xlabel=label, ylabel="seconds", xscale="log", yscale="log")
        axis.grid(alpha=0.3)
        axis.legend(fontsize=8)
    canvas.savefig(path, metadata={"Date": None} if str(path).endswith("svg") else None)
    pyplot.close(canvas)


def _draw(axis, runs, x, y, style="o-", suffix=""):
    for program, group in runs.groupby("program", sort=False):
        group = group.sort_values(x)
        axis.plot(group[x], group[y], style, color=COLOURS[program], label=program + suffix, markersize=4)
