"""STEP is read with the volume that it has, wherever it lies, or refused."""

import json
import multiprocessing
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from reebslice.errors import MeshFormatError
from reebslice.formats import opencascade, step, step_tessellation
from reebslice.formats.step import find_bodies, move_points, read_step

pytest.importorskip("cascadio")
CASES = Path(__file__).parent.parent.parent / "shared" / "cases"

HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','2026-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
"""
UNITS = {
    "millimetre": "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))",
    "metre": "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.))",
    "inch": "(CONVERSION_BASED_UNIT('INCH',#{})LENGTH_UNIT()NAMED_UNIT(#{}))",
}
MILLIMETRES = {"millimetre": 1, "metre": 1000, "inch": 25.4}
# Corners of a box by bits (x, y, z); faces as loops seen from outside, with their normals.
LOOPS = [
    ([0, 2, 3, 1], (0, 0, -1)),
    ([4, 5, 7, 6], (0, 0, 1)),
    ([0, 1, 5, 4], (0, -1, 0)),
    ([2, 6, 7, 3], (0, 1, 0)),
    ([0, 4, 6, 2], (-1, 0, 0)),
    ([1, 3, 7, 5], (1, 0, 0)),
]


class Writer:
    """Entities of a STEP file, numbered as they are added."""

    def __init__(self):
        self.rows = []

    def add(self, text):
        self.rows.append(text)
        return f"#{len(self.rows)}"

    def point(self, xyz):
        return self.add("CARTESIAN_POINT('',({}))".format(",".join(f"{x:.17E}" for x in xyz)))

    def direction(self, xyz):
        return self.add("DIRECTION('',({}))".format(",".join(f"{x:.17E}" for x in xyz)))

    def box(self, low, size):
        """A solid box."""
        corners = [np.array(low, float) + [size[k] * (bit >> k & 1) for k in range(3)] for bit in range(8)]
        ends = [self.add(f"VERTEX_POINT('',{self.point(corner)})") for corner in corners]
        edges, faces = {}, []
        for loop, normal in LOOPS:
            turns = []
            for a, b in zip(loop, loop[1:] + loop[:1], strict=True):
                key = (min(a, b), max(a, b))
                if key not in edges:
                    along = (corners[key[1]] - corners[key[0]]) / np.linalg.norm(corners[key[1]] - corners[key[0]])
                    vector = self.add(f"VECTOR('',{self.direction(along)},1.)")
                    line = self.add(f"LINE('',{self.point(corners[key[0]])},{vector})")
                    edges[key] = self.add(f"EDGE_CURVE('',{ends[key[0]]},{ends[key[1]]},{line},.T.)")
                turns.append(self.add(f"ORIENTED_EDGE('',*,*,{edges[key]},{'.T.' if a < b else '.F.'})"))
            across = (corners[loop[1]] - corners[loop[0]]) / np.linalg.norm(corners[loop[1]] - corners[loop[0]])
            frame = f"{self.point(corners[loop[0]])},{self.direction(normal)},{self.direction(across)}"
            plane = self.add(f"PLANE('',{self.add(f'AXIS2_PLACEMENT_3D({chr(39) * 2},{frame})')})")
            bound = self.add(
                f"FACE_OUTER_BOUND('',{self.add('EDGE_LOOP({},({}))'.format(chr(39) * 2, ','.join(turns)))},.T.)"
            )
            faces.append(self.add(f"ADVANCED_FACE('',({bound}),{plane},.T.)"))
        shell = self.add(f"CLOSED_SHELL('',({','.join(faces)}))")
        return self.add(f"MANIFOLD_SOLID_BREP('',{shell})")

    def length_unit(self, name):
        """A unit of length."""
        if name != "inch":
            return self.add(UNITS[name])
        millimetre = self.add(UNITS["millimetre"])
        measure = self.add(f"LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),{millimetre})")
        powers = self.add("DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)")
        return self.add(UNITS[name].format(measure[1:], powers[1:]))


def write(folder, boxes, unit="millimetre", name="a.step"):
    """Write boxes (low, size) as the solids of one part; return the path."""
    writer = Writer()
    solids = [writer.box(*box) for box in boxes]
    length = writer.length_unit(unit)
    angle = writer.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
    solid_angle = writer.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
    doubt = writer.add(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),{length},'','')")
    context = writer.add(
        f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({doubt}))"
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid_angle}))REPRESENTATION_CONTEXT('',''))"
    )
    application = writer.add("APPLICATION_CONTEXT('')")
    product = writer.add(
        f"PRODUCT('part','part','',({writer.add(f'PRODUCT_CONTEXT({chr(39) * 2},{application},{chr(39) * 2})')}))"
    )
    formation = writer.add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
    design = writer.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')")
    definition = writer.add(f"PRODUCT_DEFINITION('design','',{formation},{design})")
    shape = writer.add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
    solid = writer.add(f"ADVANCED_BREP_SHAPE_REPRESENTATION('',({','.join(solids)}),{context})")
    writer.add(f"SHAPE_DEFINITION_REPRESENTATION({shape},{solid})")
    rows = "".join(f"#{number + 1}={row};\n" for number, row in enumerate(writer.rows))
    path = folder / name
    path.write_text(f"{HEAD}{rows}ENDSEC;\nEND-ISO-10303-21;\n")
    return path


def volumes(mesh):
    """The volumes of the bodies, each about its own centre, in order of x."""
    part, one = np.zeros(len(mesh.points), int), np.eye(4)[None]
    tessellation = step_tessellation.Tessellation(mesh.points, mesh.faces, part, one, one, one)
    of_point = find_bodies(tessellation).of_point
    found = []
    for body in range(of_point.max() + 1):
        points = mesh.points - mesh.points[of_point == body].mean(axis=0)
        a, b, c = points[mesh.faces[of_point[mesh.faces[:, 0]] == body]].transpose(1, 0, 2)
        found.append((mesh.points[of_point == body, 0].min(), np.einsum("ij,ij->", a, np.cross(b, c)) / 6))
    return [volume for _, volume in sorted(found)]


@pytest.mark.skipif(not CASES.exists(), reason="../shared/cases is not there")
def test_the_shared_box_a_kilometre_off_has_its_volume():
    expected = json.loads((CASES / "expected.json").read_text())["far_box_1km.step"]
    mesh = read_step(CASES / "far_box_1km.step")
    assert volumes(mesh) == [pytest.approx(expected["volume"], rel=1e-6)]
    assert mesh.points.min(axis=0) == pytest.approx([999995, 999995, -5], abs=1e-5)
    assert mesh.unit == "millimetre" and mesh.notes == ()


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("far", [0, 1e6 + 0.3, 3e8])
def test_a_box_has_its_volume_and_its_place_in_any_unit_however_far_it_is(tmp_path, unit, far):
    scale = MILLIMETRES[unit]
    mesh = read_step(write(tmp_path, [((far / scale, -far / scale, 0), (1, 2, 5))], unit))
    assert volumes(mesh) == [pytest.approx(10 * scale**3, rel=1e-6)]
    assert mesh.points.max(axis=0) == pytest.approx([far + scale, -far + 2 * scale, 5 * scale], rel=1e-12, abs=1e-4)
    assert mesh.unit == "millimetre" and mesh.notes == ()


def test_bodies_that_lie_far_apart_are_each_read_about_themselves(tmp_path):
    mesh = read_step(
        write(tmp_path, [((0, 0, 0), (1, 2, 5)), ((1e7, 0, 0), (10, 10, 10)), ((2e7, -4e7, 0), (3, 3, 3))])
    )
    assert volumes(mesh) == [pytest.approx(10, rel=1e-6), pytest.approx(1000, rel=1e-6), pytest.approx(27, rel=1e-6)]
    assert sorted(mesh.points[:, 1])[0] == pytest.approx(-4e7, abs=1e-5)


@pytest.mark.parametrize("far", [1e6, 1e7])
def test_what_cannot_be_moved_is_refused_and_not_rounded(tmp_path, monkeypatch, far):
    monkeypatch.setattr(step, "move_points", lambda data, vector: data)
    with pytest.raises(MeshFormatError, match=r"float32.*\(\d+.*its volume by 0\.\d+ of it.*Move the model"):
        read_step(write(tmp_path, [((far, far, 0), (10, 10, 10))]))


def test_rounding_between_the_bounds_is_told(tmp_path, monkeypatch):
    monkeypatch.setattr(step, "move_points", lambda data, vector: data)
    mesh = read_step(write(tmp_path, [((5e4, 0, 0), (10, 10, 10))]))
    assert len(mesh.notes) == 1 and "its volume by 0.000" in mesh.notes[0]
    assert volumes(mesh) == [pytest.approx(1000, rel=step.LARGEST)]


def test_the_bound_on_rounding_holds_for_boxes_rounded_to_float32():
    draw = np.random.default_rng(1)
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
    triangles = np.concatenate([np.array(loop)[[[0, 1, 2], [0, 2, 3]]] for loop, _ in LOOPS])
    for _ in range(300):
        size = 10 ** draw.uniform(-1, 2, 3)
        exact = corners * size + 10 ** draw.uniform(0, 6, 3)
        points = exact.astype(np.float32).astype(np.float64)
        mesh = step_tessellation.Tessellation(points, triangles, np.zeros(8, int), *[np.eye(4)[None]] * 3)
        a, b, c = (points - exact.mean(axis=0))[triangles].transpose(1, 0, 2)
        bodies = step.measure_bodies(mesh, np.zeros(8, int))
        change = abs(np.einsum("ij,ij->", a, np.cross(b, c)) / 6 - size.prod()) / size.prod()
        if bodies.rounding[0] < 0.1:  # beyond, more than the first order counts
            assert change <= 1.3 * bodies.rounding[0] + 1e-9


def test_only_points_of_three_coordinates_are_moved():
    text = b"""#1=CARTESIAN_POINT('it''s (1.,2.,3.)',(1.,-2.5E1,
 3.));#2=CARTESIAN_POINT('',(1.,2.));#3=DIRECTION('',(0.,0.,1.));#4 = CARTESIAN_POINT ( 'x' , ( 0., 0., 0. ) );"""
    moved = move_points(text, (1, 2, 3))
    assert moved.count(b"E+") == 6 and b"(1.,2.)" in moved and b"(0.,0.,1.)" in moved
    assert b"'it''s (1.,2.,3.)',(2.0000000000000000E+00,-2.3000000000000000E+01,6.0000000000000000E+00)" in moved


def test_a_file_that_is_cut_off_is_refused_with_the_line(tmp_path):
    path = write(tmp_path, [((0, 0, 0), (1, 1, 1))])
    path.write_text(path.read_text()[:2000])
    with pytest.raises(MeshFormatError, match="OpenCascade cannot read.*Line [0-9]+"):
        read_step(path)


def read_with(path, monkeypatch, program):
    """Read a file, with another program in the process that reads."""
    with monkeypatch.context() as patch:
        patch.setattr(opencascade, "_WAITING", [])
        patch.setattr(opencascade, "_PROGRAM", program)
        try:
            return read_step(path)
        finally:
            opencascade._end_waiting()


def test_a_reader_that_dies_takes_nothing_with_it(tmp_path, monkeypatch):
    path = write(tmp_path, [((0, 0, 0), (1, 1, 1))])
    before = read_step(path)
    dying = opencascade._PROGRAM.replace("cascadio.step_to_glb(source, target, **{})", "os.kill(os.getpid(), SIGNAL)")
    for program in ("import os; os.kill(os.getpid(), SIGNAL) # {}", dying):  # the process that waits, and its fork
        with pytest.raises(MeshFormatError, match="ended with -6"):
            read_with(path, monkeypatch, program.replace("SIGNAL", "6"))
        with pytest.raises(MemoryError):
            read_with(path, monkeypatch, program.replace("SIGNAL", "9"))
    assert np.array_equal(read_step(path).points, before.points)


def test_opencascade_is_loaded_once_for_many_files_and_keeps_nothing_of_one(tmp_path, monkeypatch):
    opencascade._end_waiting()
    started, start = [], opencascade._start
    monkeypatch.setattr(opencascade, "_start", lambda: started.append(start()) or started[-1])
    paths = [write(tmp_path, [((0, 0, 0), (size, 1, 1))], name=f"{size}.step") for size in (1, 2, 3)]
    first = [read_step(path).points for path in paths]
    paths[0].write_text("ISO-10303-21; which is damaged")
    with pytest.raises(MeshFormatError):
        read_step(paths[0])
    assert np.array_equal(read_step(paths[1]).points, first[1])
    assert len(started) == 1 and started[0].poll() is None
    started[0].kill()
    started[0].wait()
    assert np.array_equal(read_step(paths[2]).points, first[2]) and len(started) == 2
    opencascade._end_waiting()
    assert started[1].returncode == 0


def test_threads_and_forks_have_processes_of_their_own(tmp_path):
    paths = [write(tmp_path, [((0, 0, 0), (size, 1, 1))], name=f"{size}.step") for size in (1, 2, 3, 4)]
    alone = [read_step(path).points for path in paths]
    with ThreadPoolExecutor(4) as threads:
        together = list(threads.map(lambda path: read_step(path).points, paths))
    with multiprocessing.get_context("fork").Pool(2) as forks:
        apart = forks.map(read_points, paths)
    for points, others, more in zip(alone, together, apart, strict=True):
        assert np.array_equal(points, others) and np.array_equal(points, more)


def read_points(path):
    """Return the points of a file."""
    return read_step(path).points
