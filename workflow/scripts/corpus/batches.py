"""Batches of models, and the work, memory and time that one needs."""

import hashlib

LARGE_MESH = 64 * 2**20  # bytes; 1.3 million faces as binary STL, beside which starting a process is little
SMALL_MESH = 2**19  # bytes; so much more of a mesh is as much work again as the smallest mesh
FEW_BATCHES = 4  # a small corpus is spread over about so many, before batches fill up
LEAST_WORK = 8  # in a batch, below which more batches cost more than they spare


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
    models : dict of str to InputFile
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
            batches[batch_alone(model)] = [model]
        else:
            shared[f"{int(_digest(model)[:16], 16):064b}"] = model
    work = {place: _work(models[model]) for place, model in shared.items()}
    for prefix, places in _split_by_prefix("", sorted(shared), work, limit):
        batches[f"batch-{prefix or 'all'}"] = sorted(shared[place] for place in places)
    return dict(sorted(batches.items()))


def batch_alone(model):
    """Return the name of the batch of this model alone."""
    return f"alone-{_digest(model)[:12]}"


def set_apart(batches, only):
    """Return the batches of a part of the corpus under names of their own, so that those of the whole stay as they are.

    Parameters
    ----------
    batches : dict of str to list of str
    only : str, list of str, or None
        What picked the part; None is the whole.
    """
    part = _digest(repr([only] if isinstance(only, str) else only))[:12]
    named = {name if only is None or name.startswith("alone-") else f"{name}-{part}": batches[name] for name in batches}
    return dict(sorted(named.items()))


def _find_limit(models, size, most):
    """Return the most work in one batch: `size` by a power of two, so that it rarely changes.

    A small corpus makes smaller batches, so that every core has work, and a
    large one larger batches, so that planning and starting stay short.
    """
    limit, total = float(size), sum(min(_work(mesh), size) for mesh in models.values())
    while total > most * limit:
        limit *= 2
    while total < min(FEW_BATCHES, most) * limit and limit > LEAST_WORK:
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
    """Return the memory in MB for any stage of a batch: what libraries take, and a share by its largest mesh.

    On a cluster two processes of Snakemake belong to the job, which know all models.
    """
    return 1000 + len(models) / 500 + 30 * max(models[model].size for model in members) / 2**20


def predict_minutes(models, members):
    """Return the minutes that suffice for any stage of a batch on a slow machine, compiling included."""
    return 10 + predict_work(models, members) / 30


def predict_gathering(count):
    """Return the memory in MB and the minutes that suffice to gather a table over `count` models."""
    return 1000 + count / 50, 10 + count / 2000


def describe_meshes(models, members):
    """Return what tells whether a batch's meshes are the same files: a digest of ids, sizes and times.

    Snakemake notices a newer file by itself, but not one replaced by an
    older one, as unpacking an archive does.
    """
    return _digest(repr([(model, models[model]) for model in members]))


def _digest(text):
    return hashlib.blake2b(text.encode(errors="surrogateescape"), digest_size=16).hexdigest()
