#!/usr/bin/env bash
# trimesh takes supports of a 3MF file for bodies, and reads on over a required extension.
#
# Objects of type `support` may be open and are never filled (3MF core specification, 4.1), and who does not
# support a required extension MUST fail (2.3.1). trimesh looks at neither: the support of a box is one more body of its
# scene, and a file that says that its mesh is not the whole shape loads without a word.
#
# Seen with trimesh 5.2.0:
#   trimesh 5.2.0
#   one solid and its support: 2 bodies
#   a file that requires beam lattices: read, volume 8.0
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

print("trimesh", trimesh.__version__)
group = "".join(f'<component objectid="{k}" p:UUID="{uuid()}"/>' for k in (1, 2))
group = f'<object id="3" p:UUID="{uuid()}"><components>{group}</components></object>'
objects = box(1, (0, 0, 0), 2) + box(2, (5, 0, 0), 1, "support") + group
write("support.3mf", model(objects, f'<item objectid="3" p:UUID="{uuid()}"/>'))
bodies = len(trimesh.load_scene("support.3mf", process=False).graph.nodes_geometry)
print("one solid and its support:", bodies, "bodies")
more = f'xmlns:b="{OLD}beamlattice/2017/02" requiredextensions="p b"'
write("required.3mf", model(box(1, (0, 0, 0), 2), f'<item objectid="1" p:UUID="{uuid()}"/>', more))
try:
    loaded = trimesh.load_scene("required.3mf", process=False).to_mesh().volume
except Exception as error:
    loaded = None
    print(type(error).__name__, error)
print("a file that requires beam lattices: read, volume", loaded)
raise SystemExit(bodies != 2 or loaded is None)
PYTHON
