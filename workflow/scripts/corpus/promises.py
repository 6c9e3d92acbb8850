"""Promises: a status table vouches for files that Snakemake does not track.

Of every model it holds a stamp: a digest of the model's key, and of name, size
and time of the receipt and of every output. Whether files are still those that
the table was written for takes no more than a look at their folder.
"""

import hashlib
import os
from array import array
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import chain

import pyarrow as pa
import pyarrow.parquet as pq

from .layout import MODELS_FOLDER, MODELS_TABLE, MODELS_TEXT, STATUS_FOLDER, STATUS_SCHEMA, line_behind, line_to
from .receipts import receipt_name, valid_receipt
from .whole_files import sync

ABSENT = (-1, -1)


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
    return [row | {"stamp": _stamp(row, _stat_files(row["model"]), receipt_name(stage), *outputs)} for row in rows]


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
        Take all for broken, so that every file is digested: a stage takes over nothing by its size and time.

    Returns
    -------
    list of str
        Paths of status tables, none of which stands behind another, and of the table of models.
    """
    collected = MODELS_TABLE.exists()
    with ThreadPoolExecutor() as threads:  # half of it is waiting for the system to tell of files
        broken = list(threads.map(partial(_find_first_broken, outputs, verify, collected), *zip(*batches.items())))
    return [*chain(*broken), *find_altered(MODELS_TABLE, MODELS_TEXT)]


def _find_first_broken(outputs, verify, collected, batch, members):
    """Return the paths of a batch's broken tables, none behind another; any counts if models were `collected`."""
    paths = {stage: STATUS_FOLDER / stage / f"{batch}.parquet" for stage in outputs}
    tables = {stage: _read_promises(path, members) for stage, path in paths.items()}
    stages = set(outputs if verify else ()).union(*(_broken_stages(model, tables, outputs) for model in members))
    return [
        str(paths[first])
        for first in (stage for stage in outputs if stages.intersection(line_to(stage)) == {stage})
        if collected or any(paths[stage].exists() for stage in line_behind(first) if stage in paths)
    ]


def find_altered(path, *more):
    """Return, in a list, the path of what is over all models where it is there and altered, itself or more; else []."""
    names = [file.name for file in (path, *more)]
    return [str(path)] if path.exists() and not valid_receipt(path.parent, path.stem, "", names) else []


def _read_promises(path, members):
    """Return key, status and stamp of every model of a status table; None where it is not that of these models."""
    try:
        table = pq.ParquetFile(path).read()
    except (OSError, ValueError, pa.ArrowException):
        return None
    if not table.schema.equals(STATUS_SCHEMA) or sorted(table["model"].to_pylist()) != members:
        return None
    return {row["model"]: row for row in table.select(["model", "key", "status", "stamp"]).to_pylist()}


def _broken_stages(model, tables, outputs):
    """Yield the stages that lack their table or, of this model, are not as it says."""
    files = _stat_files(model)
    for stage, rows in tables.items():
        row = rows and rows[model]
        names = receipt_name(stage), *outputs[stage]
        if row is None or row["status"] == "failed" or row["stamp"] != _stamp(row, files, *names):
            yield stage


def _stamp(row, files, *names):
    """Return the stamp of a model: of its key, and of size and time of these files, where they are there."""
    numbers = array("q", [number for name in names for number in files.get(name, ABSENT)])
    told = f"{row['status']} {row['key']} ".encode() + numbers.tobytes()
    return hashlib.blake2b(told, digest_size=16).hexdigest()


def _stat_files(model):
    """Return size and time of every file in a model's folder, as far as there is one."""
    files = {}
    try:
        with os.scandir(MODELS_FOLDER / model) as entries:
            for entry in entries:
                try:
                    stat = entry.stat()
                except OSError:  # a link to nothing
                    continue
                files[entry.name] = stat.st_size, stat.st_mtime_ns
    except OSError:
        pass
    return files
