"""One colour, marker and line a sampler, in every picture."""

from __future__ import annotations

from dataclasses import dataclass

from evenroad.research.bench.samplers import SAMPLERS


@dataclass(frozen=True)
class Look:
    """How a sampler's line is drawn."""

    colour: str
    marker: str
    line: str = "-"
    width: float = 1.4
    size: float = 5.0


# Families share a colour, their two protocols are told apart by the line; what we recommend is red and thick.
LOOKS: dict[str, Look] = {
    "uniform": Look("#555555", "o", width=2.0),
    "halton paper-blocks": Look("#1b9e5a", "s", "--"),
    "halton scrambled": Look("#1b9e5a", "s"),
    "sobol paper-blocks": Look("#2f5fd0", "^", "--"),
    "sobol scrambled": Look("#2f5fd0", "^"),
    "lattice": Look("#e6a23c", "v"),
    "sukharev": Look("#12a5b5", "X", ":"),
    "mpmc": Look("#e05fa8", "D"),
    "hickernell": Look("#8e5bd0", "p"),
    "even": Look("#d1343b", "*", width=2.4, size=9.0),
    "korobov": Look("#7a4a21", "P", size=6.0),
}
OTHER = Look("#000000", ".", ":")
"""For a sampler that this version does not know."""


def look_of(sampler: str) -> Look:
    """Return how a sampler is drawn."""
    return LOOKS.get(sampler, OTHER)


def sampler_place(sampler: str) -> tuple[int, str]:
    """Return what to sort samplers by: the order of :data:`SAMPLERS`, then the name."""
    known = list(SAMPLERS)
    return (known.index(sampler) if sampler in known else len(known)), sampler
