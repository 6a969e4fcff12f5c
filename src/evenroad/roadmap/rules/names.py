"""The rule that is taken when none is given, and from a rule's name back to the rule."""

from __future__ import annotations

import re
from collections.abc import Callable

from evenroad.errors import UnknownName
from evenroad.roadmap.rules.growing import KStar, RadiusStar, TheoryRadius
from evenroad.roadmap.rules.near import Complete, KEarlier, KMutual, KNearest, Radius, Rule
from evenroad.space import Space


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
