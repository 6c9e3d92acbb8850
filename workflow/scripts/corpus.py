"""The corpus: which meshes there are, how they fall into batches, what is out of date.

Everything here is plain Python over names, sizes and times of files, cheap at
ten thousand meshes, and knows nothing of Snakemake.
"""

import hashlib
import math
import os
from dataclasses import dataclass
from pathlib import Path

from batches import MODELS_FOLDER, STAGES, receipt_name
from storage import read_json

ENDINGS = (".stl", ".obj", ".ply", ".off", ".glb", ".gltf", ".3mf", ".step", ".stp")
# What lies beside meshes and belongs to them: materials, textures, buffers, notes.
COMPANIONS = (".mtl", ".bin", ".png", ".jpg", ".jpeg", ".md", ".txt", ".csv", ".json", ".yaml")
STATUS_FOLDER = Path("results/status")
MODELS_TABLE = Path("results/corpus/models.parquet")
LARGE_MESH = 16 * 2**20  # bytes; a third of a million faces as binary STL
FEW_BATCHES = 8  # a small corpus is spread over about so many, before batches fill up
MANY_BATCHES = 256  # a large one over no more: each costs eight jobs to plan and to start
LONGEST_ID = 180  # bytes; file systems end at 255 and scratch names need some


class CorpusError(ValueError):
    """The mesh folder cannot be used as it is; the text says why and what cures it."""


@dataclass(frozen=True)
class MeshFile:
    """One input file."""

    path: str
    size: int
    mtime_ns: int


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
    models : dict of str to MeshFile, sorted by model id
    others : list of str
        Files that are neither meshes nor known to accompany them.

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
    for path, entry in _walk(folder, skipped, set()):
        stem, ending = os.path.splitext(path)
        if ending.lower() not in ENDINGS:
            others += [path] if ending.lower() not in COMPANIONS else []
            continue
        if "{" in path or "}" in path:  # Snakemake would read a wildcard
            raise CorpusError(f"meshes: the path {path!r} holds a brace; rename the file or its folder")
        model = make_model_id(os.path.relpath(stem, folder))
        if model in models:
            raise CorpusError(
                f"meshes: {models[model].path!r} and {path!r} would both be the model {model!r}; rename one of them"
            )
        stat = entry.stat()
        models[model] = MeshFile(path, stat.st_size, stat.st_mtime_ns)
    if not models:
        raise CorpusError(
            f"meshes: the folder {folder!r} holds no mesh; put files there that end in {', '.join(ENDINGS)}"
        )
    return dict(sorted(models.items())), sorted(others)


def _walk(folder, skipped, seen):
    """Yield (path, entry) of the files below `folder`, hidden ones left out, links followed."""
    real = os.path.realpath(folder)
    if real in skipped or real in seen:
        return
    seen = seen | {real}  # of this branch only: a link to a sibling is fine, one to an ancestor is a loop
    with os.scandir(folder) as entries:
        for entry in sorted(entries, key=lambda entry: entry.name):
            if entry.name.startswith("."):
                continue
            if entry.is_dir():
                yield from _walk(entry.path, skipped, seen)
            elif entry.is_file():
                yield entry.path, entry


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


# --------------------------------------------------------------------------
# Batches


def form_batches(models, size):
    """Deal the models out to batches of about `size`.

    A model's batch depends on its id and on the number of batches alone, and
    that number is a power of two: adding a mesh leaves the others where they
    are, until the corpus has grown by a factor. A large mesh has a batch of
    its own. A small corpus makes smaller batches, so that every core has work,
    and a large one larger batches, so that planning stays short.

    Returns a dict of batch name to list of model ids, both sorted.
    """
    shared = [model for model, mesh in models.items() if mesh.size <= LARGE_MESH]
    count = _count_batches(len(shared), size)
    batches = {}
    for model in models:
        place = _digest(model)
        if models[model].size > LARGE_MESH:
            name = f"alone-{place[:12]}"
        else:
            name = f"{int(place[:16], 16) * count >> 64:0{len(str(count - 1))}d}of{count}"
        batches.setdefault(name, []).append(model)
    return {name: sorted(batches[name]) for name in sorted(batches)}


def _count_batches(n_models, size):
    """Return the power of two nearest (by ratio) to the wanted number of batches."""
    wanted = min(max(n_models / size, min(n_models, FEW_BATCHES), 1), MANY_BATCHES)
    return 2 ** round(math.log2(wanted))


def describe_meshes(models, members):
    """Return what tells whether a batch's meshes are the same files: a digest of ids, sizes and times.

    Snakemake notices a newer file by itself, but not one replaced by an
    older one, as unpacking an archive does.
    """
    return _digest(repr([(model, models[model]) for model in members]))


def _digest(text):
    return hashlib.blake2b(text.encode(errors="surrogateescape"), digest_size=16).hexdigest()


# --------------------------------------------------------------------------
# Promises: a status table vouches for files that Snakemake does not track


def find_broken_promises(batches, outputs):
    """Return, of every batch, the first status table that promises what is not there.

    A table is broken when a file of one of its models is gone. It is so, too,
    when one of its models failed, as a failure is tried again in every run,
    and when it is itself missing though later ones exist, which Snakemake
    would pass over.

    Parameters
    ----------
    batches : dict of str to list of str
        Models by batch.
    outputs : dict of str to tuple of str
        Names of the outputs per model, by stage.

    Returns
    -------
    list of str
        Paths of status tables, at most one per batch.
    """
    tables = {stage: _names(STATUS_FOLDER / stage) for stage in STAGES}
    collected = MODELS_TABLE.exists()
    broken = []
    for batch, members in batches.items():
        made = [f"{batch}.parquet" in tables[stage] for stage in STAGES]
        stages = [_first_broken_stage(model, made, outputs) for model in members]
        first = min(stages, default=len(STAGES))
        if first < len(STAGES) and (collected or any(made[first:])):
            broken.append(str(STATUS_FOLDER / STAGES[first] / f"{batch}.parquet"))
    return broken


def _first_broken_stage(model, made, outputs):
    """Return the number of the first stage that lacks its table or, of this model, a file."""
    folder = MODELS_FOLDER / model
    present = _names(folder)
    for number, stage in enumerate(STAGES):
        if not made[number] or receipt_name(stage) not in present:
            return number
        if not present.issuperset(outputs[stage]):
            receipt = read_json(folder / receipt_name(stage))
            rejected = receipt["status"] == "rejected" and present.issuperset(receipt["outputs"])
            # Of a rejected model later stages leave no file: their tables alone are asked for.
            return [*made, False].index(False) if rejected else number
    return len(STAGES)


def _names(folder):
    try:
        return set(os.listdir(folder))
    except FileNotFoundError:
        return set()
