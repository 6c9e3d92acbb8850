"""The facts of one model: what is given, and what each step of the certificate finds for those after it."""

from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np

from .recount.curves import Curves
from .recount.cut_surface import Recount
from .recount.exact_levels import ExactLevels
from .recount.graphs import VoidRegions
from .recount.regions import Regions
from .recount.surface import MeshEdges, Ranked

UNKNOWN: Any = None  # of a fact whose step was not made


@dataclass(slots=True)
class Facts:
    """What is known of a model; the steps of :data:`certificate.STEPS` fill it in from the top down.

    Sizes: n vertices, m faces, s shells, K levels, C contours, P pieces, B
    blocks, R regions, H handles. Arrays per row of a table are in the order of
    its rows. A fact is None until its step is made, and
    no step can set one that is not declared here.
    """

    # given to `certify`
    tables: dict  # {name: pyarrow table}
    tilt: dict  # the content of tilt.json
    graphs: dict  # {name: ReadGraph}
    size: float  # the feature size, mesh units
    distance: float | None = None  # the largest spacing of uniform levels, mesh units
    read_curves: tuple | None = None  # curves and which are drawn, as `read_curves` tells them
    inspection: dict = field(default_factory=dict)  # the content of inspection.json
    model: str | None = None  # its id
    open: dict = field(default_factory=dict)  # {question that rounding or a crossing leaves open: how often}

    # check_form
    columns: SimpleNamespace = UNKNOWN  # per table a dict {column: array, or list where values are lists or null}

    # check_mesh: the surface
    points: tuple = UNKNOWN  # columns x, y, z (n,) in the model frame
    faces: tuple = UNKNOWN  # columns a, b, c (m,) of vertices
    rotation: np.ndarray = UNKNOWN  # (3, 3), from the model frame to the tilted frame
    surface: Ranked = UNKNOWN  # the surface, its vertices in order of height
    rank: np.ndarray = UNKNOWN  # (n,) the place of each vertex in that order
    sides: MeshEdges = UNKNOWN  # its mesh edges; None too if it is not closed and oriented
    noise: float = UNKNOWN  # a length that rounding of coordinates can make or hide
    area_noise: float = UNKNOWN  # the same of an area
    volume_noise: float = UNKNOWN  # the same of a volume
    area: float = UNKNOWN  # of the surface
    volume: float = UNKNOWN  # that it bounds, voids deducted
    euler: int = UNKNOWN  # Euler characteristic of the surface
    genus: int = UNKNOWN  # the sum over its shells
    voids: int = UNKNOWN  # shells that bound a void
    betti: list = UNKNOWN  # b0, b1, b2 of the solid
    # check_mesh: its shells
    n_shells: int = UNKNOWN
    shell_of_vertex: np.ndarray = UNKNOWN  # (n,)
    shell_euler: np.ndarray = UNKNOWN  # (s,)
    shell_genus: np.ndarray = UNKNOWN  # (s,)
    void: np.ndarray = UNKNOWN  # (s,) bool, whether the shell bounds a void
    body: np.ndarray = UNKNOWN  # (s,) the shell around the solid that the shell bounds

    # check_levels
    levels: dict = UNKNOWN  # arrays height, below (vertices, copies counted), both (K,), and planes (K, 3), with ties

    # check_contours
    curves: Curves = UNKNOWN  # of the C contours, as they are drawn
    split: Ranked = UNKNOWN  # the surface with those saddles split between whose copies a level runs
    split_sides: MeshEdges = UNKNOWN  # its mesh edges
    walls: dict = UNKNOWN  # {void between two levels: (face of `split` around it, slab)}
    recount: Recount = UNKNOWN  # contours and pieces of the split surface; from check_pieces on these by rows
    exact: ExactLevels = UNKNOWN  # its level sets in rational numbers

    # check_curves
    drawn_area: np.ndarray = UNKNOWN  # (C,) signed area of each curve
    drawn_perimeter: np.ndarray = UNKNOWN  # (C,)
    slack: np.ndarray = UNKNOWN  # (C,) an area that rounding of a contour can make or hide
    centres: np.ndarray = UNKNOWN  # (C, 2) centre of gravity of each curve
    boxes: np.ndarray = UNKNOWN  # (C, 4) lower x and y, upper x and y

    # check_pieces
    kinds: np.ndarray = UNKNOWN  # (P,) words, as in `schemas.PIECE_KINDS`
    elementary: np.ndarray = UNKNOWN  # (P,) bool, neither compound nor unseen
    piece_genus: np.ndarray = UNKNOWN  # (P,)
    piece_ends: tuple = UNKNOWN  # two (P,), the numbers of contours below and above
    hidden: int = UNKNOWN  # the sum of the genera of pieces
    cancelled: np.ndarray = UNKNOWN  # height differences of the pairs that cancel within a piece

    # check_holes
    open_holes: np.ndarray = UNKNOWN  # (C,) bool, holes that a crossing leaves between two regions
    crossing: bool = UNKNOWN  # whether the surface crosses itself; check_sides looks again
    void_regions: VoidRegions | None = UNKNOWN  # of the V regions; None too where contours do not tell what is void

    # check_blocks
    n_blocks: int = UNKNOWN
    block: np.ndarray = UNKNOWN  # (P,) the block of each piece
    block_above: np.ndarray = UNKNOWN  # (R,) the block above each region
    block_below: np.ndarray = UNKNOWN  # (R,) the block below each region
    handles_of_block: list = UNKNOWN  # B lists of handles, ascending
    void_blocks: tuple | None = UNKNOWN  # those of the void: of pieces (P,), above and below regions (V,), how many

    # check_handles
    change: list = UNKNOWN  # P words like o->i,o
    chains: np.ndarray = UNKNOWN  # (B,) bool, one region throughout and only events that leave it whole
    block_resolved: np.ndarray = UNKNOWN  # (B,) bool, whether the order of its handles is known

    # check_nodes, check_edges
    entangled: bool = UNKNOWN  # whether bodies share material at some level, by more than rounding
    regions: Regions = UNKNOWN  # the R regions, from the curves as drawn
    similarity: np.ndarray = UNKNOWN  # of each edge

    inside: np.ndarray = UNKNOWN  # (R,) bool, whether the material point lies in its region

    # check_places: of the handles that are nodes of the solid's graph
    spot_region: np.ndarray = UNKNOWN  # (H,) the region whose material point the node is, or -1
    spots: np.ndarray = UNKNOWN  # (H, 3) where it lies, model frame

    # check_arcs
    parts: dict = UNKNOWN  # {graph: GraphParts} of solid and surface, and of the void if there is a graph of it
    void_events: list = UNKNOWN  # of each block of the void the handles that change it, or may do so
    arcs: dict = UNKNOWN  # {graph: {row of `arcs`: (source, target, items)}}, a graph only if its arcs are right

    # check_graphs, check_identities, check_simplified
    loops_solid: int = UNKNOWN  # first Betti number of the solid's graph
    loops_surface: int = UNKNOWN  # the same of the surface's
    loops_void: int = UNKNOWN  # and of the void's
    loops_of_shell: np.ndarray = UNKNOWN  # (s,) of the surface's graph, by shell
    suppressed: int = UNKNOWN  # genus that neither loops nor pieces show
    simplified: dict = UNKNOWN  # loops, shells and nodes of the simplified graphs
