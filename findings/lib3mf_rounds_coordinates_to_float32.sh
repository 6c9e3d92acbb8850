#!/usr/bin/env bash
# lib3mf, the reference reader of 3MF, rounds coordinates to float32.
#
# The 3MF core specification (4.1.3.1) has coordinates as decimal numbers of arbitrary precision. lib3mf keeps
# them as float32, whose neighbours at 1 km are 0.06 mm apart: a box of 10.03 mm there comes back 10 mm wide.
#
# Seen with lib3mf 2.5.0:
#   lib3mf (2, 5, 0)
#   box of 10.03 x 10.03 x 10.03 read as [10.0, 10.0, 10.029999732971191] volume 1002.9999732971191 for 1009.0270269999999
#
# Exits 0 while the behaviour is as told, and 1 when it has changed.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check lib3mf==2.5.0 2>/dev/null
venv/bin/python - <<'PYTHON'
import zipfile

HEAD = '<?xml version="1.0" encoding="UTF-8"?>'
OLD = "http://schemas.microsoft.com/3dmanufacturing/"
OPC = "http://schemas.openxmlformats.org/package/2006/"
CORNERS = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
FACES = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2)]
FACES += [(1, 3, 7), (1, 7, 5)]


def box(object_id, low, size, kind="model"):
    places = [tuple(low[k] + size * c[k] for k in range(3)) for c in CORNERS]
    vertices = "".join('<vertex x="%r" y="%r" z="%r"/>' % place for place in places)
    triangles = "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % face for face in FACES)
    mesh = f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>"
    return f'<object id="{object_id}" type="{kind}" p:UUID="{uuid()}">{mesh}</object>'


def uuid(count=[0]):
    count[0] += 1
    return f"00000000-0000-4000-8000-{count[0]:012d}"


def model(objects, items, more='requiredextensions="p"'):
    spaces = f'xmlns="{OLD}core/2015/02" xmlns:p="{OLD}production/2015/06"'
    return f'{HEAD}<model {spaces} unit="millimeter" {more}><resources>{objects}</resources><build p:UUID="{uuid()}">{items}</build></model>'


def rels(*targets):
    rows = "".join(f'<Relationship Id="r{k}" Type="{OLD}2013/01/3dmodel" Target="{t}"/>' for k, t in enumerate(targets))
    return f'{HEAD}<Relationships xmlns="{OPC}relationships">{rows}</Relationships>'


def write(path, root, parts={}):
    types = f'<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    types += f'<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>'
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("[Content_Types].xml", f'{HEAD}<Types xmlns="{OPC}content-types">{types}</Types>')
        archive.writestr("_rels/.rels", rels("/3D/3dmodel.model"))
        archive.writestr("3D/3dmodel.model", root)
        if parts:
            archive.writestr("3D/_rels/3dmodel.model.rels", rels(*("/" + part for part in parts)))
        for part, text in parts.items():
            archive.writestr(part, text)


import lib3mf

write("far.3mf", model(box(1, (1e6, 1e6, 0.0), 10.03), f'<item objectid="1" p:UUID="{uuid()}"/>'))
library = lib3mf.get_wrapper()
scene = library.CreateModel()
scene.QueryReader("3mf").ReadFromFile("far.3mf")
objects = scene.GetMeshObjects()
objects.MoveNext()
mesh = objects.GetCurrentMeshObject()
points = [tuple(vertex.Coordinates) for vertex in mesh.GetVertices()]
size = [max(p[k] for p in points) - min(p[k] for p in points) for k in range(3)]
print("lib3mf", library.GetLibraryVersion())
print("box of 10.03 x 10.03 x 10.03 read as", size, "volume", size[0] * size[1] * size[2], "for", 10.03**3)
raise SystemExit(abs(size[0] - 10.03) < 0.001)
PYTHON
