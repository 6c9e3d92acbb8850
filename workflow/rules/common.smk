# What the rules stand on: the checked configuration, the models, their batches
# and the digests of the code. The logic is in workflow/scripts/corpus/; here
# it meets Snakemake.

import os
import shutil
import sys
import tempfile
import time
from pathlib import Path

import yaml
from snakemake.exceptions import WorkflowError
from snakemake.logging import logger

WORKFLOW = Path(workflow.basedir) / "workflow"
SCRIPTS = WORKFLOW / "scripts"
sys.path.insert(0, str(SCRIPTS))

from corpus.batches import (
    describe_meshes,
    form_batches,
    predict_gathering,
    predict_memory,
    predict_minutes,
    predict_work,
)
from corpus.code_digest import compiled_code_folder, digest_code, read_outputs
from corpus.configuration import ConfigError, check_config, restore_texts
from corpus.discovery import CorpusError, find_models
from corpus.layout import MODELS_TABLE, STAGES, chosen_stages, line_behind
from corpus.model_table import count_models
from corpus.process import find_full_disks, find_last_words
from corpus.promises import find_broken_promises
from corpus.receipts import forget_stage
from corpus.shared_files import check_file_sharing

os.environ.setdefault("NUMBA_CACHE_DIR", str(compiled_code_folder(SCRIPTS / "reebslice")))

STARTED = time.time()
TOLD = 3  # so many faults of a kind are told at the end, and the number of all

# Configuration ---------------------------------------------------------------

try:
    check_file_sharing(workflow.storage_settings)
    SCHEMA = yaml.safe_load((WORKFLOW / "schemas" / "config.schema.yaml").read_text())
    config = check_config(restore_texts(config, workflow.config_settings.config_args, SCHEMA), SCHEMA)
except ConfigError as error:
    raise WorkflowError(str(error)) from None

# Models and batches ----------------------------------------------------------

try:
    MODELS, OTHER_FILES = find_models(config["meshes"])
except CorpusError as error:
    raise WorkflowError(str(error)) from None

BATCHES = form_batches(MODELS, **config["batches"])
CHOSEN = chosen_stages(config)
CODE = {stage: digest_code(SCRIPTS / f"{stage}.py") for stage in (*STAGES, "collect_models")}


wildcard_constraints:
    batch=r"batch-(all|[01]+)|alone-[0-9a-f]+",


def withdraw_table(table):
    """Remove what is in a table's place, so that Snakemake has it made again."""
    try:
        shutil.rmtree(table) if os.path.isdir(table) else Path(table).unlink(missing_ok=True)
    except OSError as fault:
        raise WorkflowError(f"{table} is not what it should be, and cannot be removed: {fault.strerror}") from None


# A status table stands for the files of its models, which Snakemake does not
# track. One that promises more than there is, is withdrawn and asked for
# again by the default target, so its batch runs, restores what is missing and passes over
# the rest.
WITHDRAWN = []
if workflow.is_main_process:
    OUTPUTS = {stage: read_outputs(SCRIPTS / f"{stage}.py") for stage in CHOSEN}
    WITHDRAWN = find_broken_promises(BATCHES, OUTPUTS, config["verify"])
    for table in WITHDRAWN:
        withdraw_table(table)
    if OTHER_FILES:
        logger.warning(
            f"{len(OTHER_FILES)} names in {config['meshes']} are no meshes that can be read "
            f"and are left out: {', '.join(OTHER_FILES[:3])}{' ...' if len(OTHER_FILES) > 3 else ''}"
        )

# Functions for the rules -----------------------------------------------------


def paths_of(wildcards):
    """Mesh files of a batch, in the order of models_of."""
    return [MODELS[model].path for model in BATCHES[wildcards.batch]]


def inputs_of(wildcards):
    """Those of them, and of the files that they name, that Snakemake can take as inputs.

    It reads {x} as a wildcard and <x> as a path variable. Of the others
    stamp_of tells when they change.
    """
    meshes = [MODELS[model] for model in BATCHES[wildcards.batch]]
    companions = [path for mesh in meshes for path, size, _ in mesh.companions if size is not None]
    return [path for path in paths_of(wildcards) + companions if not set("{}<>") & set(path)]


def models_of(wildcards):
    """Ids of a batch's models."""
    return BATCHES[wildcards.batch]


def stamp_of(wildcards):
    """What changes when one of the batch's mesh files is another."""
    return describe_meshes(MODELS, BATCHES[wildcards.batch])


def memory_of(wildcards, attempt):
    """Memory for one stage of a batch, in MB."""
    return int(predict_memory(MODELS, BATCHES[wildcards.batch]) * attempt)


def runtime_of(wildcards, attempt):
    """Time for one stage of a batch, in minutes."""
    return int(predict_minutes(MODELS, BATCHES[wildcards.batch]) * attempt)


def priority_at(stage):
    """Function that tells a batch's priority at this stage: about the work left of it.

    So all batches end at about the same time. In any order, one begun last
    goes through its stages alone while other cores have nothing to do.
    """
    left = len(line_behind(stage)) + 1  # the last stages, which take the longest, count as one more
    return lambda wildcards: left * predict_work(MODELS, BATCHES[wildcards.batch])


def status_tables():
    """Status tables of all batches, in the order of BATCHES, by stage."""
    return {stage: [f"results/status/{stage}/{batch}.parquet" for batch in BATCHES] for stage in CHOSEN}


def gathering_memory(wildcards, attempt):
    """Memory for a table over all models, in MB."""
    return int(predict_gathering(len(MODELS))[0] * attempt)


def gathering_runtime(wildcards, attempt):
    """Time for a table over all models, in minutes."""
    return int(predict_gathering(len(MODELS))[1] * attempt)


# The beginning and the end of a run ------------------------------------------


def keep_going():
    """Have a job that is killed stop nothing but what is behind it, as --keep-going does."""
    workflow.scheduler.keepgoing = True


def drop_rate_limit():
    """Let Snakemake start jobs on this machine as cores get free, whatever their number in a second.

    To keep a limit it looks over all ready jobs in every second once for each
    job that has ended so far, which takes a core to itself on a large corpus
    (https://github.com/snakemake/snakemake/pull/3744). Jobs here are few and long.
    """
    if workflow.local_exec and hasattr(workflow.scheduler, "job_rate_limiter"):
        workflow.scheduler.job_rate_limiter = None


def forget_forced():
    """Have the stages that --forceall or --forcerun names compute what receipts would spare them."""
    settings = workflow.dag_settings
    for stage in STAGES:
        if settings.forceall or stage in settings.forcerun:
            forget_stage(MODELS, stage)


def close_run():
    """Say what came out; end with an error where models failed, and tell of the first why."""
    table = MODELS_TABLE
    if not table.exists():
        return
    counts, reasons = count_models(table)
    total = sum(counts.values())
    logger.info(f"{counts['ok']} of {total} models done: results/models/, {table}")
    if counts["rejected"]:
        logger.warning(
            f"{counts['rejected']} rejected: the reasons are in {table} (column reason) "
            "and in results/models/*/inspection.json"
        )
    if counts["failed"]:
        raise WorkflowError(
            f"{counts['failed']} of {total} models FAILED, by no fault found in their meshes. The others are complete. "
            f"The reasons are in {table} (column reason), the tracebacks in results/logs/. The next run tries the "
            f"failed ones again.\n{list_first(reasons)}"
        )


def explain_error(log):
    """Say what kept the run from its end, and what it leaves behind."""
    words = find_last_words("results/logs", STARTED)
    told = [f"{path}: {word}" for path, word in words.items()] + find_full_disks([".", tempfile.gettempdir()])
    logger.error(
        "The run did not finish. Models that were completed are kept; start it again, as it is, to go on. "
        f"{MODELS_TABLE}, if it is there, is that of an earlier run. "
        f"The log is {', '.join(map(str, log)) or 'not written'}\n{list_first(told)}"
    )


def list_first(lines):
    """The first of some lines, indented, and how many more there are."""
    more = [f"and {len(lines) - TOLD} more"] if len(lines) > TOLD else []
    return "\n".join(f"  {line}" for line in lines[:TOLD] + more)
