"""Certificate: guarantees of a roadmap for every world of its space, from a bound of its milestones' dispersion alone.

Let beta bound the distance of every point of the space from its nearest milestone.  The roadmap tries all motions
between milestones up to the length R, and between start or goal and milestones up to E.  A path has clearance delta if
all points nearer to it than delta are free.

1.  If R >= 2 beta and delta >= beta, there is a path along the roadmap.  The milestones nearest to the points of the
    path, in turn, are a chain.  Where it steps from x to y, some point p of the path is within beta of both.  The
    motion from x to y is thus at most 2 beta long, and stays in the ball around p, which is free.  So, if the roadmap
    fails, no path has clearance beta.
2.  Let delta > beta, and l <= 2 sqrt(delta^2 - beta^2), l <= R - 2 beta, l <= E - beta.  Then a path of length L gives
    one along the roadmap of at most L + 2 beta (ceil(L / l) - 1), so of at most (1 + 2 beta / l) L.  Cut the path into
    ceil(L / l) equal pieces, and take a milestone within beta of each of the inner endpoints p_i.  Consecutive ones are
    at most l + 2 beta apart, so they are tried.  A motion between two stays within beta of the chord from p_i to p_i+1.
    A point q there, beside the chord's near half, is at most sqrt(beta^2 + (l / 2)^2) <= delta from p_i: it is free.
    Each of the inner endpoints adds at most 2 beta.  (Tsao, Solovey and Pavone 2020 prove it like this, for any l.)
    If a start or goal is tried only with its nearest milestone, it adds beta more, and so does that milestone.

The same holds on a torus while no motion is longer than half a turn.  The space is a box: its faces are no obstacles,
and a chord between two of its points stays inside.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from evenroad._checks import require_positive

SAFE = 1.0 - 1e-12
"""Factor < 1 that covers the rounding of a distance."""


@dataclass(frozen=True)
class Certificate:
    """Guarantees of shortest paths along a roadmap; all numbers are in the metric of the space.

    Attributes
    ----------
    dispersion : float
        beta: a bound of the distance of every point of the space from its nearest milestone.
    at_least : float
        A distance that some point certainly has from all milestones. It shows how sharp beta is.
    between : float
        Length up to which all free motions between milestones are tried; inf: all.
    to_terminals : float
        The same for motions between start or goal and a milestone; the nearest one is always tried.
    direct : bool
        Whether the motion from start to goal is tried, too.
    """

    dispersion: float
    at_least: float
    between: float
    to_terminals: float
    direct: bool

    @property
    def complete(self) -> bool:
        """Whether a path of clearance `dispersion` implies one along the roadmap; if that fails, there is none."""
        return SAFE * self.between >= 2.0 * self.dispersion

    def longest(self, length: float, clearance: float) -> float:
        """Return a bound on the length of the roadmap's path, if a path of this length and clearance exists.

        The bound is inf if nothing is guaranteed.  Both arguments are finite and > 0, else InvalidValue.
        """
        length, clearance = require_positive("length", length), require_positive("clearance", clearance)
        step, hops = self._step(clearance), 2.0 * self.dispersion
        if step <= 0.0:
            return math.inf
        bound = length + hops * (_pieces(length, step) + 1)
        if (step := min(step, SAFE * self.to_terminals - self.dispersion)) > 0.0:
            bound = min(bound, length + hops * max(_pieces(length, step) - 1, 0 if self.direct else 1))
        return bound

    def factor(self, clearance: float) -> float:
        """Return the largest ratio of the roadmap's path to a long path of this clearance; inf if nothing is
        guaranteed.
        """
        step = self._step(require_positive("clearance", clearance))
        return 1.0 + 2.0 * self.dispersion / step if step > 0.0 else math.inf

    def clearance_for(self, factor: float) -> float:
        """Return the least clearance whose :meth:`factor` is at most `factor`, > 1; inf if there is none."""
        factor = require_positive("factor", factor)
        step = 2.0 * self.dispersion / (factor - 1.0) if factor > 1.0 else math.inf
        if not step <= SAFE * self.between - 2.0 * self.dispersion:
            return math.inf
        return math.hypot(self.dispersion, 0.5 * step) / SAFE

    def _step(self, clearance: float) -> float:
        """Return the largest l of the proof, without its condition on E; <= 0 if there is none."""
        remaining = (SAFE * clearance) ** 2 - self.dispersion**2
        if remaining <= 0.0:
            return 0.0
        return min(2.0 * math.sqrt(remaining), SAFE * self.between - 2.0 * self.dispersion)


def _pieces(length: float, step: float) -> int:
    return math.ceil(length / step)
