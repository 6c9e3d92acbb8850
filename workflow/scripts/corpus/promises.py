"""Promises: a status table vouches for files that Snakemake does not track.

Of every model it holds a stamp: a digest of the model's key, and of name, size
and time of the receipt and of every output. Whether files are still those that
the table was written for takes no more than a look at their folder.
"""

import hashlib
import os
import shutil
from contextlib import suppress
from functools import partial
from itertools import chain
from pathlib import Path
from struct import Struct

import pyarrow as pa
import pyarrow.parquet as pq

from .layout import (
    MODELS_FOLDER,
    MODELS_TABLE,
    MODELS_TEXT,
    STATUS_FOLDER,
    STATUS_SCHEMA,
    line_behind,
    line_to,
    read_status,
)
from .receipts import receipt_name, seal_table, valid_receipt
from .shares import map_shared
from .whole_files import place_whole, sync

KEPT = Path(".snakemake/reebslice_status")  # status tables as they were last; Snakemake removes one that is due
MANY = 1000  # models, from which on to look after them takes longer than to start processes that share it
SIZE_AND_TIME = Struct("=qq").pack
ABSENT = SIZE_AND_TIME(-1, -1)


def vouch(stage, rows, outputs):
    """Return the rows of a status table with the stamps of what they are about, once that is on the disk.

    Parameters
    ----------
    stage : str
    rows : list of dict
        Without `stamp`.
    outputs : sequence of str
        Names of the stage's outputs.
    """
    if MODELS_FOLDER.is_dir():
        sync(MODELS_FOLDER)
    names = _name_files({stage: outputs})[stage]
    return [row | {"stamp": _stamp_row(row, names)} for row in rows]


def keep_promises(path):
    """Keep a copy of a status table for the next job that writes it; where it cannot be kept, that one reads more."""
    kept = KEPT / path.parent.name / path.name
    with suppress(OSError):
        with place_whole(kept) as scratch:
            shutil.copyfile(path, scratch)
        seal_table(kept)


def recall_standing(path, keys, outputs):
    """Return, by model, the rows of a status table, as it was last, that still stand: nothing failed or is altered.

    Parameters
    ----------
    path : Path
        Of the status table, which need not be there.
    keys : dict of str to str
        Content key that a model's row has to have.
    outputs : sequence of str
        Names of the stage's outputs.
    """
    stage = path.parent.name
    if not valid_receipt(KEPT / stage, path.stem, "", [path.name]):
        return {}
    names, rows = _name_files({stage: outputs})[stage], read_status(KEPT / stage / path.name)
    told = [row for row in rows if row["status"] != "failed" and row["key"] == keys.get(row["model"])]
    return {row["model"]: row for row in told if row["stamp"] == _stamp_row(row, names)}


def find_blocked_folders(stages):
    """Return the paths at which a folder of results has to be, and something else is.

    Parameters
    ----------
    stages : iterable of str
    """
    logs = STATUS_FOLDER.with_name("logs")
    tops = [STATUS_FOLDER.parent, STATUS_FOLDER, logs, MODELS_FOLDER, MODELS_TABLE.parent]
    folders = [*tops, *(top / stage for top in (STATUS_FOLDER, logs) for stage in stages)]
    return [str(folder) for folder in folders if folder.exists() and not folder.is_dir()]


def find_broken_promises(batches, outputs, verify=False):
    """Return the tables that promise what is not there: of every batch the first ones, and that of all models.

    A status table is broken when it cannot be read, or a file of one of its
    models is gone or was altered. It is so, too, when one of its models failed,
    as a failure is tried again in every run, and when it is itself missing
    though later ones exist, which Snakemake would pass over.

    Parameters
    ----------
    batches : dict of str to list of str
        Models by batch.
    outputs : dict of str to tuple of str
        Names of the outputs per model, by stage; these stages are looked at.
    verify : bool
        Take all for broken, and forget what was kept of the tables, so that every file is digested: a stage takes over
        nothing by its size and time.

    Returns
    -------
    list of str
        Paths of status tables, none of which stands behind another, and of the table of models.
    """
    if verify:
        shutil.rmtree(KEPT, ignore_errors=True)
    look = partial(_find_first_broken, outputs, verify, MODELS_TABLE.exists())
    processes = None if sum(map(len, batches.values())) >= MANY else 1
    return [*chain(*map_shared(look, list(batches.items()), processes)), *find_altered(MODELS_TABLE, MODELS_TEXT)]


def _find_first_broken(outputs, verify, collected, named):
    """Return the paths of a batch's broken tables, none behind another; any counts if models were `collected`.

    named : name and models of the batch.
    """
    batch, members = named
    paths = {stage: STATUS_FOLDER / stage / f"{batch}.parquet" for stage in outputs}
    tables = [(stage, names, _read_promises(paths[stage], members)) for stage, names in _name_files(outputs).items()]
    stages = set(outputs if verify else ()).union(*(_broken_stages(model, tables) for model in members))
    return [
        str(paths[first])
        for first in (stage for stage in outputs if stages.intersection(line_to(stage)) == {stage})
        if collected or any(paths[stage].exists() for stage in line_behind(first) if stage in paths)
    ]


def find_altered(path, *more):
    """Return, in a list, the path of what is over all models where it is there and altered, itself or more; else []."""
    names = [file.name for file in (path, *more)]
    return [str(path)] if path.exists() and not valid_receipt(path.parent, path.stem, "", names) else []


def _name_files(outputs):
    """Return what a stamp tells of, in this order: of each stage its receipt and its outputs."""
    return {stage: (receipt_name(stage), *outputs[stage]) for stage in outputs}


def _read_promises(path, members):
    """Return key, status and stamp of every model of a status table; None where it is not that of these models."""
    try:
        table = pq.ParquetFile(path).read(use_threads=False)
    except (OSError, ValueError, pa.ArrowException):
        return None
    if not table.schema.equals(STATUS_SCHEMA) or sorted(table["model"].to_pylist()) != members:
        return None
    models, *told = (table[name].to_pylist() for name in ("model", "key", "status", "stamp"))
    return dict(zip(models, zip(*told)))


def _broken_stages(model, tables):
    """Yield the stages that lack their table or, of this model, are not as it says.

    tables : stage, names of its files, and rows by model or None, of each table.
    """
    files = _stat_files(model)
    for stage, names, rows in tables:
        key, status, stamp = rows[model] if rows else ("", "failed", "")
        if status == "failed" or stamp != _stamp(key, status, files, names):
            yield stage


def _stamp_row(row, names):
    return _stamp(row["key"], row["status"], _stat_files(row["model"]), names)


def _stamp(key, status, files, names):
    """Return the stamp of a model: of its key, and of size and time of these files, where they are there."""
    told = b"".join([f"{status} {key} ".encode(), *[files.get(name, ABSENT) for name in names]])
    return hashlib.blake2b(told, digest_size=16).hexdigest()


def _stat_files(model):
    """Return size and time, as bytes, of every file in a model's folder, as far as there is one."""
    files = {}
    try:
        place = os.open(MODELS_FOLDER / model, os.O_RDONLY | os.O_DIRECTORY)
    except OSError:
        return files
    try:
        with os.scandir(place) as entries:  # of an open folder, so that the system need not find it for every file
            for entry in entries:
                try:
                    stat = entry.stat()
                except OSError:  # a link to nothing
                    continue
                files[entry.name] = SIZE_AND_TIME(stat.st_size, stat.st_mtime_ns)
    except OSError:
        pass
    finally:
        os.close(place)
    return files
