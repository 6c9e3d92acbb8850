"""Rounds of faults: a run of the workflow is disturbed, others follow until one comes to its end, and results are compared.

    python tests/faults.py ROUNDS [SEED]

In every round some stages of a small corpus have to be computed again. While
they are, something happens: processes are killed, the disk is full, files are
edited, a mesh is replaced, a second run begins. Then runs follow as a user
would start them, by the hints that the runs give, and at the end every result
has to be that of a run which nothing disturbed, byte for byte but for what
tells seconds, memory and times. The exit code says whether all were.
"""

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from contextlib import contextmanager, suppress
from hashlib import blake2b
from pathlib import Path

import psutil
import pyarrow.parquet as pq

ROOT = Path(__file__).parent.parent
SCRIPTS = ROOT / "workflow" / "scripts"
sys.path.insert(0, str(SCRIPTS))

from corpus.code_digest import compiled_code_folder, read_outputs
from corpus.layout import STAGES
from corpus.receipts import receipt_name

OPTIONS = (
    "levels={distance: 0.5, refine: none}",
    "tilt={mode: none}",
    "nodes={sampler: representative}",
    "draw={width: 200}",
    "batches={size: 1000, most: 1}",
)
MOST_RUNS = 6  # until one comes to its end
PATIENCE = 900  # seconds that any run may take, and any wait


# --------------------------------------------------------------------------
# A corpus, and runs over it


def write_prism(path, sides, height, torn=False):
    """Write an upright prism as OFF file, sheared so that no two vertices are at one height; torn, it lacks a face."""
    import math

    turns = [2 * math.pi * k / sides for k in range(sides)]
    flat = [(math.cos(turn), math.sin(turn)) for turn in turns]
    points = [(x, y, z + 0.1 * x + 0.03 * y) for z in (0.0, height) for x, y in flat]
    faces = [(0, k + 1, k) for k in range(1, sides - 1)] + [(sides, sides + k, sides + k + 1) for k in range(1, sides - 1)]
    for k in range(sides):
        after = (k + 1) % sides
        faces += [(k, after, sides + after), (k, sides + after, sides + k)]
    lines = ["OFF", f"{len(points)} {len(faces) - torn} 0", *(" ".join(map(repr, point)) for point in points)]
    lines += [f"3 {a} {b} {c}" for a, b, c in faces[torn:]]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n")


def make_corpus(folder):
    """Write the meshes of a corpus, three good ones and one that is rejected, and run the workflow over them."""
    write_prism(folder / "meshes/tall.off", 4, 3.0)
    write_prism(folder / "meshes/sub/wide.off", 5, 0.7)
    write_prism(folder / "meshes/round.off", 12, 1.0)
    write_prism(folder / "meshes/torn.off", 4, 1.0, torn=True)
    code, said = run(folder)
    if code:
        raise RuntimeError(f"the undisturbed run ended with {code}:\n{said}")


def start(folder, *arguments, **keywords):
    """Start the workflow in a folder, in a session and a process group of its own."""
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile"), "--cores", "2"]
    command += ["--directory", str(folder), *arguments, "--config", "meshes=meshes", *OPTIONS]
    environment = os.environ | {"NUMBA_CACHE_DIR": os.environ.get("NUMBA_CACHE_DIR", str(compiled_code_folder(SCRIPTS / "reebslice")))}
    output = tempfile.TemporaryFile("w+")
    process = subprocess.Popen(
        command, stdout=output, stderr=subprocess.STDOUT, cwd=folder, start_new_session=True, env=environment, **keywords
    )
    process.output = output
    return process


def finish(process):
    """Wait for a run's end; return its exit code and what it said."""
    try:
        code = process.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        code = process.wait()
    process.output.seek(0)
    with process.output:
        return code, process.output.read()


def run(folder, *arguments, **keywords):
    """Run the workflow in a folder; return its exit code and what it said."""
    return finish(start(folder, *arguments, **keywords))


def settle(folder):
    """Run the workflow until it comes to its end, as its hints say; return how often that took, and what was said.

    Raises RuntimeError where it does not, or where a run shows a traceback.
    """
    hints, heard = [], []
    for count in range(1, MOST_RUNS + 1):
        code, said = run(folder, *hints)
        heard.append(said)
        if "Traceback" in said:
            raise RuntimeError(f"a traceback:\n{said}")
        if not code:
            return count
        if "--unlock" in said:
            run(folder, "--unlock")
        if "--rerun-incomplete" in said:
            hints = ["--rerun-incomplete"]
    raise RuntimeError(f"no run of {MOST_RUNS} came to its end; they said:\n" + "\n".join(heard))


# --------------------------------------------------------------------------
# What a run leaves


def fingerprint(folder):
    """Digest every result in a folder, by its path: whole files, but of receipts and tables what does not tell times."""
    found = {}
    for top in ("models", "status", "corpus"):
        for path in sorted((folder / "results" / top).glob("**/*")):
            name = str(path.relative_to(folder))
            if path.is_dir():
                if path.name.startswith("."):
                    found[name] = "a folder"
            else:
                found[name] = blake2b(_content(path), digest_size=8).hexdigest()
    return found


def _content(path):
    """Return what of a result file has to be the same in every run."""
    if path.suffix == ".parquet" and path.parent.parent.name != "models":
        rows = pq.read_table(path).to_pylist()
        timed = ("seconds", "peak_memory", "stamp")
        return json.dumps([{k: v for k, v in row.items() if not k.startswith(timed)} for row in rows], default=str).encode()
    if path.name in {receipt_name(stage) for stage in STAGES}:
        receipt = json.loads(path.read_text())
        return json.dumps([receipt[name] for name in ("key", "outputs", "reason", "status")]).encode()
    if path.parent.name == "corpus" and path.suffix == ".json":
        return b""  # stamps of tables
    return path.read_bytes()


def compare(one, other):
    """List the paths at which two fingerprints differ."""
    return sorted(name for name in one.keys() | other.keys() if one.get(name) != other.get(name))


# --------------------------------------------------------------------------
# Faults


class Round:
    """A folder with work to do, and what is known of the round: `random`, the first `stage` that has work, `note`."""

    def __init__(self, folder, seed):
        self.folder, self.random = folder, random.Random(seed)
        self.first = int(len(STAGES) * self.random.random() ** 0.4)  # rather a late one, which costs less
        self.note = ""

    def undo(self):
        """Take from all models what vouches for the results of the first stage to compute, and of those behind it."""
        for stage in STAGES[self.first :]:
            for receipt in (self.folder / "results/models").glob(f"*/{receipt_name(stage)}"):
                receipt.unlink()

    def wait(self, process):
        """Wait for some moment of some stage of a run that has work to do; or for its end."""
        stage = self.random.choice(STAGES[self.first :])
        delay, begun = self.random.uniform(0, 1.2), time.time()
        self.note += f" {stage} +{delay:.2f} s"
        logs = self.folder / "results/logs" / stage
        while process.poll() is None and time.time() - begun < PATIENCE:
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
    """Snakemake alone is killed; its job goes on beside the next run."""
    process = start(round.folder)
    round.wait(process)
    process.kill()
    finish(process)


def kill_job(round):
    """The process of a job is killed."""
    _kill_one(round, worker=False)


def kill_worker(round):
    """The process that works on a model is killed, as where memory runs out."""
    _kill_one(round, worker=True)


def _kill_one(round, worker):
    process = start(round.folder)
    round.wait(process)
    with suppress(psutil.NoSuchProcess, IndexError):
        jobs = [each for each in psutil.Process(process.pid).children(recursive=True) if _is_job(each)]
        jobs = [each for each in jobs if _is_job(each.parent()) == worker]
        round.random.choice(jobs).kill()
        round.note += " hit"
    finish(process)


def _is_job(process):
    with suppress(psutil.NoSuchProcess):
        return any(".snakemake/scripts/" in word for word in process.cmdline()[1:2])
    return False


def fill_disk(round):
    """The disk is full, but for a little."""
    left = round.random.choice([0, 4, 20, 60, 200])  # kilobytes
    round.note += f" {left} kB left"
    with _small_disk(round.folder, left) as limited:
        code, said = run(round.folder, preexec_fn=limited)
    if code and "disk" not in said:
        raise RuntimeError(f"nothing is said of the disk:\n{said}")


@contextmanager
def _small_disk(folder, left):
    """Leave so many kilobytes on the disk of results, one in memory; or, where none can be mounted, in any one file."""
    results, aside = folder / "results", folder / "aside"
    results.rename(aside)
    results.mkdir()
    size = 8192
    mounted = not subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "none", results], check=False).returncode
    shutil.copytree(aside, results, dirs_exist_ok=True)
    try:
        if mounted:
            free = os.statvfs(results)
            with open(results / "filler", "wb") as filler:
                filler.write(bytes(max(free.f_bavail * free.f_frsize - left * 1024, 0)))
            yield None
        else:
            import resource

            yield lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (left * 1024, left * 1024))
    finally:
        (results / "filler").unlink(missing_ok=True)
        shutil.rmtree(aside)
        shutil.copytree(results, aside)
        if mounted:
            subprocess.run(["umount", results], check=True)
        else:
            shutil.rmtree(results)
            results.mkdir()
        results.rmdir()
        aside.rename(results)


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
    edit_during,
    kill_main,
    replace_mesh,
    interrupt,
    run_twice,
)


def play(base, expected, fault, seed):
    """Play one round; return what was done, and the paths of results that are not as in the undisturbed run."""
    folder = Path(tempfile.mkdtemp(prefix="faults-"))
    shutil.copytree(base, folder, dirs_exist_ok=True)
    round = Round(folder, seed)
    round.undo()
    begun = time.time()
    try:
        fault(round)
        count = settle(folder)
        differences = compare(expected, fingerprint(folder))
    except RuntimeError as error:
        count, differences = 0, [str(error)]
    if not differences:
        shutil.rmtree(folder)
    told = f"{fault.__name__} (seed {seed}):{round.note}; {count} runs to settle, {time.time() - begun:.1f} s in all"
    return told, differences


def main(rounds, seed=0):
    """Play rounds, each fault in turn; return how many left other results than the undisturbed run."""
    with tempfile.TemporaryDirectory(prefix="faults-base-") as base:
        base = Path(base)
        make_corpus(base)
        expected, played, bad = fingerprint(base), Counter(), 0
        for number in range(rounds):
            fault = FAULTS[number % len(FAULTS)]
            told, differences = play(base, expected, fault, seed + number)
            played[fault.__name__] += 1
            bad += bool(differences)
            print(f"{number + 1}: {told}: {'DIFFERENT: ' + ', '.join(differences[:5]) if differences else 'the same'}", flush=True)
    print(f"{rounds} rounds, {bad} with differences: {dict(played)}; {len(expected)} files compared in each")
    return bad


if __name__ == "__main__":
    sys.exit(bool(main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0)))
