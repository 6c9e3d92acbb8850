"""Make the report of a corpus, `report.html`: all models, what needs a look first, and distributions.

One page that loads nothing from a network. Of few models it holds the
thumbnails; of many it takes them from the folders of the models, as they come
into sight.
"""

import base64
import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pyarrow.parquet as pq
import yaml

from corpus.layout import MODELS_FOLDER, REPORT_PAGE
from corpus.process import trim_startup
from corpus.receipts import seal_table
from corpus.storage import read_table
from corpus.whole_files import place_whole, remove_remains
from reebslice import __version__
from reebslice.drawing.report import Run, make_report

HELD = 200  # models, up to which the page holds their thumbnails
THUMBNAIL = "thumbnail.png"
# Files of a model that the page links to or shows, and the stages that write them.
WRITERS = {
    "view.html": "view",
    "picture.png": "draw",
    THUMBNAIL: "draw",
    "loops.png": "draw_loops",
    "pockets.png": "cut_pockets",
    "certificate.json": "certify",
    "exact_graphs.json": "certify_graphs",
    "inspection.json": "inspect_mesh",
}
PACKAGES = (
    "snakemake",
    "numpy",
    "numba",
    "pyarrow",
    "shapely",
    "scipy",
    "networkx",
    "trimesh",
    "manifold3d",
    "cascadio",
)
PACKAGES += ("mapbox-earcut", "fast-simplification", "pillow")


def gather(job):
    """Write the report of the table of models `job.input.table`; `job.params` are config, own, stages, as in `main`."""
    trim_startup()
    remove_remains(REPORT_PAGE.parent, REPORT_PAGE.name)
    likeness = [read_table(path, Path(path).stem) for path in job.input.likeness]
    text = main(pq.read_table(job.input.table), job.params.config, job.params.own, job.params.stages, likeness)
    with place_whole(REPORT_PAGE, durably=True) as scratch:
        scratch.write_text(text, encoding="utf-8")
    seal_table(REPORT_PAGE)


def main(table, config, own, stages, likeness=()):
    """Return the report as text.

    table : pyarrow.Table of models. config : dict, what is told of the
    configuration. own : number of models with one of their own. stages : those
    that the configuration wants; what others left of a model is not linked.
    likeness : the tables distances and neighbours, if models are compared.
    """
    wanted = [name for name, stage in WRITERS.items() if stage in stages]
    folders = [MODELS_FOLDER / model for model in table["model"].to_pylist()]
    files = [{name for name in wanted if os.path.isfile(folder / name)} for folder in folders]
    thumbnails = [_read_thumbnail(*pair) for pair in zip(folders, files)] if len(folders) <= HELD else None
    told = yaml.safe_dump(config, sort_keys=False, default_flow_style=None, width=100)
    return make_report(
        table, files, thumbnails, Run(config["meshes"], config["only"], told, own, list_versions()), likeness
    )


def _read_thumbnail(folder, files):
    """The thumbnail of a model in base64, or None."""
    return base64.b64encode((folder / THUMBNAIL).read_bytes()).decode() if THUMBNAIL in files else None


def list_versions():
    """Return the versions of the programs that results depend on, by name, as far as they are installed."""
    versions = {"reebslice": __version__, "Python": platform.python_version()}
    for package in PACKAGES:
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            continue
    return versions
