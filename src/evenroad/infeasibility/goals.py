"""Proofs for the goals of a plan: with poses among them, for all postures that reach these."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from evenroad._arrays import Floats
from evenroad.poses.goals import Goals
from evenroad.world.protocol import Apart

if TYPE_CHECKING:
    from evenroad.infeasibility.proof import InScene


def proof_between(
    world: InScene, goals: Goals, *, straight: bool = False
) -> Callable[[Floats, Floats, bool], Apart | None]:
    """Return a function that proves that a start, (dim,), and goals, (g, dim), are apart, quickly or not.

    Between `straight` lines it proves nothing about poses: other lines may lead to other postures.
    """
    poses = [] if straight else [goal for goal, _ in goals.poses]

    def prove(start: Floats, terminals: Floats, quickly: bool) -> Apart | None:
        # Imported late: few plans need the proof.
        from evenroad.infeasibility.proof import apart

        return apart(world, start, terminals, poses, quickly=quickly, whole=goals.whole and not straight)

    return prove
