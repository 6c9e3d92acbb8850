"""Discovery: which meshes there are, and what each is called."""

import difflib
import fnmatch
import os
from dataclasses import dataclass
from functools import cache
from pathlib import Path

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


def find_models(meshes, beside=("results", ".snakemake")):
    """Find every mesh in a folder, recursively, or take the one file that is named.

    Files whose paths differ in their endings alone are models called after
    path and ending: `part.stl` beside `part.off` becomes `part_stl`.

    Parameters
    ----------
    meshes : str
        Folder or file, relative to the working directory, or absolute.
    beside : sequence of str
        Folders not to descend into, though they lie under the folder.

    Returns
    -------
    models : dict of str to InputFile, sorted by model id
    others : list of str
        What else is there, sorted: files that are neither meshes nor known to
        accompany them, and names of meshes that lead to no file.
    renamed : list of str
        Ids of the models that are called after their endings too, sorted.

    Raises
    ------
    CorpusError
        When there is no such folder or file, or no mesh in it, when two files
        have one id, or when a name cannot be used.
    """
    if os.path.isfile(meshes):
        folder, files, others = os.path.dirname(meshes), [(meshes, Path(meshes))], []
        if not is_mesh(meshes):
            raise CorpusError(f"meshes: the file {meshes!r} is no mesh; its name must end in {', '.join(ENDINGS)}")
    elif os.path.isdir(meshes):
        folder, (files, others) = meshes, _list_files(meshes, beside)
    else:
        place = "" if os.path.isabs(meshes) else f" in {os.getcwd()!r}"
        raise CorpusError(
            f"meshes: there is no folder {meshes!r}{place}, and no file; put your meshes there, or name "
            "their folder, or one of them, in config/config.yaml or by --config meshes=FOLDER"
        )
    if not files:
        raise CorpusError(
            f"meshes: the folder {meshes!r} holds no mesh; put files there that end in {', '.join(ENDINGS)}"
        )
    models, renamed = _name_models(files, folder)
    return dict(sorted(models.items())), sorted(others), sorted(renamed)


def is_mesh(path):
    """Whether the ending of a path is that of a mesh."""
    return os.path.splitext(path)[1].lower() in ENDINGS


def _list_files(folder, beside):
    """Return path and entry of all meshes below a folder, and what else is there that does not accompany them."""
    files, others = [], []
    for path, entry, fault in _walk(folder, {os.path.realpath(path) for path in beside}):
        if is_mesh(path) and not fault:
            files.append((path, entry))
        elif os.path.splitext(path)[1].lower() not in COMPANIONS:
            others.append(f"{path} ({fault})" if fault else path)
    return files, others


def _name_models(files, folder):
    """Return the models by their ids, and the ids of those that are called after their endings too."""
    namesakes = {}
    place_of = cache(lambda inner: os.path.relpath(inner or ".", folder or "."))  # of folders there are few
    for path, entry in files:
        inner, name = os.path.split(path)
        stem = os.path.normpath(os.path.join(place_of(inner), os.path.splitext(name)[0]))
        namesakes.setdefault(make_model_id(stem), []).append((path, entry))
    models, renamed = {}, []
    for name, group in namesakes.items():
        for path, entry in group:
            model = name
            if len(group) > 1:
                model = make_model_id(f"{name}_{os.path.splitext(path)[1][1:]}")
                renamed.append(model)
            if model in models:
                raise CorpusError(
                    f"meshes: {models[model].path!r} and {path!r} would both be the model {model!r}; rename one of them"
                )
            models[model] = _stamp(path, entry)
    return models, renamed


def pick_models(models, only):
    """Return the models whose ids match.

    Parameters
    ----------
    models : dict of str to InputFile
    only : str, list of str, or None
        Ids, or patterns with `*`, `?` and `[...]`, of which one must match; None matches all.

    Raises
    ------
    CorpusError
        When a pattern matches none; names the ids that are near.
    """
    if only is None:
        return models
    picked = set()
    for pattern in [only] if isinstance(only, str) else only:
        matching = match_models(models, pattern)
        if not matching:
            raise CorpusError(f"only: {pattern!r} matches none of {len(models)} models; {tell_near(pattern, models)}")
        picked.update(matching)
    return {model: mesh for model, mesh in models.items() if model in picked}


def match_models(models, pattern):
    """List the model of this id, or else those whose ids match the pattern."""
    return [pattern] if pattern in models else fnmatch.filter(models, pattern)


def tell_near(word, words):
    """Say which of some words are near to one that is not among them, or how they begin."""
    near = difflib.get_close_matches(word.strip("*"), words, n=3, cutoff=0.5)
    if near:
        return f"did you mean {' or '.join(map(repr, near))}?"
    first = sorted(words)
    return f"there are {', '.join(map(repr, first[:3]))}{' ...' if len(first) > 3 else ''}"


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
