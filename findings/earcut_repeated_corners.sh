#!/bin/sh
# mapbox_earcut leaves corners of a polygon out of its triangles, so that a closed surface cut by it opens.
#
# An L-shaped polygon names a corner twice, as CAD exports do, and another polygon has a
# spike, two mesh edges in one place. The area of the triangles is right and no exception is raised, but there
# are fewer than n - 2, and mesh edges of the outline are missing: the neighbour across such an edge
# loses its partner. A check of the area alone does not notice. manifold3d keeps every outline.
#
# Seen with mapbox_earcut 2.1.0, manifold3d 3.5.4 (Python 3.11, Linux x86_64):
#   repeated corner: 7 corners; mapbox_earcut 4 triangles, area 12.0 of 12.0, outline edges missing 2; manifold3d 5, 0
#   spike: 6 corners; mapbox_earcut 2 triangles, area 16.0 of 16.0, outline edges missing 3; manifold3d 4, 0
# Exit status 0 while that is so, 1 if the behaviour changes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet mapbox_earcut==2.1.0 manifold3d==3.5.4 numpy
cat > cut.py <<'END'
import sys

import manifold3d
import mapbox_earcut
import numpy as np

POLYGONS = {
    "repeated corner": [(0, 0), (4, 0), (4, 2), (2, 2), (2, 2), (2, 4), (0, 4)],
    "spike": [(0, 0), (4, 0), (6, 0), (4, 0), (4, 4), (0, 4)],
}


def missing(n, triangles):
    edges = {(int(a), int(b)) for one in triangles for a, b in zip(one, np.roll(one, -1))}
    return sum((k, (k + 1) % n) not in edges for k in range(n))


changed = False
for name, outline in POLYGONS.items():
    places = np.array(outline, float)
    n, (x, y) = len(places), places.T
    cut = mapbox_earcut.triangulate_float64(places, np.array([n], np.uint32)).reshape(-1, 3)
    whole = manifold3d.triangulate([places])
    a, b, c = (places[cut[:, k]] for k in range(3))
    area = abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]).sum() / 2
    right = (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2
    lost, kept = missing(n, cut), missing(n, whole)
    print(f"{name}: {n} corners; mapbox_earcut {len(cut)} triangles, area {area} of {right},"
          f" outline edges missing {lost}; manifold3d {len(whole)}, {kept}")
    changed |= not (len(cut) < n - 2 and lost and area == right and len(whole) == n - 2 and not kept)
sys.exit(changed)
END
venv/bin/python cut.py
