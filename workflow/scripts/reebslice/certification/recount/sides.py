"""Sides of critical points, from the geometry right around them."""

from .links import find_arms, find_links, find_upper_wedges, order_level_directions, smallest_tilt

LEAST = 1e-9  # share of its terms below which an area is left open


def local_sides(surface, vertices):
    """Find the side of critical vertices from the geometry around them.

    Extrema: the sign of the area of the link, that is, whether the outside is
    up. Saddles: of the sector of the horizontal plane that an upper wedge of
    the link cuts off, whether it is void (A) or material (B).

    Parameters
    ----------
    surface : Ranked
    vertices : list of int

    Returns
    -------
    list of str
        "A", "B", or "" where the saddle is multiple or the surface crosses or
        touches itself right there.
    """
    tilt, sides = smallest_tilt(surface.points), []
    for vertex, link in find_links(surface, vertices).items():
        arms = find_arms(surface.points, tilt, vertex, link)
        wedges = find_upper_wedges(arms)
        if surface.changes[vertex] == 0:
            sides.append(_side_of_extremum(arms))
        else:
            sides.append(_side_of_saddle(order_level_directions(arms, wedges)) if len(wedges) == 2 else "")
    return sides


def _side_of_extremum(arms):
    """The side by the sign of the area of the link, seen from above at one height; "" with a neighbour in its place."""
    if not all(h for _, _, h in arms):
        return ""
    least, reach = min(abs(h) for _, _, h in arms), max(max(abs(x), abs(y)) for x, y, _ in arms)
    spots = [(x * least / (abs(h) * reach), y * least / (abs(h) * reach)) for x, y, h in arms]
    terms = [px * qy - py * qx for (px, py), (qx, qy) in zip(spots, spots[1:] + spots[:1])]
    if abs(sum(terms)) <= LEAST * sum(map(abs, terms)):
        return ""
    return "B" if sum(terms) > 0 else "A"


def _side_of_saddle(places):
    """The side by the order in which a link enters and leaves the two upper wedges of a simple saddle.

    The contour above runs in where the link leaves a wedge and out where it
    enters; the material is left of it, from where it enters to where it leaves.
    """
    ways = {(places[leaves] - places[enters]) % 4 for enters, leaves in ((0, 1), (2, 3))}
    return {1: "B", 3: "A"}.get(ways.pop(), "") if len(ways) == 1 else ""
