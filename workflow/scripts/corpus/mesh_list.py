"""The meshes of a run, for the processes of Snakemake in its jobs.

On a cluster every job is a Snakemake that parses the workflow anew. Did it look
at the mesh folder, too, a mesh that was put there since would make other
batches, and the batch that the job is about might be none of them. So a run
that begins leaves a list of what it found, and its jobs read that.
"""

import json
from dataclasses import astuple
from pathlib import Path

from .discovery import InputFile
from .storage import write_text

MESH_LIST = Path(".snakemake/reebslice_meshes.json")


def keep_mesh_list(models):
    """Leave the list of a run that begins.

    Parameters
    ----------
    models : dict of str to InputFile
        All that :func:`.discovery.find_models` found.
    """
    MESH_LIST.parent.mkdir(exist_ok=True)
    write_text(MESH_LIST, json.dumps({model: astuple(mesh) for model, mesh in models.items()}))


def recall_mesh_list():
    """Return the models as they were found when the run began, or None where no run has left a list."""
    try:
        entries = json.loads(MESH_LIST.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return {
        model: InputFile(path, size, time, tuple(map(tuple, companions)))
        for model, (path, size, time, companions) in entries.items()
    }
