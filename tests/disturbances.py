"""What may happen to a run of the workflow: each function disturbs one, and returns when it is over."""

import json
import os
import random
import resource
import shutil
import signal
import subprocess
import time
from contextlib import contextmanager, suppress
from functools import partial

import psutil
import pyarrow.parquet as pq

from corpus.receipts import receipt_name
from small_corpus import CHOSEN, PATIENCE, finish, run, start, write_prism


class Round:
    """A folder with work to do, and what is known of the round: `random`, the first `stage` that has work, `note`."""

    def __init__(self, folder, seed, first=None):
        self.folder, self.random = folder, random.Random(seed)
        late = int(len(CHOSEN) * self.random.random() ** 0.4)  # rather a late stage than an early one, to be quick
        self.first = late if first is None else first
        self.note = ""

    def undo(self):
        """Take from all models what vouches for the results of the first stage to compute, and of those behind it."""
        for stage in CHOSEN[self.first :]:
            for receipt in (self.folder / "results/models").glob(f"*/{receipt_name(stage)}"):
                receipt.unlink()

    def wait(self, process):
        """Wait for some moment of some stage of a run that has work to do; or for its end."""
        stage = self.random.choice(CHOSEN[self.first :])
        delay, begun = self.random.uniform(0, 1.2), time.time()
        self.note += f" {stage} +{delay:.2f} s"
        logs = self.folder / "results/logs" / stage
        while process.poll() is None and time.time() - begun < PATIENCE:
            with suppress(FileNotFoundError):  # Snakemake removes the log of a job before it begins
                if any(log.stat().st_mtime > begun for log in logs.glob("*.log")):
                    time.sleep(delay)
                    return
            time.sleep(0.01)

    def result_files(self):
        """The files of all models, receipts among them."""
        return sorted(path for path in (self.folder / "results/models").glob("*/*") if path.is_file())


def kill_group(round):
    """All processes of a run are killed at once, as by a power cut."""
    process = start(round.folder)
    round.wait(process)
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    finish(process)


def interrupt(round):
    """The run is asked to end, by Ctrl-C or by a scheduler."""
    process = start(round.folder)
    round.wait(process)
    with suppress(ProcessLookupError):
        if round.random.random() < 0.5:
            os.killpg(process.pid, signal.SIGINT)
        else:
            process.terminate()
    finish(process)


def kill_main(round):
    """Snakemake alone is killed; its jobs end with it."""
    process = start(round.folder)
    round.wait(process)
    process.kill()
    finish(process)


def kill_job(round):
    """The process of a job is killed."""
    _kill_one(round, lambda server: server.children())


def kill_worker(round):
    """The process that works on a model is killed, as where memory runs out."""
    _kill_one(round, lambda server: [worker for job in server.children() for worker in job.children()])


def kill_fork_server(round):
    """The process is killed of which all jobs are forks."""
    _kill_one(round, lambda server: [server])


def _kill_one(round, choose):
    process = start(round.folder)
    round.wait(process)
    with suppress(psutil.NoSuchProcess, IndexError):  # of a run that has ended, or has not begun a job
        servers = [each for each in psutil.Process(process.pid).children() if "corpus.jobs" in str(each.cmdline())]
        round.random.choice(choose(servers[0])).kill()
        round.note += " hit"
    finish(process)


def fill_disk(round):
    """The disk, that of results or that of the whole folder, is full but for a little."""
    left = round.random.choice([0, 4, 20, 60, 200])  # kilobytes
    place = round.random.choice([round.folder, round.folder / "results"])
    round.note += f" {left} kB left for {'results' if place != round.folder else 'all'}"
    with _small_disk(place, left) as limited:
        code, said = run(round.folder, preexec_fn=limited)
    if code and not ("disk" in said or "No space left" in said):
        raise RuntimeError(f"nothing is said of the disk:\n{said}")
    if "The run did not finish" in said and f"The log is {round.folder.resolve()}/.snakemake/log/" not in said:
        raise RuntimeError(f"the log is not named:\n{said}")


@contextmanager
def _small_disk(place, left):
    """Put a folder on a disk in memory with some kilobytes left; where none can be mounted, bound every file so."""
    aside = place.with_name(f"{place.name}.aside")
    place.rename(aside)
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=16m", "none", str(place)]
    mounted = not subprocess.run(mount, check=False).returncode
    shutil.copytree(aside, place, dirs_exist_ok=True)
    try:
        if mounted:
            free = os.statvfs(place)
            (place / "filler").write_bytes(bytes(max(free.f_bavail * free.f_frsize - left * 1024, 0)))
        yield None if mounted else partial(resource.setrlimit, resource.RLIMIT_FSIZE, (left * 1024, left * 1024))
    finally:
        (place / "filler").unlink(missing_ok=True)
        shutil.rmtree(aside)
        shutil.copytree(place, aside, symlinks=True)
        if mounted:
            subprocess.run(["umount", place], check=True)
        else:
            shutil.rmtree(place)
            place.mkdir()
        place.rmdir()
        aside.rename(place)


def edit_before(round):
    """A file of a model is damaged before a run."""
    _damage(round)
    run(round.folder)


def edit_during(round):
    """A file of a model is damaged while a run goes on."""
    process = start(round.folder)
    round.wait(process)
    with suppress(FileNotFoundError, IndexError):
        _damage(round)
    finish(process)


def _damage(round):
    """Damage one file of a model in some way."""
    path = round.random.choice(round.result_files())
    way = round.random.choice([_truncate, _zero, _delete, _swap, _rewrite, _empty])
    round.note += f" {way.__name__[1:]} {path.relative_to(round.folder / 'results/models')}"
    way(path, round)


def _truncate(path, round):
    os.truncate(path, round.random.randrange(max(1, path.stat().st_size)))


def _zero(path, round):
    path.write_bytes(bytes(path.stat().st_size))


def _delete(path, round):
    path.unlink()


def _swap(path, round):
    """Put another model's file of the same name there."""
    others = [each for each in round.result_files() if each.name == path.name and each != path]
    shutil.copyfile(round.random.choice(others), path)


def _rewrite(path, round):
    """Write it anew as another program would: without the metadata, or without the spaces."""
    if path.suffix == ".parquet":
        pq.write_table(pq.read_table(path).replace_schema_metadata(None), path)
    elif path.suffix == ".json":
        path.write_text(json.dumps(json.loads(path.read_text()) | {"key": "", "verdict": "exact"}))
    else:
        path.write_bytes(path.read_bytes() + b"\n")


def _empty(path, round):
    path.write_text(round.random.choice(["", "{}", "[]"]))


def replace_mesh(round):
    """A mesh is replaced, or removed, while a run goes on, and put back after it."""
    path = round.folder / "meshes" / round.random.choice(["tall.off", "sub/wide.off", "torn.off"])
    whole, times = path.read_bytes(), path.stat()
    process = start(round.folder)
    round.wait(process)
    round.note += f" {path.name}"
    if round.random.random() < 0.5:
        write_prism(path, 6, 2.0)
    else:
        path.unlink()
    finish(process)
    if round.random.random() < 0.5:
        run(round.folder)
    path.parent.mkdir(exist_ok=True)  # Snakemake removes a folder that became empty as its input was removed
    path.write_bytes(whole)
    os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))


def run_twice(round):
    """A second run begins while one goes on."""
    process = start(round.folder)
    time.sleep(round.random.uniform(0, 4))
    other = start(round.folder)
    finish(process)
    finish(other)


FAULTS = (
    kill_group,
    kill_worker,
    fill_disk,
    edit_before,
    kill_job,
    kill_fork_server,
    edit_during,
    kill_main,
    replace_mesh,
    interrupt,
    run_twice,
)
