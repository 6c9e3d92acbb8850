"""Errors of the library, named for what is wrong."""


class ReebsliceError(ValueError):
    """Input that the library refuses; the message says what is wrong, where, and the cure."""


class MeshFormatError(ReebsliceError):
    """A file that holds no usable mesh; the message says why, and the cure."""
