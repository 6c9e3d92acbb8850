"""Discovery: which meshes there are, and what each is called."""

import os
from dataclasses import dataclass

from .companions import stamp_companions

ENDINGS = (".stl", ".obj", ".ply", ".off", ".glb", ".gltf", ".3mf", ".step", ".stp")
# What lies beside meshes and belongs to them: materials, textures, buffers, notes.
COMPANIONS = (".mtl", ".bin", ".png", ".jpg", ".jpeg", ".md", ".txt", ".csv", ".json", ".yaml")
LONGEST_ID = 180  # bytes; file systems end at 255 and scratch names need some


class CorpusError(ValueError):
    """The mesh folder cannot be used as it is; the text says why and what cures it."""


@dataclass(frozen=True)
class InputFile:
    """One input file."""

    path: str
    size: int
    mtime_ns: int
    companions: tuple = ()  # (path, size, mtime_ns) of the files that it names, None where one is missing


# --------------------------------------------------------------------------
# Discovery


def find_models(folder, beside=("results", ".snakemake")):
    """Find every mesh under `folder`, recursively.

    Parameters
    ----------
    folder : str
        Relative to the working directory, or absolute.
    beside : sequence of str
        Folders not to descend into, though they lie under `folder`.

    Returns
    -------
    models : dict of str to InputFile, sorted by model id
    others : list of str
        What else is there, sorted: files that are neither meshes nor known to
        accompany them, and names of meshes that lead to no file.

    Raises
    ------
    CorpusError
        When the folder is missing or holds no mesh, when two files have one
        id, or when a name cannot be used.
    """
    if not os.path.isdir(folder):
        raise CorpusError(
            f"meshes: there is no folder {folder!r} in {os.getcwd()!r}; put your meshes there, or name "
            "their folder, in config/config.yaml or by --config meshes=FOLDER"
        )
    skipped = {os.path.realpath(path) for path in beside}
    models, others = {}, []
    for path, entry, fault in _walk(folder, skipped):
        stem, ending = os.path.splitext(path)
        if fault or ending.lower() not in ENDINGS:
            others += [f"{path} ({fault})" if fault else path] if ending.lower() not in COMPANIONS else []
            continue
        model = make_model_id(os.path.relpath(stem, folder))
        if model in models:
            raise CorpusError(
                f"meshes: {models[model].path!r} and {path!r} would both be the model {model!r}; rename one of them"
            )
        models[model] = _stamp(path, entry)
    if not models:
        raise CorpusError(
            f"meshes: the folder {folder!r} holds no mesh; put files there that end in {', '.join(ENDINGS)}"
        )
    return dict(sorted(models.items())), sorted(others)


def _stamp(path, entry):
    """Describe a mesh file; where it cannot be read, the stage that reads it tells why."""
    try:
        stat = entry.stat()
    except OSError:  # gone since the folder was listed
        return InputFile(path, 0, 0)
    try:
        companions = stamp_companions(path)
    except (OSError, MemoryError):
        companions = ()
    return InputFile(path, stat.st_size, stat.st_mtime_ns, companions)


def _walk(folder, skipped):
    """Yield (path, entry, '') of what is below `folder` but hidden names, links followed.

    Each folder is searched once, whatever links lead to it: in its own place where that is below `folder`, else by the
    first link. Where no file is, or a folder that was searched already or cannot be read, (path, None, what is wrong).
    """
    seen, waiting = set(), [folder]
    while waiting:
        links = []  # to folders: followed when all that is no link has been
        for path in sorted(waiting):
            yield from _search(path, skipped, seen, links)
        waiting = links


def _search(folder, skipped, seen, links):
    """Yield what :func:`_walk` does of one folder and of those below it, and put links to folders to `links`."""
    real = os.path.realpath(folder)
    if real in skipped:
        return
    if real in seen:
        yield folder, None, "a link to a folder that is searched already"
        return
    seen.add(real)
    try:
        with os.scandir(folder) as found:
            entries = sorted(found, key=lambda entry: entry.name)
    except OSError as fault:
        yield os.path.join(folder, ""), None, f"a folder that cannot be read: {fault.strerror}"
        return
    for entry in entries:
        if not entry.name.startswith("."):
            yield from _look_at(entry, skipped, seen, links)


def _look_at(entry, skipped, seen, links):
    """Yield what :func:`_search` does of one name in a folder."""
    try:
        is_folder, is_file = entry.is_dir(), entry.is_file()
    except OSError as fault:  # a link to itself, among others
        yield entry.path, None, f"no file: {fault.strerror}"
        return
    if is_folder and entry.is_symlink():
        links.append(entry.path)
    elif is_folder:
        yield from _search(entry.path, skipped, seen, links)
    elif is_file:
        yield entry.path, entry, ""
    else:
        yield entry.path, None, "no file: a link to nothing, or a device"


def make_model_id(stem):
    """Return the id of a model: its path under the mesh folder without ending, `/` as `__`.

    Raises CorpusError when the name holds characters that no table or log
    can show on one line, or is too long for a folder's name.
    """
    model = stem.replace(os.sep, "__")
    if not model.isprintable():
        raise CorpusError(f"meshes: the name {stem!r} holds unprintable characters; rename the file")
    if len(model.encode()) > LONGEST_ID:
        raise CorpusError(
            f"meshes: {stem!r} makes an id of {len(model.encode())} bytes, more than {LONGEST_ID}; "
            "shorten the name of the file or of its folders"
        )
    return model
