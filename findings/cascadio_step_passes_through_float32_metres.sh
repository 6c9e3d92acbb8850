#!/usr/bin/env bash
# cascadio, and so trimesh, reads a 10 mm cube at 1 km from a STEP file with a volume of 1002.
#
# OpenCascade computes in float64; cascadio hands its triangles on as glTF, in float32 metres, whose neighbours
# at 1000 m are 0.06 mm apart. The boxes that it states in the same glTF are in float64, and right. The STEP file is
# written by OpenCascade's own bindings, which read it back with the volume 1000.
#
# Seen with cascadio 0.1.1, cadquery-ocp-novtk 8.0.1.1.0:
#   OpenCascade's bindings: volume 999.9999999999998
#   cascadio 0.1.1: volume 1001.95, box in metres [1000.0, 1000.0, 0.0] [1000.01, 1000.01, 0.01]
#
# Exits 0 while the behaviour is as told, and 1 when it has changed.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check cascadio==0.1.1 cadquery-ocp-novtk==8.0.1.1.0 numpy==2.4.6 2>/dev/null
venv/bin/python - <<'PYTHON'
import json
import subprocess
import sys

import numpy as np

WRITE = """
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Reader, STEPControl_Writer
from OCP.gp import gp_Pnt
writer = STEPControl_Writer()
writer.Transfer(BRepPrimAPI_MakeBox(gp_Pnt(1e6, 1e6, 0), 10, 10, 10).Shape(), STEPControl_AsIs)
writer.Write("far.step")
reader = STEPControl_Reader()
reader.ReadFile("far.step")
reader.TransferRoots()
mass = GProp_GProps()
BRepGProp.VolumeProperties_s(reader.OneShape(), mass)
open("volume", "w").write(repr(mass.Mass()))
"""
subprocess.run([sys.executable, "-c", WRITE], check=True, stdout=subprocess.DEVNULL)  # its libraries apart from cascadio's
import cascadio

data = cascadio.load(open("far.step", "rb").read())
length = int.from_bytes(data[12:16], "little")
scene, buffer = json.loads(data[20 : 20 + length]), data[28 + length :]
primitive = scene["meshes"][0]["primitives"][0]
accessors = [scene["accessors"][k] for k in (primitive["attributes"]["POSITION"], primitive["indices"])]
views = [scene["bufferViews"][accessor["bufferView"]].get("byteOffset", 0) for accessor in accessors]
points = np.frombuffer(buffer, "<f4", 3 * accessors[0]["count"], views[0]).reshape(-1, 3).astype(float) * 1000
faces = np.frombuffer(buffer, "<u2", accessors[1]["count"], views[1]).reshape(-1, 3)
a, b, c = (points - points.mean(axis=0))[faces].transpose(1, 0, 2)
volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
print("OpenCascade's bindings: volume", open("volume").read())
print(f"cascadio {cascadio.__version__}: volume {volume:.2f}, box in metres {accessors[0]['min']} {accessors[0]['max']}")
raise SystemExit(bool(abs(volume - 1000) < 1))
PYTHON
