"""The handles of events that are known by their vertices."""


def find_handles(handles, vertices, operation, side=None):
    """Find the handle of an event at each vertex.

    Parameters
    ----------
    handles : pyarrow.Table
        The table `handles`.
    vertices : sequence of int
    operation : str
        Of `schemas.OPERATIONS`.
    side : str, optional
        ``A`` or ``B``; by default either.

    Returns
    -------
    list of int or None
        The first handle of this operation, and side, at each vertex: a multiple saddle has several. None where
        there is no such handle, as the event cancels with others within its slab.
    """
    first = {}
    columns = (handles[name].to_pylist() for name in ("handle", "vertex", "operation", "side"))
    for handle, vertex, found, on in zip(*columns):
        if found == operation and side in (None, on):
            first.setdefault(vertex, handle)
    return [first.get(vertex) for vertex in vertices]
