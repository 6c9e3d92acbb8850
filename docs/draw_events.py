"""Draw docs/events.svg: the twelve ways in which material and void change as a level rises.

python docs/draw_events.py
"""

from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline
from shapely import Point, Polygon, box

mpl.rcParams.update({"svg.hashsalt": "reebslice", "svg.fonttype": "none"})  # the same file each time, text as text
MATERIAL, EDGE = "#9cc3d5", "#1f2933"
NOTHING = Polygon()


def disc(radius, x=0.0):
    """A disc about a point of the x axis."""
    return Point(x, 0).buffer(radius, 12)


RING, WIDE_RING = disc(1) - disc(0.45), disc(1) - disc(0.75)
ISLAND, TWO = WIDE_RING | disc(0.35), disc(0.48, -0.52) | disc(0.48, 0.52)
WEB = WIDE_RING | (box(-0.12, -0.9, 0.12, 0.9) & disc(1))
BRIDGE, JOINED = box(0, -0.14, 0.9, 0.14), TWO | box(-0.5, -0.2, 0.5, 0.2)
# Of each change what is below and above the critical point; side A, and read the other way round, side B.
PAIRS = (
    ("->o", "material begins", NOTHING, disc(0.6), "o->", "material ends"),
    ("i->", "a hole closes", RING, disc(1), "->i", "a hole opens"),
    ("o,o->o", "two parts merge", TWO, JOINED, "o->o,o", "a part splits"),
    ("o->i,o", "a region closes into a ring", RING - box(0, -0.2, 2, 0.2), RING, "i,o->o", "a ring opens"),
    ("i,o->i", "an island joins what is around it", ISLAND, ISLAND | BRIDGE, "i->i,o", "an island is cut off"),
    ("i->i,i", "a web crosses a hole", WIDE_RING, WEB, "i,i->i", "two holes merge"),
)
OPERATIONS = {
    "->o": "creation", "->i": "creation", "o->": "annihilation", "i->": "annihilation", "o,o->o": "union",
    "i,o->i": "union", "o->i,o": "separation", "i->i,i": "separation", "o->o,o": "separation", "i->i,o": "separation",
    "i,o->o": "union", "i,i->i": "union",
}  # fmt: skip


def draw_region(axes, region, x):
    """Draw a region of the plane about a point of the x axis, holes and all."""
    for part in getattr(region, "geoms", [region]):
        if not part.is_empty:
            rings = [Outline([(a + x, b) for a, b in ring.coords]) for ring in (part.exterior, *part.interiors)]
            axes.add_patch(PathPatch(Outline.make_compound_path(*rings), fc=MATERIAL, ec=EDGE, lw=1))


def draw_change(axes, change, words, below, above, side):
    """Draw one change: below, an arrow, above, and what it is called."""
    draw_region(axes, below, -1.5)
    draw_region(axes, above, 1.5)
    axes.annotate("", (0.32, 0), (-0.32, 0), arrowprops={"arrowstyle": "->", "color": EDGE})
    axes.set(xlim=(-2.6, 2.6), ylim=(-1.15, 1.9), aspect="equal")
    axes.axis("off")
    axes.text(-2.5, 1.55, change, family="monospace", weight="bold")
    axes.text(2.5, 1.55, f"{OPERATIONS[change]}, side {side}", ha="right", size=8)
    axes.text(0, 1.2, words, ha="center", size=8, color="#52606d")


def main():
    """Write the figure: a row for each pair, side A left."""
    figure, rows = plt.subplots(6, 2, figsize=(7.2, 11), layout="constrained")
    for (left, right), (change, words, below, above, back, back_words) in zip(rows, PAIRS):
        draw_change(left, change, words, below, above, "A")
        draw_change(right, back, back_words, above, below, "B")
    figure.savefig(Path(__file__).with_name("events.svg"), metadata={"Date": None})


if __name__ == "__main__":
    main()
