"""Read 3MF by the 3MF Core Specification 1.4 and the Production Extension 1.1.

The mesh is what the build makes: each item of the root part's build, in the
order of the file, with the components below it, each copy in its place.
Objects are keyed by part and id. Objects of type `model` and `solidsupport`
are solids; `support`, `surface` and `other` are not, and are left out. The
type of an object that has components is that of each component. A transform
that mirrors keeps the sign of volumes (section 3.3), so it turns faces over.

What is refused: a required extension that changes the shape, or is not known,
as the specification demands of whoever does not support it. What is told:
everything that was left out, extensions that are used but not required, and
the roles that slicers give to bodies in files of their own. Such roles are no
part of 3MF: by the specification, a slicer's negative volume is a body as any
other, so it is read as one, and told.
"""

from pathlib import Path

import numpy as np

from ..errors import MeshFormatError
from .mesh_file import MeshFile
from .packages import Package, fold_name
from .slicer_roles import describe_roles
from .threemf_extensions import describe_extensions
from .threemf_scene import UNITS, Scene


def read_3mf(path):
    """Return the mesh that the build of a 3MF file makes, in the file's own unit.

    Parameters
    ----------
    path : path of the file

    Returns
    -------
    MeshFile
        Copies of one mesh are copied, each with points of its own; `unit` is
        that of the root model part. There is at least one face, and every face
        names points that exist. Faces may name one point twice.

    Raises
    ------
    MeshFormatError
        The package or its XML is damaged; it requires an extension that is not
        supported; components form a circle; the build holds no solid; it
        unpacks to, or places, more than the bounds in `packages` and
        `threemf_scene`.

    References
    ----------
    3MF Consortium, "3D Manufacturing Format Core Specification & Reference
    Guide", version 1.4; "3MF Production Extension", version 1.1.
    """
    with Package(Path(path)) as package:
        scene = Scene(package)
        copies = scene.place_build()
        notes = (*describe_scene(scene), *describe_extensions(scene.models.values()), *describe_roles(package))
    if not any(len(copy.object.faces) for copy in copies):
        build = (
            f"Its build has {len(scene.root.items)} items and no solid." if scene.root.items else "Its build is empty."
        )
        raise MeshFormatError(" ".join(["The 3MF file holds no mesh.", build, *notes, "Export a solid model."]))
    return MeshFile(*join_copies(copies), UNITS[scene.root.unit], notes)


def join_copies(copies):
    """Return the points and the faces of all copies, each put in its place.

    Parameters
    ----------
    copies : list of `threemf_scene.Copy`

    Returns
    -------
    points : (n, 3) float64
    faces : (m, 3) int64
        A copy whose matrix mirrors has its faces turned over.
    """
    points, faces, count = [], [], 0
    for thing, matrix in copies:
        corners = thing.points
        if not np.array_equal(matrix, np.eye(4, 3)):
            corners = corners[:, :1] * matrix[0] + corners[:, 1:2] * matrix[1] + corners[:, 2:] * matrix[2] + matrix[3]
        points.append(corners)
        faces.append((thing.faces[:, ::-1] if np.linalg.det(matrix[:3]) < 0 else thing.faces) + count)
        count += len(corners)
    return np.concatenate(points), np.concatenate(faces)


def describe_scene(scene):
    """Return sentences on what is in the package's model parts and not in the mesh.

    Parameters
    ----------
    scene : `threemf_scene.Scene` whose build has been placed

    Returns
    -------
    list of str
    """
    notes = [
        f"{_list(things)} of part {scene.models[part].part} {_are(things)} of type '{type_}', no solid, and left out."
        for (part, type_), things in _group(scene.left_out).items()
    ]
    for key, model in scene.models.items():
        idle = [thing for id_, thing in model.objects.items() if (key, id_) not in scene.used]
        if idle:
            notes.append(f"{_list(idle)} of part {model.part} {_are(idle)} not in the build, and left out.")
    unread = [name for name in scene.package.names() if name.endswith(".model") and fold_name(name) not in scene.models]
    if unread:
        notes.append(f"The build does not refer to {_shorten(unread)}, which {_are(unread)} not read.")
    hidden = [str(number) for number, item in enumerate(scene.root.items) if not item.printable]
    if hidden:
        notes.append(
            f'Items {_shorten(hidden)} of the build (counted from 0) have printable="0", a slicer\'s attribute that'
            " 3MF does not have; they are read as any other."
        )
    return notes


def _group(left_out):
    """Objects left out, by part and type."""
    groups = {}
    for (part, _), thing in left_out.items():
        groups.setdefault((part, thing.type_), []).append(thing)
    return groups


def _list(things):
    """Objects by id and name, as the begin of a sentence."""
    told = _shorten([str(thing).removeprefix("object ") for thing in things])
    return f"Object {told}" if len(things) == 1 else f"{len(things)} objects ({told})"


def _shorten(words, most=5):
    """Words in a row, the first few of them if there are many."""
    return ", ".join(words[:most]) + (", ..." if len(words) > most else "")


def _are(things):
    """The verb for one or many."""
    return "is" if len(things) == 1 else "are"
