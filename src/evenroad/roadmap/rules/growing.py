"""Rules whose radius or k follows from the number of milestones or the evenness of the points; and rules by name.

PRM* (Karaman and Frazzoli 2011), where n counts all configurations that are joined, start and goals included, and d
is the dimension of the space; and the radius with a guarantee on the path's length (Chahine et al. 2025, section 3;
Janson, Ichter and Pavone 2018).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from evenroad._arrays import Floats, Ints32
from evenroad._checks import require_count, require_positive
from evenroad.errors import InvalidValue, NotAvailable, UnknownName
from evenroad.roadmap.neighbours import flat_metric
from evenroad.roadmap.rules.near import Complete, KEarlier, KMutual, KNearest, Radius, Reach, Rule, plain
from evenroad.space import Space


class _Growing(Rule, Protocol):
    """A rule that depends on the number of configurations."""

    def at(self, n: int, d: int) -> Rule:
        """Return the rule for n configurations in d dimensions."""

    def edges(self, q: Floats, space: Space | None = None, *, terminals: int = 0) -> Ints32:
        """Return the pairs of the rule for this number of configurations; see :class:`Rule`."""
        return self.at(len(q), q.shape[1] if space is None else space.cube_dim).edges(q, space)

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return how that rule joins a terminal; see :class:`Rule`."""
        return self.at(milestones, space.cube_dim).reach(milestones, space)


@dataclass(frozen=True)
class RadiusStar(_Growing):
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


@dataclass(frozen=True)
class KStar(_Growing):
    """``k*``: the ``k = ceil(e (1 + 1/d) log n)`` nearest, symmetrised."""

    def __str__(self) -> str:
        return "k*"

    def at(self, n: int, d: int) -> KNearest:
        """Return k for n >= 2 configurations in d dimensions."""
        return KNearest(math.ceil(math.e * (1 + 1 / d) * math.log(max(n, 2))))


def prm_star_gamma(d: int, free_measure: float) -> float:
    """Return the gamma above which PRM* is asymptotically optimal (Karaman and Frazzoli 2011, Algorithm 4).

    It is ``2 (1 + 1/d)^(1/d) (free_measure / unit_ball)^(1/d)``, with the measure of the free space in the
    units of the metric to the power d, and that of the unit ball of d dimensions.
    """
    d = require_count("d", d)
    measure = require_positive("free measure", free_measure)
    unit_ball = math.pi ** (d / 2) / math.gamma(d / 2 + 1)
    return 2 * ((1 + 1 / d) * measure / unit_ball) ** (1 / d)


@dataclass(frozen=True, kw_only=True)
class TheoryRadius(Rule):
    """``theory radius``: all pairs at most ``r = 2 alpha sqrt(d) D`` apart, D a bound of the l-infinity dispersion.

    With a path of enough clearance, the shortest one of the roadmap is then within a factor
    ``1 + 1 / (alpha - 1)`` of it.  The bound D is either the `dispersion` itself or ``2 star_discrepancy^(1/d)``: the
    dispersion is at most the d-th root of the discrepancy over *all* boxes (Niederreiter 1992), which is at most
    ``2^d`` times that over boxes at the origin.  Without the 2, as the paper could be read, it is false: the points
    (0, 0.375) and (0.55, 0.975) leave a hole of 0.975 with a star discrepancy of 0.5.  If a side is not 1,
    ``sqrt(d)`` becomes the length of the diagonal.

    `alpha` is above 1, and exactly one of the others is given, in (0, 1], of the points in the unit cube.  InvalidValue
    for other values; and from `edges`, where the radius is no less than the diameter of the space, so that it says
    nothing: in ten dimensions that is so for every set of a feasible size.
    """

    alpha: float
    star_discrepancy: float | None = None
    dispersion: float | None = None

    def __post_init__(self) -> None:
        if require_positive("alpha", self.alpha) <= 1:
            raise InvalidValue(f"alpha must be above 1, got {self.alpha!r}")
        if (self.star_discrepancy is None) == (self.dispersion is None):
            raise InvalidValue("give either star_discrepancy or dispersion")
        name, value = self._bound()
        if require_positive(name, value) > 1:
            raise InvalidValue(f"{name} must be at most 1, got {value!r}")

    def __str__(self) -> str:
        name, value = self._bound()
        return f"theory radius alpha={plain(self.alpha)} {name}={plain(value)}"

    def radius(self, space: Space) -> float:
        """Return r in the units of the space, or raise; see the class."""
        metric = flat_metric(space)
        if metric is None:
            raise NotAvailable(f"the theory radius needs a space of flat metric, not {type(space).__name__}")
        d = space.cube_dim
        name, value = self._bound()
        bound = value if name == "dispersion" else 2 * value ** (1 / d)
        # The map from the cube is affine here; twice the distance to the middle is a side, also where it wraps.
        middle = 0.5 * np.eye(d)
        sides = 2 * space.distance(space.from_cube(np.zeros((d, d))), space.from_cube(middle))
        radius = 2 * self.alpha * bound * float(np.sqrt(np.sum(sides**2)))
        diameter = float(np.sqrt(np.sum(np.where(metric.wrapping, sides / 2, sides) ** 2)))
        if radius >= diameter:
            raise InvalidValue(
                f"the {self} is {radius:.4g} here, no less than the diameter {diameter:.4g} of the space: it says"
                " nothing for so few points; take KNearest, or Complete() if every pair is meant"
            )
        return radius

    def edges(self, q: Floats, space: Space | None = None, *, terminals: int = 0) -> Ints32:
        """Return the pairs within the radius; see :class:`Rule`."""
        if space is None:
            raise InvalidValue("the theory radius depends on the space: give one")
        return Radius(self.radius(space)).edges(q, space)

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return that a terminal is joined to all within the radius; see :class:`Rule`."""
        return Reach(radius=self.radius(space))

    def _bound(self) -> tuple[str, float]:
        if self.dispersion is not None:
            return "dispersion", self.dispersion
        return "star_discrepancy", self.star_discrepancy  # type: ignore[return-value]


def default_rule(space: Space) -> KNearest:
    """Return ``k=10 symmetrised`` below six dimensions, ``k=20 symmetrised`` from there on; never fewer than 2 d.

    The nearest points of a lattice lie opposite each other in pairs, so fewer than 2 d of them leave directions out.

    From six dimensions on, k matters more than the sampler.  Success in random worlds of balls and of boxes with
    Owen-Sobol points at k = 4 / 6 / 10 / 20: 53 / 67 / 75 / 78 % (d=5, N=256), 46 / 59 / 69 / 75 % (d=6, N=512),
    49 / 62 / 72 / 78 % (d=7, N=512), 46 / 56 / 64 / 71 % (d=10, N=512).  The step from 10 to 20 gives 3 to 4 points
    in d=5 and 6 to 7 from d=6 on, where it costs a lazy search few checks.
    """
    d = space.cube_dim
    return KNearest(max(20 if d >= 6 else 10, 2 * d))


_NUMBER = r"([0-9.]+(?:e[+-]?[0-9]+)?)"

_FORMS: dict[str, tuple[str, Callable[..., Rule]]] = {
    "k=K symmetrised": (r"k=(\d+) symmetrised", lambda k: KNearest(int(k))),
    "k=K mutual": (r"k=(\d+) mutual", lambda k: KMutual(int(k))),
    "k=K earlier": (r"k=(\d+) earlier", lambda k: KEarlier(int(k))),
    "k*": (r"k\*", KStar),
    "radius=R": (rf"radius={_NUMBER}", lambda r: Radius(float(r))),
    "radius* gamma=G": (rf"radius\* gamma={_NUMBER}", lambda gamma: RadiusStar(float(gamma))),
    "complete": (r"complete", Complete),
    "theory radius alpha=A star_discrepancy|dispersion=D": (
        rf"theory radius alpha={_NUMBER} (star_discrepancy|dispersion)={_NUMBER}",
        lambda alpha, name, bound: TheoryRadius(**{"alpha": float(alpha), name: float(bound)}),
    ),
}


def rule_named(name: str) -> Rule:
    """Return the rule whose ``str()`` is `name`, for example ``k=10 earlier``.

    UnknownName, with the known forms, if there is no such rule; InvalidValue if it does not take such a number.
    """
    for pattern, make in _FORMS.values():
        match = re.fullmatch(pattern, name.strip())
        if match:
            return make(*match.groups())
    raise UnknownName.among("connection rule", name, _FORMS)
