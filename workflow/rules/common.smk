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

# This file's own place, which is not that of the main Snakefile where a workflow uses this one as a module.
WORKFLOW = Path(str(workflow.current_basedir)).parent
SCRIPTS = WORKFLOW / "scripts"
if not SCRIPTS.is_dir():
    raise WorkflowError(
        f"reebslice cannot be run from {workflow.current_basedir}, as its scripts import packages beside them: "
        "clone the repository, and name its workflow/Snakefile by a path"
    )
sys.path.insert(0, str(SCRIPTS))

from corpus.batches import (
    batch_alone,
    describe_meshes,
    form_batches,
    predict_gathering,
    predict_memory,
    predict_minutes,
    predict_work,
    set_apart,
)
from corpus.carried_files import flag_files, foretell_report, list_carried
from corpus.carried_values import describe_values
from corpus.code_digest import compiled_code_folder, digest_code, read_outputs
from corpus.configuration import (
    CONFIG_FILE,
    ConfigError,
    check_comparison,
    check_config,
    describe_sources,
    restore_texts,
)
from corpus.console import show_progress
from corpus.discovery import CorpusError, find_models, pick_models
from corpus.jobs import Job, JobError, ForkServer, wait_in_threads
from corpus.layout import (
    ASKED_FOR,
    BEFORE,
    LIKENESS_TABLES,
    MODELS_FOLDER,
    MODELS_TABLE,
    REPORT_PAGE,
    STAGES,
    chosen_stages,
    line_behind,
)
from corpus.mesh_list import keep_mesh_list, recall_mesh_list
from corpus.outcome import close_idle_runs, list_first, tell_outcome
from corpus.process import find_full_disks, find_last_words
from corpus.promises import find_altered, find_blocked_folders, find_broken_promises
from corpus.receipts import forget_stage
from corpus.rehearsal import MOST_COMPILERS, find_unrehearsed, rehearse
from corpus.sample_sheet import read_sheet
from corpus.shared_files import check_file_sharing
from corpus.targets import find_unmade, read_wishes, redirect_targets, withdraw_outdated

COMPILED = os.environ.setdefault("NUMBA_CACHE_DIR", str(compiled_code_folder(SCRIPTS / "reebslice")))

STARTED = time.time()
GATHERED = {
    "compare_methods": "results/corpus/comparison.parquet",
    "compare_directions": "results/corpus/directions.parquet",
}

try:
    check_file_sharing(workflow.storage_settings)
except ConfigError as error:
    raise WorkflowError(str(error)) from None

if str(workflow.modifier.modify_path("results")) != "results":
    raise WorkflowError(
        "reebslice cannot be used as a module with prefix: or replace_prefix:, which do not reach the files of the "
        "models; run it in a folder of its own by --directory, or leave them out"
    )

# Configuration ---------------------------------------------------------------

# As a module it is what the workflow that uses this one gives: its files and its command line are about itself.
IS_MAIN = workflow.modifier.is_main_snakefile()
PROGRESS = show_progress(workflow.logger_manager) if IS_MAIN and workflow.is_main_process else None
SOURCES = [WORKFLOW.parent / CONFIG_FILE]


configfile: SOURCES[0]


if IS_MAIN and CONFIG_FILE.exists() and not CONFIG_FILE.samefile(SOURCES[0]):
    SOURCES.append(CONFIG_FILE.absolute())

    configfile: SOURCES[-1]


SETTINGS = workflow.config_settings
TOLD_SOURCES = describe_sources(SOURCES, SETTINGS.configfiles, SETTINGS.config) if IS_MAIN else "the module's config"

SCHEMA = yaml.safe_load((WORKFLOW / "schemas" / "config.schema.yaml").read_text())

try:
    GIVEN = restore_texts(config, SETTINGS.config_args if IS_MAIN else (), SCHEMA)
    config = check_config(GIVEN, SCHEMA)
except ConfigError as error:
    raise WorkflowError(f"{error}\nIt was taken from {TOLD_SOURCES}.") from None

if workflow.is_main_process:
    logger.info(f"Configuration: {TOLD_SOURCES}")

# Models and batches ----------------------------------------------------------

try:
    FOUND, OTHER_FILES, RENAMED = None if workflow.is_main_process else recall_mesh_list(), [], []
    if FOUND is None:
        FOUND, OTHER_FILES, RENAMED = find_models(config["meshes"])
    MODELS = pick_models(FOUND, config["only"])
    check_comparison(config, len(MODELS))
    OWN = read_sheet(config["models"], FOUND, GIVEN, SCHEMA)  # configurations of models that have one of their own
except (ConfigError, CorpusError) as error:
    raise WorkflowError(str(error)) from None

BATCHES = set_apart(form_batches(MODELS, **config["batches"]), config["only"])
# Of any model a file can be asked for: then it has a batch of its own.
MEMBERS = {batch_alone(model): [model] for model in MODELS} | BATCHES
CHOSEN = chosen_stages(config)
# What models are compared by, and what this makes; nothing where they are not compared.
COMPARED_BY = "describe_shape" if config["similarity"]["by"] == "descriptors" else "graph_functions"
COMPARED = (
    [f"results/status/{COMPARED_BY}/{batch}.parquet" for batch in BATCHES] if config["similarity"]["find"] else []
)
LIKENESS = [str(path) for path in LIKENESS_TABLES] if COMPARED else []
REPORTS = [str(REPORT_PAGE)] if config["report"]["page"] else []
UNTOLD = ("compare", "directions", "report", "limits", "batches", "verify")  # what changes no result of all models
RUNNER = SCRIPTS / "corpus" / "stages.py"  # what runs a stage over models counts as its code
CODE = {stage: digest_code(SCRIPTS / f"{stage}.py", RUNNER) for stage in (*STAGES, *ASKED_FOR)}
CODE |= {
    name: digest_code(SCRIPTS / f"{name}.py")
    for name in ("collect_models", "compare_shapes", "report_models", *GATHERED)
}


wildcard_constraints:
    batch=r"batch-(all|[01]+)(-[0-9a-f]+)?|alone-[0-9a-f]+",


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
WISHES = []  # files of models that are asked for
if workflow.is_main_process:
    if BLOCKED := find_blocked_folders(BEFORE):
        raise WorkflowError(f"{BLOCKED[0]} has to be a folder, but is none: move it elsewhere, or delete it")
    OUTPUTS = {stage: read_outputs(SCRIPTS / f"{stage}.py") for stage in BEFORE}
    CHOSEN_OUTPUTS = {stage: OUTPUTS[stage] for stage in CHOSEN}
    WITHDRAWN = find_broken_promises(BATCHES, CHOSEN_OUTPUTS, config["verify"])
    WITHDRAWN += find_altered(REPORT_PAGE) if REPORTS else []
    for table in WITHDRAWN:
        withdraw_table(table)
    if OTHER_FILES:
        logger.warning(
            f"{len(OTHER_FILES)} names in {config['meshes']} are no meshes that can be read "
            f"and are left out: {', '.join(OTHER_FILES[:3])}{' ...' if len(OTHER_FILES) > 3 else ''}"
        )
    if RENAMED:
        logger.warning(
            f"{len(RENAMED)} meshes differ from another in the ending of their names alone, and are models called after "
            f"that too: {', '.join(RENAMED[:4])}{' ...' if len(RENAMED) > 4 else ''}"
        )
    if OWN:
        logger.info(f"{config['models']} says what is another for {len(OWN)} of {len(FOUND)} models.")
    if config["only"] is not None:
        logger.info(f"Only {len(MODELS)} of {len(FOUND)} models, as the key only says.")


def ask_for_tables(targets):
    """Translate targets: files of models into the status tables that stand for them."""
    try:
        WISHES[:], others = read_wishes(targets, MODELS, OUTPUTS, CHOSEN)
    except CorpusError as error:
        raise WorkflowError(str(error)) from None
    withdraw_outdated(WISHES, OUTPUTS, config["verify"])
    return {*others, *(wish.status for wish in WISHES)}


if workflow.is_main_process and IS_MAIN:
    redirect_targets(workflow, ask_for_tables)

UNDERWAY = foretell_report(workflow) if workflow.is_main_process else []
CAPTIONS = workflow.current_basedir.join("../report")

# Functions for the rules -----------------------------------------------------


def paths_of(wildcards):
    """Mesh files of a batch, in the order of models_of."""
    return [MODELS[model].path for model in MEMBERS[wildcards.batch]]


def inputs_of(wildcards):
    """Those of them, and of the files that they name, that Snakemake is to hold the status table against.

    That is the newest, as it would need longer for ten thousand than all else
    takes: if any is newer than the table, the newest is, and of the others
    stamp_of tells when they change. A workflow that uses this one as a module
    may have rules that make meshes, so there it is all of them. Snakemake reads
    {x} as a wildcard and <x> as a path variable, so files of such names are
    left out. In a job, a mesh that is gone by now is its model's fault, not the batch's.
    """
    meshes = [MODELS[model] for model in MEMBERS[wildcards.batch]]
    files = [(mesh.mtime_ns, mesh.path) for mesh in meshes]
    files += [(time, path) for mesh in meshes for path, size, time in mesh.companions if size is not None]
    files = [file for file in files if not set("{}<>") & set(file[1])]
    paths = [path for _, path in ([max(files)] if files and IS_MAIN else files)]
    return paths if workflow.is_main_process else [path for path in paths if os.path.exists(path)]


def models_of(wildcards):
    """Ids of a batch's models."""
    return MEMBERS[wildcards.batch]


def stamp_of(wildcards):
    """What changes when one of the batch's mesh files is another."""
    return describe_meshes(MODELS, MEMBERS[wildcards.batch])


def own_options(pick):
    """Function that tells the options of those of a batch's models that have their own at a stage, by model.

    `pick` gives the options of the stage by a configuration.
    """
    common = pick(config)
    own = {model: pick(configured) for model, configured in OWN.items() if pick(configured) != common}
    return lambda wildcards: {model: own[model] for model in MEMBERS[wildcards.batch] if model in own}


def own_values(wildcards):
    """Options of graph_functions of a batch's models, where values are read: the mesh file, and what is beside it."""
    if not any(name.startswith("file:") for name in config["functions"]):
        return {}
    paths = zip(models_of(wildcards), paths_of(wildcards))
    return {model: {"functions": config["functions"], **describe_values(path)} for model, path in paths}


def memory_of(wildcards, attempt):
    """Memory for one stage of a batch, in MB."""
    return int(predict_memory(MODELS, MEMBERS[wildcards.batch]) * attempt)


def runtime_of(wildcards, attempt):
    """Time for one stage of a batch, in minutes."""
    return int(predict_minutes(MODELS, MEMBERS[wildcards.batch]) * attempt)


def priority_at(stage):
    """Function that tells a batch's priority at this stage: about the work left of it.

    So all batches end at about the same time. In any order, one begun last
    goes through its stages alone while other cores have nothing to do.
    """
    left = len(line_behind(stage)) + 1  # the last stages, which take the longest, count as one more
    return lambda wildcards: left * predict_work(MODELS, MEMBERS[wildcards.batch])


def status_tables():
    """Status tables of all batches, in the order of BATCHES, by stage."""
    return {stage: [f"results/status/{stage}/{batch}.parquet" for batch in BATCHES] for stage in CHOSEN}


def carried_files(wildcards):
    """Files of models that Snakemake's own report takes up; none but while it is made."""
    files, left = list_carried(MODELS, UNDERWAY[0]) if UNDERWAY else ([], 0)
    if left:
        logger.warning(
            f"Pages and pictures of {left} models are left out of {UNDERWAY[0]}: beyond 60 MB it would not open "
            "(--report report.zip takes more), and models with {, }, < or > in their names it cannot take"
        )
    return flag_files(files, CAPTIONS)


def gathering_memory(wildcards, attempt):
    """Memory for a table over all models, in MB."""
    return int(predict_gathering(len(MODELS))[0] * attempt)


def comparing_memory(wildcards, attempt):
    """Memory for the distances of all pairs of models, in MB."""
    return gathering_memory(wildcards, attempt) + 40 * attempt * len(MODELS) ** 2 // 10**6


def gathering_runtime(wildcards, attempt):
    """Time for a table over all models, in minutes."""
    return int(predict_gathering(len(MODELS))[1] * attempt)


# Jobs ------------------------------------------------------------------------

# In a job's own Snakemake, as on a cluster, there is one job, which loads what it needs.
FORK_SERVER = ForkServer(SCRIPTS, CHOSEN if workflow.is_main_process else ())
wait_in_threads(workflow)


def run_job(name, input, output, params, log):
    """Run a job: a stage over a batch, or what is made of the results of all."""
    try:
        FORK_SERVER.run(name, Job.describe(input, output, params, log, config["limits"]))
    except JobError as error:
        raise WorkflowError(str(error)) from None


# The beginning and the end of a run ------------------------------------------


def plan_progress():
    """Tell the console what is to be done."""
    if PROGRESS:
        jobs = {
            workflow.dag.jobid(job): (job.rule.name, job.wildcards_dict.get("batch"))
            for job in workflow.dag.needrun_jobs()
        }
        batches = {batch for _, batch in jobs.values() if batch} if WISHES else BATCHES
        work = {batch: predict_work(MODELS, MEMBERS[batch]) for batch in batches}
        PROGRESS.plan(jobs, {batch: MEMBERS[batch] for batch in batches}, work)


def compile_ahead():
    """Compile, once, what the stages of this run call for, so that no model waits for it; on a cluster, say why it does."""
    if not workflow.local_exec:
        if not os.path.isdir(COMPILED):
            logger.info("The first run compiles the library as it goes, which takes some minutes; later ones do not.")
            if PROGRESS:
                PROGRESS.timed = False
        return
    planned = {job.rule.name for job in workflow.dag.needrun_jobs()} if workflow.is_main_process else ()
    stages = [stage for stage in BEFORE if any(name.endswith(stage) for name in planned)]
    by_size = sorted(MODELS.values(), key=lambda mesh: mesh.size, reverse=True)
    smallest = {os.path.splitext(mesh.path)[1].lower(): mesh.path for mesh in by_size}
    tasks = find_unrehearsed(COMPILED, stages, smallest)
    if tasks is None:
        logger.warning(
            f"What is compiled cannot be kept in {COMPILED}, so models wait for the compiler, for a minute or more:"
            " name a folder that can be written to in NUMBA_CACHE_DIR."
        )
    elif tasks:
        begun = time.monotonic()
        logger.info(
            "Compiling the library for the stages of this run, once for this installation: up to three minutes."
        )
        own = {stage: rule for rule in workflow.rules for stage in BEFORE if rule.name.endswith(stage)}
        options = {stage: rule.params.options for stage, rule in own.items()}
        rehearse(FORK_SERVER, COMPILED, tasks, options, min(workflow.cores, MOST_COMPILERS))
        logger.info(f"Compiled in {time.monotonic() - begun:.0f} s.")


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
    """Have the stages that --forceall, --forcerun or --force names compute what receipts would spare them."""
    settings = workflow.dag_settings
    models = {wish.model for wish in WISHES} or MODELS
    for stage in STAGES:
        if settings.forceall or stage in settings.forcerun:
            forget_stage(models, stage)
    for wish in WISHES if settings.forcetargets else ():
        forget_stage([wish.model], wish.stage)


def close_run():
    """Say what came out; end with an error where models failed, and tell of the first why."""
    if WISHES:
        close_wishes()
        return
    rules = {job.rule.name for job in workflow.dag.jobs}
    gathered = [path for name, path in GATHERED.items() if any(each.endswith(name) for each in rules)]
    if gathered:
        logger.info("\n".join(["Made, or there already:", *(f"  {Path(path).absolute()}" for path in gathered)]))
    if any(each.endswith("collect_models") for each in rules) and MODELS_TABLE.exists():
        lines, failed = tell_outcome(MODELS_TABLE)
        if any(each.endswith("report_models") for each in rules) and REPORT_PAGE.exists():
            lines.append(f"Open in a browser, for all of it: {REPORT_PAGE.absolute()}")
        elif "view" in CHOSEN and any(MODELS_FOLDER.glob("*/view.html")):
            lines.append(f"Pages, to be opened in a browser: {MODELS_FOLDER.absolute()}/*/view.html")
        if failed:
            raise WorkflowError(
                f"{failed} of the models FAILED, by no fault found in their meshes. The others are complete. The "
                "tracebacks are in results/logs/. The next run tries the failed ones again.\n" + "\n".join(lines)
            )
        logger.info("\n".join(lines))


def close_wishes():
    """Say of the files that were asked for where they are; end with an error where one was not made, and why."""
    unmade = find_unmade(WISHES)
    if unmade:
        raise WorkflowError(
            f"{len(unmade)} of {len(WISHES)} files asked for were not made:\n" + "\n".join(list_first(unmade))
        )
    logger.info("\n".join(["Made, or there already:", *list_first(list(dict.fromkeys(wish.path for wish in WISHES)))]))


def explain_error(log):
    """Say what kept the run from its end, and what it leaves behind."""
    stopped = PROGRESS and PROGRESS.stopped
    words = {} if stopped else find_last_words("results/logs", STARTED)
    told = [f"{path}: {word}" for path, word in words.items()] + find_full_disks([".", tempfile.gettempdir()])
    logger.error(
        f"{'Stopped, as asked for' if stopped else 'The run did not finish'}. Models that were completed are kept; start it again, as it is, to go on. "
        f"{MODELS_TABLE}, if it is there, is that of an earlier run. "
        f"The log is {', '.join(map(str, log)) or 'not written'}\n" + "\n".join(list_first(told))
    )


if workflow.is_main_process and IS_MAIN:
    close_idle_runs(workflow, close_run)
