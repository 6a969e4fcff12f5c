"""Options of a point set and of its connection rule, for all verbs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from evenroad.errors import InvalidValue, shown

if TYPE_CHECKING:
    from evenroad.points import PointSet
    from evenroad.roadmap import Rule

DEFAULT = "even"
TAKES = {"plain": ("halton", "sobol"), "skip": ("halton", "sobol"), "allow_fewer": ("sukharev",)}
"""Option -> the samplers that take it."""


@dataclass(frozen=True, kw_only=True)
class SamplerOptions:
    """The options of a point set."""

    sampler: str | None = None
    """How points are drawn: even, growing, hickernell, mpmc, korobov, lattice, cover, halton, sobol, star, sukharev or
    uniform (default: even)."""
    plain: bool = False
    """With halton and sobol: the plain sequence instead of the scrambled one."""
    skip: int = 0
    """With halton and sobol: index of the first point of the sequence."""
    allow_fewer: bool = False
    """With sukharev: take the largest grid with at most n points."""
    seed: int = 0
    """Seed of everything random; the same command gives the same points."""


def chosen_sampler(options: SamplerOptions, n: int) -> str:
    """Return the name of the sampler; InvalidValue for a bad n, or an option that the sampler does not take."""
    # Imported late: help does not need NumPy.
    from evenroad._checks import require_count, require_known
    from evenroad.points import SAMPLERS

    # Earlier plans name the default "auto".
    name = DEFAULT if options.sampler in (None, "auto") else str(options.sampler)
    require_known("sampler", name, SAMPLERS)
    require_count("n", n)
    require_seed(options.seed)
    if options.skip < 0:
        raise InvalidValue(f"--skip must be an integer >= 0, got {shown(options.skip)}")
    for option, takers in TAKES.items():
        if getattr(options, option) and name not in takers:
            said = f"--{option.replace('_', '-')} does not go with the sampler {name!r}"
            raise InvalidValue(f"{said}, only with {' and '.join(takers)}")
    return name


def draw_points(options: SamplerOptions, n: int, d: int) -> PointSet:
    """Draw the set of n points in d dimensions of the options."""
    from evenroad.points import make_sampler

    name = chosen_sampler(options, n)
    how: dict[str, object] = {}
    if name in TAKES["plain"]:
        how = {"scramble": not options.plain, "start": options.skip}
    elif name in TAKES["allow_fewer"]:
        how = {"allow_fewer": options.allow_fewer}
    return make_sampler(name, **how).draw(n, d, rng=options.seed)


def chosen_rule(k: int | None, connect_radius: float | None) -> Rule | None:
    """Return the connection rule of the options of these names, or None."""
    from evenroad.roadmap import KNearest, Radius

    if connect_radius is None:
        return None if k is None else KNearest(k)
    if k is not None:
        raise InvalidValue("give -k or --connect-radius, not both")
    return Radius(connect_radius)


def require_seed(seed: int) -> None:
    """Raise InvalidValue for a negative seed."""
    if seed < 0:
        raise InvalidValue(f"--seed must be an integer >= 0, got {shown(seed)}")
