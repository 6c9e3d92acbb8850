"""Every table and vocabulary that the stages hand on, declared once.

A table is a `pyarrow.Table`; :func:`build_table` makes one from columns and
:func:`check_table` refuses one that does not match its declaration. Units are
stated per column, in words, because the meshes themselves carry none:
`mesh` is the length unit of the input file.
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


def _field(name, kind, unit="", null=False):
    return pa.field(name, kind, nullable=null, metadata={"unit": unit} if unit else None)


def _table(key, *fields):
    return pa.schema(fields, metadata={"reebslice:primary_key": key})


SCHEMAS = {
    # The cleaned surface, model frame. Vertices in lexicographic order of
    # position, faces counter-clockwise seen from outside the material.
    "vertices": _table(
        "row",
        _field("x", _REAL, "mesh"),
        _field("y", _REAL, "mesh"),
        _field("z", _REAL, "mesh"),
    ),
    "faces": _table(
        "row",
        _field("a", _INT),
        _field("b", _INT),
        _field("c", _INT),
        _field("shell", _INT),
    ),
    # One row per connected component of the surface. A body is a shell of
    # positive volume with the voids directly inside it; `parent` is the
    # smallest shell around this one.
    "shells": _table(
        "shell",
        _field("shell", _INT),
        _field("body", _INT),
        _field("parent", _INT, null=True),
        _field("void", _FLAG),
        _field("n_vertices", _INT),
        _field("n_faces", _INT),
        _field("euler_characteristic", _INT),
        _field("genus", _INT),
        _field("area", _REAL, "mesh^2"),
        _field("volume", _REAL, "mesh^3"),
    ),
    # `vertices_below` defines the level: the number of vertices below it in
    # the order of heights (ties broken by tilted x, then y). `tie_x`, `tie_y`
    # say where, inside a flat at exactly this height, the infinitesimally
    # tilted plane runs; null where no vertex has the level's height above it.
    "levels": _table(
        "level",
        _field("level", _INT),
        _field("height", _REAL, "mesh"),
        _field("vertices_below", _INT),
        _field("tie_x", _REAL, "mesh", null=True),
        _field("tie_y", _REAL, "mesh", null=True),
        _field("n_contours", _INT),
        _field("n_regions", _INT),
        _field("why", _TEXT),
    ),
    # `n_points` counts the mesh edges that the contour crosses; `geometry` is
    # the closed curve through the crossing points, coinciding neighbours
    # dropped. `lower_vertex`, `upper_vertex`: the surface vertices of one of
    # those mesh edges, upward; they anchor the contour on the mesh.
    "contours": _table(
        "contour",
        _field("level", _INT),
        _field("contour", _INT),
        _field("height", _REAL, "mesh"),
        _field("shell", _INT),
        _field("region", _INT),
        _field("inner", _FLAG),
        _field("parent", _INT, null=True),
        _field("signed_area", _REAL, "mesh^2"),
        _field("perimeter", _REAL, "mesh"),
        _field("n_points", _INT),
        _field("lower_vertex", _INT),
        _field("upper_vertex", _INT),
        _field("geometry", pa.binary(), "mesh, tilted frame (WKB closed line string)"),
    ),
    # How those multiple saddles come apart between whose copies a level runs, one
    # row per copy but the last of each: a wedge of upper neighbours of the surface
    # vertex `vertex`, from `first` to `last` counter-clockwise seen from outside,
    # goes with its faces to a copy just below what remains. `rank`: of the copy, as
    # `critical_points.rank`. Most models have none.
    "unfoldings": _table(
        "unfolding",
        _field("unfolding", _INT),
        _field("rank", _INT),
        _field("vertex", _INT),
        _field("first", _INT),
        _field("last", _INT),
    ),
    # `block`: the connected component of the solid in the slab that the piece
    # bounds (unique in the model). `area`: of the surface in the slab. `flux`: the piece's share of the
    # volume of the solid in the slab. `critical`: the surface vertices of its
    # essential critical points, in order of height; `critical_ranks`: their
    # ranks once multiple saddles are unfolded, which tell copies apart.
    "pieces": _table(
        "piece",
        _field("slab", _INT),
        _field("piece", _INT),
        _field("shell", _INT),
        _field("block", _INT),
        _field("n_below", _INT),
        _field("n_above", _INT),
        _field("below", _INTS),
        _field("above", _INTS),
        _field("euler_characteristic", _INT),
        _field("genus", _INT),
        _field("kind", _TEXT),
        _field("area", _REAL, "mesh^2"),
        _field("flux", _REAL, "mesh^3"),
        _field("critical", _INTS),
        _field("critical_ranks", _INTS),
    ),
    # One row per Morse event, in order of height; `vertex` is the surface
    # vertex, `rank` its place among all vertices once multiple saddles are
    # unfolded. `regions_below`, `regions_above`: those of the block.
    # `branches`: the event changes the number of regions. `persistence`: the
    # height between the two members of its pair (table `critical_points`);
    # `pair`: the other one, null where that is no handle because it cancels
    # inside a slab. `resolved`: the piece is elementary.
    "handles": _table(
        "handle",
        _field("handle", _INT),
        _field("slab", _INT),
        _field("piece", _INT),
        _field("block", _INT),
        _field("vertex", _INT),
        _field("rank", _INT),
        _field("height", _REAL, "mesh"),
        _field("x", _REAL, "mesh"),
        _field("y", _REAL, "mesh"),
        _field("z", _REAL, "mesh"),
        _field("index", _INT),
        _field("side", _TEXT),
        _field("operation", _TEXT),
        _field("change", _TEXT, null=True),
        _field("contours_below", _INTS),
        _field("contours_above", _INTS),
        _field("regions_below", _INTS),
        _field("regions_above", _INTS),
        _field("branches", _FLAG),
        _field("persistence", _REAL, "mesh"),
        _field("pair", _INT, null=True),
        _field("resolved", _FLAG),
    ),
    # The exact Reeb graph of the surface, whatever the levels: every critical
    # point once multiple saddles are unfolded, in order of height, with its
    # partner by extended persistence. `pairing`: `ordinary`, a component of a
    # sublevel set between its minimum and the union that ends it; `relative`,
    # one of a superlevel set between separation and maximum; `loop`, between
    # the separation at its bottom and the union at its top; `extended`, the
    # lowest and the highest point of a shell. `handle`: null where the critical
    # point cancels inside a slab.
    "critical_points": _table(
        "critical",
        _field("critical", _INT),
        _field("vertex", _INT),
        _field("rank", _INT),
        _field("height", _REAL, "mesh"),
        _field("index", _INT),
        _field("partner", _INT),
        _field("pairing", _TEXT),
        _field("persistence", _REAL, "mesh"),
        _field("handle", _INT, null=True),
    ),
    # Its arcs; `source`, `target`: critical points, the lower first.
    "critical_arcs": _table(
        "arc",
        _field("arc", _INT),
        _field("source", _INT),
        _field("target", _INT),
        _field("lower", _REAL, "mesh"),
        _field("upper", _REAL, "mesh"),
    ),
    # One material point per region per level; node id == region id.
    "nodes": _table(
        "node",
        _field("node", _INT),
        _field("level", _INT),
        _field("region", _INT),
        _field("height", _REAL, "mesh"),
        _field("x", _REAL, "mesh"),
        _field("y", _REAL, "mesh"),
        _field("z", _REAL, "mesh"),
        _field("critical", _FLAG),
        _field("area", _REAL, "mesh^2"),
        _field("inscribed_radius", _REAL, "mesh"),
        _field("n_holes", _INT),
    ),
    # Links of consecutive levels, from the lower region to the upper one.
    "edges": _table(
        "edge",
        _field("edge", _INT),
        _field("source", _INT),
        _field("target", _INT),
        _field("slab", _INT),
        _field("handle", _INT, null=True),
        _field("operation", _TEXT),
        _field("similarity", _REAL),
        _field("area_source", _REAL, "mesh^2"),
        _field("area_target", _REAL, "mesh^2"),
        _field("area_intersection", _REAL, "mesh^2"),
        _field("area_union", _REAL, "mesh^2"),
        _field("linked", _FLAG),
        _field("method", _TEXT),
    ),
    # Edges of the Reeb graphs. `source`, `target`: handles, the lower first.
    # `nodes`: region ids (solid) or contour ids (surface), upward. `bounds`: arcs
    # of the other graph: for an arc of the solid the surface arcs around it, the
    # outer one first; for a surface arc the solid arcs it lies around, upward.
    "arcs": _table(
        "graph, arc",
        _field("arc", _INT),
        _field("graph", _TEXT),
        _field("source", _INT),
        _field("target", _INT),
        _field("lower", _REAL, "mesh"),
        _field("upper", _REAL, "mesh"),
        _field("length", _REAL, "mesh"),
        _field("volume", _REAL, "mesh^3", null=True),
        _field("area", _REAL, "mesh^2", null=True),
        _field("nodes", _INTS),
        _field("bounds", _INTS),
        _field("similarity_min", _REAL, null=True),
    ),
    # Links guessed from shapes, held against those of the mesh: one row per
    # model, tilt, number of levels, rule and kind of event; kind `all` counts
    # every block once. `half`: what is tuned is tuned on the one half of the
    # models and told of the other. `blocks`, `slabs`: those in which the kind
    # occurs, and how many of them have neither a missed nor a false link;
    # `loops`, `loops_found`: of the solid graph by either links, of kind `all`.
    "comparison": _table(
        "model, tilt, n_levels, method, kind",
        _field("model", _TEXT),
        _field("half", _TEXT),
        _field("tilt", _TEXT),
        _field("n_levels", _INT),
        _field("method", _TEXT),
        _field("kind", _TEXT),
        _field("links", _INT),
        _field("links_missed", _INT),
        _field("links_false", _INT),
        _field("blocks", _INT),
        _field("blocks_right", _INT),
        _field("slabs", _INT),
        _field("slabs_right", _INT),
        _field("loops", _INT, null=True),
        _field("loops_found", _INT, null=True),
    ),
}

# The others are over the whole corpus.
MODEL_TABLES = tuple(name for name in SCHEMAS if name != "comparison")


def build_table(name, columns):
    """Make the table `name` from a mapping of column name to array or list.

    Raises ValueError, naming the table and the column, when a column is
    missing, unknown or cannot be stored losslessly in its declared type.
    """
    schema = SCHEMAS[name]
    missing = [field.name for field in schema if field.name not in columns]
    unknown = [column for column in columns if column not in schema.names]
    if missing or unknown:
        raise ValueError(f"table {name}: missing columns {missing}, unknown columns {unknown}")
    arrays = []
    for field in schema:
        try:
            arrays.append(pa.array(columns[field.name], type=field.type))
        except (pa.ArrowInvalid, pa.ArrowTypeError) as error:
            raise ValueError(f"table {name}, column {field.name}: {error}") from error
    table = pa.Table.from_arrays(arrays, schema=schema)
    check_table(name, table)
    return table


def check_table(name, table, without=()):
    """Raise ValueError unless `table` has exactly the columns declared for `name`, but for those `without`.

    Types and order are compared, and a null in a column that admits none is
    an error. Metadata of the file (content key, GeoParquet) are not compared.
    """
    check_schema(name, table.schema, without)
    check_nulls(name, table)


def check_schema(name, schema, without=()):
    """Raise ValueError unless `schema` has exactly the columns declared for `name`, in order, but for `without`."""
    expected = pa.schema([field for field in SCHEMAS[name] if field.name not in without])
    if not schema.equals(expected, check_metadata=False):
        raise ValueError(
            f"table {name} does not match its schema:\nfound\n{schema.to_string(show_schema_metadata=False)}"
            f"\nexpected\n{expected.to_string(show_schema_metadata=False)}"
        )


def check_nulls(name, table):
    """Raise ValueError if a column that admits no null holds one; `table` may lack columns."""
    for column in table.column_names:
        if not SCHEMAS[name].field(column).nullable and table[column].null_count:
            raise ValueError(f"table {name}, column {column}: holds nulls, and may not")
