#!/bin/sh
# MeshLib's detectTunnelFaces leaves tunnels, though what it returns is said to make the surface a sphere.
#
# Its documentation says that if the returned faces are removed and every border is patched with a disk, the surface
# is topologically a sphere. Of a frame of bars along the edges of 2 x 2 x 2 cubes (genus 28) what is left has genus
# 11: by default one round is made, which finds tunnels that do not meet, and the setting maxIters asks for more. With
# 100 rounds the frame of 3 x 3 x 3 cubes (genus 81) still keeps genus 2. detectBasisTunnels finds all: 2 x genus loops.
#
# Seen with meshlib 3.1.4.297, numpy 2.4.6 (Python 3.11, Linux x86_64):
#   2 x 2 x 2 cubes, as it comes: genus 28, 56 basis loops, genus 11 left
#   3 x 3 x 3 cubes, 100 rounds: genus 81, 162 basis loops, genus 2 left
# Exit status 0 while tunnels are left in both, 1 if the behaviour changes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet meshlib==3.1.4.297 numpy==2.4.6
cat > check.py <<'PYTHON'
import sys

import meshlib.mrmeshnumpy as convert
import meshlib.mrmeshpy as mr
import numpy as np


def frame(cubes):
    """The surface of bars along the edges of cubes, in cells: closed, triangles wound outward."""
    size = (2 * cubes + 1,) * 3
    filled = sum(grid % 2 for grid in np.indices(size)) <= 1
    around, quads = np.pad(filled, 1), []
    for axis in range(3):
        one, two = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, 1):
            for cell in np.argwhere(filled):
                beside = cell + 1
                beside[axis] += 2 * side - 1
                if around[tuple(beside)]:
                    continue
                corners = np.repeat(cell[None], 4, axis=0)
                corners[:, axis] += side
                corners[:, one] += [0, 1, 1, 0]
                corners[:, two] += [0, 0, 1, 1]
                quads.append(corners if side else corners[::-1])
    points, corner = np.unique(np.reshape(quads, (-1, 3)), axis=0, return_inverse=True)
    corner = corner.reshape(-1, 4)
    faces = np.concatenate([corner[:, [0, 1, 2]], corner[:, [0, 2, 3]]])
    return convert.meshFromFacesVerts(faces.astype(np.int32), points.astype(float))


def genus(mesh):
    topology, parts = mesh.topology, len(mr.getAllComponents(mr.MeshPart(mesh)))
    edges = topology.computeNotLoneUndirectedEdges()
    return parts - (topology.numValidVerts() - edges + topology.numValidFaces()) // 2


left = []
for cubes, rounds, told in ((2, None, "as it comes"), (3, 100, "100 rounds")):
    mesh, settings = frame(cubes), mr.DetectTunnelSettings()
    if rounds:
        settings.maxIters = rounds
    before, loops = genus(mesh), len(mr.detectBasisTunnels(mr.MeshPart(mesh)))
    mesh.topology.deleteFaces(mr.detectTunnelFaces(mr.MeshPart(mesh), settings))
    for edge in mesh.topology.findHoleRepresentiveEdges():
        mr.fillHoleTrivially(mesh, edge)
    left.append(genus(mesh))
    print(f"{cubes} x {cubes} x {cubes} cubes, {told}: genus {before}, {loops} basis loops, genus {left[-1]} left")
sys.exit(0 if min(left) > 0 else f"meshlib changed: {left}")
PYTHON
venv/bin/python check.py
