"""The container of glTF 2.0: JSON or GLB, its version, its extensions, and values of the JSON.

References: "glTF 2.0 Specification" (ISO/IEC 12113:2022), sections JSON
Encoding, URIs, Asset, Specifying Extensions and GLB File Format.
"""

import json
import re
from collections import Counter
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote, urlsplit

import numpy as np

from ..errors import MeshFormatError

DAMAGED = "the file is damaged, export it again (the Khronos glTF Validator lists every fault)"
# Tried: the command decodes every compression of the registry.
UNPACK = "which is not read; write the file without it, for example by `gltf-transform copy IN.glb OUT.glb`"
CONVERT = "convert it to glTF 2.0, for example by `gltf-pipeline -i IN -o OUT`"
JSON_CHUNK, BIN_CHUNK = 0x4E4F534A, 0x004E4942
MOST_NOTES = 9  # on chunks

# Extensions that change where triangles are, and are read.
READ = {"KHR_mesh_quantization", "EXT_mesh_gpu_instancing", "KHR_mesh_primitive_restart", "KHR_node_visibility"}
# Those whose content a file may also give uncompressed.
COMPRESSION = {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"}
# Extensions of the registry that leave every triangle in its place, required or not.
HARMLESS = set(
    """
    KHR_animation_pointer KHR_interactivity KHR_lights_punctual KHR_materials_anisotropy KHR_materials_clearcoat
    KHR_materials_diffuse_transmission KHR_materials_dispersion KHR_materials_emissive_strength KHR_materials_ior
    KHR_materials_iridescence KHR_materials_pbrSpecularGlossiness KHR_materials_sheen KHR_materials_specular
    KHR_materials_transmission KHR_materials_unlit KHR_materials_variants KHR_materials_volume KHR_node_hoverability
    KHR_node_selectability KHR_techniques_webgl KHR_texture_basisu KHR_texture_transform KHR_xmp KHR_xmp_json_ld
    ADOBE_materials_clearcoat_specular ADOBE_materials_clearcoat_tint ADOBE_materials_thin_transparency AGI_stk_metadata
    CESIUM_primitive_outline EXT_lights_ies EXT_lights_image_based EXT_mesh_manifold EXT_mesh_primitive_edge_visibility
    EXT_instance_features EXT_mesh_features EXT_structural_metadata FB_ngon_encoding
    EXT_mesh_primitive_restart EXT_texture_astc EXT_texture_webp FB_geometry_metadata GODOT_single_root MSFT_lod
    MSFT_packing_normalRoughnessMetallic MSFT_packing_occlusionRoughnessMetallic MSFT_texture_dds NV_materials_mdl
    """.split()
)


class Asset(NamedTuple):
    """A glTF file whose JSON was read and whose buffers are read when they are needed."""

    path: Path
    document: dict
    chunk: np.ndarray | None
    buffers: dict
    notes: list
    files: dict
    """Bytes of the files beside it that buffers name, each once."""
    counts: Counter
    """How many elements, vertices, faces and places were taken so far (`gltf_shares`)."""


def open_asset(path):
    """Read the JSON of a .gltf or .glb file; which of the two it is, its first bytes say.

    Parameters
    ----------
    path : str or Path

    Returns
    -------
    Asset
        The document is of version 2 and states nothing that a reader of 2.0
        may not read.

    Raises
    ------
    MeshFormatError
        The container is cut off, the JSON is no JSON, the version is not 2,
        or an extension is required that is not known to be harmless.
    """
    notes = []
    text, chunk = _split_file(Path(path), notes)
    asset = Asset(Path(path), _parse_json(text), chunk, {}, notes, {}, Counter())
    _check_version(asset.document)
    _check_extensions(asset.document, notes)
    return asset


def list_companions(path):
    """Name the external buffers of a .gltf or .glb file without reading them.

    Parameters
    ----------
    path : str or Path

    Returns
    -------
    list of str
        Percent-decoded, relative to the folder of the file, without repeats,
        in the order of the file; whether they exist is not looked at. Empty
        also where the file is damaged or names what `read_gltf` refuses
        (absolute paths and addresses): reading the file tells of that.
    """
    try:
        document = _parse_json(_split_file(Path(path), [])[0])
    except (MeshFormatError, OSError):
        return []
    names, buffers = {}, document.get("buffers")
    for buffer in buffers if isinstance(buffers, list) else []:
        uri = buffer.get("uri") if isinstance(buffer, dict) else None
        if isinstance(uri, str) and not is_data(uri):
            try:
                names[decode_name(uri, "A buffer")] = None
            except MeshFormatError:
                continue
    return list(names)


def _split_file(path, notes):
    """Return the JSON of a file, as bytes, and the binary chunk (or None)."""
    if path.stat().st_size == 0:
        raise MeshFormatError("The file is empty (0 bytes); export the mesh again.")
    data = np.asarray(np.memmap(path, np.uint8, "r"))  # images are never held
    if data[:4].tobytes() != b"glTF":
        return data.tobytes(), None
    version, length = (int(word) for word in data[4:12].view("<u4")) if len(data) >= 12 else (2, 12)
    if version != 2:
        raise MeshFormatError(f"The file is binary glTF of version {version}; {CONVERT}.")
    if len(data) < length or length < 20:
        raise MeshFormatError(
            f"The GLB file is cut off: its header declares {length} bytes (20 at least), it has {len(data)};"
            " copy or export it again."
        )
    if len(data) > length:
        notes.append(f"The {len(data) - length} bytes after the end that the GLB header declares were left out.")
    kinds, chunks = zip(*_split_chunks(data[:length], notes), strict=True)
    if kinds[0] != JSON_CHUNK:
        raise MeshFormatError(f"The GLB file does not begin with a JSON chunk; {DAMAGED}.")
    if kinds[1:].count(BIN_CHUNK) > 1:
        raise MeshFormatError(f"The GLB file has 2 BIN chunks or more, where one is allowed; {DAMAGED}.")
    return chunks[0].tobytes().rstrip(b"\0"), chunks[1] if len(chunks) > 1 else None


def _split_chunks(data, notes):
    """Return the kind and the bytes of the first chunk of a GLB file and of those of kind BIN, two at most."""
    chunks, at, number = [], 12, 0
    while at + 8 <= len(data) and len(chunks) < 3:
        size, kind = (int.from_bytes(data[k : k + 4].tobytes(), "little") for k in (at, at + 4))
        end = at + 8 + size
        if end > len(data):
            raise MeshFormatError(
                f"Chunk {number} of the GLB file, at byte {at}, declares {size} bytes, but {len(data) - at - 8}"
                f" are left; {DAMAGED}."
            )
        if end % 4 and len(notes) < MOST_NOTES:  # as some writers leave them; the next header is where it is found
            notes.append(f"Chunk {number} of the GLB file ends at byte {end}, not on a multiple of four bytes.")
        if kind == BIN_CHUNK or not chunks:
            chunks.append((kind, data[at + 8 : end]))
        at, number = end, number + 1
    return chunks


def _parse_json(text):
    """Return the top object of the JSON; for a repeated key the last value counts, as the specification wants."""
    try:
        document = json.loads(text.decode("utf-8-sig"))
    except json.JSONDecodeError as error:
        place = f"line {error.lineno}, column {error.colno}"
        raise MeshFormatError(f"The JSON of the glTF file is none from {place} on ({error.msg}); {DAMAGED}.") from error
    except (ValueError, RecursionError) as error:  # no UTF-8, thousands of digits, thousands of brackets
        raise MeshFormatError(f"The JSON of the glTF file cannot be read ({error}); {DAMAGED}.") from error
    if not isinstance(document, dict):
        raise MeshFormatError(f"The JSON of the glTF file is no object; {DAMAGED}.")
    return document


def _check_version(document):
    """Refuse what a reader of glTF 2.0 may not read."""
    asset = document.get("asset")
    asset = asset if isinstance(asset, dict) else {}
    needed = asset.get("minVersion", asset.get("version"))
    version = re.match(r"(\d{1,9})(?:\.(\d{1,9}))?", str(needed))
    # Lists of glTF 2.0 were objects of named entries in 1.0, where the version could be left out.
    older = needed is None and any(isinstance(document.get(key), dict) for key in ("nodes", "meshes", "accessors"))
    if older or (version and int(version[1]) < 2):
        raise MeshFormatError(
            f"The file is glTF {needed or '1.0'}, which is laid out otherwise than glTF 2.0; {CONVERT}."
        )
    if not version:
        raise MeshFormatError(f"The file names no version of glTF (asset.version is {needed!r:.40}); {DAMAGED}.")
    if int(version[1]) > 2 or ("minVersion" in asset and int(version[2] or 0) > 0):
        raise MeshFormatError(f"The file needs a reader of glTF {needed}, this one reads 2.0; save it as glTF 2.0.")


def _check_extensions(document, notes):
    """Refuse what requires an extension that is not read, by its name; tell what else is not read."""
    used, required = (take_kind(document, key, list, "The file") for key in ("extensionsUsed", "extensionsRequired"))
    unknown = sorted({str(name) for name in required} - READ - HARMLESS)
    if unknown:
        cure = UNPACK if COMPRESSION.issuperset(unknown) else "which is not read; save it without that"
        raise MeshFormatError(f"The file requires {' and '.join(unknown)}, {cure}.")
    used = {str(name) for name in used}
    if packed := sorted(used & COMPRESSION):
        notes.append(f"{' and '.join(packed)} is optional here: the uncompressed form is read.")
    if unknown := sorted(used - READ - HARMLESS - COMPRESSION):
        notes.append(f"The optional extensions {', '.join(unknown)} are not known and not read.")


# --------------------------------------------------------------------------
# URIs


def is_data(uri):
    """Tell whether a URI holds its data itself."""
    return uri[:5].lower() == "data:"


def decode_name(uri, where):
    """Return the relative path that a URI names, percent-decoded."""
    try:
        parts = urlsplit(uri)
        name = unquote(parts.path, errors="strict")
        plain = not (parts.scheme or parts.netloc or parts.query or parts.fragment)
    except ValueError:  # a host that is none, or bytes that are no UTF-8
        name, plain = "", False
    if not plain or not name or name.startswith("/") or "\0" in name:
        raise MeshFormatError(
            f"{where} is at {uri!r:.80}; only a path relative to the file is read (percent-encoded, without scheme,"
            " host, '?' and '#'): put the buffer beside the file and name it so, or save as .glb."
        )
    return name


# --------------------------------------------------------------------------
# Values of the JSON


def take_entry(document, kind, index, where):
    """Return object `index` of the array `kind` of the document, or say who names one that is not there."""
    entries = document.get(kind, [])
    if not isinstance(entries, list) or not 0 <= index < len(entries) or not isinstance(entries[index], dict):
        count = f"{len(entries)} of them" if isinstance(entries, list) else "no such list"
        raise MeshFormatError(f"{where} names entry {index} of {kind}, but the file has {count}; {DAMAGED}.")
    return entries[index]


def take_whole(owner, key, where, default=None):
    """Return a whole number of zero or more; 36.0 and 3.6e1 are whole numbers in glTF."""
    value = owner.get(key, default)
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= 2**53:
        shown = f"{value:.3g}" if isinstance(value, int) and abs(value) < 10**300 else f"{value!r:.40}"
        raise MeshFormatError(f"{where} has {key} = {shown} where a whole number (to 2^53) is due; {DAMAGED}.")
    return value


def take_wholes(owner, key, where):
    """Return a list of whole numbers, empty where there is none."""
    values = take_kind(owner, key, list, where)
    return [take_whole({key: value}, key, where) for value in values]


def take_numbers(owner, key, count, where, default=None):
    """Return (count,) finite float64, or of any length if `count` is None."""
    values = owner.get(key, default)
    numeric = isinstance(values, list) and all(type(value) in (int, float) for value in values)
    if numeric and count in (None, len(values)) and all(abs(value) < 1e300 for value in values):
        return np.array(values, np.float64)
    raise MeshFormatError(f"{where} has {key} = {values!r:.60} where {count or 'some'} numbers are due; {DAMAGED}.")


def take_kind(owner, key, kind, where):
    """Return the dict or list under a key, empty where there is none."""
    value = owner.get(key, kind())
    if not isinstance(value, kind):
        name = "an object" if kind is dict else "a list"
        raise MeshFormatError(f"{where} has {key} = {value!r:.40} where {name} is due; {DAMAGED}.")
    return value
