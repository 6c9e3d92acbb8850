#!/bin/sh
# lib3mf takes a 3MF transform near the identity for none: in its bounds, and when it writes the file.
#
# One cube of 1000 units is built with four transforms, in metres. lib3mf hands the matrix out as the
# file has it (GetObjectTransform); but HasObjectTransform says that there is none where the matrix is
# within an absolute tolerance of the identity, GetOutbox leaves it out, and the file that lib3mf writes
# from what it read does not have it. A shift of 0.0002 m, a fifth of a millimetre, is lost so, and a
# scale of 0.9999 by which the cube's volume is 3e-4 smaller. The tolerance does not depend on the unit,
# so the same drawing in millimetres keeps its shift of 0.2.
#
# Seen with lib3mf 2.5.0 (Python 3.11, Linux x86_64):
#   shift by 0.0005: transform True, outbox up to 1000.0005, written with a transform
#   shift by 0.0002: transform False, outbox up to 1000.0000, written without a transform
#   scale by 0.9995: transform True, outbox up to 999.5000, written with a transform
#   scale by 0.9999: transform False, outbox up to 1000.0000, written without a transform
# Exit status 0 while that is so, 1 if the behaviour changes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet lib3mf==2.5.0
cat > check.py <<'PYTHON'
import sys
import zipfile

import lib3mf

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
OPC = "http://schemas.openxmlformats.org/package/2006"
CORNERS = [(x, y, z) for z in (0, 1000) for y in (0, 1000) for x in (0, 1000)]
FACES = "0 2 3/0 3 1/4 5 7/4 7 6/0 1 5/0 5 4/1 3 7/1 7 5/3 2 6/3 6 7/2 0 4/2 4 6"
CASES = {
    "shift by 0.0005": "1 0 0 0 1 0 0 0 1 0.0005 0 0",
    "shift by 0.0002": "1 0 0 0 1 0 0 0 1 0.0002 0 0",
    "scale by 0.9995": "0.9995 0 0 0 0.9995 0 0 0 0.9995 0 0 0",
    "scale by 0.9999": "0.9999 0 0 0 0.9999 0 0 0 0.9999 0 0 0",
}


def write(name, transform):
    vertices = "".join('<vertex x="%d" y="%d" z="%d"/>' % corner for corner in CORNERS)
    triangles = "".join('<triangle v1="%s" v2="%s" v3="%s"/>' % tuple(f.split()) for f in FACES.split("/"))
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{OPC}/content-types"><Default Extension="rels" ContentType='
        '"application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType='
        '"application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>',
        "_rels/.rels": f'<Relationships xmlns="{OPC}/relationships"><Relationship Target="/3D/3dmodel.model" Id="r0"'
        ' Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>',
        "3D/3dmodel.model": f'<model unit="meter" xml:lang="en-US" xmlns="{CORE}"><resources><object id="1" type="model">'
        f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh></object></resources>"
        f'<build><item objectid="1" transform="{transform}"/></build></model>',
    }
    with zipfile.ZipFile(name, "w") as package:
        for part, text in parts.items():
            package.writestr(part, '<?xml version="1.0" encoding="UTF-8"?>' + text)


wrapper = lib3mf.get_wrapper()
print("lib3mf", ".".join(map(str, wrapper.GetLibraryVersion())))
seen = []
for title, transform in CASES.items():
    write("in.3mf", transform)
    model = wrapper.CreateModel()
    model.QueryReader("3mf").ReadFromFile("in.3mf")
    items = model.GetBuildItems()
    items.MoveNext()
    has = bool(items.GetCurrent().HasObjectTransform())
    top = model.GetOutbox().MaxCoordinate[0]
    model.QueryWriter("3mf").WriteToFile("out.3mf")
    kept = "transform=" in zipfile.ZipFile("out.3mf").read("3D/3dmodel.model").decode()
    seen.append((has, round(top, 3), kept))
    print(f"{title}: transform {has}, outbox up to {top:.4f}, written {'with' if kept else 'without'} a transform")
expected = [(True, 1000.0, True), (False, 1000.0, False), (True, 999.5, True), (False, 1000.0, False)]
sys.exit(0 if seen == expected else f"lib3mf changed: {seen}")
PYTHON
venv/bin/python check.py
