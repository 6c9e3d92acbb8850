"""Faces with the arcs that they lie on, whole or cut where arcs end, as a table and as a coloured mesh."""

from typing import NamedTuple

import numpy as np
import pyarrow as pa

from ..mesh.arguments import take_rotation
from ..morse.face_arcs import label_arcs, match_faces
from ..table_checks import build_table
from .cut_faces import cut_mesh, middle_pieces, part_faces


class LabelledMesh(NamedTuple):
    """A surface whose T triangles lie on one arc each.

    Attributes
    ----------
    points : (n, 3) float64
        Model frame.
    triangles : (T, 3) int64
        Counter-clockwise seen from outside.
    row : (T,) int64
        Row of the table `face_arcs` of each.
    """

    points: np.ndarray
    triangles: np.ndarray
    row: np.ndarray


def list_face_arcs(mesh, graph, labels, surface, rotation, cut):
    """Tell on which arcs each face lies.

    Parameters
    ----------
    mesh : HeightMesh
    graph : ReebGraph
        The mesh's.
    labels : ArcSlices
        Of :func:`.arc_labels.slice_arcs`.
    surface : (points, faces)
        The surface that the mesh was made of: (n, 3) float64, model frame, and (m, 3) int.
    rotation : (3, 3) float64
        From the model frame to the tilted frame.
    cut : bool
        Whether faces are cut where an arc ends; else each goes by its middle.

    Returns
    -------
    face_arcs : pyarrow.Table
        A row for each face, in their order; or for each part of a face, in the order of faces, then upward. Then
        the areas of an arc add up to that of the surface along it but for rounding. A part that is no more
        than a line has no row.
    labelled : LabelledMesh
        The faces or, if they are cut, triangles of their parts: a surface as closed as that of the faces.
    """
    points, faces = surface
    row = match_faces(mesh, faces)
    critical = np.empty(len(faces), np.int64)
    critical[row[row >= 0]] = label_arcs(mesh, graph).of_face[row >= 0]
    if cut:
        labelled, face, piece = _cut(mesh, labels, points, row, take_rotation(rotation))
    else:
        labelled, face = LabelledMesh(points, np.asarray(faces, np.int64), np.arange(len(faces))), np.arange(len(faces))
        piece = np.empty(len(faces), np.int64)
        piece[row[row >= 0]] = middle_pieces(mesh, labels.slices)[row >= 0]
    solid = labels.solid_of_block[labels.slices.block_of_piece[piece]]
    area = np.bincount(labelled.row, weights=_areas(labelled.points, labelled.triangles), minlength=len(face))
    columns = {
        "face": face,
        "surface_arc": _or_null(labels.surface_of_piece[piece]),
        "solid_arc": _or_null(solid),
        "critical_arc": critical[face],
        "area": area,
    }
    return build_table("face_arcs", columns), labelled


def _cut(mesh, labels, points, row, rotation):
    """The cut surface, and of each part that has triangles its face and a piece with its arcs."""
    slices = labels.slices
    arcs = np.column_stack([labels.surface_of_piece, labels.solid_of_block[slices.block_of_piece]])
    _, piece, label = np.unique(arcs, axis=0, return_index=True, return_inverse=True)
    parts = part_faces(mesh, slices, label.ravel())
    cut = cut_mesh(mesh, slices, parts, len(points))
    order = np.lexsort((cut.part, row[parts.face[cut.part]]))
    kept, number = np.unique(cut.part[order], return_inverse=True)
    place = np.argsort(np.lexsort((kept, row[parts.face[kept]])))
    found = LabelledMesh(np.concatenate([points, cut.points @ rotation]), cut.triangles[order], place[number.ravel()])
    kept = kept[np.argsort(place)]
    return found, row[parts.face[kept]], piece[parts.label[kept]]


def _areas(points, triangles):
    """Areas of triangles."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def _or_null(ids):
    """Ids for a table, null for -1."""
    return pa.array(ids, pa.int32(), mask=ids < 0)
