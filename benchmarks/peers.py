"""How each peer is asked to slice, or for a Reeb graph or a skeleton: see :mod:`entrants`.

Modules are imported by the functions, since a peer that is not installed is skipped.
"""

import numpy as np

from answer_figures import graph_figures

# --------------------------------------------------------------------------
# manifold3d


def build_manifold(points, faces):
    import manifold3d

    body = manifold3d.Manifold(manifold3d.Mesh64(vert_properties=points, tri_verts=faces.astype(np.uint64)))
    if body.is_empty():
        raise ValueError(f"manifold3d refuses the mesh: {body.status()}")
    return body


def slice_manifold(body, heights):
    return [ring for height in heights for ring in body.slice(height).to_polygons()]


def nest_manifold(body, heights):
    return [part.to_polygons() for height in heights for part in body.slice(height).decompose()]


# --------------------------------------------------------------------------
# VTK


def build_vtk(points, faces):
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

    corners, cells, surface = vtkPoints(), vtkCellArray(), vtkPolyData()
    corners.SetData(numpy_to_vtk(points, deep=True))
    offsets = np.arange(0, 3 * len(faces) + 1, 3, dtype=np.int64)
    cells.SetData(
        numpy_to_vtkIdTypeArray(offsets, deep=True),
        numpy_to_vtkIdTypeArray(faces.ravel().astype(np.int64), deep=True),
    )
    surface.SetPoints(corners)
    surface.SetPolys(cells)
    height = numpy_to_vtk(np.ascontiguousarray(points[:, 2]), deep=True)
    height.SetName("height")
    surface.GetPointData().SetScalars(height)
    return surface


def build_vtk_contours(points, faces):
    from vtkmodules.vtkFiltersCore import vtkContourFilter, vtkStripper

    cutter, stripper = vtkContourFilter(), vtkStripper()
    cutter.SetInputData(build_vtk(points, faces))
    cutter.UseScalarTreeOn()
    cutter.SetOutputPointsPrecision(1)  # double
    stripper.SetInputConnection(cutter.GetOutputPort())
    stripper.JoinContiguousSegmentsOn()
    stripper.SetMaximumLength(2**31 - 1)
    return cutter, stripper


def slice_vtk(filters, heights):
    """Level by level, which takes less than all at once: the scalar tree stays, and fewer points are to be merged."""
    return [ring for height in heights for ring in slice_vtk_once(*filters, height)]


def slice_vtk_once(cutter, stripper, height):
    from vtkmodules.util.numpy_support import vtk_to_numpy

    cutter.SetValue(0, height)
    stripper.Update()
    lines = stripper.GetOutput().GetLines()
    points = vtk_to_numpy(stripper.GetOutput().GetPoints().GetData())
    ids, ends = vtk_to_numpy(lines.GetConnectivityArray()), vtk_to_numpy(lines.GetOffsetsArray())
    rings = np.split(points[ids], ends[1:-1])
    return [ring[:-1] for ring in rings if (ring[0] == ring[-1]).all()]


def sweep_vtk(surface, _):
    from vtkmodules.vtkFiltersGeneral import vtkPolyDataToReebGraphFilter

    sweep = vtkPolyDataToReebGraphFilter()
    sweep.SetInputData(surface)
    sweep.SetFieldId(0)
    sweep.Update()
    return sweep.GetOutput()


def check_vtk_graph(graph):
    return graph_figures(graph.GetNumberOfVertices(), graph.GetNumberOfEdges())


# --------------------------------------------------------------------------
# meshlib, trimesh, open3d


def build_meshlib(points, faces):
    from meshlib import mrmeshnumpy

    return mrmeshnumpy.meshFromFacesVerts(faces, points)


def slice_meshlib(mesh, heights):
    from meshlib import mrmeshpy

    rings, frame = [], mrmeshpy.AffineXf3f()
    for height in heights:
        sections = mrmeshpy.extractXYPlaneSections(mesh, float(height))
        for ring in mrmeshpy.planeSectionsToContours2f(mesh, sections, frame):
            rings.append(np.array([(point.x, point.y) for point in ring])[:-1])
    return rings


def build_trimesh(points, faces):
    import trimesh

    return trimesh.Trimesh(points, faces, process=False)


def section_trimesh(mesh, heights):
    paths = mesh.section_multiplane(np.zeros(3), np.array([0.0, 0.0, 1.0]), heights)
    return [path for path in paths if path is not None]


def slice_trimesh(mesh, heights):
    return [np.asarray(ring)[:-1] for path in section_trimesh(mesh, heights) for ring in path.discrete]


def nest_trimesh(mesh, heights):
    polygons = [polygon for path in section_trimesh(mesh, heights) for polygon in path.polygons_full]
    return [[np.array(ring.coords)[:-1] for ring in (part.exterior, *part.interiors)] for part in polygons]


def build_open3d(points, faces):
    import open3d

    mesh = open3d.t.geometry.TriangleMesh()
    mesh.vertex.positions = open3d.core.Tensor(points)
    mesh.triangle.indices = open3d.core.Tensor(faces)
    return mesh


def slice_open3d(mesh, heights):
    lines = mesh.slice_plane([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], list(map(float, heights)))
    return lines.point.positions.numpy(), lines.line.indices.numpy()


def check_segments(segments):
    return {"points": len(segments[1])}


# --------------------------------------------------------------------------
# ceREEBerus, skeletor


def build_cereeberus(points, faces):
    from cereeberus import LowerStar
    from gudhi import SimplexTree

    star = LowerStar()
    star.insert_batch(np.ascontiguousarray(faces.T), np.full(len(faces), points[:, 2].min()))
    for vertex, height in enumerate(points[:, 2].tolist()):  # LowerStar's own would visit the star of each
        SimplexTree.assign_filtration(star, [vertex], height)
    star.make_filtration_non_decreasing()
    return star


def sweep_cereeberus(star, _):
    from cereeberus import computeReeb

    return computeReeb(star)


def check_multigraph(graph):
    return graph_figures(graph.number_of_nodes(), graph.number_of_edges())


def find_skeleton(way, mesh, _):
    import skeletor

    if way == "by_mean_curvature":
        mesh = skeletor.pre.contract(mesh, epsilon=0.1, progress=False)  # as it advises where nothing is left
        return skeletor.skeletonize.by_mean_curvature(mesh, progress=False)
    step = {"step_size": np.ptp(mesh.vertices, axis=0).max() / 200} if way == "by_wavefront_exact" else {}
    return getattr(skeletor.skeletonize, way)(mesh, progress=False, **step)


def check_skeleton(skeleton):
    import networkx

    graph = skeleton.get_graph().to_undirected()
    parts = networkx.number_connected_components(graph)
    return graph_figures(graph.number_of_nodes(), graph.number_of_edges(), parts)
