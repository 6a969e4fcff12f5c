"""Connection rules of published protocols: OMPL's order of insertion, and the radius of PRM*."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats, Ints32
from evenroad._checks import require_count, require_positive
from evenroad.roadmap import Reach, Rule, rules
from evenroad.roadmap.neighbours import nearest
from evenroad.roadmap.rules import ByNumber, Radius, arcs_of, ascending, plain
from evenroad.space import Space


@dataclass(frozen=True)
class KEarlier(ByNumber):
    """``k earlier``: each configuration is joined to its k nearest among those inserted before it.

    Start and goal are inserted first, then the milestones by their index: the order of OMPL's PRM, whose
    default strategy this is (k = 10).
    """

    which = "earlier"

    def edges(self, q: Floats, space: Space | None = None, *, terminals: int = 0) -> Ints32:
        """Return the pairs of each with its k nearest earlier ones; see :class:`Rule`."""
        n = len(q)
        inserted = np.concatenate([np.arange(n - terminals, n), np.arange(n - terminals)])
        arcs = arcs_of(nearest(q[inserted], self.k, space, earlier=True))
        return ascending(inserted[arcs], n)


@dataclass(frozen=True)
class RadiusStar(Rule):
    """``radius*``: all pairs at most ``r = gamma (log n / n)^(1/d)`` apart.

    `gamma` is in the units of the space, > 0; asymptotically optimal above :func:`prm_star_gamma`.
    """

    gamma: float

    def __post_init__(self) -> None:
        require_positive("gamma", self.gamma)

    def __str__(self) -> str:
        return f"radius* gamma={plain(self.gamma)}"

    def at(self, n: int, d: int) -> Radius:
        """Return the radius for n >= 2 configurations in d dimensions; 1 has no log to speak of."""
        n = max(n, 2)
        return Radius(self.gamma * (math.log(n) / n) ** (1 / d))

    def edges(self, q: Floats, space: Space | None = None, *, terminals: int = 0) -> Ints32:
        """Return the pairs within the radius for this number of configurations."""
        return self.at(len(q), q.shape[1] if space is None else space.cube_dim).edges(q, space)

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return that a terminal is joined to all within the radius for this number of milestones."""
        return self.at(milestones, space.cube_dim).reach(milestones, space)


def prm_star_gamma(d: int, free_measure: float) -> float:
    """Return the gamma above which PRM* is asymptotically optimal (Karaman and Frazzoli 2011, Algorithm 4).

    It is ``2 (1 + 1/d)^(1/d) (free_measure / unit_ball)^(1/d)``, with the measure of the free space in the
    units of the metric to the power d, and that of the unit ball of d dimensions.
    """
    d = require_count("d", d)
    measure = require_positive("free measure", free_measure)
    unit_ball = math.pi ** (d / 2) / math.gamma(d / 2 + 1)
    return 2 * ((1 + 1 / d) * measure / unit_ball) ** (1 / d)


FORMS = rules.FORMS | {
    "k=K earlier": (r"k=(\d+) earlier", lambda k: KEarlier(int(k))),
    "radius* gamma=G": (rf"radius\* gamma={rules.NUMBER}", lambda gamma: RadiusStar(float(gamma))),
}


def rule_named(name: str) -> Rule:
    """Return the rule whose ``str()`` is `name`, for example ``k=10 earlier``; errors as evenroad's."""
    return rules.rule_named(name, FORMS)
