#!/usr/bin/env bash
# MeshLab: a primitive of LINES in glTF comes back as triangles, three ends of lines after three.
#
# Run with Python 3.11.7, pymeshlab 2025.7.post1. A mesh is a unit cube of 12 triangles and, as CAD programs add them
# for drawing, a second primitive of three lines along its edges (mode 1). Lines have no faces in glTF 2.0; here
# they add two triangles to the surface, which is then no longer closed, and nothing is said of it. Line strips
# and loops (modes 2 and 3) likewise; points (mode 0) are left out.
#
# Seen:   faces of the cube alone 12; of the cube and three lines 14; of the cube and six points 12
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT; cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check pymeshlab==2025.7.post1 numpy==2.4.6
cat > run.py <<'PY'
import base64, json, platform, sys
from importlib.metadata import version
import numpy as np
import pymeshlab

print(f"Python {platform.python_version()}, pymeshlab {version('pymeshlab')}")
corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], "<f4")
faces = np.array([0,2,1, 1,2,3, 4,5,6, 5,7,6, 0,1,4, 1,5,4, 2,6,3, 3,6,7, 0,4,2, 2,4,6, 1,3,5, 3,7,5], "<u2")

def count_faces(primitives):
    data = corners.tobytes() + faces.tobytes()
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    bounds = {"min": [0, 0, 0], "max": [1, 1, 1]}
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": primitives}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", **bounds},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
            {"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3", **bounds},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
        "buffers": [{"byteLength": 168, "uri": uri}],
    }
    with open("cube.gltf", "w") as file:
        json.dump(document, file)
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh("cube.gltf")
    return [meshes.mesh(k).face_number() for k in range(meshes.mesh_number())]

cube = {"attributes": {"POSITION": 0}, "indices": 1}
alone = count_faces([cube])
points, lines = (count_faces([cube, {"attributes": {"POSITION": 2}, "mode": mode}]) for mode in (0, 1))
print(f"faces of the cube alone {sum(alone)}; of the cube and three lines {sum(lines)}; and six points {sum(points)}")
sys.exit(0 if (sum(alone), sum(lines), sum(points)) == (12, 14, 12) else 1)
PY
venv/bin/python run.py
