"""Counting: a world that keeps count of what it is asked."""

from __future__ import annotations

from dataclasses import dataclass

from evenroad._arrays import Bools, Floats
from evenroad.space import Space
from evenroad.world.protocol import World


@dataclass(eq=False)
class Counting:
    """Another world's answers, with counts of what was asked.  Not for several threads at once."""

    world: World
    configurations: int = 0
    """That `valid` was asked for; the states inside of motions are not counted."""
    motions: int = 0
    """That `motion_valid` was asked for."""

    def __post_init__(self) -> None:
        # Attributes, and only where the world has them, so that its optional protocols hold of both or of neither.
        for name in ("explain", "proof", "validate", "fingerprint"):
            if hasattr(self.world, name):
                setattr(self, name, getattr(self.world, name))

    @property
    def space(self) -> Space:
        """The world's space."""
        return self.world.space

    def valid(self, q: Floats) -> Bools:
        """Return the world's `valid`."""
        answer = self.world.valid(q)
        self.configurations += len(answer)
        return answer

    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return the world's `motion_valid`."""
        answer = self.world.motion_valid(a, b)
        self.motions += len(answer)
        return answer
