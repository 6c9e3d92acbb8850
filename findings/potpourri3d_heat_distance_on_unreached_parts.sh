#!/usr/bin/env bash
# potpourri3d 1.4.0: heat distance gives finite, plausible numbers on parts of a mesh that the source does not reach.
#
# Two closed spheres far apart in one mesh, which share no vertex. From a vertex of the first one there is no way along
# the surface to the second one: the exact algorithm (pygeodesic 0.1.11) says infinity there, and so would a user expect,
# as of graph distances in scipy. MeshHeatMethodDistanceSolver.compute_distance(source) returns finite numbers, of the
# size of real distances, without a warning: one and the same at all vertices of such a part, half-way through the range
# of the real ones, which means nothing. Whoever takes the
# farthest vertex, or cuts at a distance, over a mesh of several parts gets vertices of parts that were never reached.
# Seen with numpy 2.4, scipy 1.17, Python 3.11:
#   own sphere: heat 0.00 to 3.11, exact 0.00 to 3.14
#   other sphere: heat 1.56 at all 2562 vertices; exact infinite at all of them
#
# Exits 0 while this is so, 1 once it behaves otherwise.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check potpourri3d==1.4.0 pygeodesic==0.1.11 trimesh==4.10.1 'numpy<3' scipy
"$folder/venv/bin/python" - <<'PY'
import sys

import numpy as np
import potpourri3d
import trimesh
from pygeodesic.geodesic import PyGeodesicAlgorithmExact

ball = trimesh.creation.icosphere(subdivisions=4)
points = np.vstack([ball.vertices, ball.vertices + [10.0, 0, 0]])
faces = np.vstack([ball.faces, ball.faces + len(ball.vertices)]).astype(np.int32)
own = np.arange(len(points)) < len(ball.vertices)
exact, _ = PyGeodesicAlgorithmExact(points, faces).geodesicDistances(np.array([0]), None)
found = {}
for scale in (1.0, 10.0):
    heat = potpourri3d.MeshHeatMethodDistanceSolver(points, faces, t_coef=scale).compute_distance(0)
    found[scale] = heat
    print(f"t_coef {scale}: own sphere: heat {heat[own].min():.2f} to {heat[own].max():.2f}, exact {exact[own].min():.2f} to {exact[own].max():.2f}")
    print(f"  other sphere: heat {heat[~own].min():.2f} to {heat[~own].max():.2f}, {np.isfinite(heat[~own]).sum()} of {(~own).sum()} finite; exact: {np.isinf(exact[~own]).sum()} infinite")
same = all(np.isfinite(heat).all() for heat in found.values()) and np.isinf(exact[~own]).all()
sys.exit(0 if same else 1)
PY
