"""Cuts that open the loops of a surface, one contour right below the top of each.

As Tierny, Gyulassy, Simon and Pascucci 2009 do in volumes (doi:10.1109/TVCG.2009.163).
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from .height_mesh import next_half_edge


class Cuts(NamedTuple):
    """J contours along which a surface is cut, cut j between the ranks vertex[j] - 1 and vertex[j].

    vertex : (J,) int32, ascending
    top : (J,) int32, number of the node right below the cut, :mod:`contour_trees`
    first : (J,) int32, one half-edge that each cut crosses
    half_edge, cut : (X,) int32, all crossings, in order of half-edge, then of level
    """

    vertex: np.ndarray
    top: np.ndarray
    first: np.ndarray
    half_edge: np.ndarray
    cut: np.ndarray


def no_cuts():
    """:class:`Cuts` of a surface that stays whole."""
    return Cuts(*(np.zeros(0, np.int32) for _ in Cuts._fields))


def cut_loops(faces, twins, into, nodes, loose):
    """One contour right below each saddle that has two there: :class:`Cuts`.

    into : from `find_gates`; nodes : (K,) ranks of the critical points; loose :
    (L,) those of saddles that may be the top of a loop, ascending. Of the two
    contours the one with fewer crossings is taken.
    """
    length, start = _measure_cuts(faces, twins, into, loose)
    tops = length > 0
    if not tops.any():
        return no_cuts()
    vertex, first = loose[tops], start[tops]
    length = length[tops]
    half_edge = _walk_cuts(faces, twins, vertex, first, int(length.sum()))
    cut = np.repeat(np.arange(len(vertex), dtype=np.int32), length)
    order = np.lexsort((cut, half_edge))
    top = np.searchsorted(nodes, vertex) + 2 * np.arange(len(vertex))
    return Cuts(vertex, top.astype(np.int32), first, half_edge[order], cut[order])


@njit(cache=True)
def _measure_cuts(faces, twins, into, saddles):
    """Crossings of the shorter contour below each saddle, 0 if there is but one; its first half-edge."""
    length, start = np.zeros(len(saddles), np.int64), np.full(len(saddles), np.int32(-1))
    for s in range(len(saddles)):
        v = saddles[s]
        first, second = into[v]
        a, b, steps = first, second, 0
        while True:
            steps += 1
            a = next_half_edge(faces, twins, a, v)
            b = next_half_edge(faces, twins, b, v)
            if a == second or b == first:
                break
            if a == first or b == second:
                length[s], start[s] = steps, a if a == first else b
                break
    return length, start


@njit(cache=True)
def _walk_cuts(faces, twins, vertex, first, total):
    out, place = np.empty(total, np.int32), 0
    for j in range(len(vertex)):
        h = first[j]
        while True:
            out[place] = h
            place += 1
            h = next_half_edge(faces, twins, h, vertex[j])
            if h == first[j]:
                break
    return out


@njit(cache=True)
def divert(near, faces, gates, cuts, upward):
    """Put the node of a cut, as -2 - node, into `near` where a gate crosses one; returns what is behind each cut.

    faces, gates, upward : as for `merge_components`; near : (n, 2), the vertex
    behind each gate. Behind a cut, (J,), there is a vertex or another cut.
    """
    half_edge, cut, top = cuts.half_edge, cuts.cut, cuts.top
    behind, back = np.empty(len(top), np.int32), -1 if upward else 1
    for place in range(len(cut)):
        h = half_edge[place]
        tail, head = faces[h // 3, h % 3], faces[h // 3, (h % 3 + 1) % 3]
        vertex, far = (head, tail) if upward else (tail, head)
        if cuts.first[cut[place]] == h:
            crossed = 0 <= place + back < len(cut) and half_edge[place + back] == h
            behind[cut[place]] = _as_seen(top[cut[place + back]], upward) if crossed else far
        if not 0 <= place - back < len(cut) or half_edge[place - back] != h:
            for k in range(2):
                if gates[vertex, k] == h:
                    near[vertex, k] = _as_seen(top[cut[place]], upward)
    return behind


@njit(cache=True, inline="always")
def _as_seen(top, upward):
    """-2 - the node of a cut that a sweep comes from: upward, the one above it."""
    return -2 - (top + 1 if upward else top)
