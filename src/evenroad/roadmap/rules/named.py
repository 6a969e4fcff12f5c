"""From a rule's name back to the rule."""

from __future__ import annotations

import re
from collections.abc import Callable

from evenroad.errors import UnknownName
from evenroad.roadmap.rules.complete import Complete
from evenroad.roadmap.rules.k_nearest import KEarlier, KMutual, KNearest
from evenroad.roadmap.rules.radius import Radius
from evenroad.roadmap.rules.rule import Rule
from evenroad.roadmap.rules.star import KStar, RadiusStar
from evenroad.roadmap.rules.theory import TheoryRadius

_NUMBER = r"([0-9.]+(?:e[+-]?[0-9]+)?)"

_FORMS: dict[str, tuple[str, Callable[..., Rule]]] = {
    "k=K symmetrised": (r"k=(\d+) symmetrised", lambda k: KNearest(int(k))),
    "k=K mutual": (r"k=(\d+) mutual", lambda k: KMutual(int(k))),
    "k=K earlier": (r"k=(\d+) earlier", lambda k: KEarlier(int(k))),
    "k*": (r"k\*", KStar),
    "radius=R": (rf"radius={_NUMBER}", lambda r: Radius(float(r))),
    "radius* gamma=G": (rf"radius\* gamma={_NUMBER}", lambda gamma: RadiusStar(float(gamma))),
    "complete": (r"complete", Complete),
    "theory radius alpha=A star_discrepancy=D": (
        rf"theory radius alpha={_NUMBER} star_discrepancy={_NUMBER}",
        lambda alpha, bound: TheoryRadius(alpha=float(alpha), star_discrepancy=float(bound)),
    ),
    "theory radius alpha=A dispersion=D": (
        rf"theory radius alpha={_NUMBER} dispersion={_NUMBER}",
        lambda alpha, bound: TheoryRadius(alpha=float(alpha), dispersion=float(bound)),
    ),
}


def rule_named(name: str) -> Rule:
    """Return the rule whose ``str()`` is `name`, for example ``k=10 earlier``.

    Raises
    ------
    UnknownName
        If there is no such rule; the text lists the forms.
    InvalidValue
        If the rule does not take such a number.
    """
    for pattern, make in _FORMS.values():
        match = re.fullmatch(pattern, name.strip())
        if match:
            return make(*match.groups())
    raise UnknownName.among("connection rule", name, _FORMS)
