"""Files of models as targets of a run.

Snakemake does not track the files of a model; the status table of the stage
that writes them stands for them. So a file that is asked for is asked for by
the status table of the batch of its model alone. The batches of the whole
corpus stay as they are, and what a run over it finds made it passes over.
"""

import os
from pathlib import Path
from typing import NamedTuple

from .batches import batch_alone
from .discovery import CorpusError, tell_near
from .layout import BEFORE, MODELS_FOLDER, SIDE_STAGES, STATUS_FOLDER, line_behind, line_to, read_status
from .promises import find_broken_promises


class Wish(NamedTuple):
    """A file, or the folder, of a model that is asked for, and the stage whose status table stands for it."""

    path: str
    model: str
    stage: str

    @property
    def status(self):
        """Path of that status table."""
        return status_path(self.stage, batch_alone(self.model))


def status_path(stage, batch):
    """Return the path of a status table."""
    return str(STATUS_FOLDER / stage / f"{batch}.parquet")


def read_wishes(targets, models, outputs, chosen):
    """Return what of the targets of a run is of models, and the other targets.

    Parameters
    ----------
    targets : iterable of str
        Rules and paths.
    models : container of str
    outputs : dict of str to sequence of str
        Names of the files per model, by stage.
    chosen : sequence of str
        Stages that a model goes through where all its files are asked for.

    Returns
    -------
    wishes : list of Wish
    others : list of str

    Raises
    ------
    CorpusError
        When there is no such model, or no stage leaves such a file.
    """
    wishes, others = [], []
    for target in sorted(targets):
        try:
            inside = Path(os.path.relpath(target)).relative_to(MODELS_FOLDER).parts
        except ValueError:
            inside = ()
        if not inside:
            others.append(target)
            continue
        model, *file = inside
        if model not in models:
            raise CorpusError(f"{target}: there is no model {model!r}; {tell_near(model, models)}")
        name = "/".join(file)
        last = [stage for stage in chosen if stage not in map(BEFORE.get, chosen)]
        stages = [stage for stage in outputs if name in outputs[stage]] if file else last
        if not stages:
            names = [name for stage in outputs for name in outputs[stage]]
            raise CorpusError(f"{target}: no stage writes a file {name!r}; {tell_near(name, names)}")
        wishes += [Wish(str(MODELS_FOLDER.joinpath(*inside)), model, stage) for stage in stages]
    return wishes, others


def withdraw_outdated(wishes, outputs, verify):
    """Remove the status tables that do not stand for what is asked for, so that Snakemake has them made again.

    They are those that promise what is not there, with those behind them,
    and those by which there is none, so that the run tells why once more.
    """
    for wish in wishes:
        on_the_way = {stage: outputs[stage] for stage in line_to(wish.stage)}
        for table in map(Path, find_broken_promises({batch_alone(wish.model): [wish.model]}, on_the_way, verify)):
            for stage in line_behind(table.parent.name) if table.parent.name in on_the_way else ():
                (STATUS_FOLDER / stage / table.name).unlink(missing_ok=True)
        if Path(wish.status).exists() and _tell_unmade(wish):
            Path(wish.status).unlink()


def find_unmade(wishes):
    """Return a sentence for each file that is asked for and was not made: its path and why."""
    return [sentence for sentence in map(_tell_unmade, wishes) if sentence]


def _tell_unmade(wish):
    """Return a sentence on why the file is not there by the status table that stands for it, or ''."""
    if not Path(wish.status).exists():
        return f"{wish.path}: {wish.stage} was left out, as by --until or --omit-from"
    (row,) = read_status(wish.status)
    refused_aside = row["status"] == "rejected" and wish.stage in SIDE_STAGES and Path(wish.path).is_dir()
    made = row["status"] == "ok" or refused_aside or Path(wish.path).is_file()
    return "" if made else f"{wish.path}: {row['reason']}"


def redirect_targets(workflow, translate):
    """Have Snakemake plan the run for other targets than those given.

    It tells a workflow what is asked for only after it has read the Snakefiles.

    Parameters
    ----------
    workflow : snakemake.workflow.Workflow
    translate : function of a set of str
        Returns the set of targets to plan for.
    """
    prepare = workflow._prepare_dag

    def prepare_translated(*arguments, **settings):
        workflow.dag_settings.targets = translate(workflow.dag_settings.targets)
        return prepare(*arguments, **settings)

    workflow._prepare_dag = prepare_translated
