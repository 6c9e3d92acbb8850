"""Packages of parts in a ZIP archive, by the Open Packaging Conventions (ECMA-376 part 2), read with bounds.

A package can be small on disk and vast once it is unpacked, so nothing is
unpacked but the parts that are asked for, and each only after the size that
the archive declares for it was held against bounds.
"""

import errno
import posixpath
import struct
import zipfile
import zlib
from collections import defaultdict
from urllib.parse import unquote
from xml.parsers import expat

from ..errors import MeshFormatError

LARGEST_PART = 1 << 32  # bytes
# Text of meshes packs 3 to 30 fold. A package that unpacks more than this many times its size on disk is no mesh.
LARGEST_RATIO, FREE_BYTES = 100, 1 << 25
METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # those that the conventions allow; others unpack without bound
# What zipfile raises on damage: a place outside the file (OSError EINVAL) and names that are no text among it.
_DAMAGE = (zipfile.BadZipFile, zlib.error, struct.error, EOFError, OSError, RuntimeError, ValueError)
RELATIONSHIP = "http://schemas.openxmlformats.org/package/2006/relationships Relationship"


class Package:
    """Parts of a package by name: '/3D/3dmodel.model', in any case of its letters, percent-encoded or not.

    Parameters
    ----------
    path : path of the ZIP archive

    Attributes
    ----------
    unpacked : int, bytes of all parts read so far

    Raises
    ------
    MeshFormatError
        The file is no ZIP archive.
    """

    def __init__(self, path):
        try:
            self._archive = zipfile.ZipFile(path)
        except _DAMAGE as error:
            if isinstance(error, OSError) and error.errno not in (None, errno.EINVAL):
                raise
            raise MeshFormatError(
                f"The file is no ZIP archive as 3MF has to be, or is cut off ({error}); copy or export it again."
            ) from None
        self._size = path.stat().st_size
        self.unpacked = 0
        self._entries = defaultdict(list)
        for entry in self._archive.infolist():
            if not entry.is_dir():
                self._entries[fold_name(entry.filename)].append(entry)

    def close(self):
        """Close the archive."""
        self._archive.close()

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.close()

    def names(self):
        """Return the names of all parts as the archive spells them, in its order, each with a leading slash."""
        return [spell_name(entries[0].filename) for entries in self._entries.values()]

    def __contains__(self, name):
        return fold_name(name) in self._entries

    def read(self, name):
        """Return the bytes of a part.

        Raises
        ------
        MeshFormatError
            There is no such part or there are two; it is damaged, encrypted or
            packed as the conventions do not allow; it would unpack to more than `LARGEST_PART` bytes, or all parts read
            so far to more than `LARGEST_RATIO` times the package's size
            (`FREE_BYTES` are free).
        """
        entries = self._entries.get(fold_name(name), [])
        if len(entries) != 1:
            found = f"has {len(entries)} parts named" if entries else "has no part"
            raise MeshFormatError(f"The package {found} {spell_name(name)}, which it refers to; export it again.")
        entry = entries[0]
        self._hold_against_bounds(entry)
        try:
            with self._archive.open(entry) as file:
                data = file.read(entry.file_size)  # with a size, zipfile unpacks no more; without, all that there is
            if len(data) < entry.file_size:
                raise EOFError(f"it unpacks to {len(data)} bytes instead of {entry.file_size}")
            return data
        except _DAMAGE as error:
            if isinstance(error, OSError) and error.errno not in (None, errno.EINVAL):
                raise  # the disk's fault, not the file's
            raise MeshFormatError(
                f"Part {spell_name(name)} cannot be unpacked ({error}); the file is damaged or encrypted: copy or"
                " export it again."
            ) from None

    def _hold_against_bounds(self, entry):
        """Refuse a part whose declared size is beyond bounds, or that is packed by a method that keeps to none."""
        if entry.compress_type not in METHODS:
            raise MeshFormatError(
                f"Part {spell_name(entry.filename)} is packed by method {entry.compress_type} of ZIP; packages hold"
                " parts that are stored or deflated (methods 0 and 8) only: export the model again."
            )
        most = max(FREE_BYTES, LARGEST_RATIO * self._size)
        self.unpacked += entry.file_size
        if entry.file_size > LARGEST_PART or self.unpacked > most:
            raise MeshFormatError(
                f"Part {spell_name(entry.filename)} unpacks to {entry.file_size} bytes, in a package of {self._size}"
                f" bytes; at most {LARGEST_PART} bytes for one part, and {most} for all that are read, are unpacked."
                " Export the model again, in fewer triangles if it is so large."
            )

    def related(self, type_):
        """Return the names of the parts to which the package itself has a relationship of this type, each once.

        Raises
        ------
        MeshFormatError
            The relationships are missing, broken, or lead out of the package.
        """
        if "/_rels/.rels" not in self:
            raise MeshFormatError(
                "The archive has no part /_rels/.rels, with which every 3MF package begins; export the model again."
            )
        targets = []

        def start(tag, attributes):
            if tag == RELATIONSHIP and attributes.get("Type") == type_:
                if attributes.get("TargetMode") == "External":
                    raise MeshFormatError(
                        f"The package's model is {attributes.get('Target')}, outside the package, which 3MF forbids;"
                        " export the model with all its parts."
                    )
                targets.append(spell_name(posixpath.normpath("/" + attributes.get("Target", ""))))

        parse_xml(self.read("/_rels/.rels"), "/_rels/.rels", start)
        return list({fold_name(target): target for target in targets}.values())


def spell_name(name):
    r"""Return a part's name with one leading slash.

    >>> spell_name("3D\\a.model")
    '/3D/a.model'
    """
    return "/" + name.replace("\\", "/").lstrip("/")


def fold_name(name):
    """Return what is equal for all spellings of one part's name: case, percent-encoding and slashes apart.

    >>> fold_name("3D/My%20Part.model") == fold_name("/3d/my part.MODEL")
    True
    """
    return unquote(spell_name(name)).casefold()


def parse_xml(data, part, start, end=None, namespace=None, text=None):
    """Run through the XML of a part; names of elements and attributes arrive as 'namespace name'.

    Parameters
    ----------
    data : bytes
    part : name of the part, for messages
    start : function of (name, attributes) for the begin of each element
    end : function of the name, for its end
    namespace : function of (prefix, uri), called ahead of `start` for each namespace that the element declares
    text : function of a piece of text between elements

    Raises
    ------
    MeshFormatError
        The XML is not well-formed, or has a document type declaration: 3MF
        forbids these, and entities declared there can grow without bound.
    """

    def refuse(*_):
        raise MeshFormatError(
            f"Part {part} has a document type declaration (DTD), which 3MF forbids; remove it, or export the model"
            " again."
        )

    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.StartNamespaceDeclHandler, parser.CharacterDataHandler = namespace, text
    try:
        parser.Parse(data, True)
    except (expat.ExpatError, LookupError, ValueError) as error:
        if isinstance(error, MeshFormatError):
            raise
        raise MeshFormatError(
            f"Part {part} is not well-formed XML ({error}, counted from line 1 and column 0); the file is damaged or"
            " cut off: copy or export it again."
        ) from None
