"""Read mesh files of any supported format, each by the module that is named for it."""

from os import PathLike
from pathlib import Path

import numpy as np

from ..errors import MeshFormatError
from ..mesh.faults import find_fault
from .mesh_file import MeshFile
from .number_lines import decode

SUFFIXES = (".stl", ".obj", ".ply", ".off", ".glb", ".gltf", ".3mf", ".step", ".stp")
CHECKED = (".stl", ".obj", ".ply", ".off")  # their readers name a fault by its line or facet themselves
LONGEST = 2000  # letters of a sentence; what is wrong stands at its begin, and the cure at its end
POINTER = b"version https://git-lfs"


def read_mesh(path: str | PathLike[str]) -> MeshFile:
    r"""Read the mesh of a file.

    Parameters
    ----------
    path : str or Path
        Its ending, in any case, is one of `SUFFIXES` and says the format.

    Returns
    -------
    MeshFile
        Points (n, 3) float64 as the file has them, neither merged nor scaled,
        the parts of a scene in their places; triangles (m, 3) int32, at least
        one, into which polygons are cut; all ids exist, all coordinates in use
        are finite. The unit, and sentences on what the file holds besides.

    Raises
    ------
    MeshFormatError
        The ending is none of `SUFFIXES`, or the file is empty, damaged, holds
        no faces, or something that is not read.
    ImportError
        The format takes a package that is not installed.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "square.obj"
    ...     _ = path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    ...     file = read_mesh(path)
    >>> len(file.points), len(file.faces), file.unit, file.notes
    (4, 2, None, ())
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in SUFFIXES:
        raise MeshFormatError(
            f"Files ending in {path.suffix or 'nothing'} are not supported; convert the mesh to"
            f" one of {', '.join(SUFFIXES)}."
        )
    _check_content(path)
    reader = _find_reader(ending)  # what goes wrong here is no fault of the mesh
    try:
        mesh = reader(path)
    except MeshFormatError as error:
        raise MeshFormatError(_shorten(str(error))) from error
    except (ImportError, MemoryError, OSError):  # these are no faults of the mesh
        raise
    except Exception as error:  # a reader may stumble over damage in any way it likes
        told = _shorten(f"{type(error).__name__}: {error}".splitlines()[0])
        raise MeshFormatError(f"The file is damaged or not really {ending} ({told}); export the mesh again.") from error
    points = np.asarray(mesh.points, np.float64).reshape(-1, 3)
    if ending not in CHECKED and (fault := find_fault(points, mesh.faces)):
        raise MeshFormatError(fault)
    notes = tuple(map(_shorten, mesh.notes))
    return mesh._replace(points=points, faces=mesh.faces.astype(np.int32, copy=False), notes=notes)


def _shorten(sentence):
    """Return a sentence on one line, without its middle if names from the file make it very long."""
    sentence = "".join(letter if letter.isprintable() else " " for letter in sentence)
    return sentence if len(sentence) <= LONGEST else f"{sentence[: LONGEST // 2]} ... {sentence[-LONGEST // 2 :]}"


def _find_reader(ending):
    """Import the reader of a format: one of them, as some take a while to load."""
    match ending:
        case ".stl":
            from .stl import read_stl as reader
        case ".obj":
            from .obj import read_obj as reader
        case ".ply":
            from .ply import read_ply as reader
        case ".off":
            from .off import read_off as reader
        case ".glb" | ".gltf":
            from .gltf import read_gltf as reader
        case ".3mf":
            from .threemf import read_3mf as reader
        case _:
            from .step import read_step as reader
    return reader


def _check_content(path):
    """Refuse files that hold nothing, or stand for another file."""
    with open(path, "rb") as file:
        head = file.read(1024)
    if not head:
        raise MeshFormatError("The file is empty (0 bytes); export the mesh again.")
    if head.startswith(POINTER):
        size = next((line.split()[-1] for line in head.splitlines() if line.startswith(b"size ")), b"")
        raise MeshFormatError(
            "The file is a Git LFS pointer, not the mesh"
            f"{f' of {decode(size)} bytes' if size else ''} itself; fetch the file with: git lfs pull."
        )
