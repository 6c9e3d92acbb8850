#!/usr/bin/env bash
# trimesh loses, doubles or swaps the bodies of a 3MF file that keeps them in parts of their own.
#
# The production extension lets items and components name an object by part and id (`p:path`), as slicers do
# today. trimesh reads all meshes of the part that a component names, whichever object it asks for, once more for each
# component; keys objects by id alone, so that equal ids in two parts are one; and does not look at paths of items.
#
# Seen with trimesh 5.2.0:
#   trimesh 5.2.0
#   two objects of one part, volume 35: 70.0
#   one id in two parts, volume 35: 70.0
#   an item with a path, volume 8: 0.0
#
# Exits 0 while the behaviour is as told, and 1 when it has changed.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check trimesh==5.2.0 lxml==6.1.3 networkx==3.6.1 scipy==1.17.1 2>/dev/null
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


import trimesh


def use(tag, object_id, part="", x=0):
    path = f'p:path="/{part}"' if part else ""
    return f'<{tag} objectid="{object_id}" {path} p:UUID="{uuid()}" transform="1 0 0 0 1 0 0 0 1 {x} 0 0"/>'


def group(*uses):
    return f'<object id="9" p:UUID="{uuid()}"><components>{"".join(uses)}</components></object>'


one, two = "3D/Objects/one.model", "3D/Objects/two.model"
both = {one: model(box(1, (0, 0, 0), 2) + box(2, (0, 0, 0), 3), "")}
apart = {one: model(box(1, (0, 0, 0), 2), ""), two: model(box(1, (0, 0, 0), 3), "")}
cases = {
    "two objects of one part, volume 35": (group(use("component", 1, one), use("component", 2, one, 9)), use("item", 9), both),
    "one id in two parts, volume 35": (group(use("component", 1, one), use("component", 1, two, 9)), use("item", 9), apart),
    "an item with a path, volume 8": ("", use("item", 1, one), both),
}
print("trimesh", trimesh.__version__)
right = 0
for name, (objects, items, parts) in cases.items():
    write("case.3mf", model(objects, items), parts)
    try:
        found = float(trimesh.load_scene("case.3mf", process=False).to_mesh().volume)
    except Exception as error:
        found = f"{type(error).__name__}: {error}"
    print(f"{name}: {found}")
    right += isinstance(found, float) and abs(found - float(name.split()[-1])) < 1e-6
raise SystemExit(bool(right))
PYTHON
