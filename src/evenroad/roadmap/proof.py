"""The last check of a path: no motion is handed out that its world does not confirm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad.roadmap.result import PlanResult, Status
from evenroad.roadmap.search import BLOCKED, EdgeStates, Found
from evenroad.world import Rechecks, World


def proof_of(world: World) -> str:
    """Return what is shown of every path in a world: ``exact``, ``certified``, or ``resolution`` if it does not say."""
    # Not by `isinstance`, which takes as long as some checks.
    return str(getattr(world, "proof", "resolution"))


def confirmed(world: World, path: Floats, doubtful: Bools) -> Bools:
    """Return which motions of a path, (p, dim), pass the world's strict check, (p - 1,); all where it has none.

    Only the doubtful ones, (p - 1,), have to be checked: the others passed before.
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
    nodes, along, _ = found
    passed = confirmed(states.world, states.configurations[nodes], ~states.confirmed[along])
    states.confirmed[along] = passed
    states.edge_states[along[~passed]] = BLOCKED
    return bool(passed.all())


def require_certified(world: World, result: PlanResult) -> PlanResult:
    """Return the plan if all motions of its path are proved free, by a check of its own, else ``not_certified``.

    The message then names the first motion that is not; the path stays in the result.
    """
    if result.path is None or result.proof == "exact":
        return result
    if not (isinstance(world, Rechecks) and world.proof == "certified"):
        message = "the path is free at the states tested; motions of this world cannot be proved free"
        return replace(result, status=Status.NOT_CERTIFIED, message=message)
    failed = np.flatnonzero(~world.recheck(result.path))
    if not len(failed):
        return replace(result, proof="certified")
    first, last = ("(" + ", ".join(f"{x:.6g}" for x in result.path[failed[0] + i]) + ")" for i in (0, 1))
    message = (
        f"motion {failed[0] + 1} of {len(result.path) - 1} is not proved free, from {first} to {last}:"
        " it may touch, or pass too near to contact to tell"
    )
    return replace(result, status=Status.NOT_CERTIFIED, message=message, proof="resolution")
