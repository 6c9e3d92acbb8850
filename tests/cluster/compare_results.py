"""What of two runs over the same meshes differs: every result file, but for seconds and memory.

    python tests/cluster/compare_results.py FOLDER OTHER

Files of models have to be equal byte for byte, but for the seconds and the
memory in receipts, and the times of files there. Status tables and the table of
models are compared row by row, since runs may have other batches; the report
but for what it tells of seconds and memory. Logs are no results.
"""

import csv
import json
import re
import sys
from pathlib import Path

import pyarrow.parquet as pq

MEASURED = ("seconds", "peak_memory_mb", "stamp", "seal")  # stamps and seals are digests of times, too


def compare_results(folder, other):
    """Return the number of files compared, and the names of those that differ or are on one side only."""
    sides = [Path(side) / "results" for side in (folder, other)]
    models, corpus = ([_list_files(side / name) for side in sides] for name in ("models", "corpus"))
    tables = [_read_status(side / "status") for side in sides]
    differing = _differing(*models, _content) + _differing(*corpus, _content) + _differing(*tables, lambda rows: rows)
    return len(models[0]) + len(corpus[0]), differing


def _list_files(folder):
    return {path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()}


def _differing(one, other, content):
    """Return the names that are in one mapping only, or whose content differs."""
    both = one.keys() & other.keys()
    return sorted((one.keys() ^ other.keys()) | {name for name in both if content(one[name]) != content(other[name])})


def _content(path):
    """Return what has to be equal of a file."""
    if path.name == "models.parquet":
        return [_without_measured(row) for row in pq.read_table(path).to_pylist()]
    if path.name == "models.csv":
        return [_without_measured(row) for row in csv.DictReader(path.read_text().splitlines())]
    if path.name.startswith(".") and path.suffix == ".json":
        receipt = json.loads(path.read_text())
        outputs = {name: (size, digest) for name, (size, _, digest) in receipt["outputs"].items()}
        # those of the table of models and of the report digest seconds
        timed = path.name in (".models.json", ".report.json")
        return _without_measured(receipt | {"outputs": sorted(outputs) if timed else outputs})
    if path.name == "report.html":
        return without_times(path.read_text())
    return path.read_bytes()


def _read_status(folder):
    """Return the rows of every stage's status tables by model."""
    stages = {}
    for table in sorted(folder.glob("*/*.parquet")):
        rows = stages.setdefault(table.parent.name, {})
        rows |= {row["model"]: _without_measured(row) for row in pq.ParquetFile(table).read().to_pylist()}
    return stages


def without_times(page):
    """Return the report without what it tells of seconds and memory."""
    timed = MEASURED[:2]
    page = re.sub(f'<figure class="chart" data-figure="({"|".join(timed)})".*?</figure>', "", page, flags=re.DOTALL)
    head, data, rest = re.split(r'(?<=id="data">)(.*?)(?=</script>)', page, maxsplit=1, flags=re.DOTALL)
    facts = json.loads(data)
    facts["figures"] = [figure for figure in facts["figures"] if figure["name"] not in timed]
    return head + json.dumps(facts) + rest


def _without_measured(facts):
    return {name: value for name, value in facts.items() if not name.startswith(MEASURED)}


if __name__ == "__main__":
    count, differing = compare_results(*sys.argv[1:])
    print(f"{count} files compared, {len(differing)} differ", *differing, sep="\n")
    sys.exit(bool(differing) or not count)
