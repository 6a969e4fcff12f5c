"""The kinematic chain of ten links."""

from __future__ import annotations

from evenroad.research.bench.task import Problem, ProblemSource
from evenroad.research.worlds.chain import ChainWorld


def _chain(instance: int) -> Problem:
    world = ChainWorld(10)
    return Problem(world, world.start, world.goal, set_dim=world.links)


CHAINS = (
    ProblemSource(
        "chain-10d",
        10,
        _chain,
        about="planar chain of 10 links that folds out of a horn, measured by its joints in the plane (OMPL's demo)",
    ),
)
