"""A damaged 3MF file, or one that unpacks to far more than it weighs, is refused with what, where and the cure."""

import zipfile

import pytest

from reebslice.formats import packages, threemf_scene
from reebslice.formats.threemf import read_3mf
from threemf_files import HEAD, ROOT, box, group, model_xml, refusal, relationships, volume, write

# --------------------------------------------------------------------------
# Damage: what, where, cure


def _damaged(old, new):
    return model_xml(box().replace(old, new, 1))


DAMAGED_MODELS = {
    "vertex 12 of 8 (both counted from 0) in triangle 1 of object 1": _damaged('v1="0" v2="3"', 'v1="12" v2="3"'),
    "vertex -1 of 8": _damaged('v1="0" v2="3"', 'v1="-1" v2="3"'),
    "v1 v2 v3 = 0.5": _damaged('v1="0" v2="3" v3="1"', 'v1="0.5" v2="x" v3="1"'),
    "x y z = 1,5 0 0 at vertex 1 (counted from 0) of object 1": _damaged('x="1" y="0" z="0"', 'x="1,5" y="0" z="0"'),
    "x y z = nan": _damaged('x="1"', 'x="nan"'),
    "x y z = 1_0": _damaged('x="1"', 'x="1_0"'),
    "beyond the range of float64 at vertex 1": _damaged('x="1"', 'x="1e999"'),
    "has no y at vertex 1": _damaged('x="1" y="0"', 'x="1"'),
    "two objects of id 1": model_xml(box() + box()),
    "of type 'modell'": model_xml(box(more='type="modell"')),
    'id="one"': model_xml(box("one")),
    "more than one list of vertices": _damaged("</vertices>", "</vertices><vertices></vertices>"),
    "more than one mesh or list of components": _damaged("</mesh>", "</mesh><components></components>"),
    "item 0 (counted from 0) of the build": model_xml(box(), '<item objectid="7"/>'),
    "names object 7, which part /3D/3dmodel.model does not have (it has: 1)": model_xml(box(), '<item objectid="7"/>'),
    'transform "1 0 0 0 1 0 0 0 1 0 0"': model_xml(box(), '<item objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0"/>'),
    "makes the object flat": model_xml(box(), '<item objectid="1" transform="1 0 0 0 1 0 0 0 0 0 0 0"/>'),
    "no part /3D/b.model": model_xml("", '<item objectid="1" p:path="/3D/b.model"/>'),
    "no <build>": model_xml(box()).replace("<build>", "<p:build>").replace("</build>", "</p:build>"),
    "build is empty": model_xml(box(), ""),
    "draft of 3MF": model_xml(box()).replace("core/2015/02", "2013/01"),
    "line 3, column 2": model_xml(box()).replace("</vertices>", "</vertices>\n\n</oops>"),
    "document type declaration": model_xml(box()).replace(HEAD, HEAD + "<!DOCTYPE model>"),
    "object 2 of /3D/3dmodel.model, in object 3 of /3D/3dmodel.model": model_xml(
        group(2, 'objectid="3"') + group(3, 'objectid="2"'), '<item objectid="2"/>'
    ),
}


@pytest.mark.parametrize("words, root", DAMAGED_MODELS.items(), ids=DAMAGED_MODELS)
def test_damage_is_told_by_part_object_and_place(tmp_path, words, root):
    told = refusal(write(tmp_path, root))
    assert words in told and told.endswith(".")


def test_packages_that_do_not_say_which_model_is_meant_are_refused(tmp_path):
    root, other = model_xml(box()), {"3D/other.model": model_xml(box())}
    assert "no 3D model" in refusal(write(tmp_path, root, targets=()))
    two = refusal(write(tmp_path, root, other, targets=("/" + ROOT, "/3D/other.model")))
    assert "/3D/other.model" in two and "more than one" in two
    assert "no part /3D/none.model" in refusal(write(tmp_path, root, targets=("/3D/none.model",)))
    path = tmp_path / "bare.3mf"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(ROOT, root)
    assert "/_rels/.rels" in refusal(path)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("_rels/.rels", relationships("http://example.com/a.model", more='TargetMode="External"'))
    assert "outside the package" in refusal(path)


def test_archives_that_are_cut_off_or_changed_are_refused(tmp_path):
    path = write(tmp_path, model_xml(box()))
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    assert "no ZIP archive" in refusal(path)
    with zipfile.ZipFile(write(tmp_path, model_xml(box()))) as archive:
        place = archive.getinfo(ROOT).header_offset + 30 + len(ROOT) + 40
    path.write_bytes(data[:place] + bytes([data[place] ^ 255]) + data[place + 1 :])
    assert f"Part /{ROOT} cannot be unpacked" in refusal(path)


def test_a_part_that_is_there_twice_is_refused(tmp_path):
    path = write(tmp_path, model_xml(box()), {"3d/3DMODEL.model": model_xml(box())})
    assert "2 parts named" in refusal(path)


# --------------------------------------------------------------------------
# Packages that are small and hold much


def test_a_part_that_unpacks_far_beyond_the_packages_size_is_refused_before_it_is_unpacked(tmp_path, monkeypatch):
    monkeypatch.setattr(packages, "FREE_BYTES", 10_000)
    path = write(tmp_path, model_xml(box()) + " " * 10_000_000)
    monkeypatch.setattr(zipfile.ZipFile, "read", _read_rels_alone)
    told = refusal(path)
    assert f"/{ROOT} unpacks to 1000" in told and str(packages.LARGEST_PART) in told


def _read_rels_alone(archive, entry):
    """Stand in for ZipFile.read, where nothing but the relationships may be unpacked."""
    assert entry.filename == "_rels/.rels"
    with archive.open(entry) as file:
        return file.read()


def test_many_parts_together_are_held_against_the_bound(tmp_path, monkeypatch):
    monkeypatch.setattr(packages, "FREE_BYTES", 20_000)
    monkeypatch.setattr(packages, "LARGEST_RATIO", 0)
    parts = {f"3D/{k}.model": model_xml(box(), "") for k in range(40)}
    items = "".join(f'<item objectid="1" p:path="/{part}"/>' for part in parts)
    assert "for all that are read" in refusal(write(tmp_path, model_xml("", items), parts))


@pytest.mark.parametrize("bottom", [box(1), group(1)], ids=["meshes", "nothing"])
def test_components_that_multiply_are_counted_before_they_are_placed(tmp_path, bottom):
    groups = [group(k, f'objectid="{k - 1}"', f'objectid="{k - 1}"') for k in range(2, 40)]
    told = refusal(write(tmp_path, model_xml(bottom + "".join(groups), '<item objectid="39"/>')))
    assert str(threemf_scene.MOST_PLACES) in told


def test_long_chains_of_components_and_deep_elements(tmp_path):
    groups = [group(k, f'objectid="{k - 1}"') for k in range(2, 5000)]
    mesh = read_3mf(write(tmp_path, model_xml(box() + "".join(groups), '<item objectid="4999"/>')))
    assert volume(mesh) == 1
    deep = model_xml(box() + "<p:a>" * 300 + "</p:a>" * 300)
    assert "nested" in refusal(write(tmp_path, deep))
