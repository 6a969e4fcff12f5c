"""The rule that is taken when none is given."""

from __future__ import annotations

from evenroad.roadmap.rules.k_nearest import KNearest
from evenroad.space import Space


def default_rule(space: Space) -> KNearest:
    """Return ``k=10 symmetrised`` below six dimensions, ``k=20 symmetrised`` from there on.

    From six dimensions on, k matters more than the sampler.  Success in random worlds of balls and of boxes with
    Owen-Sobol points at k = 4 / 6 / 10 / 20: 53 / 67 / 75 / 78 % (d=5, N=256), 46 / 59 / 69 / 75 % (d=6, N=512),
    49 / 62 / 72 / 78 % (d=7, N=512), 46 / 56 / 64 / 71 % (d=10, N=512).  The step from 10 to 20 gives 3 to 4 points
    in d=5 and 6 to 7 from d=6 on, where it costs a lazy search few checks.
    """
    return KNearest(20 if space.cube_dim >= 6 else 10)
