"""Run the workflow through a real SLURM, and hold every result file against a local run's.

    python tests/cluster/run_on_slurm.py [FOLDER [WAY ...]]

Brings a SLURM of one node up on this machine (one_node_slurm.sh: as root, on
Debian), sends the examples and, where ../shared/meshes is there, twenty small
real meshes through it in the ways of WAYS, and takes it down again. On the way
a job is cancelled, and the node is drained and resumed. The exit code says
whether every run finished with the files of the local one. All that is
written is in FOLDER, by default a new one under the system's temporary folder;
with one that holds a local run already, that is what is compared with.
"""

import os
import shlex
import signal
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import yaml

from compare_results import compare_results

HERE = Path(__file__).parent.resolve()
ROOT = HERE.parents[1]
PROFILES = ROOT / "workflow/profiles"
ENDINGS = (".stl", ".obj", ".ply", ".off", ".glb")
REAL, SMALLEST = 20, 10_000  # real meshes, and the fewest bytes of one
TARGETS = ("all", "compare_methods")
# Few levels, since what is tried is the way of the jobs.
CONFIG = (
    "batches={most: 1, size: 64}",
    "levels={distance: 0.05}",
    "compare={levels: [16], tilts: [none]}",
    "draw={width: 400}",
)
ABREAST = ("--resources", "side_by_side=2")
QUICK = ("--latency-wait", "5")  # one file system, one node
POLL = ("--slurm-init-seconds-before-status-checks", "5")
SUBMIT = "sbatch --parsable --mem={resources.mem_mb} --time={resources.runtime} --output=sbatch-%j.log"
GROUPS = [
    f"{rule}={group}" for rule, group in yaml.safe_load((PROFILES / "slurm/config.yaml").read_text())["groups"].items()
]
SERIAL = ("--default-resources", "side_by_side=1", "--resources", "side_by_side=1")
SERIAL += ("--set-resource-scopes", "side_by_side=local")
GENERIC = ("--executor", "cluster-generic", "--cluster-generic-submit-cmd", SUBMIT)
GENERIC += ("--cluster-generic-status-cmd", str(HERE / "job_status.sh"), "--cluster-generic-cancel-cmd", "scancel")


@dataclass(frozen=True)
class Way:
    """One way to run the workflow.

    Its name; arguments of Snakemake; whether a job is cancelled and the node
    drained on the way; what Snakemake has to say; and the command that takes
    Snakemake itself into a job, if so.
    """

    name: str
    arguments: tuple
    disturbed: bool = False
    says: tuple = ()
    launcher: tuple = ()


ALL_WAYS = (
    Way(
        "one job per batch",
        ("--workflow-profile", str(PROFILES / "slurm"), *POLL, *QUICK),
        disturbed=True,
        says=("Trying to restart job",),
    ),
    Way(
        "single jobs",
        ("--executor", "slurm", "--slurm-status-command", "squeue", "--jobs", "20", "--retries", "1", *POLL, *QUICK),
        disturbed=True,
        says=("Trying to restart job",),
    ),
    Way(
        "array jobs",
        ("--workflow-profile", str(PROFILES / "slurm-arrays"), *POLL),
        disturbed=True,
        says=("Trying to restart job", "Submitted array job"),
    ),
    Way(
        "cluster-generic",
        (
            *GENERIC,
            "--jobs",
            "20",
            "--retries",
            "1",
            "--max-jobs-per-timespan",
            "1/20s",
            *QUICK,
            "--groups",
            *GROUPS,
            *SERIAL,
        ),
        disturbed=True,
        says=("Trying to restart job", "Job rate limit reached"),
    ),
    Way(
        "one job for two batches",
        ("--workflow-profile", str(PROFILES / "slurm"), "--group-components", "batch=2", *ABREAST, *POLL, *QUICK),
    ),
    Way(
        "all in one job",
        ("--workflow-profile", str(PROFILES / "long"), "--cores", "2"),
        launcher=("sbatch", "--wait", "--cpus-per-task=2", "--mem=4000", "--time=120", "--output=run.log", "--wrap"),
    ),
)


WAYS = {way.name: way for way in ALL_WAYS}


def main(folder=None, *names):
    """Run the ways of these names, or all, in `folder`; return the exit code."""
    folder = Path(folder or tempfile.mkdtemp(prefix="reebslice-slurm-")).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended from outside"))  # SLURM is taken down all the same
    say(f"everything is in {folder}")
    if not (folder / "local/results/corpus/comparison.parquet").exists():
        lay_out_meshes(folder / "meshes")
        install_plugins(folder / "plugins")
        run(folder, "local", ("--cores", "2"))
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (f"{folder}/plugins", os.environ.get("PYTHONPATH"))))
    with slurm(folder / "slurm"):
        outcomes = [try_way(folder, WAYS[name]) for name in names or WAYS]
    print("\nway, seconds, processor seconds of the jobs, jobs by state, result files compared, what is wrong")
    for outcome in outcomes:
        print(*outcome, sep=", ")
    return int(any(outcome[-1] != "nothing" for outcome in outcomes))


def say(text):
    """Print `text` with the time of day."""
    print(time.strftime("%H:%M:%S"), text, flush=True)


def lay_out_meshes(folder):
    """Make the examples, and link the smallest real meshes beside them."""
    call([sys.executable, ROOT / "workflow/scripts/make_examples.py", folder])
    sizes = {path: path.stat().st_size for path in (ROOT.parent / "shared/meshes").glob("*")}
    found = [path for path in sizes if path.suffix.lower() in ENDINGS and sizes[path] >= SMALLEST]
    for path in sorted(found, key=lambda path: (sizes[path], path.name))[:REAL]:
        (folder / "real").mkdir(exist_ok=True)
        (folder / "real" / path.name).symlink_to(path)
    say(f"9 examples and {min(len(found), REAL)} real meshes")


def install_plugins(folder):
    """Put Snakemake's executors, which the environment of the project does without, in a folder of their own."""
    pins = PROFILES / "slurm/plugins.txt"
    call([sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", folder, "--requirement", pins])


@contextmanager
def slurm(folder):
    """A SLURM whose state is in `folder`."""
    try:
        call(["bash", HERE / "one_node_slurm.sh", "up", folder])
        os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
        yield
    finally:
        call(["bash", HERE / "one_node_slurm.sh", "down", folder])


def try_way(folder, way):
    """Run one way; return its name, seconds, those of processors, jobs, files compared, and what is wrong."""
    before, start = set(list_jobs()), time.perf_counter()
    disturbance = threading.Thread(target=disturb, args=(before,), daemon=True)
    if way.disturbed:
        disturbance.start()
    said = run(folder, way.name, way.arguments, way.launcher)
    seconds = round(time.perf_counter() - start)
    if way.disturbed:
        disturbance.join()
    jobs = {job: facts for job, facts in list_jobs().items() if job not in before}
    compared, differing = compare_results(folder / "local", folder / way.name)
    wrong = [f"{name} differs" for name in differing] + [f"not said: {text}" for text in way.says if text not in said]
    wrong += [f"job {job} without a time limit" for job, (_, limit, _) in jobs.items() if not limit.isdigit()]
    states = [state for state, _, _ in jobs.values()]
    if way.disturbed and "CANCELLED" not in states:
        wrong.append("no job was cancelled")
    counts = " and ".join(f"{states.count(state)} {state}" for state in sorted(set(states)))
    processor = round(sum(used for _, _, used in jobs.values()))
    say(f"{way.name}: {seconds} s, {counts}; {compared} files compared, {len(differing)} differ")
    return way.name, seconds, processor, counts, compared, "; ".join(wrong) or "nothing"


def run(folder, name, arguments, launcher=()):
    """Run Snakemake in a folder of its own, itself or as the last argument of `launcher`; return all that it said."""
    say(f"{name}: begins")
    place = folder / name
    place.mkdir()
    command = [sys.executable, "-m", "snakemake", *TARGETS, "--snakefile", ROOT / "Snakefile", "--directory", place]
    command += [*arguments, "--config", f"meshes={folder / 'meshes'}", *CONFIG]
    if launcher:
        command = [*launcher, shlex.join(map(str, command))]
    with open(place / ("launch.log" if launcher else "run.log"), "w") as log:
        done = subprocess.run(command, stdout=log, stderr=subprocess.STDOUT, cwd=place, check=False)
    if done.returncode:
        say(f"{name}: Snakemake ended with {done.returncode}, see {place / 'run.log'}")
    return "".join(path.read_text() for path in (place / "run.log", *place.glob(".snakemake/log/*.log")))


def disturb(before):
    """Cancel the first job that runs, then let the node take no more jobs for a while."""
    job = wait_for_running_job(before)
    time.sleep(2)  # into its work
    call(["scancel", job])
    say(f"job {job} cancelled")
    node = call(["sinfo", "--noheader", "--format=%n"]).strip()
    call(["scontrol", "update", f"NodeName={node}", "State=DRAIN", "Reason=test"])
    say(f"node drained: {call(['sinfo', '--noheader', '--format=%T']).strip()}")
    time.sleep(20)
    waiting = call(["squeue", "--noheader", "--array", "--states=PENDING", "--format=%i"]).split()
    call(["scontrol", "update", f"NodeName={node}", "State=RESUME"])
    say(f"node resumed, {len(waiting)} jobs were waiting")


def wait_for_running_job(before):
    """Return the id of a running job that is not in `before`."""
    while True:
        running = call(["squeue", "--noheader", "--array", "--states=RUNNING", "--format=%i"]).split()
        fresh = sorted(set(running) - before)
        if fresh:
            return fresh[0]
        time.sleep(0.5)


def list_jobs():
    """Return all jobs that SLURM knows, array tasks apart: {id: (state, time limit in minutes, processor seconds)}."""
    columns = "--format=JobID,State,TimelimitRaw,TotalCPU"
    rows = call(["sacct", "--noheader", "--parsable2", "--starttime=now-1day", columns])
    jobs = {}
    for row in rows.splitlines():
        job, state, limit, used = row.split("|")
        if "." not in job:  # no step of a job; a job alone (--allocations) would not tell of its steps' seconds
            jobs[job] = (state.split()[0], limit, read_seconds(used))
    return jobs


def read_seconds(text):
    """Return the seconds of a time as SLURM writes it: 1-02:03:04, 02:03:04 or 03:04.567."""
    days, _, clock = text.rpartition("-")
    seconds = int(days or 0) * 24 * 3600.0
    for place, part in enumerate(reversed(clock.split(":"))):
        seconds += float(part or 0) * 60**place
    return seconds


def call(command):
    """Run a command that has to succeed; return its output."""
    return subprocess.run(list(map(str, command)), check=True, text=True, stdout=subprocess.PIPE).stdout


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
