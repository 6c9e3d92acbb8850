"""3MF packages written by hand, and what a test asks of the mesh that is read from one."""

import zipfile

import numpy as np
import pytest

from reebslice.errors import MeshFormatError
from reebslice.formats import packages
from reebslice.formats.threemf import read_3mf

OLD = "http://schemas.microsoft.com/3dmanufacturing/"
START = f"{OLD}2013/01/3dmodel"
ROOT = "3D/3dmodel.model"
HEAD = '<?xml version="1.0" encoding="UTF-8"?>'

CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
BOX_FACES = np.array(
    [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2]]
    + [[1, 3, 7], [1, 7, 5]]
)


def mesh_xml(size=(1, 1, 1)):
    """A box with a corner at the origin."""
    vertices = "".join('<vertex x="{}" y="{}" z="{}"/>'.format(*point) for point in (CORNERS * size).tolist())
    triangles = "".join('<triangle v1="{}" v2="{}" v3="{}"/>'.format(*face) for face in BOX_FACES.tolist())
    return f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>"


def box(object_id=1, size=(1, 1, 1), more='type="model"'):
    """An object that is a box."""
    return f'<object id="{object_id}" {more}>{mesh_xml(size)}</object>'


def group(object_id, *uses):
    """An object of components, each given by its attributes."""
    components = "".join(f"<component {use}/>" for use in uses)
    return f'<object id="{object_id}"><components>{components}</components></object>'


def model_xml(objects="", items='<item objectid="1"/>', more=""):
    """A model part."""
    spaces = f'xmlns="{OLD}core/2015/02" xmlns:p="{OLD}production/2015/06"'
    return f"{HEAD}<model {spaces} {more}><resources>{objects}</resources><build>{items}</build></model>"


def relationships(*targets, more=""):
    """The package's relationships to its model."""
    rows = "".join(f'<Relationship Id="r{k}" Type="{START}" Target="{t}" {more}/>' for k, t in enumerate(targets))
    return f'{HEAD}<Relationships xmlns="{packages.RELATIONSHIP.split()[0]}">{rows}</Relationships>'


def write(folder, root=None, parts=(), name="a.3mf", targets=("/" + ROOT,)):
    """Write a package and return its path."""
    path = folder / name
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("_rels/.rels", relationships(*targets))
        if root is not None:
            archive.writestr(ROOT, root)
        for part, text in dict(parts).items():
            archive.writestr(part, text)
    return path


def volume(mesh):
    """The volume that the faces bound."""
    a, b, c = mesh.points[mesh.faces].transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def bounds(mesh):
    """The box of the points that faces use."""
    used = mesh.points[np.unique(mesh.faces)]
    return [used.min(axis=0).tolist(), used.max(axis=0).tolist()]


def refusal(path):
    """The sentence with which a file is refused."""
    with pytest.raises(MeshFormatError) as caught:
        read_3mf(path)
    return str(caught.value)
