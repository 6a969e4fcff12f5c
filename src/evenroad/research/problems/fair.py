"""The fair suite's problems: random worlds, starts and goals, new in every instance, that favour no place."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import NamedTuple

from evenroad.research.bench.task import ProblemSource
from evenroad.research.problems.fair_worlds import PREFIX, Family, Stream, make_instance

# How large the obstacles are was measured with uniform points alone, by `python -m benchmarks.fair_calibrate`
# (docs/data/fair_calibration.csv): at these sizes they solve 25, 50 and 75 % of the instances with k = 10 symmetrised;
# where that was tried again, they did up to 6 points more or less.

DIFFICULTIES = (25, 50, 75)
"""Success of uniform points [%]."""

_CUBE_POINTS = {2: 128, 3: 256, 4: 256, 5: 256, 6: 512, 7: 512, 10: 512}

CALIBRATED_AT: Mapping[tuple[Family, int], int] = {
    **{(family, d): n for family in (Family.BALLS, Family.BOXES) for d, n in _CUBE_POINTS.items()},
    (Family.MAZE, 2): 512,
    (Family.SE2, 3): 256,
    (Family.SE3, 6): 256,
}
"""Family and dimension of the sets -> N of the calibration."""

SIZES: Mapping[tuple[Family, int], tuple[float, float, float]] = {
    (Family.BALLS, 2): (0.1428, 0.1176, 0.09682),
    (Family.BALLS, 3): (0.2015, 0.1843, 0.1685),
    (Family.BALLS, 4): (0.2589, 0.2455, 0.2328),
    (Family.BALLS, 5): (0.3086, 0.2961, 0.2842),
    (Family.BALLS, 6): (0.3666, 0.3548, 0.3434),
    (Family.BALLS, 7): (0.4246, 0.4139, 0.4034),
    (Family.BALLS, 10): (0.5776, 0.5659, 0.5544),
    (Family.BOXES, 2): (0.1154, 0.09369, 0.07603),
    (Family.BOXES, 3): (0.1746, 0.1586, 0.144),
    (Family.BOXES, 4): (0.1499, 0.1367, 0.1247),
    (Family.BOXES, 5): (0.1485, 0.1344, 0.1216),
    (Family.BOXES, 6): (0.1578, 0.1429, 0.1294),
    (Family.BOXES, 7): (0.1528, 0.1383, 0.1252),
    (Family.BOXES, 10): (0.1488, 0.1321, 0.1172),
    (Family.MAZE, 2): (29.5, 35.93, 43.76),
    (Family.SE2, 3): (0.04396, 0.01752, 0.006979),
    (Family.SE3, 6): (0.05804, 0.04362, 0.03279),
}
"""Family and dimension -> size for each difficulty: radius, middle half extent, for mazes width of doors [pixels]."""

ABOUT = {
    Family.BALLS: "random balls on the torus, exact straight motions",
    Family.BOXES: "random boxes that bound 3 random coordinates, exact straight motions",
    Family.MAZE: "random maze of rooms, disk of radius 6",
    Family.SE2: "an L of two boxes turns among random boxes in the plane",
    Family.SE3: "a body of three boxes turns among random boxes in space",
}

TUNED_ON = (Family.BALLS, Family.BOXES)
"""Families that may choose a default; the others are there to be reported on alone."""


class FairProblem(NamedTuple):
    """What decides a stream of random problems.

    `d` is the dimension of the point sets, `difficulty` the success of uniform points [%] with k = 10 symmetrised, and
    `size` that of the obstacles, as calibrated.
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
        make = partial(make_instance, *self)
        about = f"{ABOUT[self.family]}; uniform solves {self.difficulty} % with N = {self.n}"
        return ProblemSource(self.name, self.d, make, random=True, about=about)


_EVERY = (
    FairProblem(stream, family, d, difficulty, size)
    for stream in PREFIX
    for (family, d), sizes in SIZES.items()
    for difficulty, size in zip(DIFFICULTIES, sizes, strict=True)
)
FAIR_PROBLEMS = {each.name: each for each in _EVERY if each.stream is Stream.REPORTING or each.tuned_on}
"""Name -> problem: ``fair-..`` for what is reported, ``tune-..`` for what chooses."""

FAIR = tuple(problem.source() for problem in FAIR_PROBLEMS.values())
