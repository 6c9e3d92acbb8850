"""3MF is read as its core specification and its production extension say, or refused by name."""

import json
import re
import zipfile
from pathlib import Path

import numpy as np
import pytest

from reebslice.formats import threemf_scene
from reebslice.formats.threemf import read_3mf
from threemf_files import HEAD, OLD, ROOT, bounds, box, group, model_xml, refusal, volume, write

CASES = Path(__file__).parent.parent.parent / "shared" / "cases"
NEW = "http://schemas.3mf.io/3dmanufacturing/"


# --------------------------------------------------------------------------
# Files made for this purpose, with their right answers


@pytest.mark.skipif(not CASES.exists(), reason="../shared/cases is not there")
@pytest.mark.parametrize("path", sorted(CASES.glob("*.3mf")), ids=lambda path: path.stem)
def test_a_shared_case_has_its_right_answer(path):
    expected = json.loads((CASES / "expected.json").read_text())[path.name]
    if expected.get("status") == "rejected":
        assert "beam lattice" in refusal(path)
        return
    mesh = read_3mf(path)
    assert volume(mesh) == pytest.approx(expected.get("volume", 1), rel=1e-12)
    if "bounds" in expected:
        assert bounds(mesh) == expected["bounds"]
    assert mesh.unit == ("inch" if "inch" in path.stem else "millimetre")


# --------------------------------------------------------------------------
# Units, transforms, types, parts


@pytest.mark.parametrize("written, told", [*threemf_scene.UNITS.items(), (None, "millimetre")])
def test_the_unit_is_told_and_never_applied(tmp_path, written, told):
    mesh = read_3mf(write(tmp_path, model_xml(box(), more=f'unit="{written}"' if written else "")))
    assert mesh.unit == told and volume(mesh) == 1
    assert mesh.faces.shape == (12, 3) and mesh.points.dtype == np.float64 and mesh.notes == ()


def test_an_unknown_unit_is_refused(tmp_path):
    assert "'parsec'" in refusal(write(tmp_path, model_xml(box(), more='unit="parsec"')))


def test_a_component_is_placed_by_its_own_matrix_and_then_by_the_items(tmp_path):
    objects = box(1, (1, 2, 3)) + group(2, 'objectid="1" transform="1 0 0 0 1 0 0 0 1 10 0 0"')
    quarter = "0 1 0 -1 0 0 0 0 1 0 0 5"  # row vectors: x to y, y to -x; then up by 5
    mesh = read_3mf(write(tmp_path, model_xml(objects, f'<item objectid="2" transform="{quarter}"/>')))
    assert bounds(mesh) == [[-2, 10, 5], [0, 11, 8]] and volume(mesh) == pytest.approx(6)


@pytest.mark.parametrize(
    "matrix", ["-1 0 0 0 1 0 0 0 1 0 0 0", "0 1 0 1 0 0 0 0 1 7 7 7", "-2 0 0 0 -1 0 0 0 -1 0 0 0"]
)
def test_a_mirrored_body_keeps_the_sign_of_its_volume(tmp_path, matrix):
    mesh = read_3mf(write(tmp_path, model_xml(box(), f'<item objectid="1" transform="{matrix}"/>')))
    assert volume(mesh) == pytest.approx(2 if "2" in matrix else 1)


def test_copies_have_points_of_their_own(tmp_path):
    mesh = read_3mf(write(tmp_path, model_xml(box(), '<item objectid="1"/>' * 2)))
    assert len(mesh.points) == 16 and volume(mesh) == 2
    assert not set(mesh.faces[:12].ravel()) & set(mesh.faces[12:].ravel())


@pytest.mark.parametrize("kind", ["support", "surface", "other"])
def test_what_is_no_solid_is_left_out_and_told(tmp_path, kind):
    objects = box(1) + box(2, more=f'type="{kind}" name="thin"') + group(3, 'objectid="1"', 'objectid="2"')
    mesh = read_3mf(write(tmp_path, model_xml(objects, '<item objectid="3"/>')))
    assert volume(mesh) == 1
    assert mesh.notes == (f"Object 2 'thin' of part /{ROOT} is of type '{kind}', no solid, and left out.",)
    alone = refusal(write(tmp_path, model_xml(objects, '<item objectid="2"/>')))
    assert "no solid" in alone and kind in alone


def test_solid_support_is_a_solid_and_the_type_of_a_group_says_nothing(tmp_path):
    grouped = group(2, 'objectid="1"').replace('id="2"', 'id="2" type="support"')
    mesh = read_3mf(write(tmp_path, model_xml(box(1, more='type="solidsupport"') + grouped, '<item objectid="2"/>')))
    assert volume(mesh) == 1 and mesh.notes == ()


def test_objects_that_are_not_built_are_left_out_and_told(tmp_path):
    mesh = read_3mf(write(tmp_path, model_xml(box(1) + box(2, (9, 9, 9)) + box(3))))
    assert volume(mesh) == 1
    assert mesh.notes == (f"2 objects (2, 3) of part /{ROOT} are not in the build, and left out.",)


def test_objects_are_keyed_by_part_and_id(tmp_path):
    parts = {f"3D/Objects/{k}.model": model_xml(box(1, (k, 1, 1)), "") for k in (2, 3)}
    uses = [f'objectid="1" p:path="/3D/Objects/{k}.model"' for k in (2, 3)]
    objects = box(1) + group(5, 'objectid="1"', *uses)
    items = f'<item objectid="5"/><item {uses[1]} transform="1 0 0 0 1 0 0 0 1 0 0 9"/>'
    mesh = read_3mf(write(tmp_path, model_xml(objects, items, 'requiredextensions="p"'), parts))
    assert volume(mesh) == pytest.approx(1 + 2 + 3 + 3) and mesh.notes == ()


def test_a_parts_name_is_one_in_any_case_and_percent_encoded_or_not(tmp_path):
    root = model_xml("", '<item objectid="1" p:path="/3d/My%20Part.model"/>')
    path = write(tmp_path, root, {"3D/my part.model": model_xml(box(), "")}, targets=("3d/3DModel.model",))
    assert volume(read_3mf(path)) == 1


def test_only_the_root_part_names_other_parts(tmp_path):
    inner = model_xml(group(2, 'objectid="1" p:path="/3D/b.model"'), "")
    parts = {"3D/a.model": inner, "3D/b.model": model_xml(box(), "")}
    told = refusal(write(tmp_path, model_xml("", '<item objectid="2" p:path="/3D/a.model"/>'), parts))
    assert "component 0" in told and "/3D/a.model" in told and "root part alone" in told


def test_parts_in_different_units_are_refused(tmp_path):
    parts = {"3D/a.model": model_xml(box(), "", 'unit="inch"')}
    told = refusal(write(tmp_path, model_xml("", '<item objectid="1" p:path="/3D/a.model"/>'), parts))
    assert "inch" in told and "millimetre" in told


def test_parts_that_nothing_refers_to_are_told_and_not_unpacked(tmp_path):
    path = write(tmp_path, model_xml(box()), {"3D/idle.model": model_xml(box())})
    data = path.read_bytes()
    with zipfile.ZipFile(path) as archive:
        start = archive.getinfo("3D/idle.model").header_offset + 30 + len("3D/idle.model")
    path.write_bytes(data[:start] + bytes(20) + data[start + 20 :])  # what cannot be unpacked is not missed
    mesh = read_3mf(path)
    assert volume(mesh) == 1 and mesh.notes == ("The build does not refer to /3D/idle.model, which is not read.",)


def test_items_that_a_slicer_does_not_print_are_read_and_told(tmp_path):
    mesh = read_3mf(write(tmp_path, model_xml(box(), '<item objectid="1"/><item objectid="1" printable="0"/>')))
    assert volume(mesh) == 2 and "Items 1 of the build" in mesh.notes[0] and "printable" in mesh.notes[0]


# --------------------------------------------------------------------------
# Extensions

HONOURED = [f"{OLD}production/2015/06", f"{OLD}material/2015/02", f"{OLD}slice/2015/07", f"{OLD}trianglesets/2021/07"]
REFUSED = {
    "beam lattice": f"{OLD}beamlattice/2017/02",
    "volumetric": f"{NEW}volumetric/2022/01",
    "implicit": f"{NEW}implicit/2023/12",
    "displacement": f"{OLD}displacement/2022/07",
    "boolean operations": f"{NEW}booleanoperations/2023/07",
    "secure content": f"{OLD}securecontent/2019/04",
    "alternatives": f"{OLD}production/alternatives/2021/04",
    "http://example.com/own/2020": "http://example.com/own/2020",
}


@pytest.mark.parametrize("uri", HONOURED)
def test_a_required_extension_that_leaves_the_mesh_alone_is_honoured(tmp_path, uri):
    assert volume(read_3mf(write(tmp_path, model_xml(box(), more=f'xmlns:q="{uri}" requiredextensions="q"')))) == 1


@pytest.mark.parametrize("name, uri", REFUSED.items())
def test_another_required_extension_is_refused_by_name(tmp_path, name, uri):
    told = refusal(write(tmp_path, model_xml(box(), more=f'xmlns:q="{uri}" requiredextensions=" p  q "')))
    assert name in told and uri in told and f"/{ROOT}" in told


def test_a_required_prefix_that_nothing_declares_is_refused(tmp_path):
    assert "xyz" in refusal(write(tmp_path, model_xml(box(), more='requiredextensions="xyz"')))


def test_a_part_below_that_requires_an_extension_is_refused(tmp_path):
    inner = model_xml(box(), "", f'xmlns:b="{OLD}beamlattice/2017/02" requiredextensions="b"')
    root = model_xml("", '<item objectid="1" p:path="/3D/a.model"/>')
    assert "/3D/a.model requires" in refusal(write(tmp_path, root, {"3D/a.model": inner}))


def test_an_extension_that_is_used_and_not_required_is_told(tmp_path):
    lattice = box().replace("</mesh>", "<b:beamlattice><b:beams/></b:beamlattice></mesh>")
    mesh = read_3mf(write(tmp_path, model_xml(lattice, more=f'xmlns:b="{OLD}beamlattice/2017/02"')))
    assert volume(mesh) == 1 and len(mesh.notes) == 1 and "beam lattice" in mesh.notes[0]


def test_a_recommended_extension_is_told(tmp_path):
    more = f'xmlns:i="{NEW}implicit/2023/12" recommendedextensions="i"'
    assert "recommends the extension implicit" in read_3mf(write(tmp_path, model_xml(box(), more=more))).notes[0]


@pytest.mark.parametrize("kind", ["meshresolution", "modelresolution"])
def test_a_mesh_that_stands_in_for_another_shape_is_refused(tmp_path, kind):
    told = refusal(write(tmp_path, model_xml(box(more=f's:{kind}="lowres"'), more=f'xmlns:s="{OLD}slice/2015/07"')))
    assert "object 1" in told and "lowres" in told


def test_an_object_without_mesh_and_components_is_refused_by_what_it_has(tmp_path):
    shape = '<object id="1"><d:displacementmesh/></object>'
    told = refusal(write(tmp_path, model_xml(shape, more=f'xmlns:d="{REFUSED["displacement"]}"')))
    assert "object 1" in told and "displacementmesh" in told


# --------------------------------------------------------------------------
# Roles that slicers give to bodies


def test_roles_in_the_settings_of_bambu_and_orca_are_told_by_name(tmp_path):
    part = '<part id="{}" subtype="{}"><metadata key="name" value="{}"/></part>'
    parts = part.format(1, "normal_part", "plate") + part.format(2, "negative_part", "bore")
    settings_xml = f'{HEAD}<config><object id="5"><metadata key="name" value="all"/>{parts}</object></config>'
    objects = box(1) + box(2) + group(5, 'objectid="1"', 'objectid="2"')
    root = model_xml(objects, '<item objectid="5"/>')
    mesh = read_3mf(write(tmp_path, root, {"Metadata/model_settings.config": settings_xml}))
    assert volume(mesh) == 2  # by 3MF both are bodies
    assert len(mesh.notes) == 1 and "part 2 'bore' of object 5 a 'negative_part'" in mesh.notes[0]


def test_roles_in_the_settings_of_prusa_slicer_are_told_by_name(tmp_path):
    data = '<metadata type="volume" key="{}" value="{}"/>'
    rows = [("ModelPart", "a"), ("ParameterModifier", "dense"), ("SupportBlocker", "no")]
    volumes = "".join(
        f'<volume firstid="{k}" lastid="{k + 5}">{data.format("name", name)}{data.format("volume_type", kind)}</volume>'
        for k, (kind, name) in zip((0, 6, 12), rows, strict=True)
    )
    old = f'<volume firstid="18" lastid="20">{data.format("modifier", "1")}</volume>'
    text = f'{HEAD}<config><object id="1" instances_count="1">{volumes}{old}</object></config>'
    notes = read_3mf(write(tmp_path, model_xml(box()), {"Metadata/Slic3r_PE_model.config": text})).notes
    assert [re.search(r"triangles (\d+) to \d+ '(\w*)' of object 1 a '(\w+)'", note).groups() for note in notes] == [
        ("6", "dense", "ParameterModifier"),
        ("12", "no", "SupportBlocker"),
        ("18", "", "ParameterModifier"),
    ]


def test_slicer_settings_that_cannot_be_read_are_told(tmp_path):
    mesh = read_3mf(write(tmp_path, model_xml(box()), {"Metadata/model_settings.config": "<config>"}))
    assert volume(mesh) == 1 and "not read" in mesh.notes[0]
