"""Charts over a corpus."""

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from ..links.comparison import EVERY, KINDS, METHODS, rates

# Okabe and Ito's colours, told apart by the colour-blind too.
COLOURS = {"similarity": "#0072B2", "groups": "#E69F00", "overlap": "#009E73", "proximity": "#CC79A7"}
MARKERS = {"similarity": "o", "groups": "s", "overlap": "^", "proximity": "D"}
TITLES = {"none": "up as in the file", "auto": "least tilt that makes the height Morse", "random": "a random direction"}
ROWS = {"wrong": "slabs not wholly right, %", "missed": "links missed, per 1000", "false": "links false, per 1000"}


def draw_comparison(table):
    """The table `comparison` as a matplotlib Figure, of the models of the report half.

    Above, by tilt and number of levels, slabs not wholly right and links
    missed and false; below, by kind of event, blocks that are not right.
    """
    frame = table.to_pandas()
    # a corpus may be too small to have another half
    frame = frame[frame["half"] == ("report" if "report" in set(frame["half"]) else frame["half"].iloc[0])]
    figure = Figure(figsize=(11, 13), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    upper, lower = figure.subfigures(2, 1, height_ratios=(2.6, 1))
    n_models = frame["model"].nunique()
    figure.suptitle(f"Links guessed from the shapes of regions, held against the links of the mesh: {n_models} models")
    tilts = list(dict.fromkeys(frame["tilt"]))
    axes = upper.subplots(len(ROWS), len(tilts), sharex=True, sharey="row", squeeze=False)
    total = rates(frame[frame["kind"] == EVERY], ("tilt", "method", "n_levels")).assign(
        wrong=lambda row: 100 * (1 - row["slabs_right"])
    )
    for column, tilt in enumerate(tilts):
        _draw_column(axes[:, column], total.loc[tilt])
        axes[0, column].set_title(TITLES[tilt])
    for axis, (name, label) in zip(axes[:, 0], ROWS.items()):
        axis.set_ylabel(label)
        axis.set_ylim(0, max(1.2, 1.3 * total[name].max()))
    axes[0, 0].legend(frameon=False)
    _draw_kinds(lower.subplots(), rates(frame, ("method", "kind")))
    return figure


def _draw_column(axes, total):
    """Draw all measures of one tilt, one below the other; total is indexed by method and number of levels."""
    for axis, name in zip(axes, ROWS):
        for method in METHODS:
            values = total.loc[method, name].sort_index()
            axis.plot(values.index, values, color=COLOURS[method], marker=MARKERS[method], markersize=5, label=method)
        axis.set_xscale("log", base=2)
        axis.set_yscale("symlog", linthresh=1)
        axis.set_yticks([0, 1, 10, 100, 1000], ["0", "1", "10", "100", "1000"])
        axis.set_xticks(values.index, [str(count) for count in values.index])
        axis.minorticks_off()
        axis.grid(alpha=0.3)
    axes[-1].set_xlabel("levels over the height of the model")


def _draw_kinds(axis, total):
    """Draw, by kind of event, the share of blocks that are not right, one bar per method."""
    present = set(total.index.get_level_values("kind"))
    kinds = [kind for kind in KINDS if kind in present]
    for place, method in enumerate(METHODS):
        wrong = [100 * (1 - total.loc[(method, kind), "blocks_right"]) for kind in kinds]
        axis.bar([n + (place - 1.5) / 5 for n in range(len(kinds))], wrong, 1 / 5, color=COLOURS[method], label=method)
    counts = [int(total.loc[(METHODS[0], kind), "blocks"]) for kind in kinds]
    axis.set_xticks(range(len(kinds)), [f"{kind}\n{count}" for kind, count in zip(kinds, counts)], fontsize=8)
    axis.set_ylabel("blocks not right, %")
    axis.set_xlabel("what happens in the block (o: outer contour, i: hole; below -> above), and number of blocks")
    axis.grid(axis="y", alpha=0.3)
