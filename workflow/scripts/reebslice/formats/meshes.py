"""Read mesh files of any supported format, each by the module that is named for it."""

from importlib import import_module
from pathlib import Path

import numpy as np

from ..errors import MeshFormatError
from ..mesh.faults import find_fault
from .number_lines import decode

__all__ = ["READERS", "SUFFIXES", "read_mesh"]

# Ending: module of this folder, its function. Imported when needed: some take a while.
READERS = {
    ".stl": ("stl", "read_stl"),
    ".obj": ("obj", "read_obj"),
    ".ply": ("ply", "read_ply"),
    ".off": ("off", "read_off"),
    ".glb": ("gltf", "read_gltf"),
    ".gltf": ("gltf", "read_gltf"),
    ".3mf": ("threemf", "read_3mf"),
    ".step": ("step", "read_step"),
    ".stp": ("step", "read_step"),
}
SUFFIXES = tuple(READERS)
CHECKED = ("stl", "obj", "ply", "off")  # modules that name a fault by its line or facet themselves
POINTER = b"version https://git-lfs"


def read_mesh(path):
    """Read the mesh of a file.

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
    """
    path = Path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise MeshFormatError(
            f"Files ending in {path.suffix or 'nothing'} are not supported; convert the mesh to"
            f" one of {', '.join(SUFFIXES)}."
        )
    _check_content(path)
    module, function = reader
    try:
        mesh = getattr(import_module(f".{module}", __package__), function)(path)
    except (MeshFormatError, ImportError):
        raise
    except Exception as error:  # a reader may stumble over damage in any way it likes
        told = f"{type(error).__name__}: {error}".splitlines()[0]
        raise MeshFormatError(
            f"The file is damaged or not really {path.suffix.lower()} ({told}); export the mesh again."
        ) from error
    points = np.asarray(mesh.points, np.float64).reshape(-1, 3)
    if module not in CHECKED and (fault := find_fault(points, mesh.faces)):
        raise MeshFormatError(fault)
    return mesh._replace(points=points, faces=mesh.faces.astype(np.int32, copy=False))


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
