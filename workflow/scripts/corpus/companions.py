"""Files that a mesh file names and that belong to its geometry."""

from pathlib import Path


def list_companions(path):
    """List the files, as paths, that a mesh file names and that belong to its geometry: the buffers of a glTF file."""
    if Path(path).suffix.lower() not in (".gltf", ".glb"):
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
