"""Where the nodes of the solid's graph lie: in the material, next to their events."""

# Operations whose node is the region above the event: what was united, or has closed its hole.
ENDING = ("union", "annihilation")


def embed_joints(parts, joints, points, room):
    """Put the nodes of the solid's graph into the material, as the paper does.

    A node is the material point of a region next to its block: of the region
    above a union, of the region below a separation; where parts begin or end,
    the critical vertex at the end of their tip.

    Parameters
    ----------
    parts : GraphParts
        Of the solid.
    joints : dict
        Row of every joint by its id, with x, y, z and, of a handle, index, side and operation.
    points : (R, 3) float64
        Material points of the regions, model frame.
    room : (R,) float64
        Their distances to the boundaries of their regions.

    Returns
    -------
    dict
        The rows with x, y, z of the node, and `region`, whose material point that is, None at a tip. Rows of
        handles have their vertex as `vertex_x`, `vertex_y`, `vertex_z`. Upward along a chain of events no node
        lies below the one before. Where several regions would do, it is the one with the most room, the first such.
    """
    placed = {}
    for part, (lower, upper, members) in enumerate(zip(parts.below, parts.above, parts.joints)):
        above = False
        for joint in [number for number in members or (-1 - part,) if number in joints]:
            row = joints[joint]
            if "vertex" in row:
                row = row | {f"vertex_{axis}": row[axis] for axis in "xyz"}
            above = above or row["operation"] in ENDING
            region = _choose_region(row, lower, upper, above, room)
            place = {} if region is None else dict(zip("xyz", points[region].tolist()))
            placed[joint] = row | place | {"region": region}
    return placed


def _choose_region(row, lower, upper, above, room):
    """The region whose material point a node is; None at a tip, which is at its vertex.

    above : whether that of an event that leaves the number of regions as it is lies above it.
    """
    at_vertex = "vertex_x" in row and (row["index"], row["side"]) in ((0, "A"), (2, "B"))
    if not (lower or upper) or (at_vertex and not (lower and upper)):
        return None
    if not (lower and upper):
        chosen = lower or upper
    elif (len(lower) == 1) != (len(upper) == 1):
        chosen = lower if len(lower) == 1 else upper
    else:
        chosen = upper if above else lower
    return max(chosen, key=lambda region: (room[region], -region))
