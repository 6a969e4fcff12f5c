"""The last check of a path: no motion is handed out that its world does not confirm."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.roadmap.search import BLOCKED, EdgeStates, Found
from evenroad.world import Proves, Rechecks, World


def proof_of(world: World) -> str:
    """Return what is shown of every path in a world: ``exact``, ``certified``, or ``resolution`` if it does not say."""
    return world.proof if isinstance(world, Proves) else "resolution"


def confirmed(
    world: World, path: npt.NDArray[np.float64], doubtful: npt.NDArray[np.bool_]
) -> npt.NDArray[np.bool_]:
    """Return which motions of a path pass the world's strict check, (p - 1,).

    Parameters
    ----------
    world : World
        All motions pass where it has none.
    path : ndarray, shape (p, dim)
        Waypoints.
    doubtful : ndarray of bool, shape (p - 1,)
        Which motions have to be checked; the others passed before.
    """
    passed = ~doubtful
    if not isinstance(world, Rechecks):
        return np.ones_like(passed)
    # Runs of motions that follow one another are one call.
    edges = np.flatnonzero(np.diff(np.concatenate([[False], doubtful, [False]])))
    for first, last in edges.reshape(-1, 2):
        passed[first:last] = world.recheck(path[first : last + 1])
    return passed


def confirm(states: EdgeStates, found: Found) -> bool:
    """Return whether the world confirms all motions of a path; those that fail are blocked from now on."""
    nodes, along = found
    passed = confirmed(states.world, states.configurations[nodes], ~states.confirmed[along])
    states.confirmed[along] = passed
    states.edge_states[along[~passed]] = BLOCKED
    return bool(passed.all())
