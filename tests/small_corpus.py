"""A small corpus, runs of the workflow over it, and what of their results has to be the same in all of them."""

import csv
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
from hashlib import blake2b
from pathlib import Path

import pyarrow.parquet as pq

from compare_results import without_times
from corpus.code_digest import compiled_code_folder
from corpus.layout import line_to
from corpus.receipts import receipt_name

ROOT = Path(__file__).parent.parent
SCRIPTS = ROOT / "workflow" / "scripts"
OPTIONS = (
    "levels={distance: 0.5, refine: none}",
    "tilt={mode: none}",
    "nodes={sampler: representative}",
    "draw={width: 200}",
    "view={pages: false}",
    "loops={find: false}",
    "faces={find: false}",
    "batches={size: 1000, most: 1}",
)
CHOSEN = (*line_to("draw"), "find_pockets")  # stages that these options leave: the way to the picture and one aside
MOST_RUNS = 6  # until one comes to its end
PATIENCE = 900  # seconds that any run may take, and any wait


# --------------------------------------------------------------------------
# A corpus, and runs over it


def write_prism(path, sides, height, torn=False):
    """Write an upright prism as OFF file, sheared so that no two vertices are at one height; torn, it lacks a face."""
    turns = [2 * math.pi * k / sides for k in range(sides)]
    flat = [(math.cos(turn), math.sin(turn)) for turn in turns]
    points = [(x, y, z + 0.1 * x + 0.03 * y) for z in (0.0, height) for x, y in flat]
    faces = [(0, k + 1, k) for k in range(1, sides - 1)] + [
        (sides, sides + k, sides + k + 1) for k in range(1, sides - 1)
    ]
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
    environment = os.environ | {
        "NUMBA_CACHE_DIR": os.environ.get("NUMBA_CACHE_DIR", str(compiled_code_folder(SCRIPTS / "reebslice")))
    }
    output = tempfile.TemporaryFile("w+")  # noqa: SIM115, finish closes it
    process = subprocess.Popen(
        command,
        stdout=output,
        stderr=subprocess.STDOUT,
        cwd=folder,
        start_new_session=True,
        env=environment,
        **keywords,
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
    """Run the workflow until it comes to its end, as its hints say; return how many runs that took, and the hints.

    Raises RuntimeError where it does not, or where a run shows a traceback.
    """
    hints, heard, given = [], [], []
    for count in range(1, MOST_RUNS + 1):
        code, said = run(folder, *hints)
        heard.append(said)
        if "Traceback" in said:
            raise RuntimeError(f"a traceback:\n{said}")
        if not code:
            return count, given
        if "--unlock" in said:
            given.append("--unlock")
            run(folder, "--unlock")
        if "--rerun-incomplete" in said:
            hints = ["--rerun-incomplete"]
            given += hints
    raise RuntimeError(f"no run of {MOST_RUNS} came to its end; they said:\n" + "\n".join(heard))


# --------------------------------------------------------------------------
# What a run leaves


def fingerprint(folder):
    """Digest every result in a folder, by its path: of receipts and tables over models what does not tell times."""
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
        return json.dumps(
            [{k: v for k, v in row.items() if not k.startswith(timed)} for row in rows], default=str
        ).encode()
    if path.name == "models.csv":
        rows = csv.DictReader(path.read_text().splitlines())
        return json.dumps(
            [{k: v for k, v in row.items() if not k.startswith(("seconds", "peak"))} for row in rows]
        ).encode()
    if path.name in {receipt_name(stage) for stage in CHOSEN}:
        receipt = json.loads(path.read_text())
        marks = {name: (size, digest) for name, (size, _, digest) in receipt["outputs"].items()}
        return json.dumps([marks, *(receipt[name] for name in ("before", "key", "reason", "status"))]).encode()
    if path.name == "report.html":
        return without_times(path.read_text()).encode()
    if path.parent.name == "corpus" and path.suffix == ".json":
        return b""  # stamps of tables
    return path.read_bytes()


def compare(one, other):
    """List the paths at which two fingerprints differ."""
    return sorted(name for name in one.keys() | other.keys() if one.get(name) != other.get(name))
