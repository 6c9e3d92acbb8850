"""Damaged files give a mesh, a table or a sentence, and never end the process (`make fuzz`: by the thousand)."""

import pytest

from fuzz_readers import FACTOR, FREE, MESHES, OTHERS, Reader, make_file, run


@pytest.mark.parametrize("kind", [*MESHES, *OTHERS])
def test_damage_is_the_same_for_the_same_seed(kind):
    assert make_file(kind, 7) == make_file(kind, 7) and make_file(kind, 7) != make_file(kind, 8)


def test_a_few_hundred_damaged_files_are_read_or_refused():
    counts, faults = run([*MESHES, *OTHERS], range(40), None)
    assert not faults, faults
    ends = {kind: {end for of, end in counts if of == kind} for kind in MESHES}
    assert all(found == {"read", "refused"} for found in ends.values()), ends  # neither all sound nor all hopeless


def test_a_reader_that_ends_its_process_or_takes_too_much_is_told(tmp_path, monkeypatch):
    """The campaign can fail: what it is to find is found."""
    program = "import fuzz_readers, os; fuzz_readers._read_mesh = lambda path: {}; fuzz_readers.serve(False)"
    reader = Reader()
    path = tmp_path / "a.off"
    path.write_text("OFF\n")
    for fault, told in (("os.abort()", "the process ended"), ("bytearray(3 << 26).count(1)", "bytes of memory")):
        monkeypatch.setattr("fuzz_readers.SERVER", ["-c", program.format(fault)])
        found = reader.read(".off", path, 4)
        assert found["end"] == "fault" and told in found["why"]
        reader.close()


COUNTS = {  # what is declared, and is not there
    "a.stl": bytes(80) + b"\xff\xff\xff\xff" + bytes(100),
    "a.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n"
    b"property float z\nelement face 4000000000\nproperty list uint int vertex_indices\nend_header\n" + bytes(200),
    "b.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
    b"property float z\nelement face 1\nproperty list uint int vertex_indices\nend_header\n"
    + bytes(12)
    + b"\xff" * 4
    + bytes(80),
    "c.ply": b"ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\n"
    b"element face 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n",
    "a.off": b"OFF\n4000000000 4000000000 0\n0 0 0\n3 0 1 2\n",
    "b.off": b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n",
    "c.off": b"OFF BINARY\n" + b"\x7f\xff\xff\xff" * 3 + bytes(60),
    "a.glb": b"glTF\2\0\0\0\xff\xff\xff\xff\xff\xff\xff\xffJSON{}",
    "b.glb": b"glTF\2\0\0\0\x20\0\0\0\xff\xff\xff\xffJSON{}          ",
}


def test_what_a_file_declares_and_does_not_hold_takes_no_memory(tmp_path):
    reader = Reader()
    for name, data in COUNTS.items():
        path = tmp_path / name
        path.write_bytes(data)
        told = reader.read(path.suffix, path, len(data))
        assert told["end"] == "refused" and told["bytes"] < FREE / 4 + FACTOR * len(data), (name, told)
    reader.close()
