"""Objects and build of one model part of a 3MF package, from its XML."""

import re
from typing import ClassVar, NamedTuple

import numpy as np

from ..errors import MeshFormatError
from .attribute_numbers import MARK, cut_runs, read_rows
from .packages import parse_xml

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
DRAFT = "http://schemas.microsoft.com/3dmanufacturing/2013/01"
PRODUCTION = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
RUNS = {b"vertices": (b"vertex", b"x", b"y", b"z"), b"triangles": (b"triangle", b"v1", b"v2", b"v3")}
# Looser than the schema, as writers are: `1.` is a number. What is too large for float64 is refused later.
ROWS = {"vertex": re.compile(r"(\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s+){3}", re.ASCII)}
ROWS |= {"triangle": re.compile(r"(\s*[-+]?\d+\s+){3}", re.ASCII)}
AXES = {"vertex": ("x", "y", "z"), "triangle": ("v1", "v2", "v3")}
ROW_PLACES = {f"{CORE} vertex": "/model/resources/object/mesh/vertices"}
ROW_PLACES |= {f"{CORE} triangle": "/model/resources/object/mesh/triangles"}
DEEPEST = 256
# Elements that hold what is read. All others are in one place: names of elements may be as long as the part.
PLACES = {"/model", "/model/resources", "/model/resources/object", "/model/resources/object/mesh", *ROW_PLACES.values()}
PLACES |= {"/model/resources/object/components", "/model/build"}
ELSEWHERE = "elsewhere"
TYPES = ("model", "solidsupport", "support", "surface", "other")


class Use(NamedTuple):
    """A component, or an item of the build: an object, put in place."""

    object_id: int
    part: str | None  # where the object is, if not in this part
    matrix: np.ndarray  # (4, 3), applied to row vectors (x, y, z, 1)
    printable: bool
    where: str  # for messages


class Object(NamedTuple):
    """An object: a mesh, or components, or neither (then `foreign` may say why)."""

    object_id: int
    type_: str
    name: str
    resolution: str
    points: np.ndarray | None  # (n, 3) float64
    faces: np.ndarray | None  # (m, 3) int64
    composed: bool  # there is a list of components, be it empty
    components: list[Use]
    foreign: set[str]  # 'namespace name' of elements of extensions, in the object or below

    def __str__(self):
        return f"object {self.object_id}" + (f" '{self.name}'" if self.name else "")


class Model(NamedTuple):
    """A model part: objects by id, items of the build, and the extensions that it requires or recommends."""

    part: str
    unit: str
    objects: dict[int, Object]
    items: list[Use]
    required: dict[str, str]  # namespaces by the prefixes that the part names
    recommended: dict[str, str]
    foreign: set[str]  # 'namespace name' of all elements of extensions


def read_model(data, part):
    """Return the `Model` that the bytes of a part hold.

    Raises
    ------
    MeshFormatError
        The XML is damaged, or is no 3MF model: the message names the part, the
        object and the element.
    """
    xml, tables = cut_runs(data, RUNS)
    try:
        return _Reader(part, tables).read(xml)
    except MeshFormatError:
        if tables:
            return _Reader(part, []).read(data)  # for the line that the error is in
        raise


class _Reader:
    """State of the run through the XML of a model part."""

    def __init__(self, part, tables):
        self.part, self.tables = part, tables
        self.places, self.prefixes = [""], {}
        self.model, self.built = None, False
        self.object, self.mesh = None, None

    def read(self, xml):
        """Run through the XML."""
        parse_xml(xml, self.part, self.start, self.end, self.declare)
        if not self.built:
            raise self.fault("has no <build> element, without which nothing is to be made", "export the model again")
        return self.model

    def fault(self, wrong, cure="the file is damaged: export it again"):
        """The error that says what is wrong with this part."""
        return MeshFormatError(f"Part {self.part} {wrong}; {cure}.")

    def declare(self, prefix, uri):
        """Note what a prefix stands for on the root element."""
        if len(self.places) == 1:
            self.prefixes[prefix or ""] = uri

    def start(self, tag, attributes):
        """Take the begin of an element, by where it is."""
        if ROW_PLACES.get(tag) == self.places[-1]:  # by far the most frequent
            self.places.append(tag)
            self.take_row(tag[len(CORE) + 1 :], attributes)
            return
        namespace, _, name = tag.rpartition(" ")
        place = f"{self.places[-1]}/{name}" if namespace == CORE else ELSEWHERE
        self.places.append(place if place in PLACES else ELSEWHERE)
        if len(self.places) > DEEPEST:
            raise self.fault(f"has elements nested more than {DEEPEST} deep")
        if len(self.places) == 2:
            self.begin_model(tag, attributes)
        elif namespace != CORE:
            self.model.foreign.add(tag)
            if self.object is not None:
                self.object["foreign"].add(tag)
        elif handler := self.STARTS.get(place):
            handler(self, name, attributes)

    def end(self, _):
        """Take the end of an element, by where it is."""
        if self.places.pop() == "/model/resources/object":
            self.end_object()

    def begin_model(self, tag, attributes):
        """Take the root element."""
        if tag != f"{CORE} model":
            told = (
                "is of a draft of 3MF from before its version 1" if tag == f"{DRAFT} model" else f"begins with '{tag}'"
            )
            raise self.fault(f"{told}, and not with <model> of {CORE}", "export the model again with a newer program")
        named = [self.name_extensions(attributes, f"{word}extensions") for word in ("required", "recommended")]
        self.model = Model(self.part, attributes.get("unit", "millimeter").strip(), {}, [], *named, set())

    def name_extensions(self, attributes, name):
        """The namespaces of the prefixes that an attribute lists."""
        words = attributes.get(name, "").split()
        return {word: self.prefixes.get(word, "a prefix that nothing declares") for word in words}

    def begin_object(self, _, attributes):
        """Take the begin of an object."""
        object_id = self.read_id(attributes, "id", "an object")
        if object_id in self.model.objects:
            raise self.fault(f"has two objects of id {object_id}", "export the model again")
        type_ = attributes.get("type", "model").strip()
        if type_ not in TYPES:
            raise self.fault(f"has object {object_id} of type '{type_}', not one of {', '.join(TYPES)}")
        resolutions = [
            word for key, word in attributes.items() if key.endswith((" meshresolution", " modelresolution"))
        ]
        resolution = next((word for word in resolutions if word != "fullres"), "fullres")
        self.object = {"object_id": object_id, "type_": type_, "name": attributes.get("name", "")}
        self.object |= {
            "foreign": set(),
            "components": [],
            "resolution": resolution,
            "meshed": False,
            "composed": False,
        }
        self.mesh = None

    def begin_mesh(self, name, _):
        """Take the begin of the mesh or the components of an object, of which it has one."""
        if self.mesh is not None:
            raise self.fault(f"has more than one mesh or list of components in object {self.object['object_id']}")
        self.mesh = {}
        self.object["meshed" if name == "mesh" else "composed"] = True

    def begin_run(self, name, attributes):
        """Take the begin of the vertices or the triangles of a mesh, which may have been read ahead."""
        kind = "vertex" if name == "vertices" else "triangle"
        if kind in self.mesh:
            raise self.fault(f"has more than one list of {name} in object {self.object['object_id']}")
        ahead = attributes.get(MARK.decode()) if self.tables else None
        self.mesh[kind] = [] if ahead is None else self.tables[int(ahead)]

    def take_row(self, kind, attributes):
        """Take one vertex or triangle, as words."""
        try:
            first, second, third = AXES[kind]
            self.mesh[kind].append(f"{attributes[first]} {attributes[second]} {attributes[third]}\n")
        except KeyError as missing:
            row = f"{kind} {len(self.mesh[kind])} (counted from 0) of object {self.object['object_id']}"
            raise self.fault(f"has no {missing.args[0]} at {row}") from None

    def read_table(self, kind):
        """The vertices or triangles of the mesh as (n, 3) numbers."""
        rows = self.mesh.get(kind, [])
        if isinstance(rows, np.ndarray):
            return rows
        table = read_rows("".join(rows).encode())
        if table is None or len(table) != len(rows):
            row = next((row for row, words in enumerate(rows) if not ROWS[kind].fullmatch(words)), 0)
            what = "three whole numbers" if kind == "triangle" else "three decimal numbers, with a point"
            raise self.fault(
                f"has {' '.join(AXES[kind])} = {rows[row].strip()[:90]} at {kind} {row} (counted from 0) of object"
                f" {self.object['object_id']}, where 3MF has {what}"
            )
        return table

    def end_object(self):
        """Put an object's arrays together."""
        points = faces = None
        if self.object.pop("meshed"):
            points, faces = self.read_table("vertex"), self.read_table("triangle")
            self.check_mesh(points, faces)
            faces = faces.astype(np.int64)
        self.model.objects[self.object["object_id"]] = Object(points=points, faces=faces, **self.object)
        self.object = self.mesh = None

    def check_mesh(self, points, faces):
        """Refuse coordinates that are too large, and triangles that name vertices that there are not."""
        if not np.isfinite(points).all():
            row = np.flatnonzero(~np.isfinite(points).all(axis=1))[0]
            where = f"vertex {row} (counted from 0) of object {self.object['object_id']}"
            raise self.fault(f"has coordinates beyond the range of float64 at {where}")
        stray = (faces < 0) | (faces >= len(points)) | (faces != np.floor(faces))
        if stray.any():
            row, corner = np.argwhere(stray)[0]
            raise self.fault(
                f"has {int(stray.any(axis=1).sum())} triangles that name vertices that do not exist, the first is"
                f" vertex {faces[row, corner]:.15g} of {len(points)} (both counted from 0) in triangle {row} of object"
                f" {self.object['object_id']}"
            )

    def take_use(self, name, attributes):
        """Take a component or an item."""
        uses = self.object["components"] if name == "component" else self.model.items
        owner = f" of object {self.object['object_id']}" if name == "component" else " of the build"
        where = f"{name} {len(uses)} (counted from 0){owner} in part {self.part}"
        object_id = self.read_id(attributes, "objectid", where)
        words = attributes.get("transform", "1 0 0 0 1 0 0 0 1 0 0 0").split()
        try:
            matrix = np.array([float(word) for word in words]).reshape(4, 3)
        except ValueError:
            matrix = np.full((4, 3), np.nan)
        if not np.isfinite(matrix).all() or np.linalg.det(matrix[:3]) == 0:
            raise self.fault(
                f'has the transform "{" ".join(words)[:200]}" at {where}, which is not twelve finite numbers, or makes'
                " the object flat",
                "mend it or export the model again",
            )
        printable = attributes.get("printable", "1").strip().lower() not in ("0", "false")
        uses.append(Use(object_id, attributes.get(f"{PRODUCTION} path"), matrix, printable, where))

    def read_id(self, attributes, name, where):
        """An id as a number."""
        word = attributes.get(name, "").strip()
        if not (word.isascii() and word.isdigit()):
            raise self.fault(f'has {name}="{word[:30]}" at {where}, which is not a whole number')
        return int(word)

    def begin_build(self, *_):
        """Take the begin of the build."""
        self.built = True

    STARTS: ClassVar = {
        "/model/resources/object": begin_object,
        "/model/resources/object/mesh": begin_mesh,
        "/model/resources/object/components": begin_mesh,
        "/model/resources/object/components/component": take_use,
        "/model/resources/object/mesh/vertices": begin_run,
        "/model/resources/object/mesh/triangles": begin_run,
        "/model/build": begin_build,
        "/model/build/item": take_use,
    }
