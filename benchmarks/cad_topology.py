"""The topology of the solids in a STEP file, from its own vertices, edges and faces, by OpenCascade.

    python benchmarks/cad_topology.py [STEP...]

prints it, first of shapes whose genus is known, which it is held against.

What it tells owes nothing to triangles. The Euler characteristic of a shell is the number of its vertices, less
that of its edges, plus the sum of those of its open faces. A face without its seams lies open in a plane; its Euler
characteristic is 2 less the number of pieces of its boundary, which are its wires, of which those that share a
vertex are one. So the face of a plate with three holes has -2, the side of a cylinder, whose one wire runs along
the seam twice, 1, and one between two circles without a seam 0. An edge is counted once however many faces use
it; a degenerated one, which is a point of a sphere or of a cone, never. Faces on closed surfaces that nothing
bounds are told as `untrimmed`; OpenCascade gives them seams when it reads.
"""

import sys
from collections import Counter

from OCP.BRep import BRep_Tool
from OCP.BRepTools import BRepTools_WireExplorer
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import (
    TopAbs_EDGE,
    TopAbs_FACE,
    TopAbs_FORWARD,
    TopAbs_SHAPE,
    TopAbs_SHELL,
    TopAbs_SOLID,
    TopAbs_VERTEX,
    TopAbs_WIRE,
)
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS

FIGURES = (
    "solids",
    "shells",
    "genus",
    "vertices",
    "edges",
    "faces",
    "odd",
    "irregular",
    "pinched",
    "untrimmed",
    "loose",
)


class Place:
    """A vertex or an edge where it is, whatever its orientation: equal to what is the same in space."""

    def __init__(self, shape):
        self.shape = shape

    def __hash__(self):
        return hash(self.shape)

    def __eq__(self, other):
        return self.shape.IsSame(other.shape)


def read_shape(path):
    """Return the shape in a STEP file; raise ValueError where OpenCascade finds none."""
    reader = STEPControl_Reader()
    if int(reader.ReadFile(str(path))) != 1:  # IFSelect_RetDone
        raise ValueError("OpenCascade cannot read the file")
    reader.TransferRoots()
    shape = reader.OneShape()
    if shape.IsNull():
        raise ValueError("OpenCascade finds no shape in the file")
    return shape


def measure_shape(shape):
    """Return the figures of a shape as a dictionary.

    `solids`, `shells` (of solids), `genus` (their sum), `vertices`, `edges` and
    `faces` (of each shell for itself), shells whose Euler characteristic is
    `odd` so that they have no genus, edges that are used by other than two
    faces' sides, `irregular`, vertices around which faces form several fans,
    `pinched`, faces without an edge, `untrimmed`, and faces in no solid, `loose`.
    """
    figures = Counter()
    for solid in parts_of(shape, TopAbs_SOLID):
        figures["solids"] += 1
        for shell in parts_of(solid, TopAbs_SHELL):
            figures.update(measure_shell(shell))
    figures["loose"] = sum(1 for _ in parts_of(shape, TopAbs_FACE, TopAbs_SOLID))
    return {name: figures[name] for name in FIGURES}


def measure_shell(shell):
    """Return the figures of one shell."""
    faces = [wires_of(face) for face in parts_of(shell, TopAbs_FACE)]
    every = [edge for wires in faces for wire in wires for edge in wire]
    uses = Counter(Place(edge) for edge in every if not BRep_Tool.Degenerated_s(edge))
    vertices = {vertex for edge in every for vertex in ends_of(edge)}
    inside = sum(2 - len(join([set().union(*map(ends_of, wire)) for wire in wires])) for wires in faces)
    chi = len(vertices) - len(uses) + inside
    return {
        "shells": 1,
        "genus": (2 - chi) // 2,
        "vertices": len(vertices),
        "edges": len(uses),
        "faces": len(faces),
        "odd": chi % 2,
        "irregular": sum(count != 2 for count in uses.values()),
        "pinched": count_pinched([wire for wires in faces for wire in wires]),
        "untrimmed": sum(not wires for wires in faces),
    }


def wires_of(face):
    """Return the wires of a face, each a list of edges in the order in which they follow one another."""
    wires = []
    for wire in parts_of(face, TopAbs_WIRE):
        walk, edges = BRepTools_WireExplorer(TopoDS.Wire(wire), TopoDS.Face(face)), []
        while walk.More():
            edges.append(walk.Current())
            walk.Next()
        left = [TopoDS.Edge(edge) for edge in parts_of(wire, TopAbs_EDGE)]
        wires.append(edges if len(edges) == len(left) else left)  # a walk may end early where a wire touches itself
    return [wire for wire in wires if wire]


def count_pinched(wires):
    """Return the number of vertices around which the faces form more than one fan.

    Ends of edges around a vertex are joined where a face has the corner between
    them; as each end is named by the edge, both faces beside it have it.
    """
    fans = {}
    for wire in wires:
        for edge, after in zip(wire, wire[1:] + wire[:1], strict=True):
            here, there = walk_of(edge)[1], walk_of(after)[0]
            if here == there:
                corner = {(Place(edge), end_of(edge, True)), (Place(after), end_of(after, False))}
                fans.setdefault(here, []).append(corner)
    return sum(len(join(corners)) > 1 for corners in fans.values())


def walk_of(edge):
    """Return the vertices at which an edge begins and ends, as its wire runs through it."""
    return Place(TopExp.FirstVertex_s(edge, True)), Place(TopExp.LastVertex_s(edge, True))


def end_of(edge, last):
    """Return which end of an edge, as it lies in space, is the last (or first) one as its wire runs."""
    return (edge.Orientation() == TopAbs_FORWARD) == last


def ends_of(edge):
    """Return the set of vertices of an edge."""
    return {Place(vertex) for vertex in parts_of(edge, TopAbs_VERTEX)}


def join(sets):
    """Return the unions of those sets that are connected by common members."""
    joined = []
    for members in sets:
        apart = [other for other in joined if not other & members]
        joined = [*apart, members.union(*(other for other in joined if other & members))]
    return joined


def parts_of(shape, kind, avoided=TopAbs_SHAPE):
    """Yield the parts of a kind, as often as the shape has them, but those in parts of the kind that is avoided."""
    explorer = TopExp_Explorer(shape, kind, avoided)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


# --------------------------------------------------------------------------
# Shapes of known genus


def make_known_shapes():
    """Yield name, shape, number of shells and genus."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import (
        BRepPrimAPI_MakeBox,
        BRepPrimAPI_MakeCone,
        BRepPrimAPI_MakeCylinder,
        BRepPrimAPI_MakeSphere,
        BRepPrimAPI_MakeTorus,
    )
    from OCP.gp import gp_Trsf, gp_Vec
    from OCP.TopLoc import TopLoc_Location

    def at(shape, *place):
        move = gp_Trsf()
        move.SetTranslation(gp_Vec(*place))
        return shape.Moved(TopLoc_Location(move))

    def cut(shape, *others):
        for other in others:
            shape = BRepAlgoAPI_Cut(shape, other).Shape()
        return shape

    box, ball = BRepPrimAPI_MakeBox(20.0, 20.0, 20.0).Shape(), BRepPrimAPI_MakeSphere(5.0).Shape()
    rod, ring = BRepPrimAPI_MakeCylinder(2.0, 60.0).Shape(), BRepPrimAPI_MakeTorus(5.0, 2.0).Shape()
    yield "box", box, 1, 0
    yield "cylinder", rod, 1, 0
    yield "sphere", ball, 1, 0
    yield "torus", ring, 1, 1
    yield "cone", BRepPrimAPI_MakeCone(3.0, 0.0, 5.0).Shape(), 1, 0
    yield "frustum", BRepPrimAPI_MakeCone(3.0, 1.0, 5.0).Shape(), 1, 0
    yield "plate with three holes", cut(box, *(at(rod, *xy, -5.0) for xy in ((5, 5), (15, 5), (10, 15)))), 1, 3
    yield "half a sphere", cut(ball, at(box, -10.0, -10.0, 0.0)), 1, 0
    yield "sphere drilled along its poles", cut(ball, at(rod, 0.0, 0.0, -30.0)), 1, 1
    yield "sphere drilled aside", cut(ball, at(rod, 1.0, 1.0, -30.0)), 1, 1
    yield "torus drilled", cut(ring, at(BRepPrimAPI_MakeCylinder(0.5, 60.0).Shape(), 5.0, 0.0, -30.0)), 1, 2
    yield "box with a round void", cut(box, at(ball, 10.0, 10.0, 10.0)), 2, 0
    yield "box with the void of a torus", cut(box, at(ring, 10.0, 10.0, 10.0)), 2, 1


def check_known_shapes():
    """Raise AssertionError where a shape of known genus is measured otherwise; return what was measured, by name."""
    measured = {}
    for name, shape, shells, genus in make_known_shapes():
        found = measured[name] = measure_shape(shape)
        peculiar = sum(found[figure] for figure in ("odd", "irregular", "pinched", "untrimmed", "loose"))
        if (found["solids"], found["shells"], found["genus"], peculiar) != (1, shells, genus, 0):
            raise AssertionError(f"{name}: {found}, but it has {shells} shells and genus {genus}")
    return measured


if __name__ == "__main__":
    for name, figures in check_known_shapes().items():
        print(name, figures)
    for path in sys.argv[1:]:
        print(path, measure_shape(read_shape(path)))
