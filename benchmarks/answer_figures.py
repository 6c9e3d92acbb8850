"""What an answer comes to in figures: contours, regions, graphs."""

import numpy as np


def ring_figures(rings):
    """Figures of closed curves, a list of (k, 2 or more) arrays; area is the sum of signed areas."""
    area = [signed_area(ring) for ring in rings]
    return {
        "contours": len(rings), "points": sum(map(len, rings)),
        "area": float(np.sum(area)), "absolute_area": float(np.abs(area).sum()),
    }  # fmt: skip


def signed_area(ring):
    x, y = ring[:, 0] - ring[0, 0], ring[:, 1] - ring[0, 1]
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def unsigned_figures(rings):
    """The same of curves that are not oriented: no signed area."""
    return ring_figures(rings) | {"area": np.nan}


def region_figures(regions):
    """Figures of a list of regions, each the list of its rings."""
    return ring_figures([ring for region in regions for ring in region]) | {"regions": len(regions)}


def graph_figures(nodes, arcs, components=1):
    return {"nodes": int(nodes), "loops": int(arcs - nodes + components)}
