"""Errors that a user can cure: each names what is wrong, where, and the cure."""


class ReebsliceError(ValueError):
    """Base of all errors that the library raises on account of what it was given."""


class MeshFormatError(ReebsliceError):
    """A file holds no usable mesh, or one that is not read as its format says."""


class NumberFormatError(ReebsliceError):
    """Text that should hold numbers holds something else."""


class NotASolidError(ReebsliceError):
    """A mesh is not the boundary of a solid, and no allowed repair makes it one."""


class TouchingSheetsError(ReebsliceError):
    """Sheets touch along a mesh edge in such a way that it is not sure how they come apart."""

    def __init__(self, message, edge, cure):
        super().__init__(message)
        self.edge = edge
        self.cure = cure


class UnionError(ReebsliceError):
    """Bodies that overlap cannot be united for sure."""


class TooManyCrossingsError(ReebsliceError):
    """The levels would cross the mesh edges more often than memory holds."""
