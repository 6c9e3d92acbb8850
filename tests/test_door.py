"""The public door: what `import reebslice` gives, what it checks, and where it works."""

import ast
import doctest
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import networkx
import numpy as np
import pytest

import reebslice
import solids
from reebslice.errors import NotASolidError, ReebsliceError
from reebslice.schemas import SCHEMAS

SCRIPTS = Path(__file__).parents[1] / "workflow" / "scripts"
CORE = {"numba", "numpy", "pyarrow", "scipy", "shapely"}
BALL = solids.icosphere(2)


def test_every_exported_name_is_there_and_stubs_say_the_same():
    stub = ast.parse((SCRIPTS / "reebslice" / "__init__.pyi").read_text())
    told = {
        alias.asname: f".{node.module}"
        for node in stub.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    homes = {name: f".{home}" for name, home in reebslice._HOMES.items()}
    assert told == homes | {"errors": ".None"}
    assert all(getattr(reebslice, name) is not None for name in reebslice.__all__)
    assert set(reebslice.__all__) == set(dir(reebslice))
    assert reebslice.SCHEMAS is SCHEMAS
    with pytest.raises(AttributeError, match="no attribute 'slice'; it exports ArcBodies, Centrelines, Contours, "):
        _ = reebslice.slice


def run_python(script, **environment):
    """What a new interpreter prints that sees the library and nothing else of the project."""
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        env=os.environ | {"PYTHONPATH": str(SCRIPTS)} | environment,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_importing_loads_nothing_else():
    loaded = run_python("import sys, reebslice; print(*sys.modules)").split()
    assert not CORE & set(loaded) and [name for name in loaded if name.startswith("reebslice")] == ["reebslice"]


def test_the_library_runs_with_its_own_dependencies_alone():
    """What extras bring (Snakemake, pandas, trimesh, matplotlib, ...) is hidden from the interpreter."""
    script = f"""
import sys
from importlib import metadata
keep = {CORE | {"llvmlite", "pip", "setuptools"}!r}
owners = metadata.packages_distributions()
hidden = {{top for top in owners if not keep & {{one.lower() for one in owners[top]}}}}
class Hide:
    @staticmethod
    def find_spec(name, path=None, target=None):
        if name.split(".")[0] in hidden:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)
sys.meta_path.insert(0, Hide)
import numpy as np, reebslice
points = np.array([[0, 0, 0], [1, 0, 0.1], [0, 1, 0.2], [0, 0, 1]], float)
faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
for graph in reebslice.exact_graphs(points, faces):
    print(len(graph.vertex), len(graph.arcs))
tables, record = reebslice.inspect_surface(points[faces].reshape(-1, 3), np.arange(12).reshape(-1, 3))
print(record["status"], tables["vertices"].num_rows)
"""
    assert run_python(script).split() == ["2", "1", "2", "1", "accepted", "4"]


def test_it_imports_and_runs_where_nothing_is_writable():
    script = """
import tempfile
def refuse(*arguments, **options):
    raise PermissionError("nothing is writable")
tempfile.TemporaryFile = refuse  # by which numba tries whether it can write to a folder
import numpy as np
from reebslice.arrays.sorting import sort_stably
print(sort_stably((np.array([1, 0]), 2)))
"""
    assert run_python(script).strip() == "[1 0]"
    broken = script.replace("from reebslice.arrays.sorting", "from numba import njit; njit(cache=True)(refuse) #")
    with pytest.raises(AssertionError, match="no locator available"):  # what numba alone makes of it
        run_python(broken)


def test_processes_that_need_one_kernel_at_once_compile_it_once(tmp_path):
    (tmp_path / "kernels_here.py").write_text("""
from reebslice.kernels import njit
@njit
def fold(x):
    return 1.0 if x < 1 else x * fold(x - 1)
@njit
def fold_twice(x):
    return fold(x) + fold(x + 1)
""")
    script = f"""
import sys
sys.path.insert(0, {str(tmp_path)!r})
import kernels_here
print(kernels_here.fold_twice(3.0), sum(kernels_here.fold_twice.stats.cache_misses.values()))
"""
    folder = os.environ | {"PYTHONPATH": str(SCRIPTS), "NUMBA_CACHE_DIR": str(tmp_path / "compiled")}
    command = [sys.executable, "-c", script]
    runs = [subprocess.Popen(command, env=folder, stdout=subprocess.PIPE, text=True) for _ in range(3)]
    assert sorted(run.communicate()[0].split() for run in runs) == [["30.0", "0"], ["30.0", "0"], ["30.0", "1"]]


def test_inner_kernels_are_for_kernels_and_constants_make_no_kernels_of_their_own(tmp_path):
    (tmp_path / "kernels_here.py").write_text("""
from reebslice.kernels import njit
@njit(inner=True)
def double(x):
    return 2 * x
@njit
def sum_doubles(x):
    return double(x) + double(3)
""")
    script = f"""
import sys
sys.path.insert(0, {str(tmp_path)!r})
from kernels_here import double, sum_doubles
print(sum_doubles(1), len(double.signatures))
for _ in range(2):
    try:
        double(1)
    except TypeError as error:
        print(error)
"""
    for compiled in (1, 0):  # compiled, and loaded with what calls it
        said = run_python(script, NUMBA_CACHE_DIR=str(tmp_path))
        assert said.split("\n")[:3] == [
            f"8 {compiled}",
            *["double is for kernels to call; declare it without `inner`"] * 2,
        ]


def with_value(array, place, value):
    array = np.array(array)
    array[place] = value
    return array


@pytest.mark.parametrize(
    "points, faces, says",
    [
        (BALL.points[:0], BALL.faces, "points is empty"),
        (BALL.points, BALL.faces[:0], "faces is empty"),
        (BALL.points[:, :2], BALL.faces, r"points has the shape \(\d+, 2\); give an array of shape \(n, 3\)"),
        (BALL.points, BALL.faces.ravel(), "faces has the shape .* cut polygons into triangles first"),
        (BALL.points, [[0, 1, 2], [0, 1]], "faces has rows of unequal length"),
        (BALL.points, BALL.faces.astype(float), "faces holds values of type float64; give whole numbers"),
        (BALL.points.astype(complex), BALL.faces, "points holds values of type complex128; give real numbers"),
        (with_value(BALL.points, (7, 1), np.nan), BALL.faces, r"1 points have .* the first is points\[7\] = \(.*nan"),
        (
            BALL.points,
            with_value(BALL.faces, (5, 2), len(BALL.points)),
            r"faces\[5, 2\] is \d+, but points has the rows 0 to",
        ),
        (BALL.points, with_value(BALL.faces, (5, 2), -1), r"faces\[5, 2\] is -1, but"),
        (BALL.points, BALL.faces[1:], "the surface is open, branches, or is not oriented. reebslice.inspect_surface"),
        (
            BALL.points[BALL.faces].reshape(-1, 3),
            np.arange(3 * len(BALL.faces)).reshape(-1, 3),
            "corners are not merged.*merges",
        ),
        (BALL.points, BALL.faces[:, ::-1], r"point inward.*Reverse their corners, faces\[:, ::-1\]"),
        (BALL.points, None, "A ndarray is given alone: give points"),
    ],
)
def test_the_door_says_what_is_wrong_where_and_the_cure(points, faces, says):
    for function in reebslice.height_mesh, reebslice.exact_graphs:
        with pytest.raises(NotASolidError, match=f"(?s){says}") as raised:
            function(points, faces)
        assert isinstance(raised.value, ReebsliceError) and isinstance(raised.value, ValueError)


@pytest.mark.parametrize(
    "call, says",
    [
        (lambda: reebslice.exact_graphs(BALL.points, BALL.faces, np.eye(2)), r"rotation has the shape \(2, 2\)"),
        (lambda: reebslice.height_mesh(BALL.points, BALL.faces, 2 * np.eye(3)), "is no rotation"),
        (lambda: reebslice.height_mesh(BALL.points, BALL.faces, np.full((3, 3), np.nan)), "is no rotation"),
        (lambda: reebslice.height_mesh(BALL.points, BALL.faces, -np.eye(3)), "must not mirror"),
        (lambda: reebslice.height_mesh(BALL.points, BALL.faces, "upright"), "rotation is a str"),
        (lambda: reebslice.exact_graphs(BALL.points, BALL.faces, None, [0, 1]), r"body_of_vertex has the shape \(2,\)"),
        (lambda: reebslice.exact_graphs(BALL.points, BALL.faces, None, -np.ones(len(BALL.points), int)), "0 or more"),
        (lambda: reebslice.inspect_surface(BALL.points[:, :2], BALL.faces), r"points has the shape \(\d+, 2\)"),
        (lambda: reebslice.inspect_surface(BALL.points, BALL.faces + 0.4), "faces holds values of type float64"),
        (lambda: reebslice.select_tilt(BALL.points, BALL.faces, "up"), "mode is 'up': give one of 'auto', 'none'"),
        (lambda: reebslice.select_tilt(BALL.points, BALL.faces, "direction", [0, 0, 0]), "give three finite numbers"),
        (lambda: reebslice.select_tilt(BALL.points, BALL.faces, "direction"), "give three finite numbers"),
        (lambda: reebslice.surface_reeb_graph(BALL.points), "mesh is a ndarray, not a HeightMesh: make one by"),
        (lambda: reebslice.nested_contours(BALL, [0.0]), "mesh is a Solid, not a HeightMesh"),
        (lambda: reebslice.nested_contours(reebslice.height_mesh(BALL.points, BALL.faces), [1, 0]), "ascending order"),
        (lambda: reebslice.nested_contours(reebslice.height_mesh(BALL.points, BALL.faces), [np.nan]), "finite numbers"),
        (lambda: list(reebslice.nested_blocks(reebslice.height_mesh(BALL.points, BALL.faces), [0], 0)), "1 or more"),
    ],
)
def test_other_arguments_are_checked(call, says):
    with pytest.raises(ReebsliceError, match=says):
        call()


def test_directions_of_any_length_are_brought_to_one():
    for length in (1e-300, 1e300):
        found = reebslice.select_tilt(BALL.points, BALL.faces, "direction", [0, 0, length])
        assert found["direction"] == [0, 0, 1]


def test_unused_points_may_be_anything():
    points = np.vstack([BALL.points, [[np.nan] * 3]])
    assert len(reebslice.exact_graphs(points, BALL.faces)[0].vertex) == 2


def test_meshes_of_other_libraries_are_taken_whole():
    trimesh = pytest.importorskip("trimesh")
    expected = reebslice.exact_graphs(BALL.points, BALL.faces)[1]
    whole = trimesh.Trimesh(BALL.points, BALL.faces, process=False)
    # as pyvista names the arrays of a PolyData, which is not installed for tests
    poly = SimpleNamespace(points=BALL.points, regular_faces=BALL.faces, is_all_triangles=True)
    for mesh in whole, poly:
        found = reebslice.exact_graphs(mesh)[1]
        assert found.vertex.tolist() == expected.vertex.tolist() and found.arcs.tolist() == expected.arcs.tolist()
    poly.is_all_triangles = False
    with pytest.raises(NotASolidError, match=r"call its triangulate\(\) first"):
        reebslice.height_mesh(poly)


def test_a_surface_in_order_of_height_is_taken_as_the_surface_is():
    """Also where multiple saddles were unfolded before it was turned inside out, and points lie in no face."""
    for seed, solid in enumerate((solids.torus(), solids.monkey_saddle(5), solids.cup(), *map(solids.csg, range(6)))):
        turn = None if seed % 2 else solids.rotation(seed)
        points = np.vstack([[[np.nan] * 3], solid.points, [[np.inf] * 3]])
        body, given = np.zeros(len(points), np.int32), (points, solid.faces + 1)
        mesh = reebslice.height_mesh(*given, turn)
        found = [reebslice.exact_graphs(mesh, body_of_vertex=body), reebslice.find_islands(mesh, None, None, body)]
        wanted = [reebslice.exact_graphs(*given, turn, body), reebslice.find_islands(*given, turn, body)]
        for function in reebslice.void_reeb_graph, reebslice.find_pockets:
            found.append(function(mesh))
            wanted.append(function(*given, turn))
        found.append(reebslice.find_loops(mesh, rotation=turn, body_of_vertex=body))
        wanted.append(reebslice.find_loops(*given, turn, body_of_vertex=body))
        np.testing.assert_equal(found, wanted)


def test_a_surface_in_order_of_height_is_given_alone():
    mesh = reebslice.height_mesh(BALL.points, BALL.faces)
    with pytest.raises(ReebsliceError, match="leave them out"):
        reebslice.exact_graphs(mesh, BALL.faces)
    with pytest.raises(ReebsliceError, match="one whole number for each"):
        reebslice.exact_graphs(mesh, body_of_vertex=[0, 0])


def test_graphs_become_networkx_graphs_with_parallel_arcs():
    torus = solids.torus(upright=True)
    surface, _ = reebslice.exact_graphs(torus.points, torus.faces)
    graph = surface.to_networkx()
    assert isinstance(graph, networkx.MultiGraph)
    assert graph.number_of_nodes() == len(surface.vertex) and graph.number_of_edges() == len(surface.arcs)
    assert [graph.nodes[k]["height"] for k in graph] == surface.height.tolist()
    assert sorted(tuple(sorted(ends)) for ends in graph.edges()) == sorted(map(tuple, surface.arcs.tolist()))
    assert graph.number_of_edges() - graph.number_of_nodes() + 1 == 1


@pytest.mark.parametrize(
    "name", [name for name in reebslice._HOMES if callable(getattr(reebslice, name)) and name.islower()]
)
def test_every_exported_function_has_an_example_that_works(name):
    function = getattr(reebslice, name)
    (found,) = doctest.DocTestFinder(recurse=False).find(
        function, name, globs=vars(sys.modules[function.__module__]).copy()
    )
    assert found.examples
    assert doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(found).failed == 0
