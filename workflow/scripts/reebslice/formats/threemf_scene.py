"""Model parts of a 3MF package, and the copies of meshes that the build puts in place."""

from typing import NamedTuple

import numpy as np

from ..errors import MeshFormatError
from .packages import fold_name, spell_name
from .threemf_extensions import refuse_extensions, refuse_stand_in
from .threemf_model import Object, read_model

START_PART = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
UNITS = {"micron": "micrometre", "millimeter": "millimetre", "centimeter": "centimetre", "meter": "metre"}
UNITS |= {"inch": "inch", "foot": "foot"}
SOLID = ("model", "solidsupport")
# Components of components multiply: thirty levels of two are a billion copies in a kilobyte. What a package holds
# itself, less than one triangle, vertex or place for each byte, it may always place.
MOST_TRIANGLES, MOST_PLACES = 1 << 25, 1 << 18
UNCOUNTED = 10**15  # beyond this, copies are not counted: their number may have more digits than the file has bytes


class Copy(NamedTuple):
    """An object of solid type with a mesh, put in place."""

    object: Object
    matrix: np.ndarray  # (4, 3), applied to row vectors (x, y, z, 1)


class Scene:
    """The model parts of a package that its build refers to, each read once, when it is first referred to.

    Parameters
    ----------
    package : `packages.Package`

    Attributes
    ----------
    root : `threemf_model.Model`, the root part
    models : dict of `threemf_model.Model` by folded names of parts
    used : set of (part, id) of the objects that the build places
    left_out : dict of `threemf_model.Object` by (part, id), those among them that are no solids
    """

    def __init__(self, package):
        self.package = package
        self.models, self.used, self.left_out = {}, set(), {}
        self._sizes = {}  # triangles (or vertices, if more) and places at and below each object, copies included
        self._root_name = find_root(package)
        self.root = self._load(self._root_name)

    def place_build(self):
        """Return all copies of solid meshes that the build makes, in its order.

        Returns
        -------
        list of Copy

        Raises
        ------
        MeshFormatError
            An item or component names an object or part that is not there;
            components form a circle; there are more than `MOST_TRIANGLES` or
            `MOST_PLACES`, and more than the package has bytes, unpacked; an
            object's shape is not a mesh.
        """
        found = [self._find(item, fold_name(self._root_name)) for item in self.root.items]
        triangles, places = (sum(sizes) for sizes in zip((0, 0), *(self._measure(key) for key in found), strict=True))
        most = max(MOST_TRIANGLES, self.package.unpacked), max(MOST_PLACES, self.package.unpacked)
        if triangles > most[0] or places > most[1]:
            more = " and more" * (max(triangles, places) >= UNCOUNTED)
            raise MeshFormatError(
                f"The build of the 3MF file places {triangles} triangles (or vertices) in {places} objects{more},"
                f" copies included; at most {most[0]} and {most[1]} are read from it. Export fewer copies."
            )
        matrices = [item.matrix for item in self.root.items]
        return [copy for key, matrix in zip(found, matrices, strict=True) for copy in self._place(key, matrix)]

    def _load(self, part):
        """The model of a part, checked against what the root part is."""
        key = fold_name(part)
        if key not in self.models:
            model = read_model(self.package.read(part), spell_name(part))
            refuse_extensions(model)
            if model.unit not in UNITS:
                raise MeshFormatError(
                    f"Part {model.part} has the unit '{model.unit}', not one of {', '.join(UNITS)}; mend it or export"
                    " the model again."
                )
            if self.models and model.unit != self.root.unit:
                raise MeshFormatError(
                    f"Part {model.part} is in {UNITS[model.unit]} and {self.root.part} in {UNITS[self.root.unit]}; 3MF"
                    " does not say how these go together: export the model in one unit."
                )
            self.models[key] = model
        return self.models[key]

    def _find(self, use, part):
        """The key (part, id) of the object that an item or a component in a part stands for."""
        if use.part is not None:
            if part != fold_name(self._root_name):
                raise MeshFormatError(
                    f"The {use.where} has a path ({use.part}), which is allowed in the root part alone; export the"
                    " model again."
                )
            part = fold_name(use.part)
            self._load(use.part)
        model = self.models[part]
        if use.object_id not in model.objects:
            known = ", ".join(map(str, sorted(model.objects)[:10])) or "none"
            raise MeshFormatError(
                f"The {use.where} names object {use.object_id}, which part {model.part} does not have (it has:"
                f" {known}); the file is damaged: export the model again."
            )
        return part, use.object_id

    def _components(self, key):
        """The keys of the components of an object."""
        return [self._find(use, key[0]) for use in self._object(key).components]

    def _object(self, key):
        """The object of a key."""
        return self.models[key[0]].objects[key[1]]

    def _measure(self, top):
        """How many triangles and places are at and below an object, copies included; circles are refused."""
        above, waiting = {}, [(top, None)]  # objects that wait for those below them, from the top down
        while waiting:
            key, below = waiting.pop()
            if below is not None:
                del above[key]
                sums = map(sum, zip((0, 1), *(self._sizes[child] for child in below), strict=True))
                self._sizes[key] = tuple(min(count, UNCOUNTED) for count in sums)
            elif key in above:
                circle = [*list(above)[list(above).index(key) :], key]
                shown = [f"object {object_id} of {self.models[part].part}" for part, object_id in circle[::-1]]
                told = ", in ".join(shown if len(shown) < 9 else [*shown[:4], "...", *shown[-4:]])
                raise MeshFormatError(f"Components form a circle: {told}; the file is damaged: export the model again.")
            elif key not in self._sizes and (below := self._components(key)):
                above[key] = None
                waiting += [(key, below), *((child, None) for child in below)]
            elif key not in self._sizes:
                thing = self._object(key)
                self._sizes[key] = (0 if thing.faces is None else max(len(thing.faces), len(thing.points)), 1)
        return self._sizes[top]

    def _place(self, key, matrix):
        """The copies of solid meshes at and below an object, in order."""
        copies, waiting = [], [(key, matrix)]
        while waiting:
            key, matrix = waiting.pop()
            thing = self._object(key)
            self.used.add(key)
            refuse_stand_in(thing, self.models[key[0]].part)
            if thing.faces is not None and thing.type_ in SOLID:
                copies.append(Copy(thing, matrix))
            elif thing.faces is not None:
                self.left_out[key] = thing
            below = zip(self._components(key), thing.components, strict=True)
            waiting += [(child, _compose(use.matrix, matrix)) for child, use in reversed(list(below))]
        return copies


def find_root(package):
    """Return the name of the root model part, to which the package's relationships lead.

    Parameters
    ----------
    package : `packages.Package`

    Returns
    -------
    str

    Raises
    ------
    MeshFormatError
        There is none, or more than one.
    """
    targets = package.related(START_PART)
    if len(targets) != 1:
        told = f"more than one 3D model ({', '.join(targets)})" if targets else "no 3D model"
        raise MeshFormatError(f"The relationships of the 3MF package name {told}; export the model again.")
    return targets[0]


def _compose(inner, outer):
    """The (4, 3) matrix that puts a component in place whose object another matrix puts in place."""
    return np.vstack([inner[:3] @ outer[:3], inner[3] @ outer[:3] + outer[3]])
