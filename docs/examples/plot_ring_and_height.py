"""
One ring, two directions
========================

The Reeb graph of a solid depends on what is up. Upright, a ring is two regions at the heights of its hole, and its
graph has a loop; lying, it is one region at every height. The surface's graph has the loop either way, since that is
the genus.
"""

import matplotlib.pyplot as plt
import numpy as np
import trimesh

import reebslice

ring = trimesh.creation.torus(3, 1, major_sections=64, minor_sections=32)
upright = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])

figure, rows = plt.subplots(1, 2, figsize=(7, 3.2), layout="constrained", sharey=True)
for axes, (name, turn) in zip(rows, {"lying": None, "upright": upright}.items()):
    mesh = reebslice.height_mesh(ring.vertices, ring.faces, turn)
    surface, solid = reebslice.exact_graphs(mesh)
    loops = {which: len(g.arcs) - len(g.vertex) + 1 for which, g in (("surface", surface), ("solid", solid))}
    print(name, loops)
    # contours of one level in the middle of the hole
    contours, regions = reebslice.nested_contours(mesh, [0.05])
    for c in range(len(regions.inner)):
        curve = contours.points[contours.start[c] : contours.start[c + 1]]
        axes.fill(*curve[:, :2].T, color="white" if regions.inner[c] else "#9cc3d5", ec="#1f2933")
    axes.set(title=f"{name}: {len(np.unique(regions.of_contour))} region(s) at this level", aspect="equal")

# %%
# The loop has a place: lying, the hole is a tunnel that one looks through from above; upright, the same ring has a
# bar of material as wide as its tube.

for name, turn in {"lying": None, "upright": upright}.items():
    found = reebslice.find_loops(ring.vertices, ring.faces, turn)
    print(name, found.kind[0], "of radius", found.inscribed_radius[0].round(2))
plt.show()
