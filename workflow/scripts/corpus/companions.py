"""Files that a mesh file names and that belong to its geometry, and the digest of all of them."""

import hashlib
from pathlib import Path

from .whole_files import digest_file


def list_companions(path):
    """List the files, as paths, that a mesh file names and that belong to its geometry: the buffers of a glTF file."""
    if not str(path).lower().endswith((".gltf", ".glb")):
        return []
    from reebslice.formats.gltf_asset import list_companions  # of the library, and only where such a file is

    return [Path(path).parent / name for name in list_companions(path)]


def stamp_companions(path):
    """Size and time of every file that a mesh file names, as a tuple of (path, size, mtime_ns)."""
    stamps = []
    for companion in list_companions(path):
        stat = companion.stat() if companion.is_file() else None
        stamps.append((str(companion), stat and stat.st_size, stat and stat.st_mtime_ns))
    return tuple(stamps)


def digest_mesh(path):
    """Return a digest of all that reading a mesh depends on but the reader's code.

    That is its ending, which chooses the reader, the bytes of the file, and
    those of the files that it names; of one that is missing, its absence.
    """
    parts = [Path(path).suffix.lower(), digest_file(path)]
    for companion in list_companions(path):
        parts += [companion.name, digest_file(companion) if companion.is_file() else "missing"]
    return hashlib.blake2b("\0".join(parts).encode(errors="surrogateescape"), digest_size=16).hexdigest()
