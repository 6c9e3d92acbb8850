"""Extensions of 3MF: which ones change the shape, and what is refused or told of them."""

from ..errors import MeshFormatError
from .threemf_model import PRODUCTION

_OLD = "http://schemas.microsoft.com/3dmanufacturing/"
SLICES = f"{_OLD}slice/2015/07"
# Extensions that leave the shape as the mesh has it, whether they are read or not.
HONOURED = {PRODUCTION, SLICES, f"{_OLD}material/2015/02", f"{_OLD}trianglesets/2021/07"}
# Words in the namespaces, of whichever year, of extensions that say something of the shape, and their names.
SHAPES = {
    "beamlattice": "beam lattice",
    "volumetric": "volumetric",
    "implicit": "implicit",
    "displacement": "displacement",
    "boolean": "boolean operations",
    "securecontent": "secure content",
    "alternatives": "alternatives",
    "slice": "slices",
}


def name_extension(namespace):
    """Return an extension's name and namespace, as one reads it.

    >>> name_extension("http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02")
    'beam lattice (http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02)'
    """
    name = _find_shape(namespace)
    return f"{name} ({namespace})" if name else namespace


def _find_shape(namespace):
    """The name of an extension that says something of the shape, or None."""
    return next((name for word, name in SHAPES.items() if f"/{word}" in namespace), None)


def refuse_extensions(model):
    """Refuse a model part that requires an extension which changes the shape, or which is not known.

    Parameters
    ----------
    model : `threemf_model.Model`

    Raises
    ------
    MeshFormatError
        The message names the extensions.
    """
    refused = [f"{word}: {name_extension(uri)}" for word, uri in model.required.items() if uri not in HONOURED]
    if refused:
        raise MeshFormatError(
            f"Part {model.part} requires extensions of 3MF that are not supported ({', '.join(refused)}), without which"
            " its meshes are not the model; export the model as plain meshes."
        )


def refuse_stand_in(thing, part):
    """Refuse an object whose mesh only stands in for a shape that is told otherwise, or that has no mesh.

    Parameters
    ----------
    thing : `threemf_model.Object`
    part : name of its part

    Raises
    ------
    MeshFormatError
        The message names the object, its part and what tells its shape.
    """
    if thing.resolution != "fullres":
        raise MeshFormatError(
            f"The mesh of {thing} in part {part} is '{thing.resolution}', a stand-in for slices or for another object"
            " that tells the real shape; export the model with its full mesh."
        )
    if thing.faces is None and not thing.components and not thing.composed:
        found = ", ".join(sorted(thing.foreign)) or "nothing"
        raise MeshFormatError(
            f"The {thing} in part {part} has neither a mesh nor components, but {found}; export the model as plain"
            " meshes."
        )


def describe_extensions(models):
    """Return sentences on extensions that were found and not read.

    Parameters
    ----------
    models : iterable of `threemf_model.Model`

    Returns
    -------
    list of str
        One for each extension that says something of the shape and is used but
        not required, and one for each that is recommended and not supported.
    """
    notes = {}
    for model in models:
        used = {tag.rpartition(" ")[0] for tag in model.foreign}
        for namespace in sorted(used):
            if name := _find_shape(namespace):
                notes[f"The file uses the extension {name} ({namespace}), which is not read: the meshes alone are."] = (
                    None
                )
        for namespace in sorted(set(model.recommended.values()) - HONOURED):
            notes[f"The file recommends the extension {name_extension(namespace)}, which is not read."] = None
    return list(notes)
