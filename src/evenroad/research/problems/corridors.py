"""Corridors along edges of the hypercube, and the legacy problem that published tables are of.

"Low ones first": coordinates before the free one are at most the width, those after it at least one minus the width, as
a comment in OMPL's demo says.  The demo's code has it the other way round.
"""

from __future__ import annotations

from functools import partial

from evenroad.research.bench.task import Problem, ProblemSource
from evenroad.research.worlds.corridor import Corridor, hypercube_legacy6

WIDTHS: dict[int, tuple[float, ...]] = {2: (0.1, 0.0225), 3: (0.2, 0.1), 10: (0.37, 0.495)}
"""Dimension -> widths lambda: the paper's, then one where samplers can differ.

The second ones were chosen by uniform's success alone, k = 10 earlier, 400 runs of seed 1001 (200 in 3-D), at
N = 256 / 512 / 1024: 13 / 29 / 53 % in 2-D, 6 / 26 / 63 % in 3-D, 1 / 4 / 28 % in 10-D.  In 10-D no width has 10 % at
all three: from one half on the straight way is free, and just below it success rises from 1 to 28 %.
"""


def _corridor(d: int, lam: float, instance: int) -> Problem:
    world = Corridor(d, lam)
    return Problem(world, world.start, world.goal, set_dim=d)


def _legacy6(instance: int) -> Problem:
    world = hypercube_legacy6()
    return Problem(world, world.start, world.goal, set_dim=world.d)


CORRIDORS = (
    *(
        ProblemSource(
            f"corridor-{d}d-{lam:g}",
            d,
            partial(_corridor, d, lam),
            about=f"corridor along {d} edges of the cube, width {lam:g}, all coordinates tested, low ones first",
        )
        for d, widths in WIDTHS.items()
        for lam in widths
    ),
    ProblemSource(
        "hypercube-legacy6",
        10,
        _legacy6,
        about="10-D corridor, width 0.37, only 6 coordinates tested, high ones first (OMPL's demo)",
    ),
)
