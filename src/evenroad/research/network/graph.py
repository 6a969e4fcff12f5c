"""Who hears of whom: neighbours among the starting points, fixed for the whole training."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from evenroad.points.measures.l2 import Array

Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Edges:
    """Messages of a graph: message e goes from point ``sender[e]`` to point ``receiver[e]``.

    Attributes
    ----------
    sender, receiver : ndarray of int64, shape (m,)
        Sorted by receiver.
    """

    sender: Indices
    receiver: Indices


def nearest_edges(points: Array, k: int) -> Edges:
    """Let every point of (n, d) hear of its k nearest others, or of all others where n <= k."""
    n = len(points)
    k = min(k, n - 1)
    _, found = cKDTree(points).query(points, k=k + 1)
    found = found.reshape(n, k + 1)
    other = found != np.arange(n)[:, np.newaxis]
    # Where more than k others lie at distance 0, a point may be missing among its own nearest ones.
    other[other.all(axis=1), -1] = False
    return Edges(found[other].astype(np.int64), np.repeat(np.arange(n), k))


def radius_edges(points: Array, radius: float) -> Edges:
    """Let every point of (n, d) hear of all points at most `radius` away, itself included."""
    lists = cKDTree(points).query_ball_point(points, radius, return_sorted=True)
    found = [np.array(each, dtype=np.int64) for each in lists]
    degrees = [len(each) for each in found]
    return Edges(np.concatenate(found), np.repeat(np.arange(len(points)), degrees))


def edges_of_sets(sets: Array, k: int, radius: float | None) -> Edges:
    """Build the graph of every set of (s, n, d); point i of set t has the number t n + i.

    Parameters
    ----------
    sets : ndarray, shape (s, n, d)
        Starting points, n >= 2.
    k : int
        Nearest neighbours, if there is no radius.
    radius : float or None
        Distance within which all are neighbours.
    """
    n = sets.shape[1]
    graphs = [nearest_edges(each, k) if radius is None else radius_edges(each, radius) for each in sets]
    return Edges(
        np.concatenate([graph.sender + t * n for t, graph in enumerate(graphs)]),
        np.concatenate([graph.receiver + t * n for t, graph in enumerate(graphs)]),
    )
