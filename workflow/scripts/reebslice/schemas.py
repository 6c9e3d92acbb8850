"""Every table and vocabulary that the stages hand on, declared once.

A table is a `pyarrow.Table`; :mod:`.table_checks` makes one from columns and
refuses one that does not match its declaration. Every column has a unit, where
it has one, and a description, which go into the metadata of Parquet fields and
into docs/tables.md. The unit `mesh` is the length unit of the input file, which
inspection.json names where the format has one.
"""

from functools import cache

from .corpus_tables import CORPUS_TABLES
from .declarations import FLAG, INT, INTS, REAL, TEXT, WKB, table, with_model
from .side_tables import SIDE_TABLES

FORMAT_VERSION = "2"

# --------------------------------------------------------------------------
# Vocabulary: words, kinds, the twelve events

PIECE_KINDS = ("cylinder", "birth", "death", "join", "split", "compound", "unseen")
OPERATIONS = ("creation", "union", "separation", "annihilation")
GRAPHS = ("solid", "surface", "void", "augmented", "solid_simplified", "surface_simplified")
EXACT_GRAPHS = ("exact_surface", "exact_solid")  # without levels
PAIRINGS = ("ordinary", "relative", "loop", "extended")
VERDICTS = ("exact", "exact_at_feature_size", "uncertified", "rejected")

# change: (side, index, outer, inner, regions, operation); the last four
# columns say by how much the event alters the number of outer contours, of
# inner contours and of regions as the height rises.
EVENTS = {
    "->o": ("A", 0, +1, 0, +1, "creation"),
    "->i": ("B", 0, 0, +1, 0, "creation"),
    "o->": ("B", 2, -1, 0, -1, "annihilation"),
    "i->": ("A", 2, 0, -1, 0, "annihilation"),
    "o,o->o": ("A", 1, -1, 0, -1, "union"),
    "i,o->i": ("A", 1, -1, 0, -1, "union"),
    "o->i,o": ("A", 1, 0, +1, 0, "separation"),
    "i->i,i": ("A", 1, 0, +1, 0, "separation"),
    "o->o,o": ("B", 1, +1, 0, +1, "separation"),
    "i->i,o": ("B", 1, +1, 0, +1, "separation"),
    "i,o->o": ("B", 1, 0, -1, 0, "union"),
    "i,i->i": ("B", 1, 0, -1, 0, "union"),
}

# --------------------------------------------------------------------------
# Tables

SCHEMAS = {
    "vertices": table(
        "row",
        "A vertex of the cleaned surface, model frame; in lexicographic order of position.",
        ("x", REAL, "First coordinate.", ("unit", "mesh")),
        ("y", REAL, "Second coordinate.", ("unit", "mesh")),
        ("z", REAL, "Third coordinate.", ("unit", "mesh")),
    ),
    "faces": table(
        "row",
        "A triangle of the cleaned surface, counter-clockwise seen from outside the material.",
        ("a", INT, "Row of its first corner in `vertices`."),
        ("b", INT, "Row of its second corner."),
        ("c", INT, "Row of its third corner."),
        ("shell", INT, "Shell that it belongs to."),
    ),
    "shells": table(
        "shell",
        "A connected component of the surface.",
        ("shell", INT, "Id of the shell."),
        ("body", INT, "Body that it bounds: a shell of positive volume with the voids inside it."),
        ("parent", INT, "Smallest shell around it; null outside all others.", ("null", True)),
        ("void", FLAG, "Whether material is outside it."),
        ("n_vertices", INT, "Vertices."),
        ("n_faces", INT, "Triangles."),
        ("euler_characteristic", INT, "Vertices - mesh edges + triangles."),
        ("genus", INT, "Handles: (2 - Euler characteristic) / 2."),
        ("area", REAL, "Area.", ("unit", "mesh^2")),
        ("volume", REAL, "Signed volume; negative for a void.", ("unit", "mesh^3")),
    ),
    "levels": table(
        "level",
        "A cutting plane.",
        ("level", INT, "Id of the level, upward."),
        ("height", REAL, "Height of the plane.", ("unit", "mesh")),
        ("vertices_below", INT, "Vertices below it in the order of heights, which defines it."),
        ("tie_x", REAL, "Tilted x at which it runs through a flat of its height.", ("unit", "mesh"), ("null", True)),
        ("tie_y", REAL, "Tilted y for that.", ("unit", "mesh"), ("null", True)),
        ("n_contours", INT, "Contours at the level."),
        ("n_regions", INT, "Regions at the level."),
        ("why", TEXT, "`uniform`: one of the equispaced levels; `refined`: added to tell events apart."),
    ),
    "contours": table(
        "contour",
        "A closed curve of a level set: a point of the Reeb graph of the surface.",
        ("level", INT, "Level."),
        ("contour", INT, "Id of the contour, unique in the model."),
        ("height", REAL, "Height of its level.", ("unit", "mesh")),
        ("shell", INT, "Shell that it lies on."),
        ("region", INT, "Region that it bounds."),
        ("inner", FLAG, "Whether it bounds a hole of the region."),
        ("parent", INT, "Smallest contour around it; null outside all others.", ("null", True)),
        ("signed_area", REAL, "Area inside; negative for a hole.", ("unit", "mesh^2")),
        ("perimeter", REAL, "Length.", ("unit", "mesh")),
        ("n_points", INT, "Mesh edges that it crosses."),
        ("lower_vertex", INT, "Lower vertex of one of those mesh edges, which anchors the contour on the mesh."),
        ("upper_vertex", INT, "Upper vertex of that mesh edge."),
        ("geometry", WKB, "The closed curve, material on its left.", ("unit", "mesh, TILTED frame, WKB")),
    ),
    "unfoldings": table(
        "unfolding",
        "How a multiple saddle comes apart where a level runs between its copies; most models have none.",
        ("unfolding", INT, "Id: one for each copy of a vertex but its last."),
        ("rank", INT, "Place of the copy in the order of heights, as in `critical_points`."),
        ("vertex", INT, "The vertex, a row of `vertices`."),
        (
            "first",
            INT,
            "Upper neighbour, a row of `vertices`, at which the wedge of faces that the copy takes begins.",
        ),
        ("last", INT, "Upper neighbour at which it ends, counter-clockwise seen from outside."),
    ),
    "pieces": table(
        "piece",
        "A connected component of the surface between two consecutive levels.",
        ("slab", INT, "Slab: the id of the level below it; -1 below the lowest."),
        ("piece", INT, "Id of the piece."),
        ("shell", INT, "Shell that it is part of."),
        ("block", INT, "Block: the component of the solid in the slab that it bounds, unique in the model."),
        ("n_below", INT, "Contours that bound it from below."),
        ("n_above", INT, "Contours that bound it from above."),
        ("below", INTS, "Those contours below."),
        ("above", INTS, "Those contours above."),
        ("euler_characteristic", INT, "Sum of the indices of its vertices."),
        ("genus", INT, "Handles inside the slab, which the contours do not show."),
        ("kind", TEXT, "`cylinder`, `birth`, `death`, `join`, `split`, else `compound` or `unseen`."),
        ("area", REAL, "Area of the surface in the slab.", ("unit", "mesh^2")),
        ("flux", REAL, "Share of the volume of the solid in the slab.", ("unit", "mesh^3")),
        ("critical", INTS, "Surface vertices of its essential critical points, in order of height."),
        ("critical_ranks", INTS, "Their ranks once multiple saddles are unfolded, which tell copies apart."),
    ),
    "handles": table(
        "handle",
        "A Morse event: a handle attached, in order of height.",
        ("handle", INT, "Id of the handle."),
        ("slab", INT, "Slab in which it happens."),
        ("piece", INT, "Piece that holds it."),
        ("block", INT, "Block that holds it."),
        ("vertex", INT, "Its vertex, a row of `vertices`."),
        ("rank", INT, "Place of the vertex in the order of heights once multiple saddles are unfolded."),
        ("height", REAL, "Height of the vertex.", ("unit", "mesh")),
        ("x", REAL, "Its first coordinate, model frame.", ("unit", "mesh")),
        ("y", REAL, "Its second coordinate.", ("unit", "mesh")),
        ("z", REAL, "Its third coordinate.", ("unit", "mesh")),
        ("index", INT, "Index of the critical point: minimum 0, saddle 1, maximum 2."),
        ("side", TEXT, "`A`: material appears as the height rises; `B`: void does."),
        ("operation", TEXT, "`creation`, `union`, `separation` or `annihilation` of contours."),
        (
            "change",
            TEXT,
            "What becomes of outer (o) and inner (i) contours, such as `o->i,o`; null where it is not resolved.",
            ("null", True),
        ),
        ("contours_below", INTS, "Contours below the event."),
        ("contours_above", INTS, "Contours above it."),
        ("regions_below", INTS, "Regions below its block."),
        ("regions_above", INTS, "Regions above its block."),
        ("branches", FLAG, "Whether the number of regions changes."),
        ("persistence", REAL, "Height between the two members of its pair in `critical_points`.", ("unit", "mesh")),
        ("pair", INT, "Handle of the other member; null where that one cancels inside a slab.", ("null", True)),
        ("resolved", FLAG, "Whether its piece holds no other event."),
    ),
    "critical_points": table(
        "critical",
        "A critical point of the height, whatever the levels; a node of the exact Reeb graph of the surface.",
        ("critical", INT, "Id, in order of height; multiple saddles are unfolded into several."),
        ("vertex", INT, "Its vertex, a row of `vertices`."),
        ("rank", INT, "Place of the vertex in the order of heights once multiple saddles are unfolded."),
        ("height", REAL, "Height.", ("unit", "mesh")),
        ("index", INT, "Minimum 0, saddle 1, maximum 2."),
        ("partner", INT, "The other member of its extended persistence pair."),
        (
            "pairing",
            TEXT,
            "`ordinary`: minimum and the union that ends its component; `relative`: the mirror of that; "
            "`loop`: its bottom and top; `extended`: lowest and highest point of a shell.",
        ),
        ("persistence", REAL, "Height between the two.", ("unit", "mesh")),
        ("handle", INT, "The handle of the same event; null where it cancels inside a slab.", ("null", True)),
    ),
    "critical_arcs": table(
        "arc",
        "An arc of the exact Reeb graph of the surface.",
        ("arc", INT, "Id of the arc."),
        ("source", INT, "Critical point at its lower end."),
        ("target", INT, "Critical point at its upper end."),
        ("lower", REAL, "Height of the lower end.", ("unit", "mesh")),
        ("upper", REAL, "Height of the upper end.", ("unit", "mesh")),
    ),
    "nodes": table(
        "node",
        "A material point: one per region and level.",
        ("node", INT, "Id of the node, equal to its region."),
        ("level", INT, "Level."),
        ("region", INT, "Region."),
        ("height", REAL, "Height of its level.", ("unit", "mesh")),
        ("x", REAL, "First coordinate, model frame.", ("unit", "mesh")),
        ("y", REAL, "Second coordinate.", ("unit", "mesh")),
        ("z", REAL, "Third coordinate.", ("unit", "mesh")),
        ("critical", FLAG, "Whether an event happens in the block above or below."),
        ("area", REAL, "Area of the region.", ("unit", "mesh^2")),
        (
            "inscribed_radius",
            REAL,
            "Distance from the point to the boundary of the region; with `sampler: inscribed` at least 0.9 of the "
            "largest that was found.",
            ("unit", "mesh"),
        ),
        ("n_holes", INT, "Holes of the region."),
    ),
    "edges": table(
        "edge",
        "A link between material points of consecutive levels.",
        ("edge", INT, "Id of the edge."),
        ("source", INT, "Node at its lower end."),
        ("target", INT, "Node at its upper end."),
        ("slab", INT, "Slab between them."),
        ("handle", INT, "Handle in the block between them; null on a plain continuation.", ("null", True)),
        ("operation", TEXT, "Operation of that handle, or `continuation`."),
        ("similarity", REAL, "Area of the intersection of both regions over that of their union."),
        ("area_source", REAL, "Area of the lower region.", ("unit", "mesh^2")),
        ("area_target", REAL, "Area of the upper region.", ("unit", "mesh^2")),
        ("area_intersection", REAL, "Area that both share.", ("unit", "mesh^2")),
        ("area_union", REAL, "Area of both together.", ("unit", "mesh^2")),
        ("linked", FLAG, "Whether the mesh links the two regions."),
        ("method", TEXT, "`exact`, `similarity` or `proximity`: what made the link."),
    ),
    "arcs": table(
        "graph, arc",
        "An edge of a Reeb graph: a chain of links between two events.",
        ("arc", INT, "Id of the arc in its graph."),
        ("graph", TEXT, "`solid`, `surface` or `void`."),
        ("source", INT, "Handle at its lower end; of the void, -1 where the outside goes on below all."),
        ("target", INT, "Handle at its upper end; of the void, -2 where the outside goes on above all."),
        ("lower", REAL, "Height of the lower end; where the outside goes on, of the lowest vertex.", ("unit", "mesh")),
        (
            "upper",
            REAL,
            "Height of the upper end; where the outside goes on, of the highest vertex.",
            ("unit", "mesh"),
        ),
        (
            "length",
            REAL,
            "Length of the path through its nodes, of the solid between material points at its ends, of the others "
            "between vertices; null for the outside.",
            ("unit", "mesh"),
            ("null", True),
        ),
        (
            "volume",
            REAL,
            "Volume of material or of void along it; null for the surface, for what ends at or is the outside, and "
            "where a body floats in the void between two levels.",
            ("unit", "mesh^3"),
            ("null", True),
        ),
        ("area", REAL, "Area of surface along it; null for solid and void.", ("unit", "mesh^2"), ("null", True)),
        (
            "nodes",
            INTS,
            "Regions (solid), CONTOURS (surface) or contours of holes (void) along it, upward; none for the outside.",
        ),
        (
            "bounds",
            INTS,
            "Arcs of the surface around an arc of the solid, outer first, or of the void, holes first; arcs of the "
            "solid that a surface arc bounds.",
        ),
        ("similarity_min", REAL, "Smallest similarity of its links; null without links.", ("null", True)),
    ),
}

# What the graphs are made of, and what is certified.
MODEL_TABLES = tuple(SCHEMAS)
SCHEMAS |= SIDE_TABLES | CORPUS_TABLES


@cache
def file_schema(name):
    """Declare a table of `SCHEMAS` as its file holds it (:func:`.declarations.with_model`)."""
    return with_model(SCHEMAS[name])
