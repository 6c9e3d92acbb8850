"""Where results lie, the order of the stages, and the status tables between them."""

from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

STAGES = (
    "inspect_mesh",
    "select_tilt",
    "slice_mesh",
    "classify_handles",
    "sample_nodes",
    "synthesize_edges",
    "certify",
    "draw",
)
MODELS_FOLDER = Path("results/models")

# One row per model of the batch. `path` is the mesh file; `reason` is empty
# for `ok`; `key` is the content key of the stage's outputs; `stamp` tells whether
# they are still the files that they were (corpus.promises).
STATUS_SCHEMA = pa.schema(
    [
        pa.field("model", pa.string(), nullable=False),
        pa.field("path", pa.string(), nullable=False),
        pa.field("status", pa.string(), nullable=False),
        pa.field("reason", pa.string(), nullable=False),
        pa.field("seconds", pa.float64(), nullable=True),
        pa.field("peak_memory_mb", pa.float64(), nullable=True),
        pa.field("key", pa.string(), nullable=False),
        pa.field("stamp", pa.string(), nullable=False),
    ]
)


def read_status(path):
    """Return the rows of a status table as dictionaries; raise ValueError where the file holds none."""
    try:
        table = pq.ParquetFile(path).read()
        if not table.schema.equals(STATUS_SCHEMA):
            raise ValueError("its columns are others")
        return table.to_pylist()
    except (OSError, ValueError, pa.ArrowException) as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise  # the disk's fault, not the file's: pyarrow says both so
        told = str(error).strip().splitlines() or [type(error).__name__]
        raise ValueError(f"{path}: is no status table ({told[0]}); delete it and run the workflow again") from error


STATUS_FOLDER = Path("results/status")
MODELS_TABLE = Path("results/corpus/models.parquet")
