"""Damage done to files: to their bytes, and to what they are made of."""

import json
import re
import struct
import zipfile

import numpy as np
import pyarrow as pa

from fuzz_seeds import LOOP, pack, parquet_bytes, table, threemf_parts
from gltf_files import pack_glb
from reebslice.schemas import SCHEMAS

NUMBER = re.compile(rb"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
WORDS = (
    b"-1 0 1 2 3 4 7 8 255 256 65535 65536 2147483647 2147483648 -2147483648 4294967295 4294967296 9223372036854775807"
    b" 9223372036854775808 18446744073709551616 -0 0.5 2.5 -1.5 1e3 1e18 1e19 1e75 1e76 1e-75 1e-320 1e308 1e309 nan"
    b" -nan inf -inf NaN(1) 0x10 1_0 1,5 +1 ++1 - . e 1e 1.#IND 3/ 3/x // \\ # ; \xb2 \xff\xfe \x00 \xef\xbb\xbf"
).split() + [b"", b" ", b"\n", b"\r", b"\t", b"\x0b", b"\x85", b"9" * 400, b"1" + b"0" * 5000]
OTHER_TYPES = {pa.int64(): 1, pa.string(): "1", pa.float32(): 1, pa.list_(pa.int64()): [1], pa.binary(): b"\xff"}
TABLES = (*SCHEMAS, "status")
WHOLES = [0, 1, 2, 3, 127, 128, 255, 256, 32767, 65535, 2**31 - 1, 2**31, 2**32 - 1, 2**63 - 1, 2**64 - 1]
JUNK = [None, True, -1, 0, 1, 2, 3, 5, 7, 255, 1.5, 2**31, 2**32, 2**53, 2**70, 1e308, float("nan"), float("inf")]
JUNK += ["", "x", "MAT4", "SCALAR", "VEC3", "VEC4", "data:,", "data:;base64,AAAA", "a.bin", "../a", [], [0], [[]]]
JUNK += [[0] * 20, {}, {"x": 1}, 5120, 5121, 5123, 5125, 5126, 16777216, 16777217]


def mutate_bytes(data, random, seeds):
    """Change, add, drop, repeat or take over a few bytes, or runs of them."""
    data = bytearray(data)
    for _ in range(random.choice((1, 1, 1, 2, 3, 8))):
        at, width = random.randrange(len(data) + 1), random.choice((1, 1, 2, 4, 8, 16, 50, 200))
        match random.randrange(8):
            case 0 if at < len(data):
                data[at] ^= 1 << random.randrange(8)
            case 1 if at < len(data):
                data[at] = random.choice((0, 1, 9, 10, 13, 32, 34, 35, 45, 48, 57, 60, 62, 127, 128, 255))
            case 2:
                del data[at : at + width]
            case 3:
                data[at:at] = data[at : at + width] * random.choice((1, 2, 20))
            case 4:
                data[at:at] = random.randbytes(width)
            case 5:
                other = random.choice(seeds)
                start = random.randrange(len(other))
                data[at : at + width * random.randrange(2)] = other[start : start + width]
            case 6:
                size, sign = random.choice((1, 2, 4, 4, 4, 8)), random.choice("<>")
                letter = {1: "B", 2: "H", 4: "I", 8: "Q"}[size]
                whole = random.choice(WHOLES) & (256**size - 1)
                data[at : at + size] = struct.pack(sign + letter, whole)
            case _ if random.random() < 0.3:
                del data[at:]
    return bytes(data)


def mutate_text(data, random, seeds):
    """Replace numbers, and drop, repeat, swap, join or take over words and lines."""
    for _ in range(random.choice((1, 1, 2, 3))):
        kind = random.randrange(7)
        if kind < 3:
            found = list(NUMBER.finditer(data))
            if found:
                one = random.choice(found)
                data = data[: one.start()] + random.choice(WORDS) + data[one.end() :]
            continue
        end, other = (b"\n", b"\n") if random.random() < 0.5 else (b" ", b" ")
        parts = data.split(end)
        i, j = random.randrange(len(parts)), random.randrange(len(parts))
        if kind == 3:
            parts[i : i + random.choice((1, 1, 3))] = []
        elif kind == 4:
            parts[j:j] = [parts[i]] * random.choice((1, 1, 2, 40))
        elif kind == 5:
            parts[i], parts[j] = parts[j], parts[i]
        else:
            parts[i:i] = random.choice((random.choice(seeds).split(other)[:1], [random.choice(WORDS)], [b""] * 9))
        data = end.join(parts)
    return data


def mutate_json(document, random):
    """Replace, drop or copy values of a JSON document, in place."""
    for _ in range(random.choice((1, 1, 2, 3, 5))):
        places = list_places(document)
        if not places:
            return
        owner, last = random.choice(places)
        if random.random() < 0.15:
            del owner[last]
        elif random.random() < 0.2:
            source, key = random.choice(places)
            owner[last] = json.loads(json.dumps(source[key]))
        elif isinstance(owner, list) and random.random() < 0.2:
            owner += json.loads(json.dumps(owner)) * random.choice((1, 3))
        else:
            owner[last] = json.loads(json.dumps(random.choice(JUNK)))


def list_places(value):
    """Every (owner, key) of a JSON value."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [found for key, inner in list(items) for found in [(value, key), *list_places(inner)]]


def mutate_gltf(data, random, seeds):
    """Damage the JSON of a .gltf file, or its text."""
    if random.random() < 0.15:
        return mutate_text(data, random, seeds)
    document = json.loads(data)
    mutate_json(document, random)
    return json.dumps(document).encode()


def mutate_glb(data, random, _):
    """Damage the JSON in a .glb file and keep the container, or drop or repeat chunks."""
    length = int.from_bytes(data[12:16], "little")
    document = json.loads(data[20 : 20 + length])
    mutate_json(document, random)
    found = pack_glb(json.dumps(document).encode(), data[28 + length :][: random.choice((None, None, None, 40))])
    if random.random() < 0.1:
        found = found[:12] + random.choice((found[12:] * 2, found[28:], b"")) + found[12:]
        found = found[:8] + struct.pack("<I", random.choice((len(found), 0, 2**32 - 1))) + found[12:]
    return found


TAG = re.compile(rb"<[^>]*>")
VALUE = re.compile(rb'"[^"]*"')


def mutate_xml(data, random, seeds):
    """Drop, repeat or move elements, or replace values of attributes."""
    for _ in range(random.choice((1, 1, 2, 4))):
        if random.random() < 0.2:
            data = mutate_text(data, random, seeds)
            continue
        pattern = VALUE if random.random() < 0.6 else TAG
        found = list(pattern.finditer(data))
        if not found:
            continue
        one, other = random.choice(found), random.choice(found)
        word = b'"%s"' % random.choice(WORDS) if pattern is VALUE else random.choice((b"", other[0], one[0] * 3, b"x"))
        if random.random() < 0.3:
            word = other[0]
        data = data[: one.start()] + word + data[one.end() :]
    return data


def mutate_3mf(data, random, _):
    """Damage parts and pack them soundly, or the list of what the archive holds."""
    parts = {name: text.encode() for name, text in threemf_parts().items()}
    name = random.choice(list(parts))
    match random.randrange(5):
        case 0:
            parts[name] = mutate_bytes(parts[name], random, [*parts.values()])
        case 1:
            at = [one.start() for one in re.finditer(rb"PK(?:\x01\x02|\x03\x04)", data)]
            place = random.choice(at) + random.randrange(4, 46)
            return data[:place] + random.randbytes(random.choice((1, 2, 4))) + data[place + 1 :]
        case 2:
            others = name.upper(), name + "/", "/" + name, "3D\\x.model", "%00", "..", "3D/3dmodel.model"
            parts[random.choice(others)] = parts.pop(name)
        case _:
            parts[name] = mutate_xml(parts[name], random, [*parts.values()])
    return pack(parts, random.choices((zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED, zipfile.ZIP_BZIP2), (8, 2, 1), k=3))


def mutate_curves(random):
    """Blobs that should each be a closed line string."""
    blobs = []
    for _ in range(random.randrange(6)):
        points = np.round(np.array([random.gauss(0, 1) for _ in range(2 * random.randrange(6))]), 1).reshape(-1, 2)
        points = np.concatenate([points, points[:1]]) if random.random() < 0.8 else points
        blob = b"\1" + struct.pack("<II", 2, len(points)) + points.astype("<f8").tobytes()
        blobs.append(mutate_bytes(blob, random, [LOOP]) if random.random() < 0.6 else blob)
    return blobs


def mutate_parquet(random, name):
    """A table that is not as declared, or whose file is damaged, or both."""
    values = table(name, random.choice((0, 1, 5, 300)))
    for _ in range(random.choice((0, 0, 1, 2))):
        values = _change_table(values, random)
    style = {"compression": random.choice(("none", "snappy", "gzip", "zstd")), "use_dictionary": random.random() < 0.5}
    style |= {"data_page_version": random.choice(("1.0", "2.0")), "row_group_size": random.choice((2, 1000))}
    data = parquet_bytes(values, **style)
    if random.random() < 0.3:  # the footer says what is where
        head, foot = data[: -min(len(data), 2000)], data[-min(len(data), 2000) :]
        return head + mutate_bytes(foot, random, [foot])
    return mutate_bytes(data, random, [data]) if random.random() < 0.7 else data


def _change_table(values, random):
    """A table with a column, or what is told of it, changed."""
    k = random.randrange(values.num_columns) if values.num_columns else 0
    match random.randrange(6):
        case 0 if values.num_columns:
            return values.remove_column(k)
        case 1 if values.num_columns:
            return values.append_column(values.field(k), values.column(k))
        case 2:
            key = random.choice((b"reebslice:table", b"reebslice:format_version", b"reebslice:content_key", b"geo"))
            return values.replace_schema_metadata((values.schema.metadata or {}) | {key: random.randbytes(4)})
        case 3 if values.num_columns:
            nulls = pa.nulls(len(values), values.field(k).type)
            return values.set_column(k, values.field(k).with_nullable(True), nulls)
        case 4 if values.num_columns:
            kind, one = random.choice([*OTHER_TYPES.items()])
            return values.set_column(k, pa.field(values.field(k).name, kind), pa.array([one] * len(values), kind))
        case 5 if values.num_columns and pa.types.is_binary(values.field(k).type) and len(values):
            blobs = [mutate_bytes(LOOP, random, [LOOP]) for _ in range(len(values))]
            return values.set_column(k, values.field(k), pa.array(blobs, pa.binary()))
    return values
