"""The corpus: which meshes there are, how they fall into batches, what is out of date.

Everything here is plain Python over names, sizes and times of files, cheap at
ten thousand meshes, and knows nothing of Snakemake.
"""

import hashlib
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
LARGE_MESH = 64 * 2**20  # bytes; 1.3 million faces as binary STL, beside which starting a process is little
SMALL_MESH = 2**19  # bytes; so much more of a mesh is as much work again as the smallest mesh
FEW_BATCHES = 4  # a small corpus is spread over about so many, before batches fill up
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


def form_batches(models, size, most):
    """Deal the models out to batches of about equal work.

    A model's batch is the shortest beginning of the binary digest of its id
    under which there is no more work than :func:`_find_limit` allows. So a
    mesh more or less changes one batch, or makes two of one, and no other,
    until the corpus has grown by a factor. A large mesh has a batch of its own.

    Parameters
    ----------
    models : dict of str to MeshFile
    size : int
        Models of a kilobyte that share a process; a large mesh counts as
        many of them.
    most : int
        About how many batches there are at most, large meshes not counted.

    Returns
    -------
    dict of str to list of str
        Ids of models by name of the batch, both sorted.
    """
    limit = _find_limit(models, size, most)
    batches, shared = {}, {}
    for model, mesh in models.items():
        if mesh.size > LARGE_MESH or _work(mesh) > limit:
            batches[f"alone-{_digest(model)[:12]}"] = [model]
        else:
            shared[f"{int(_digest(model)[:16], 16):064b}"] = model
    work = {place: _work(models[model]) for place, model in shared.items()}
    for prefix, places in _split_by_prefix("", sorted(shared), work, limit):
        batches[f"batch-{prefix or 'all'}"] = sorted(shared[place] for place in places)
    return dict(sorted(batches.items()))


def _find_limit(models, size, most):
    """Return the most work in one batch: `size` by a power of two, so that it rarely changes.

    A small corpus makes smaller batches, so that every core has work, and a
    large one larger batches, so that planning and starting stay short.
    """
    limit, total = float(size), sum(min(_work(mesh), size) for mesh in models.values())
    while total > most * limit:
        limit *= 2
    while total < min(FEW_BATCHES, most) * limit and limit > 2:
        limit /= 2
    return limit


def _work(mesh):
    """Return about how much work a mesh is, as a multiple of that of the smallest."""
    return 1 + mesh.size / SMALL_MESH


def _split_by_prefix(prefix, places, work, limit):
    """Yield (prefix, places) of the largest groups of equal beginning whose work is within the limit."""
    if not places:
        return
    if sum(work[place] for place in places) <= limit or len(places) == 1:
        yield prefix, places
        return
    for bit in "01":
        longer = prefix + bit
        yield from _split_by_prefix(longer, [place for place in places if place.startswith(longer)], work, limit)


def predict_work(models, members):
    """Return about how much work a batch is, as a multiple of that of the smallest mesh."""
    return sum(_work(models[model]) for model in members)


def predict_memory(models, members):
    """Return the memory in MB for any stage of a batch: what the libraries take, and a share by its largest mesh."""
    return 600 + 30 * max(models[model].size for model in members) / 2**20


def predict_minutes(models, members):
    """Return the minutes that suffice for any stage of a batch on a slow machine, compiling included."""
    return 10 + predict_work(models, members) / 30


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
