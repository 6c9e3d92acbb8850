"""Loops with a place: where each loop of a surface's Reeb graph is thinnest, and a closed path along it."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays.grouping import Groups
from ..mesh.arguments import LEAST, take_number, take_rotation
from ..morse.height_mesh import height_mesh_of_bodies
from ..morse.reeb_graph import surface_reeb_graph
from ..slicing.graph_slices import trace_arcs_at_levels
from ..slicing.levels import Levels, cut_between, make_levels, pierce, uniform_heights
from .loop_cycles import cut_cycles, find_core, match_cuts, pair_loops, trace_loops
from .loop_kinds import KINDS, count_inside, find_kinds
from .loop_measures import draw_circles, measure_insides, nest_bodies, paths_of_vertices
from .loop_paths import walk_cycles
from .loop_shortcuts import shorten_paths

# Of the height range: the default distance between the levels at which loops are measured.
SHARE = 1 / 200


class Loops(NamedTuple):
    """The L loops of a surface's Reeb graph, by the height of their bottoms.

    Attributes
    ----------
    bottom, top : (L,) int32
        Vertices: the saddle above which there are two ways around, and the one at which they meet. They are
        partners by extended persistence. Inside a multiple saddle both may be the same vertex.
    bottom_height, top_height : (L,) float64
        Their heights, mesh units.
    kind : (L,) str
        ``handle``: the circle around bounds in the material and not in the void, as a band around the handle of
        a mug; cut there, and the loop is open. ``tunnel``: it bounds in the void and not in the material, as a
        band around the inside of a drilled hole; plug it there, and the loop is filled. ``mixed``: it bounds in
        neither, as around a tube that is bent into a ring.
    inner : (L,) bool
        Whether the circle around is the rim of a hole; material is outside it then, else inside.
    flat : (L,) bool
        Whether the flat disc that fills the circle meets no more of the body's surface: it lies all in material
        or all in void, and says the same as `kind`.
    height : (L,) float64
        Of the circle around, mesh units; between those of bottom and top.
    perimeter : (L,) float64
        Of the circle around, mesh units.
    section : (L,) float64
        Area of what is immediately inside the circle in its plane, mesh units squared: of material, or of void
        if `inner`; what other contours enclose in there is left out.
    inscribed_radius : (L,) float64
        Of the largest circle in that area, mesh units.
    centre : (L, 3) float64
        Its centre, model frame.
    length : (L,) float64
        Of the closed path, mesh units.
    circles : list of (P, 3) float64
        Points of the circle around, model frame, material on the left seen from above; the first is not
        repeated at the end.
    paths : Groups
        Vertices of the closed path, each joined to the next by a mesh edge and the last to the first.
    """

    bottom: np.ndarray
    top: np.ndarray
    bottom_height: np.ndarray
    top_height: np.ndarray
    kind: np.ndarray
    inner: np.ndarray
    flat: np.ndarray
    height: np.ndarray
    perimeter: np.ndarray
    section: np.ndarray
    inscribed_radius: np.ndarray
    centre: np.ndarray
    length: np.ndarray
    circles: list
    paths: Groups


def find_loops(
    points: Any,
    faces: ArrayLike | None = None,
    rotation: ArrayLike | None = None,
    distance: float | None = None,
    body_of_vertex: ArrayLike | None = None,
) -> Loops:
    """Find the loops of a surface's Reeb graph, each with a circle around it and a closed path along it.

    The circles around are contours of equispaced levels, and of a few more where these miss a loop. Together
    they cut each shell into a connected surface without loops, a sphere with holes. Of all choices of such
    contours this one has the fewest mixed ones, then the fewest that bound only on the side that is outside
    them, and then the least sum of perimeters.

    Parameters
    ----------
    points, faces, rotation, body_of_vertex
        As for :func:`exact_graphs`. The rotation of a :class:`HeightMesh` is that by which it was made: it brings
        centres and circles back to the model frame.
    distance : float, optional
        Upper bound of the spacing of the levels, mesh units; by default 1/200 of the height of the surface.

    Returns
    -------
    Loops
        As many as the sum of the genera of the shells. The path of each loop crosses its own circle around once,
        and circles and paths together are a basis of the first homology of the surface. `kind` is exact if
        no shell crosses itself or another one of its body; bodies are told apart, so what one does to the void
        around another does not count.

    Raises
    ------
    NotASolidError, TooManyCrossingsError
        As of :func:`exact_graphs`.
    ReebsliceError
        The rotation or the bodies are none, or the distance is no positive number.

    References
    ----------
    T. K. Dey, F. Fan and Y. Wang, An efficient computation of handle and tunnel loops via Reeb graphs, ACM
    Transactions on Graphics 32 (2013), doi:10.1145/2461912.2462017

    Examples
    --------
    >>> import trimesh
    >>> ring = trimesh.creation.torus(3, 1)
    >>> loops = find_loops(ring)  # lying: a hole that one looks through from above
    >>> loops.kind.tolist(), loops.inscribed_radius.round(1).tolist()
    (['tunnel'], [2.0])
    >>> loops = find_loops(ring, rotation=[[1, 0, 0], [0, 0, -1], [0, 1, 0]])  # upright
    >>> loops.kind.tolist(), loops.inscribed_radius.round(1).tolist()
    (['handle'], [1.0])
    """
    mesh, body = height_mesh_of_bodies(points, faces, rotation, body_of_vertex)
    low, high = mesh.points[[0, -1], 2]
    if distance is not None:
        take_number(distance, "distance", LEAST)
    levels = make_levels(mesh, uniform_heights(low, high, distance or (high - low) * SHARE) if high > low else [])
    loops, turn = loops_at_levels(mesh, surface_reeb_graph(mesh), levels, body), take_rotation(rotation)
    return loops._replace(centre=loops.centre @ turn, circles=[circle @ turn for circle in loops.circles])


def loops_at_levels(mesh, graph, levels, body_of_vertex):
    """Do as :func:`find_loops` with what the pipeline has at hand.

    Parameters
    ----------
    mesh : HeightMesh
        Of n vertices.
    graph : ReebGraph
        The mesh's.
    levels : Levels
        Where to look for circles around; levels that cut no loop are passed over, and further ones are put
        in where these miss one.
    body_of_vertex : (n,) int32
        Of the ranks.

    Returns
    -------
    Loops
        Centres and circles in the tilted frame.
    """
    core = find_core(graph)
    levels = _levels_of_loops(mesh, graph, core, levels)
    contours, of_arcs = trace_arcs_at_levels(mesh, graph, levels)
    nesting = nest_bodies(mesh, levels, contours, of_arcs, body_of_vertex)
    kind_of_chain, ordered = _order_contours(core, nesting)
    bottom, top = pair_loops(graph)
    cycles = trace_loops(core, bottom, top)
    chosen = _choose_circles(core, cycles, nesting.arc, ordered)
    height, kind = levels.height[contours.level[chosen]], kind_of_chain[core.chain[nesting.arc[chosen]]]
    circles = contours.first[chosen], levels.below[contours.level[chosen]]
    walked = shorten_paths(mesh, walk_cycles(mesh, graph, cycles, circles[1]), *circles)
    ends = graph.nodes[bottom], graph.nodes[top]
    flat = count_inside(nesting, np.ones(len(nesting.arc), bool))[chosen] == 0
    section, radius, centre = measure_insides(contours, nesting, chosen)
    paths, length = paths_of_vertices(mesh, walked)
    return Loops(
        *(mesh.vertex[ranks] for ranks in ends), *(mesh.points[ranks, 2] for ranks in ends), np.array(KINDS)[kind],
        nesting.inner[chosen], flat, height, nesting.perimeter[chosen], section, radius,
        np.column_stack([centre, height]), length, draw_circles(contours, chosen, height), paths,
    )  # fmt: skip


def _levels_of_loops(mesh, graph, core, levels):
    """The levels that cut the core, and the fewest more with which they cut every chain of it."""
    ends = graph.nodes[core.arcs[core.kept]].astype(np.int64)
    first, stop = (np.searchsorted(levels.below, ends[:, k], side="right") for k in (0, 1))
    count = len(levels.below) + 1
    used = np.cumsum(np.bincount(first, minlength=count) - np.bincount(stop, minlength=count))[:-1] > 0
    chain, rise = core.chain[core.kept], mesh.points[ends[:, 1], 2] - mesh.points[ends[:, 0], 2]
    longest = np.lexsort((-rise, chain))
    longest = longest[np.unique(chain[longest], return_index=True)[1]]  # arc of each chain
    missed = np.bincount(chain, weights=stop - first)[chain[longest]] == 0 if len(chain) else []
    rows = [cut_between(mesh, *pair) for pair in pierce(map(tuple, ends[longest[missed]].tolist()))]
    more = zip(*rows) if rows else ([] for _ in levels)
    merged = [np.concatenate([kept[used], np.array(new, kept.dtype)]) for kept, new in zip(levels, more)]
    order = np.lexsort(merged[:2])
    return Levels(*(column[order] for column in merged))


def _order_contours(core, nesting):
    """The place in `KINDS` of each chain of the core, and the core's contours, the best circle around first.

    First come those that bound on the side that is inside them, then those that bound on the other side, then
    mixed ones; among each the shorter ones.
    """
    contours = np.flatnonzero(core.chain[nesting.arc] >= 0)
    chain = core.chain[nesting.arc[contours]]
    inside = count_inside(nesting, core.chain[nesting.arc] >= 0)[contours]
    simplest = np.lexsort((inside, chain))
    simplest = simplest[np.unique(chain[simplest], return_index=True)[1]]  # of each chain
    kind, own = find_kinds(core, nesting, contours[simplest])
    grade = np.where(kind == KINDS.index("mixed"), 2, np.where(own, 0, 1))
    return kind, contours[np.lexsort((nesting.perimeter[contours], grade[chain]))]


def _choose_circles(core, cycles, arc_of, ordered):
    """The circle around each cycle, (L,): contours, of which those that come first in `ordered` are to be taken."""
    best = np.full(len(core.arcs), -1)  # contour of each arc
    best[arc_of[ordered[::-1]]] = ordered[::-1]  # the first one comes last, and stays
    missed = core.kept[best[core.kept] < 0]
    worst_first = arc_of[ordered[best[arc_of[ordered]] == ordered]][::-1]
    return best[match_cuts(cycles, cut_cycles(core, np.concatenate([missed, worst_first])), len(core.arcs))]
