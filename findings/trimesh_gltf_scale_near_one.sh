#!/bin/sh
# trimesh replaces a glTF node's scale by 1 where it is within about 5e-6 of 1, and so the volume is wrong.
#
# trimesh's scene graph takes a matrix close to a rotation for a rotation that suffered from rounding, and
# puts the nearest rotation in its place (SceneGraph repairs by default what deviates less than 1e-5).
# A cube with an edge of 2000 units whose node has the scale 1.000004 is 2000.008 units wide by the
# file, and 2000 in trimesh: 65 times the step of a float32 there. At 1.000006 the scale is honoured.
# The 3MF files that ruby3mf and lib3mf carry as tests have build items with 0.999997 in their matrices.
#
# Seen with trimesh 5.2.0, numpy 2.4.6 (Python 3.11, Linux x86_64):
#   node scale 1.000004: width 2000.000 for 2000.008
#   node scale 1.000006: width 2000.012 for 2000.012
# Exit status 0 while that is so, 1 if the behaviour changes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet trimesh==5.2.0 numpy==2.4.6 networkx
cat > check.py <<'PYTHON'
import base64
import json
import sys
from pathlib import Path

import numpy as np
import trimesh

POINTS = np.array([(x, y, z) for z in (0, 2000) for y in (0, 2000) for x in (0, 2000)], "<f4")
FACES = np.array("0 2 3 0 3 1 4 5 7 4 7 6 0 1 5 0 5 4 1 3 7 1 7 5 3 2 6 3 6 7 2 0 4 2 4 6".split(), "<u2")


def write(name, scale):
    data = POINTS.tobytes() + FACES.tobytes()
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    asset = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "scale": [scale] * 3}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0, 0, 0], "max": [2000] * 3},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
        "buffers": [{"byteLength": len(data), "uri": uri}],
    }
    Path(name).write_text(json.dumps(asset))


print("trimesh", trimesh.__version__, "numpy", np.__version__)
seen = []
for scale in (1.000004, 1.000006):
    write("cube.gltf", scale)
    width = trimesh.load_scene("cube.gltf", process=False).to_mesh().extents[0]
    seen.append(round(float(width), 3))
    print(f"node scale {scale}: width {width:.3f} for {2000 * scale:.3f}")
sys.exit(0 if seen == [2000.0, 2000.012] else f"trimesh changed: {seen}")
PYTHON
venv/bin/python check.py
