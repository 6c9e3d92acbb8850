"""
From results to insight
=======================

What a run leaves is tables and graphs that pandas and networkx read. This notebook runs the workflow on some of the
examples, and asks: which models have loops, how wide are their holes, how does a section grow along a branch?
"""

import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import networkx as nx
import pandas as pd

# %%
# The workflow, here over three of the examples, without what is not asked for below. With results of your own, leave
# this out.

checkout = Path("../..").resolve()  # this script lies in docs/examples
here = checkout / "build/notebook"
if not (here / "meshes").exists():
    examples = [sys.executable, checkout / "workflow/scripts/make_examples.py", here / "meshes"]
    subprocess.run(examples, check=True)
only = "[torus_upright, torus_lying, vase]"
command = [
    Path(sys.executable).with_name("snakemake"), "--snakefile", checkout / "Snakefile", "--directory", here,
    "--cores", "2", "--config", "meshes=meshes", f"only={only}", "view={pages: false}", "faces={find: false}",
    "pockets={find: false}", "report={page: false}",
]  # fmt: skip
subprocess.run(command, check=True, capture_output=True)
results = here / "results"

# %%
# One row per model
# -----------------
# ``genus`` is the number of loops of the surface, ``loops_solid`` those of the solid: an upright torus has a loop of
# material, a lying one has none.

models = pd.read_parquet(results / "corpus/models.parquet")
models[["model", "verdict", "genus", "loops_solid", "levels", "volume"]].set_index("model")

# %%
# Loops with a place
# ------------------
# Every loop has a circle around it where it is thinnest.

loops = pd.concat(
    pd.read_parquet(results / f"models/{model}/loops.parquet").assign(model=model) for model in models["model"]
)
loops[["model", "kind", "height", "perimeter", "inscribed_radius"]].round(3)

# %%
# A graph
# -------
# GraphML holds parallel arcs, so it is read as a multigraph. A node's ``height`` and ``operation`` say what happens
# there.

graph = nx.read_graphml(results / "models/vase/solid.graphml", force_multigraph=True)
for node, data in sorted(graph.nodes(data=True), key=lambda item: item[1]["height"]):
    print(f"{node:4} {data['height']:8.3f}  {data['operation']:12} degree {graph.degree(node)}")

# %%
# Along the arcs
# --------------
# ``nodes`` has a material point per region and level, ``arcs`` lists those of each arc: so a section, or the largest
# circle in it, can be followed along a branch.

nodes = pd.read_parquet(results / "models/vase/nodes.parquet")
arcs = pd.read_parquet(results / "models/vase/arcs.parquet").query("graph == 'solid'")
figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
for row in arcs.itertuples():
    along = nodes.iloc[row.nodes].sort_values("height")
    axes.plot(along["area"], along["height"], label=f"arc {row.arc}")
axes.set(xlabel="area of the section", ylabel="height", title="vase: sections of every arc of the solid")
axes.legend()
plt.show()
