"""Run the stages on one mesh file, without Snakemake, with the configuration of config/config.yaml."""

import importlib
import json
import os
import shutil
import sys
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "workflow" / "scripts"))

from corpus.code_digest import compiled_code_folder

os.environ.setdefault("NUMBA_CACHE_DIR", str(compiled_code_folder(ROOT / "workflow" / "scripts" / "reebslice")))

from corpus.storage import read_table

CONFIG = yaml.safe_load((ROOT / "config" / "config.yaml").read_text())
FIRST = ("inspect_mesh", "select_tilt")
THEN = ("slice_mesh", "classify_handles", "sample_nodes", "synthesize_edges", "certify")


def run_model(path, folder, kept=False, tilt=(), **levels):
    """Run all stages on the mesh file `path`: the folder of its results, one of `folder` for every choice of levels.

    tilt, levels : what differs from the sections of the configuration, such as
    ``distance=None, feature_size=0.1``. kept : take results that are there
    as they are. Raises what a stage raises, `RejectedMesh` among it.
    """
    sections = stage_options(tilt, **levels)
    base = Path(folder) / Path(path).stem
    target = base / ("_".join(f"{name}_{value}" for name, value in levels.items() if value is not None) or "default")
    if kept and (target / "certificate.json").exists():
        return target
    if not (kept and (base / "tilt.json").exists()):
        base.mkdir(parents=True, exist_ok=True)
        for stage in FIRST:
            importlib.import_module(stage).main(Path(path) if stage == "inspect_mesh" else base, base, sections[stage])
    target.mkdir(exist_ok=True)
    for file in base.iterdir():
        if file.is_file():
            shutil.copy(file, target)
    for stage in THEN:
        importlib.import_module(stage).main(target, target, sections[stage])
    return target


def stage_options(tilt=(), **levels):
    """The options of every stage, by its name: those of the configuration, but for what is given."""
    levels = CONFIG["levels"] | levels
    return {
        "inspect_mesh": CONFIG["inspect"],
        "select_tilt": CONFIG["tilt"] | dict(tilt),
        "slice_mesh": levels,
        "classify_handles": {},
        "sample_nodes": CONFIG["nodes"],
        "synthesize_edges": CONFIG["edges"] | {"levels": levels},
        "certify": levels,
        "draw": CONFIG["draw"],
    }


def read_figures(folder):
    """What a table of models shows of the results in `folder`, as a dict."""
    certificate, sampling = (json.loads((folder / f"{name}.json").read_text()) for name in ("certificate", "sampling"))
    simplified = certificate["simplified"]
    return {
        "faces": read_table(folder / "faces.parquet", "faces").num_rows,
        "critical": read_table(folder / "critical_points.parquet", "critical_points").num_rows,
        **{name: certificate[name] for name in ("genus", "levels", "verdict")},
        **{name: sampling[name] for name in ("fewest_levels", "exact_distance")},
        "events": read_table(folder / "handles.parquet", "handles").num_rows,
        "nodes": simplified["nodes_solid"],
        "loops_solid": simplified["loops_solid"],
        "loops": simplified["loops_surface"],
        "suppressed": simplified["suppressed_loops"],
        "hidden": certificate["hidden_genus"],
    }
