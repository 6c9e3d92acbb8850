"""Where results lie, the tree of the stages, and the status tables between them."""

from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

# Every stage, and the one that it goes on from: it reads the status table of that one, and of a model what
# that one and those before it wrote.
BEFORE = {
    "inspect_mesh": None,
    "select_tilt": "inspect_mesh",
    "slice_mesh": "select_tilt",
    "classify_handles": "slice_mesh",
    "sample_nodes": "classify_handles",
    "synthesize_edges": "sample_nodes",
    "certify": "synthesize_edges",
    "draw": "certify",
    "view": "certify",
    "draw_figures": "certify",
    "find_pockets": "classify_handles",
    "find_loops": "classify_handles",
    "cut_pockets": "find_pockets",
    "draw_loops": "find_loops",
    "label_faces": "synthesize_edges",
    "colour_faces": "synthesize_edges",
    "decompose_solid": "synthesize_edges",
    "export_model": "certify",
    "build_graphs": "select_tilt",
    "certify_graphs": "build_graphs",
    "graph_functions": "inspect_mesh",
    "describe_shape": "graph_functions",
    "trace_centrelines": "inspect_mesh",
    "compare_links": "inspect_mesh",
    "rate_directions": "inspect_mesh",
}
# Asked for by name, through the tables that are gathered of them; the others are those of the default target.
ASKED_FOR = ("compare_links", "rate_directions")
STAGES = tuple(stage for stage in BEFORE if stage not in ASKED_FOR)
# Of these, those that a key in a group of the configuration switches off, or a key at its top, here without a group.
SIDE_STAGES = {
    "view": ("view", "pages"),
    "draw_figures": ("draw", "figures"),
    "find_pockets": ("pockets", "find"),
    "find_loops": ("loops", "find"),
    "cut_pockets": ("pockets", "cut"),
    "draw_loops": ("loops", "draw"),
    "label_faces": ("faces", "find"),
    "colour_faces": ("colours", "find"),
    "decompose_solid": ("parts", "find"),
    "export_model": ("export", "files"),
    "graph_functions": (None, "functions"),
    "describe_shape": ("descriptors", "find"),
    "trace_centrelines": ("centrelines", "find"),
}


def line_to(stage):
    """Return the stages that lead to this one, the first one first, itself last."""
    before = BEFORE[stage]
    return [*(line_to(before) if before else ()), stage]


def line_behind(stage):
    """Return this stage and those that go on from it, directly or not, in the order of BEFORE."""
    return [each for each in BEFORE if stage in line_to(each)]


def chosen_stages(config):
    """Return the stages of the default target that the checked configuration wants."""
    wanted = {stage: (config[group] if group else config)[key] for stage, (group, key) in SIDE_STAGES.items()}
    refine = config["levels"]["refine"]
    wanted |= {"slice_mesh": refine != "graphs", "build_graphs": refine in ("exact", "graphs")}
    return tuple(stage for stage in STAGES if all(wanted.get(each, True) for each in line_to(stage)))


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
LIKENESS_TABLES = tuple(Path("results/corpus", f"{name}.parquet") for name in ("distances", "neighbours"))
MODELS_TEXT = MODELS_TABLE.with_suffix(".csv")  # the same, as text
REPORT_PAGE = Path("results/corpus/report.html")
