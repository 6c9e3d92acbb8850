#!/usr/bin/env bash
# VTK: vtkGLTFReader leaves the faces of a mirrored node inside out.
#
# Run with Python 3.11.7, vtk 9.7.2. glTF 2.0, section Instantiation: the sign of the determinant of a node's global
# transform gives the winding of its triangles, so that a part mirrored by scale -1 keeps its outside. The reader
# (ApplyDeformationsToGeometry is on, its default) moves the points and keeps the order of the corners.
#
# Seen:   signed volume of a unit cube by scale 1, 1, 1:   1.0
#         and of the same cube by scale -1, 1, 1:         -1.0
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT; cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check vtk==9.7.2 numpy==2.4.6
cat > run.py <<'PY'
import base64, json, platform, sys
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

print(f"Python {platform.python_version()}, vtk {vtk.vtkVersion.GetVTKVersion()}")
corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], "<f4")
faces = np.array([0,2,1, 1,2,3, 4,5,6, 5,7,6, 0,1,4, 1,5,4, 2,6,3, 3,6,7, 0,4,2, 2,4,6, 1,3,5, 3,7,5], "<u2")

def volume(scale):
    data = corners.tobytes() + faces.tobytes()
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "scale": scale}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
        "buffers": [{"byteLength": 168, "uri": uri}],
    }
    with open("cube.gltf", "w") as file:
        json.dump(document, file)
    reader = vtk.vtkGLTFReader()
    reader.SetFileName("cube.gltf")
    reader.Update()
    surface = vtk.vtkCompositeDataGeometryFilter()
    surface.SetInputConnection(reader.GetOutputPort())
    surface.Update()
    mesh = surface.GetOutput()
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    a, b, c = points[vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)].transpose(1, 0, 2)
    return (a * np.cross(b, c)).sum() / 6

plain, mirrored = volume([1, 1, 1]), volume([-1, 1, 1])
print(f"signed volume: scale 1, 1, 1 {plain:.1f}; scale -1, 1, 1 {mirrored:.1f}")
sys.exit(0 if abs(plain - 1) < 1e-6 and abs(mirrored + 1) < 1e-6 else 1)
PY
venv/bin/python run.py
