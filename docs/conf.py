"""How Sphinx makes the documentation: `make docs`, into build/docs/."""

import os
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "workflow" / "scripts"))

import reebslice
from corpus.code_digest import compiled_code_folder

# What the tests and the workflow have compiled serves here too.
os.environ.setdefault("NUMBA_CACHE_DIR", str(compiled_code_folder(ROOT / "workflow" / "scripts" / "reebslice")))

project, author = "reebslice", "reebslice developers"
copyright = "reebslice developers, MIT licence"
version = release = reebslice.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_gallery.gen_gallery"]
exclude_patterns = ["examples/*"]

myst_enable_extensions = ["deflist"]
myst_heading_anchors = 3
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings say more: shapes and units
napoleon_use_ivar = True

sphinx_gallery_conf = {
    "examples_dirs": "examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "abort_on_example_error": True,
    "only_warn_on_example_error": False,
    "download_all_examples": False,
    "show_memory": False,
    "write_computation_times": False,
}

html_theme = "furo"
html_title = f"reebslice {release}"
html_show_sourcelink = False
