"""Certified claims against brute force: is one of them false, and how much do they leave?

    python -m studies.benchmarks.certificates --csv docs/data/certificates.csv
    python -m studies.benchmarks.certificates --holes      # the largest holes and the least k by dimension alone

Random discs in planes of the cube, d = 2, 3, 4, in which the shortest path of any clearance is known (tests/
clear_paths.py).  A roadmap is asked once; its certificate then makes claims, each of them a row:

    cost    a path of clearance delta and known length exists, so the roadmap's is at most so long (seven deltas)
    leads   a path of clearance beta exists, so the roadmap has one
    none    the roadmap failed, so no path of clearance beta exists

"walls" are rows of discs across the cube with gaps about as wide as the certificate can tell; "fields" are discs
anywhere.  `tightness` is the cost's share of what was claimed.  `verdict` is "undecided" where a grid of 800 x 800
cells cannot tell whether a path of clearance beta exists.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from studies.benchmarks.rows import write_rows
from tests.clear_paths import DiscWorld, Plane

from evenroad._arrays import Floats
from evenroad.planning import PRM, plan
from evenroad.points import PointSet, draw
from evenroad.roadmap import Budget, KNearest, Radius, Rule
from evenroad.roadmap.certify import certify
from evenroad.space import BoxSpace

SETS = {2: 256, 3: 512, 4: 512}
"""Dimension -> number of points."""

FAMILIES = {2: ("cover", "even", "sobol", "hickernell"), 3: ("cover", "even"), 4: ("cover", "even")}
RULES: tuple[tuple[str, float], ...] = (("radius", 3.0), ("radius", 4.0), ("neighbours", 3.0))
"""Radius in dispersions; and as many neighbours as certify that many."""

SHARES = (1.02, 1.08, 1.15, 1.4, 1.6, 1.8, 2.4)
"""Clearances in dispersions."""

POOL = 4
"""Sets of each family: worlds are new every time."""

FIELDS = ["d", "world", "kind", "sampler", "n", "rule", "beta", "at_least", "between", "ends", "claim"]
FIELDS += ["delta", "optimum", "exact", "cost", "bound", "tightness", "verdict"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--worlds", type=int, default=26, help="of each kind and dimension; half in d = 4")
    parser.add_argument("--csv", type=Path)
    parser.add_argument("--holes", action="store_true", help="no claims: the largest holes and the least k")
    options = parser.parse_args()
    rows: list[dict[str, Any]] = []
    began = time.process_time()
    if options.holes:
        print_holes()
        return
    for d in SETS:
        rules = {sampler: rules_for(d, sampler) for sampler in FAMILIES[d]}
        for world in range(options.worlds if d < 4 else options.worlds // 2):
            for kind in ("field", "wall"):
                rows += claims(d, world, kind, rules)
        summarise(d, [row for row in rows if row["d"] == d])
        write_rows(options.csv, FIELDS, [{name: _short(row[name]) for name in FIELDS} for row in rows])
    false = sum(row["verdict"] == "false" for row in rows)
    print(f"{len(rows)} claims, {false} false; {time.process_time() - began:.0f} s of processor time")


def print_holes() -> None:
    """Print the certified dispersion by sampler, N and dimension, and the least k that is complete."""
    print("largest hole of the unit cube, certified; in brackets the least k, symmetrised, that is complete with it")
    for sampler in ("cover", "even", "uniform"):
        for n in (256, 1024):
            texts = []
            for d in (2, 3, 4, 5, 6, 7):
                points, space = draw(sampler, n, d), BoxSpace([0.0] * d, [1.0] * d)
                beta = certify(points, Radius(1.0), space).dispersion
                k = "" if beta > 0.5 else f" ({_least_k(points, space)})"
                texts.append(f"d={d} {beta:.3f}{k}")
            print(f"{sampler:8} N={n:4}: " + "  ".join(texts), flush=True)


def _least_k(points: PointSet, space: BoxSpace) -> int:
    """Return the smallest k, to within a tenth, whose certificate is complete."""
    k = 3
    while not certify(points, KNearest(k), space).complete:
        k += max(1, k // 10)
    return k


def rules_for(d: int, sampler: str) -> list[Rule]:
    """Return the rules of :data:`RULES` for this sampler's sets."""
    points, space = draw(sampler, SETS[d], d), BoxSpace([0.0] * d, [1.0] * d)
    beta, rules = certify(points, Radius(1.0), space).dispersion, []
    for kind, share in RULES:
        if kind == "radius":
            rules.append(Radius(share * beta))
        else:
            k = 4
            while certify(points, KNearest(k), space).between < share * beta:
                k += max(1, k // 8)
            rules.append(KNearest(k))
    return rules


def claims(d: int, number: int, kind: str, rules: dict[str, list[Rule]]) -> Iterator[dict[str, Any]]:
    """Yield the claims of every sampler and rule in one random world."""
    rng = np.random.default_rng([d, number, kind == "wall"])
    for sampler in FAMILIES[d]:
        points = _set(sampler, d, number % POOL)
        beta = certify(points, Radius(1.0), BoxSpace([0.0] * d, [1.0] * d)).dispersion
        world, start, goal = make_world(d, kind, beta, np.random.default_rng(rng.integers(2**32)))
        inside = all((np.minimum(p.centres, 1 - p.centres).min(1) > p.radii).all() for p in world.planes)
        exists = world.leads(start, goal, beta)
        optima = [(s * beta, world.optimum(start, goal, s * beta)) for s in SHARES]
        for rule in rules[sampler]:
            options: dict[str, Any] = dict(rule=rule, smooth=False, certify=True, budget=Budget(seconds=None))
            result = plan(world, start, goal, PRM(points, search="lazy"), **options)
            certificate = result.certificate
            assert certificate is not None
            assert certificate.dispersion == beta
            row = dict(d=d, world=number, kind=kind, sampler=sampler, n=points.n, rule=str(rule), beta=beta)
            row |= dict(at_least=certificate.at_least, between=certificate.between, ends=certificate.to_terminals)
            row |= dict(optimum=None, exact=None, cost=result.milestone_cost, bound=None, tightness=None)
            if certificate.complete and exists:
                yield row | dict(claim="leads", delta=beta, verdict=_verdict(result.solved))
            if certificate.complete and not result.solved:
                verdict = "undecided" if exists is None else _verdict(not exists)
                yield row | dict(claim="none", delta=beta, verdict=verdict)
            for delta, optimum in optima:
                bound = certificate.longest(optimum, delta) if math.isfinite(optimum) else math.inf
                if math.isfinite(bound):
                    cost = result.milestone_cost if result.solved else math.inf
                    assert cost is not None
                    exact = inside and _holds(world, delta)
                    facts = dict(delta=delta, optimum=optimum, exact=exact, bound=bound, tightness=cost / bound)
                    yield row | facts | dict(claim="cost", verdict=_verdict(cost <= bound))


@lru_cache(maxsize=64)
def _set(sampler: str, d: int, seed: int) -> PointSet:
    return draw(sampler, SETS[d], d, rng=seed)


def make_world(d: int, kind: str, beta: float, rng: np.random.Generator) -> tuple[DiscWorld, Floats, Floats]:
    """Return a world of one plane, in d = 4 of two half of the time, with a start and a goal clear by beta."""
    while True:
        axes = rng.permutation(d)
        planes = [(int(axes[0]), int(axes[1]))]
        if d == 4 and rng.random() < 0.5:
            planes.append((int(axes[2]), int(axes[3])))
        world = DiscWorld(d, tuple(_discs(each, kind, beta, rng) for each in planes))
        for _ in range(20):
            start, goal = rng.random((2, d))
            a = world.planes[0].axes[0]
            if kind == "wall" and (start[a] - 0.5) * (goal[a] - 0.5) > 0:
                continue
            ends = np.stack([start, goal])
            clear = min(plane.clearance(ends, ends).min() for plane in world.planes)
            if clear >= beta and not world.motion_valid(start[None], goal[None])[0]:
                return world, start, goal


def _discs(axes: tuple[int, int], kind: str, beta: float, rng: np.random.Generator) -> Plane:
    if kind == "field":
        m = int(rng.integers(1, 7))
        return Plane(axes, rng.random((m, 2)), rng.uniform(0.03, 0.2, m))
    # From below the lower side to beyond the upper one, with gaps between.
    centres, radii, top, widest = [], [], -0.2, 10.0 ** rng.uniform(-3.0, 0.1)
    while top < 1.0:
        radius = rng.uniform(0.03, 0.15)
        gap = rng.uniform(0.0, widest) * 2.0 * beta
        centres.append((0.5 + rng.uniform(-0.02, 0.02), top + gap + radius))
        radii.append(radius)
        top += gap + 2.0 * radius
    return Plane(axes, np.array(centres), np.array(radii))


def _holds(world: DiscWorld, delta: float) -> bool:
    """Whether every disc, larger by delta, lies inside the square: then the optimum is exact."""
    return all((np.minimum(p.centres, 1 - p.centres).min(1) > p.radii + delta).all() for p in world.planes)


def _verdict(true: bool) -> str:
    return "true" if true else "false"


def _short(value: Any) -> Any:
    return f"{value:.6g}" if isinstance(value, float) else value


def summarise(d: int, rows: list[dict[str, Any]]) -> None:
    """Print how many claims were made and how much they left."""
    for claim in ("cost", "leads", "none"):
        mine = [row for row in rows if row["claim"] == claim]
        verdicts = {each: sum(row["verdict"] == each for row in mine) for each in ("true", "false", "undecided")}
        text = ", ".join(f"{count} {each}" for each, count in verdicts.items() if count)
        print(f"d={d} {claim:5}: {len(mine):5} claims, {text}")
        if claim == "cost":
            for share in SHARES:
                tight = [r["tightness"] for r in mine if abs(r["delta"] / r["beta"] - share) < 1e-9]
                paid = [r["cost"] / r["optimum"] for r in mine if abs(r["delta"] / r["beta"] - share) < 1e-9]
                said = [r["bound"] / r["optimum"] for r in mine if abs(r["delta"] / r["beta"] - share) < 1e-9]
                if tight:
                    print(
                        f"    delta = {share:4} beta: {len(tight):5} claims; at most {np.median(said):5.2f} times the"
                        f" optimum is claimed (median), {np.median(paid):.3f} paid (median), {max(paid):.3f} (worst);"
                        f" cost / bound {np.median(tight):.2f} (median), {max(tight):.2f} (worst)"
                    )


if __name__ == "__main__":
    main()
