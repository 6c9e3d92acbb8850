"""Read the solid's graph as a tree with navis and MorphIO."""

import json
import math
import sys
from pathlib import Path

import morphio
import navis

morphio.set_maximum_warnings(0)
for folder in sys.argv[1:]:
    told = json.loads(Path(folder, "expected.json").read_text())
    tree = navis.read_swc(f"{folder}/solid.swc")
    assert (tree.n_nodes, tree.n_trees) == (told["points"], told["trees"])
    assert math.isclose(tree.nodes["radius"].max(), told["radius"], rel_tol=1e-6)
    read = morphio.Morphology(f"{folder}/solid.swc")
    assert len(read.root_sections) == told["trees"] and not len(read.soma.points)
    assert math.isclose(read.diameters.max() / 2, told["radius"], rel_tol=1e-6)
    # a point at which sections meet begins each of them
    doubled = sum(len(section.children) for section in read.iter())
    assert len(read.points) - doubled == told["points"]
print("navis", navis.__version__, "morphio", morphio.version)
