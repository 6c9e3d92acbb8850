"""Checks of where the nodes of the solid's graph lie: in the material, or at the tip of a part.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

import numpy as np

from ..recount.graphs import list_items

TIPS = ((0, "A"), (2, "B"))  # index and side of the events at which parts begin and end
RAISED = ("union", "annihilation")


def check_places(facts, ledger):
    """Each node of the solid's graph is a material point inside a region next to its block, or a tip of the surface."""
    t, points = facts.columns.handles, np.stack([facts.columns.nodes[axis] for axis in "xyz"], axis=1)
    facts.spot_region = find_spot_regions(facts)
    facts.spots = np.stack([column[t["vertex"]] for column in facts.points], axis=-1)
    inside = facts.spot_region >= 0
    facts.spots[inside] = points[facts.spot_region[inside]]
    holds = []
    for name, data in facts.graphs["solid"].nodes.items():
        handle, spot = int(name[1:]), [data[axis] for axis in "xyz"]
        region, block = data.get("region", -1), t["block"][handle]
        if 0 <= region < len(points):
            near = facts.block_above[region] == block or facts.block_below[region] == block
            holds.append(near and facts.inside[region] and bool((points[region] == spot).all()))
        else:
            vertex = t["vertex"][handle]
            holds.append((t["index"][handle], t["side"][handle]) in TIPS and [c[vertex] for c in facts.points] == spot)
    ledger.rows("solid.nodes_inside", holds, "a point inside a region next to the event, or the vertex at a tip")


def find_spot_regions(facts):
    """Find for each handle that is a node of the solid's graph the region whose material point it is.

    Of a union that is the region above, of a separation the one below, and
    where there are several, the one with the most room. Of events that leave
    the number of regions alone, those from the first union or closed hole of a
    chain on are above, those before it below.

    Parameters
    ----------
    facts : Facts

    Returns
    -------
    (H,) int64
        -1 at a tip, and of handles that are no nodes.
    """
    t, room = facts.columns.handles, facts.columns.nodes["inscribed_radius"]
    spot_region = np.full(len(t["handle"]), -1)
    for lower, upper, joints in zip(*list_items(facts.parts["solid"]), facts.parts["solid"].joints):
        raised = np.logical_or.accumulate([t["operation"][handle] in RAISED for handle in joints])
        for handle, up in zip(joints, raised):
            if lower and upper:
                alone = [side for side in (lower, upper) if len(side) == 1]
                side = alone[0] if len(alone) == 1 else upper if up else lower
            elif (t["index"][handle], t["side"][handle]) in TIPS:
                continue
            else:
                side = lower or upper
            if side:
                spot_region[handle] = min(side, key=lambda region: (-room[region], region))
    return spot_region
