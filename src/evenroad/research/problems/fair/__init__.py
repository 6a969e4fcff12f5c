"""The fair suite: random worlds, starts and goals, new in every instance, that favour no place of the space."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from evenroad.research.bench.task import ProblemSource
from evenroad.research.problems.fair.instance import make_instance
from evenroad.research.problems.fair.sizes import CALIBRATED_AT, DIFFICULTIES, SIZES
from evenroad.research.problems.fair.streams import PREFIX, Family, Stream

ABOUT = {
    Family.BALLS: "random balls on the torus, exact straight motions",
    Family.BOXES: "random boxes that bound 3 random coordinates, exact straight motions",
    Family.MAZE: "random maze of rooms, disk of radius 6",
    Family.SE2: "an L of two boxes turns among random boxes in the plane",
    Family.SE3: "a body of three boxes turns among random boxes in space",
}

TUNED_ON = (Family.BALLS, Family.BOXES)
"""Families that may choose a default; the others are there to be reported on alone."""


@dataclass(frozen=True)
class FairProblem:
    """What decides a stream of random problems.

    Attributes
    ----------
    stream : Stream
        What its instances are for.
    family : Family
        Kind of world.
    d : int
        Dimension of the point sets.
    difficulty : int
        Success of uniform points [%] with k = 10 symmetrised.
    size : float
        Of the obstacles, as calibrated.
    """

    stream: Stream
    family: Family
    d: int
    difficulty: int
    size: float

    @property
    def name(self) -> str:
        """``fair-balls-5d-50``, ``tune-balls-5d-50``, ``fair-se2-25``, ..."""
        dimension = f"-{self.d}d" if self.tuned_on else ""
        return f"{PREFIX[self.stream]}-{self.family.name.lower()}{dimension}-{self.difficulty}"

    @property
    def n(self) -> int:
        """Points with which the difficulty was calibrated."""
        return CALIBRATED_AT[self.family, self.d]

    @property
    def tuned_on(self) -> bool:
        """Whether the family may choose a default."""
        return self.family in TUNED_ON

    def source(self) -> ProblemSource:
        """Return the problems by the number of their instance."""
        make = partial(make_instance, self.stream, self.family, self.d, self.difficulty, self.size)
        about = f"{ABOUT[self.family]}; uniform solves {self.difficulty} % with N = {self.n}"
        return ProblemSource(self.name, self.d, make, random=True, about=about)


def _problems() -> dict[str, FairProblem]:
    every = (
        FairProblem(stream, family, d, difficulty, size)
        for stream in PREFIX
        for (family, d), sizes in SIZES.items()
        for difficulty, size in zip(DIFFICULTIES, sizes, strict=True)
    )
    return {each.name: each for each in every if each.stream is Stream.REPORTING or each.tuned_on}


FAIR_PROBLEMS = _problems()
"""Name -> problem: ``fair-..`` for what is reported, ``tune-..`` for what chooses."""

FAIR = tuple(problem.source() for problem in FAIR_PROBLEMS.values())
