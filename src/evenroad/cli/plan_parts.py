"""What planning for disks and for arms has in common: the rule, the points, the files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from evenroad import roadmap
from evenroad._checks import require_count, require_positive
from evenroad._files import require_writable_folder
from evenroad._rng import generator
from evenroad.cli.plan_options import PlanOptions
from evenroad.errors import InvalidValue, UnknownName
from evenroad.points import SAMPLERS, PointSet, make_sampler
from evenroad.roadmap import Budget, KNearest, Radius, Rule
from evenroad.roadmap.find_path import SECONDS
from evenroad.world import ConnectsItself, Rechecks

if TYPE_CHECKING:
    from evenroad.world import World

DEFAULT_FAMILY = "even"

DEFAULT_N = 512

_FEW = 16
"""Points of a plan that only loads compiled code."""


def chosen_rule(plan: PlanOptions, default_k: int) -> Rule:
    """Return the connection rule that was asked for."""
    if plan.connect_radius is None:
        return KNearest(default_k if plan.k is None else plan.k)
    if plan.k is not None:
        raise InvalidValue("give -k or --connect-radius, not both")
    return Radius(plan.connect_radius)


def wants_points(plan: PlanOptions) -> bool:
    """Return whether an option was given that speaks of points or of how they are joined."""
    given = (plan.n, plan.k, plan.connect_radius)
    return any(value is not None for value in given) or bool(
        plan.sampler != "auto" or plan.plain or plan.skip or plan.allow_fewer
    )


def chosen_budget(plan: PlanOptions) -> Budget:
    """Return how long to plan, and refuse what does not go with the points or the goals that were asked for."""
    if plan.improve and wants_points(plan):
        raise InvalidValue("--improve goes without points: a roadmap of exactly so many has one best path")
    if not plan.goal:
        raise InvalidValue("give --goal, where the path is to end")
    if plan.time is not None:
        return Budget(seconds=require_positive("time", _number(plan.time)))
    return Budget() if wants_points(plan) else Budget(seconds=SECONDS)


def _number(text: str) -> float | str:
    """Return a text as a number, or as it is where it is none, for an error that shows it."""
    try:
        return float(text)
    except ValueError:
        return text


def draw_points(plan: PlanOptions, d: int) -> PointSet:
    """Draw the set of n points in d dimensions that was asked for."""
    n = require_count("n", DEFAULT_N if plan.n is None else plan.n)
    generator(plan.seed)
    name = DEFAULT_FAMILY if plan.sampler == "auto" else plan.sampler
    if name not in SAMPLERS:
        raise UnknownName.among("sampler", name, [*SAMPLERS, "auto"])
    return make_sampler(name, **_sampler_options(plan, name)).draw(n, d, rng=plan.seed)


def load_compiled_code(
    world: World,
    start: npt.ArrayLike,
    goals: npt.ArrayLike,
    points: PointSet | None,
    rule: Rule,
    search: str = "full",
) -> None:
    """Plan once for nothing, with a few of the points: else the times would be those of loading compiled code."""
    if points is None:
        roadmap.find_path(world, start, start, budget=Budget(samples=1))
        return
    few = PointSet(points.points[:_FEW])
    roadmap.plan(world, start, goals, few, rule=rule, search=search)
    stay = np.array([start, start], dtype=np.float64)
    if isinstance(world, Rechecks):
        world.recheck(stay)
        if isinstance(world, ConnectsItself):
            world.shorten(stay)


def output_files(
    plan: PlanOptions, inputs: Iterable[Path], suffixes: Sequence[str], what: str
) -> dict[str, Path]:
    """Return where results go, suffix -> file, refusing what cannot be written or would overwrite an input."""
    if plan.out is not None and not plan.out.name:
        raise InvalidValue(f"--out must end with a file name, got {str(plan.out)!r}")
    suffixes = [*suffixes, *(() if plan.no_picture else ("png",))]
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


def common_query(plan: PlanOptions) -> dict[str, Any]:
    """Return the options that every plan has, for the record."""
    names = ("n", "time", "improve", "certified", "sampler", "plain", "skip", "allow_fewer", "seed", "raw")
    return {name: getattr(plan, name) for name in names} | {"time": chosen_budget(plan).seconds}


def _named(stem: Path, suffixes: Sequence[str]) -> dict[str, Path]:
    return {suffix: stem.with_name(f"{stem.name}.{suffix}") for suffix in suffixes}


def _sampler_options(plan: PlanOptions, name: str) -> dict[str, Any]:
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
