"""Read damaged files by the tens of thousands, and tell where that ends in anything but a result or a refusal.

    python tests/fuzz_readers.py --rounds 20000 [--seed 0] [--only .stl .ply curves] [--keep FOLDER]

Files are read in a process of their own, so that one that ends the process, takes long or takes much memory for its
size is told like any other fault. What it was is kept in FOLDER (by default a new one beside temporary files). The exit
code says whether there was a fault.
"""

import argparse
import json
import os
import random
import select
import subprocess
import sys
import tempfile
import time
import traceback
from collections import Counter
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

if find_spec("reebslice") is None:
    sys.path.insert(0, str(Path(__file__).parent.parent / "workflow" / "scripts"))

SECONDS = 60  # for one file of a few kilobytes, on a machine that has other things to do; compiling takes some
FREE, FACTOR = 64 << 20, 64  # bytes of memory that reading may take: these, and so many for each of the file's
ROOM = 6 << 30  # bytes of address space beyond which a process gets no memory
MESHES = (".stl", ".obj", ".ply", ".off", ".gltf", ".glb", ".3mf")
OTHERS = ("graphml", "json", "curves", "tables")
CRASHED = "the process ended"
SERVER = [__file__, "--serve"]


# --------------------------------------------------------------------------
# The damaged files


def make_file(kind, seed):
    """Return the bytes of a damaged file of a kind: the same for the same seed."""
    import fuzz_mutations as damage
    from fuzz_seeds import graph_files, mesh_files

    chance = random.Random(f"{kind} {seed}")
    if kind == "curves":
        return json.dumps([blob.hex() for blob in damage.mutate_curves(chance)]).encode()
    if kind == "tables":
        name = chance.choice(damage.TABLES)
        return name.encode() + b"\n" + damage.mutate_parquet(chance, name)
    if kind == "json":
        seeds, ways = [b'{"a": [1, 2.5, {"b": null}], "key": "0f", "outputs": ["x.json"]}'], [damage.mutate_text]
    elif kind == "graphml":
        seeds, ways = graph_files(), [damage.mutate_xml]
    else:
        seeds = mesh_files()[kind]
        ways = {".gltf": [damage.mutate_gltf], ".glb": [damage.mutate_glb], ".3mf": [damage.mutate_3mf]}
        ways = ways.get(kind, [damage.mutate_text])
    return chance.choice([*ways * 3, damage.mutate_bytes])(chance.choice(seeds), chance, seeds)


# --------------------------------------------------------------------------
# Reading one of them


def read_file(kind, path):
    """Read a file of a kind; raise AssertionError if what is read of it cannot be, and let refusals pass."""
    from xml.parsers.expat import ExpatError

    from corpus.storage import read_json
    from reebslice.certification.graphml import parse_graph

    if kind == "graphml":
        try:
            return parse_graph(path.read_bytes())
        except (KeyError, ExpatError) as error:  # as documented there
            raise ValueError(error) from error
    if kind == "json":
        return read_json(path)
    return {"curves": _read_curves, "tables": _read_tables}.get(kind, _read_mesh)(path)


def _read_mesh(path):
    """A mesh has ids that exist and finite coordinates, a refusal is one sentence."""
    import numpy as np

    from reebslice.errors import MeshFormatError
    from reebslice.formats.meshes import read_mesh

    try:
        points, faces, _, notes = read_mesh(path)
    except MeshFormatError as error:
        told = str(error)
        assert told and told.isprintable() and len(told) < 3000, f"a refusal of {len(told)} letters: {told[:80]!r}"
        raise
    assert points.dtype == np.float64 and faces.dtype == np.int32 and faces.shape[1:] == (3,) and len(faces)
    assert faces.min() >= 0 and faces.max() < len(points) and np.isfinite(points[faces]).all()
    assert all(note and note.isprintable() for note in notes), notes


def _read_curves(path):
    """Curves are drawn where shapely reads closed plane line strings from the same bytes, and measured alike."""
    import numpy as np
    import pyarrow as pa
    import shapely

    from reebslice.certification.recount.curves import measure_curves, read_curves

    blobs = [bytes.fromhex(blob) for blob in json.loads(path.read_text())]
    halves = [pa.array([b"before", *part], pa.binary())[1:] for part in (blobs[::2], blobs[1::2])]
    curves, drawn = read_curves(halves)
    area = measure_curves(*curves)[0]
    for k, blob in enumerate(blobs[::2] + blobs[1::2]):
        line = shapely.from_wkb(blob, on_invalid="ignore") if blob[:5] == bytes.fromhex("0102000000") else None
        plain = line is not None and len(line.coords) > 1
        points = np.array(line.coords) if plain else np.full((1, 2), np.nan)
        whole = plain and len(blob) == 9 + 16 * len(points)
        closed = bool(whole and np.isfinite(points).all() and (points[0] == points[-1]).all())
        if closed and np.abs(points).max() > 1e150:  # products leave the range, which is as good as not drawn
            continue
        assert drawn[k] == closed, (k, blob.hex())
        if closed and np.abs(points).max() < 1e9:
            x, y = points.T
            want = 0.5 * (x[:-1] * y[1:] - x[1:] * y[:-1]).sum()
            assert np.isclose(area[k], want, atol=1e-6 * np.abs(points).max() ** 2)


def _read_tables(path):
    """A table, whole and block by block."""
    from corpus.layout import read_status
    from corpus.storage import read_blocks, read_key, read_table
    from reebslice.schemas import SCHEMAS

    data = path.read_bytes()
    name, _, data = data.partition(b"\n")
    name = name.decode()
    path.write_bytes(data)
    if name == "status":
        return read_status(path)
    table = read_table(path, name)
    read_key(path)
    for column in SCHEMAS[name].names:
        assert sum(map(len, read_blocks(path, name, column))) == len(table)
        table[column].to_pylist()
    return table


def serve(warm=True):
    """Read the files that standard input names, and tell of each how that ended."""
    if warm:
        _warm_up()
    _bound_memory()
    print("ready", flush=True)
    for line in sys.stdin:
        kind, path = json.loads(line)
        before, began = _reset_peak(), time.monotonic()
        try:
            read_file(kind, Path(path))
            told = {"end": "read"}
        except ValueError:
            told = {"end": "refused"}
        except BaseException:
            told = {"end": "fault", "why": traceback.format_exc()}
        told |= {"seconds": time.monotonic() - began, "bytes": _peak() - before}
        print(json.dumps(told), flush=True)


def _warm_up():
    """Read sound files once, so that what is loaded and compiled is not taken for what a file costs."""
    from fuzz_seeds import LOOP, mesh_files

    sound = mesh_files() | {"curves": [json.dumps([LOOP.hex()]).encode()]}
    for kind, files in sound.items():
        for data in files:
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder, "sound" + kind)
                path.write_bytes(data)
                read_file(kind, path)


def _bound_memory():
    with suppress(ImportError, ValueError, OSError):  # not on this system: the peak is measured all the same
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (ROOM, ROOM))


def _reset_peak():
    """Forget the peak of memory, where the system can; return what is taken now."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")
    return _peak()


def _peak():
    """The most memory that this process has had, in bytes; 0 where that is not known."""
    try:
        words = Path("/proc/self/status").read_text().split()
        return int(words[words.index("VmHWM:") + 1]) << 10
    except OSError:
        return 0


# --------------------------------------------------------------------------
# The campaign


class Reader:
    """A process that reads files, begun again when it has ended."""

    def __init__(self):
        self.process = self.log = None

    def read(self, kind, path, size):
        """Return how reading ended, as {end, why, seconds, bytes}."""
        if self.process is None:
            self._begin()
        print(json.dumps([kind, str(path)]), file=self.process.stdin, flush=True)
        if not select.select([self.process.stdout], [], [], SECONDS)[0]:
            self.close()
            return {"end": "fault", "why": f"longer than {SECONDS} s"}
        line = self.process.stdout.readline()
        if not line:
            code = self.process.wait()
            self.log.seek(0)
            why = f"{CRASHED} with {code}\n" + self.log.read()[-3000:]
            self.close()
            return {"end": "fault", "why": why}
        told = json.loads(line)
        if told["end"] != "fault" and told["bytes"] > FREE + FACTOR * size:
            told |= {"end": "fault", "why": f"{told['bytes']} bytes of memory for a file of {size}"}
        return told

    def _begin(self):
        self.log = tempfile.TemporaryFile("w+")  # noqa: SIM115, closed with the process
        command = [sys.executable, "-X", "faulthandler", *SERVER]
        alone = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": self.log, "text": True, "bufsize": 1}
        self.process = subprocess.Popen(command, env=alone, **pipes)
        if self.process.stdout.readline() != "ready\n":
            self.log.seek(0)
            raise RuntimeError(f"Sound files are not read:\n{self.log.read()}")

    def close(self):
        """End the process."""
        if self.process is not None:
            self.process.kill()
            self.process.communicate()
            self.log.close()
            self.process = None


def run(kinds, seeds, keep):
    """Read a damaged file of each kind for each seed; return counts by kind and end, and the faults."""
    counts, faults, reader = Counter(), [], Reader()
    with tempfile.TemporaryDirectory() as folder:
        for seed in seeds:
            for kind in kinds:
                path = Path(folder, f"damaged{kind}" if kind in MESHES else f"damaged.{kind}")
                data = make_file(kind, seed)
                path.write_bytes(data)
                told = reader.read(kind, path, len(data))
                counts[kind, told["end"]] += 1
                if told["end"] == "fault":
                    faults.append((kind, seed, told["why"]))
                    if keep:
                        Path(keep, f"{seed}-{path.name}").write_bytes(data)
    reader.close()
    return counts, faults


def main():
    """Run a campaign; return the exit code."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--rounds", type=int, default=20_000, help="how many files, all kinds together")
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--only", nargs="+", default=[*MESHES, *OTHERS], choices=[*MESHES, *OTHERS])
    options.add_argument("--keep", type=Path)
    options.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    options = options.parse_args()
    if options.serve:
        return serve()
    keep = options.keep or Path(tempfile.mkdtemp(prefix="fuzz-"))
    keep.mkdir(parents=True, exist_ok=True)
    rounds = -(-options.rounds // len(options.only))
    counts, faults = run(options.only, range(options.seed, options.seed + rounds), keep)
    for kind in options.only:
        print(f"{kind:8}", ", ".join(f"{counts[kind, end]} {end}" for end in ("read", "refused", "fault")))
    for kind, seed, why in faults:
        print(f"\n{kind}, seed {seed} (kept in {keep}):\n{why}")
    print(f"\n{sum(counts.values())} files, {len(faults)} faults")
    return int(bool(faults))


if __name__ == "__main__":
    os.environ.setdefault("PYTHONHASHSEED", "0")
    sys.exit(main())
