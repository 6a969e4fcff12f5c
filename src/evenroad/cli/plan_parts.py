"""What planning for disks and for arms has in common: the rule, the points, the files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from evenroad import roadmap
from evenroad._checks import require_count
from evenroad._files import require_writable_folder
from evenroad._rng import generator
from evenroad.errors import InvalidValue, UnknownName
from evenroad.points import SAMPLERS, PointSet, make_sampler
from evenroad.roadmap import KNearest, Radius, Rule

if TYPE_CHECKING:
    from evenroad.cli.plan import Plan
    from evenroad.world import World

DEFAULT_FAMILY = "even"

_FEW = 16
"""Points of a plan that only loads compiled code."""


def refuse_options(plan: Plan, names: Iterable[str], belongs_to: str) -> None:
    """Raise InvalidValue for an option that was given and would be ignored."""
    for name in names:
        if getattr(plan, name) not in (None, False, 0.0):
            raise InvalidValue(f"--{name.replace('_', '-')} goes with {belongs_to} only")


def chosen_rule(plan: Plan, default_k: int) -> Rule:
    """Return the connection rule that was asked for."""
    if plan.connect_radius is None:
        return KNearest(default_k if plan.k is None else plan.k)
    if plan.k is not None:
        raise InvalidValue("give -k or --connect-radius, not both")
    return Radius(plan.connect_radius)


def draw_points(plan: Plan, d: int) -> PointSet:
    """Draw the set of n points in d dimensions that was asked for."""
    require_count("n", plan.n)
    generator(plan.seed)
    name = DEFAULT_FAMILY if plan.sampler == "auto" else plan.sampler
    if name not in SAMPLERS:
        raise UnknownName.among("sampler", name, [*SAMPLERS, "auto"])
    return make_sampler(name, **_sampler_options(plan, name)).draw(plan.n, d, rng=plan.seed)


def load_compiled_code(
    world: World,
    start: npt.ArrayLike,
    goal: npt.ArrayLike,
    points: PointSet,
    rule: Rule,
    search: str = "full",
) -> None:
    """Plan once with a few of the points: else the times of the plan would be those of loading compiled code."""
    roadmap.plan(world, start, goal, PointSet(points.points[:_FEW]), rule=rule, search=search)


def output_files(plan: Plan, inputs: Iterable[Path], suffixes: Sequence[str], what: str) -> dict[str, Path]:
    """Return where results go, suffix -> file, refusing what cannot be written or would overwrite an input."""
    if plan.out is not None and not plan.out.name:
        raise InvalidValue(f"--out must end with a file name, got {str(plan.out)!r}")
    taken = {source.resolve() for source in inputs}
    stem = plan.out if plan.out is not None else Path(plan.world.stem)
    if plan.out is None and any(path.resolve() in taken for path in _named(stem, suffixes).values()):
        stem = Path(f"{plan.world.stem}-plan")
    files = _named(stem, suffixes)
    for path in files.values():
        if path.resolve() in taken:
            raise InvalidValue(f"--out {stem} would overwrite the {what} {path}")
        require_writable_folder(path)
    return files


def common_query(plan: Plan) -> dict[str, Any]:
    """Return the options that every plan has, for the record."""
    names = ("n", "sampler", "plain", "skip", "allow_fewer", "seed", "raw")
    return {name: getattr(plan, name) for name in names}


def _named(stem: Path, suffixes: Sequence[str]) -> dict[str, Path]:
    return {suffix: stem.with_name(f"{stem.name}.{suffix}") for suffix in suffixes}


def _sampler_options(plan: Plan, name: str) -> dict[str, Any]:
    """Return the sampler's options, refusing those that this sampler would silently ignore."""
    takes = {"halton": {"plain", "skip"}, "sobol": {"plain", "skip"}, "sukharev": {"allow_fewer"}}.get(
        name, set()
    )
    for option in ("plain", "skip", "allow_fewer"):
        if getattr(plan, option) and option not in takes:
            raise InvalidValue(f"--{option.replace('_', '-')} does not go with the sampler {name!r}")
    if "plain" in takes:
        return {"scramble": not plan.plain, "start": plan.skip}
    return {"allow_fewer": plan.allow_fewer} if "allow_fewer" in takes else {}
