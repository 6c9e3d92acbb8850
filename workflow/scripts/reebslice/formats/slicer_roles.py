"""Roles that slicers give to bodies of a 3MF package, in files of their own beside the model.

Bambu Studio and Orca Slicer write `Metadata/model_settings.config`, a part of
an object per component; PrusaSlicer and its kin write
`Metadata/Slic3r_PE_model.config`, a volume of an object per range of its
triangles. Neither is part of 3MF.
"""

from ..errors import MeshFormatError
from .packages import parse_xml

ENDINGS = ("model_settings.config", "_model.config")
PLAIN = ("normal_part", "ModelPart", "")


def describe_roles(package):
    """Return a sentence for each body to which a slicer's file gives a role other than that of a part.

    Parameters
    ----------
    package : `packages.Package`

    Returns
    -------
    list of str
        A file that cannot be read is told as well.
    """
    notes = []
    for name in package.names():
        if name.endswith(ENDINGS):
            try:
                notes += [
                    f"The slicer's settings ({name}) make {body} of object {owner} a '{role}'; 3MF has no such role,"
                    " so it is read as a body like any other."
                    for owner, body, role in read_roles(package.read(name), name)
                ]
            except MeshFormatError as error:
                notes.append(f"The slicer's settings were not read: {error}")
    return notes


def read_roles(data, name):
    """Return (object id, body, role) of the bodies whose role is told, from a slicer's settings of the model.

    Parameters
    ----------
    data : bytes
    name : name of the part

    Returns
    -------
    list of (str, str, str)
        Role as the slicer writes it: 'negative_part', 'ParameterModifier', ...

    Raises
    ------
    MeshFormatError
        The XML is damaged.
    """
    found, owner, body = [], "", {}

    def start(tag, attributes):
        nonlocal owner, body
        if tag == "object":
            owner = attributes.get("id", "")
        elif tag in ("part", "volume"):
            what = f"triangles {attributes['firstid']} to {attributes.get('lastid')}" if "firstid" in attributes else ""
            body = {"what": what or f"part {attributes.get('id')}", "role": attributes.get("subtype", ""), "name": ""}
        elif tag == "metadata" and body:
            key, value = attributes.get("key"), attributes.get("value", "")
            if key == "name":
                body["name"] = value
            elif key == "volume_type" or (key == "modifier" and value == "1" and not body["role"]):
                body["role"] = value if key == "volume_type" else "ParameterModifier"

    def end(tag):
        nonlocal body
        if tag in ("part", "volume"):
            if body["role"] not in PLAIN:
                found.append((owner, f"{body['what']} '{body['name']}'", body["role"]))
            body = {}

    parse_xml(data, name, start, end)
    return found
