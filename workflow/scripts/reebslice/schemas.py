"""Every table and vocabulary that the stages hand on, declared once.

A table is a `pyarrow.Table`; :mod:`.table_checks` makes one from columns and
refuses one that does not match its declaration. Every column has a unit, where
it has one, and a description, which go into the metadata of Parquet fields and
into docs/tables.md. The unit `mesh` is the length unit of the input file, which
inspection.json names where the format has one.
"""

import pyarrow as pa

FORMAT_VERSION = "1"

# --------------------------------------------------------------------------
# Vocabulary: words, kinds, the twelve events

PIECE_KINDS = ("cylinder", "birth", "death", "join", "split", "compound", "unseen")
OPERATIONS = ("creation", "union", "separation", "annihilation")
GRAPHS = ("solid", "surface", "augmented", "solid_simplified", "surface_simplified")
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

_INT = pa.int32()
_INTS = pa.list_(pa.int32())
_REAL = pa.float64()
_FLAG = pa.bool_()
_TEXT = pa.string()
_WKB = pa.binary()


def _column(name, kind, description, unit="", null=False):
    """Declare a column."""
    metadata = {"description": description} | ({"unit": unit} if unit else {})
    return pa.field(name, kind, nullable=null, metadata=metadata)


def _table(key, description, *columns):
    """Declare a table by its primary key, what a row of it is, and its columns."""
    metadata = {"reebslice:primary_key": key, "description": description}
    return pa.schema([_column(*column[:3], **dict(column[3:])) for column in columns], metadata=metadata)


SCHEMAS = {
    "vertices": _table(
        "row",
        "A vertex of the cleaned surface, model frame; in lexicographic order of position.",
        ("x", _REAL, "First coordinate.", ("unit", "mesh")),
        ("y", _REAL, "Second coordinate.", ("unit", "mesh")),
        ("z", _REAL, "Third coordinate.", ("unit", "mesh")),
    ),
    "faces": _table(
        "row",
        "A triangle of the cleaned surface, counter-clockwise seen from outside the material.",
        ("a", _INT, "Row of its first corner in `vertices`."),
        ("b", _INT, "Row of its second corner."),
        ("c", _INT, "Row of its third corner."),
        ("shell", _INT, "Shell that it belongs to."),
    ),
    "shells": _table(
        "shell",
        "A connected component of the surface.",
        ("shell", _INT, "Id of the shell."),
        ("body", _INT, "Body that it bounds: a shell of positive volume with the voids inside it."),
        ("parent", _INT, "Smallest shell around it; null outside all others.", ("null", True)),
        ("void", _FLAG, "Whether material is outside it."),
        ("n_vertices", _INT, "Vertices."),
        ("n_faces", _INT, "Triangles."),
        ("euler_characteristic", _INT, "Vertices - mesh edges + triangles."),
        ("genus", _INT, "Handles: (2 - Euler characteristic) / 2."),
        ("area", _REAL, "Area.", ("unit", "mesh^2")),
        ("volume", _REAL, "Signed volume; negative for a void.", ("unit", "mesh^3")),
    ),
    "levels": _table(
        "level",
        "A cutting plane.",
        ("level", _INT, "Id of the level, upward."),
        ("height", _REAL, "Height of the plane.", ("unit", "mesh")),
        ("vertices_below", _INT, "Vertices below it in the order of heights, which defines it."),
        ("tie_x", _REAL, "Tilted x at which it runs through a flat of its height.", ("unit", "mesh"), ("null", True)),
        ("tie_y", _REAL, "Tilted y for that.", ("unit", "mesh"), ("null", True)),
        ("n_contours", _INT, "Contours at the level."),
        ("n_regions", _INT, "Regions at the level."),
        ("why", _TEXT, "`uniform`: one of the equispaced levels; `refined`: added to tell events apart."),
    ),
    "contours": _table(
        "contour",
        "A closed curve of a level set: a point of the Reeb graph of the surface.",
        ("level", _INT, "Level."),
        ("contour", _INT, "Id of the contour, unique in the model."),
        ("height", _REAL, "Height of its level.", ("unit", "mesh")),
        ("shell", _INT, "Shell that it lies on."),
        ("region", _INT, "Region that it bounds."),
        ("inner", _FLAG, "Whether it bounds a hole of the region."),
        ("parent", _INT, "Smallest contour around it; null outside all others.", ("null", True)),
        ("signed_area", _REAL, "Area inside; negative for a hole.", ("unit", "mesh^2")),
        ("perimeter", _REAL, "Length.", ("unit", "mesh")),
        ("n_points", _INT, "Mesh edges that it crosses."),
        ("lower_vertex", _INT, "Lower vertex of one of those mesh edges, which anchors the contour on the mesh."),
        ("upper_vertex", _INT, "Upper vertex of that mesh edge."),
        ("geometry", _WKB, "The closed curve, material on its left.", ("unit", "mesh, TILTED frame, WKB")),
    ),
    "unfoldings": _table(
        "unfolding",
        "How a multiple saddle comes apart where a level runs between its copies; most models have none.",
        ("unfolding", _INT, "Id: one for each copy of a vertex but its last."),
        ("rank", _INT, "Place of the copy in the order of heights, as in `critical_points`."),
        ("vertex", _INT, "The vertex, a row of `vertices`."),
        (
            "first",
            _INT,
            "Upper neighbour, a row of `vertices`, at which the wedge of faces that the copy takes begins.",
        ),
        ("last", _INT, "Upper neighbour at which it ends, counter-clockwise seen from outside."),
    ),
    "pieces": _table(
        "piece",
        "A connected component of the surface between two consecutive levels.",
        ("slab", _INT, "Slab: the id of the level below it; -1 below the lowest."),
        ("piece", _INT, "Id of the piece."),
        ("shell", _INT, "Shell that it is part of."),
        ("block", _INT, "Block: the component of the solid in the slab that it bounds, unique in the model."),
        ("n_below", _INT, "Contours that bound it from below."),
        ("n_above", _INT, "Contours that bound it from above."),
        ("below", _INTS, "Those contours below."),
        ("above", _INTS, "Those contours above."),
        ("euler_characteristic", _INT, "Sum of the indices of its vertices."),
        ("genus", _INT, "Handles inside the slab, which the contours do not show."),
        ("kind", _TEXT, "`cylinder`, `birth`, `death`, `join`, `split`, else `compound` or `unseen`."),
        ("area", _REAL, "Area of the surface in the slab.", ("unit", "mesh^2")),
        ("flux", _REAL, "Share of the volume of the solid in the slab.", ("unit", "mesh^3")),
        ("critical", _INTS, "Surface vertices of its essential critical points, in order of height."),
        ("critical_ranks", _INTS, "Their ranks once multiple saddles are unfolded, which tell copies apart."),
    ),
    "handles": _table(
        "handle",
        "A Morse event: a handle attached, in order of height.",
        ("handle", _INT, "Id of the handle."),
        ("slab", _INT, "Slab in which it happens."),
        ("piece", _INT, "Piece that holds it."),
        ("block", _INT, "Block that holds it."),
        ("vertex", _INT, "Its vertex, a row of `vertices`."),
        ("rank", _INT, "Place of the vertex in the order of heights once multiple saddles are unfolded."),
        ("height", _REAL, "Height of the vertex.", ("unit", "mesh")),
        ("x", _REAL, "Its first coordinate, model frame.", ("unit", "mesh")),
        ("y", _REAL, "Its second coordinate.", ("unit", "mesh")),
        ("z", _REAL, "Its third coordinate.", ("unit", "mesh")),
        ("index", _INT, "Index of the critical point: minimum 0, saddle 1, maximum 2."),
        ("side", _TEXT, "`A`: material appears as the height rises; `B`: void does."),
        ("operation", _TEXT, "`creation`, `union`, `separation` or `annihilation` of contours."),
        (
            "change",
            _TEXT,
            "What becomes of outer (o) and inner (i) contours, such as `o->i,o`; null where it is not resolved.",
            ("null", True),
        ),
        ("contours_below", _INTS, "Contours below the event."),
        ("contours_above", _INTS, "Contours above it."),
        ("regions_below", _INTS, "Regions below its block."),
        ("regions_above", _INTS, "Regions above its block."),
        ("branches", _FLAG, "Whether the number of regions changes."),
        ("persistence", _REAL, "Height between the two members of its pair in `critical_points`.", ("unit", "mesh")),
        ("pair", _INT, "Handle of the other member; null where that one cancels inside a slab.", ("null", True)),
        ("resolved", _FLAG, "Whether its piece holds no other event."),
    ),
    "critical_points": _table(
        "critical",
        "A critical point of the height, whatever the levels; a node of the exact Reeb graph of the surface.",
        ("critical", _INT, "Id, in order of height; multiple saddles are unfolded into several."),
        ("vertex", _INT, "Its vertex, a row of `vertices`."),
        ("rank", _INT, "Place of the vertex in the order of heights once multiple saddles are unfolded."),
        ("height", _REAL, "Height.", ("unit", "mesh")),
        ("index", _INT, "Minimum 0, saddle 1, maximum 2."),
        ("partner", _INT, "The other member of its extended persistence pair."),
        (
            "pairing",
            _TEXT,
            "`ordinary`: minimum and the union that ends its component; `relative`: the mirror of that; "
            "`loop`: its bottom and top; `extended`: lowest and highest point of a shell.",
        ),
        ("persistence", _REAL, "Height between the two.", ("unit", "mesh")),
        ("handle", _INT, "The handle of the same event; null where it cancels inside a slab.", ("null", True)),
    ),
    "critical_arcs": _table(
        "arc",
        "An arc of the exact Reeb graph of the surface.",
        ("arc", _INT, "Id of the arc."),
        ("source", _INT, "Critical point at its lower end."),
        ("target", _INT, "Critical point at its upper end."),
        ("lower", _REAL, "Height of the lower end.", ("unit", "mesh")),
        ("upper", _REAL, "Height of the upper end.", ("unit", "mesh")),
    ),
    "nodes": _table(
        "node",
        "A material point: one per region and level.",
        ("node", _INT, "Id of the node, equal to its region."),
        ("level", _INT, "Level."),
        ("region", _INT, "Region."),
        ("height", _REAL, "Height of its level.", ("unit", "mesh")),
        ("x", _REAL, "First coordinate, model frame.", ("unit", "mesh")),
        ("y", _REAL, "Second coordinate.", ("unit", "mesh")),
        ("z", _REAL, "Third coordinate.", ("unit", "mesh")),
        ("critical", _FLAG, "Whether an event happens in the block above or below."),
        ("area", _REAL, "Area of the region.", ("unit", "mesh^2")),
        ("inscribed_radius", _REAL, "Distance from the point to the boundary of the region.", ("unit", "mesh")),
        ("n_holes", _INT, "Holes of the region."),
    ),
    "edges": _table(
        "edge",
        "A link between material points of consecutive levels.",
        ("edge", _INT, "Id of the edge."),
        ("source", _INT, "Node at its lower end."),
        ("target", _INT, "Node at its upper end."),
        ("slab", _INT, "Slab between them."),
        ("handle", _INT, "Handle in the block between them; null on a plain continuation.", ("null", True)),
        ("operation", _TEXT, "Operation of that handle, or `continuation`."),
        ("similarity", _REAL, "Area of the intersection of both regions over that of their union."),
        ("area_source", _REAL, "Area of the lower region.", ("unit", "mesh^2")),
        ("area_target", _REAL, "Area of the upper region.", ("unit", "mesh^2")),
        ("area_intersection", _REAL, "Area that both share.", ("unit", "mesh^2")),
        ("area_union", _REAL, "Area of both together.", ("unit", "mesh^2")),
        ("linked", _FLAG, "Whether the mesh links the two regions."),
        ("method", _TEXT, "`exact`, `similarity` or `proximity`: what made the link."),
    ),
    "arcs": _table(
        "graph, arc",
        "An edge of a Reeb graph: a chain of links between two events.",
        ("arc", _INT, "Id of the arc in its graph."),
        ("graph", _TEXT, "`solid` or `surface`."),
        ("source", _INT, "Handle at its lower end."),
        ("target", _INT, "Handle at its upper end."),
        ("lower", _REAL, "Height of the lower end.", ("unit", "mesh")),
        ("upper", _REAL, "Height of the upper end.", ("unit", "mesh")),
        ("length", _REAL, "Length of the path through its nodes.", ("unit", "mesh")),
        ("volume", _REAL, "Volume of material along it; null for the surface.", ("unit", "mesh^3"), ("null", True)),
        ("area", _REAL, "Area of surface along it; null for the solid.", ("unit", "mesh^2"), ("null", True)),
        ("nodes", _INTS, "Regions (solid) or CONTOURS (surface) along it, upward."),
        (
            "bounds",
            _INTS,
            "Arcs of the other graph: those around an arc of the solid, outer first; those that a surface arc bounds.",
        ),
        ("similarity_min", _REAL, "Smallest similarity of its links; null without links.", ("null", True)),
    ),
    "comparison": _table(
        "model, tilt, n_levels, method, kind",
        "Links guessed from shapes, held against those of the mesh.",
        ("model", _TEXT, "Model."),
        ("half", _TEXT, "Rules are tuned on the models of one half and reported on the other."),
        ("tilt", _TEXT, "`none`, `auto` or `random`."),
        ("n_levels", _INT, "Uniform levels."),
        ("method", _TEXT, "Rule that guesses links."),
        ("kind", _TEXT, "Kind of event in the block; `all` counts every block once."),
        ("links", _INT, "Links of the mesh."),
        ("links_missed", _INT, "Those that the rule misses."),
        ("links_false", _INT, "Links of the rule that the mesh does not have."),
        ("blocks", _INT, "Blocks in which the kind occurs."),
        ("blocks_right", _INT, "Those without a fault."),
        ("slabs", _INT, "Slabs in which the kind occurs."),
        ("slabs_right", _INT, "Those without a fault."),
        ("loops", _INT, "Loops of the solid graph by the mesh; of kind `all` only.", ("null", True)),
        ("loops_found", _INT, "Loops by the rule; of kind `all` only.", ("null", True)),
    ),
}

# The others are over the whole corpus.
MODEL_TABLES = tuple(name for name in SCHEMAS if name != "comparison")
