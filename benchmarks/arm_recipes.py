"""Recipes of roadmaps on the suite's problems, paired with the control.

    python -m benchmarks.arm_recipes --robot ur5-5 -n 256 --problems 60 --draws 2 --recipes 0:0 4:0 0:3000 4:3000
    python -m benchmarks.arm_recipes -n 64 --recipes 4:3000 --afar 0
    python -m benchmarks.arm_recipes --recipes 4:3000 swaps --against 4:3000

A recipe is GAMMA:ENDS, as `evenroad.make_roadmap` takes them, or `swaps`: milestones of
the last recipe before it, of which those that serve least are swapped for others as long as more of its random ends
see one; what such ends, drawn anew, see is said; or `beginning`: the first n of four times as many. The control are
the first scrambled Sobol points that are free of robot and cell, in the same metric. Constants are chosen on the
stream `tune`. The differences have standard errors over problems. `room` is the share of the space that milestones
are left where their density is in proportion to the chance of being free to the power of gamma times the number of
joints: (sum of p)^2 / (n sum of p^2).
"""

from __future__ import annotations

import argparse
import itertools

import numpy as np

from evenroad.robot import with_group
from evenroad.robot_roadmap import pockets
from evenroad.robot_roadmap.make import joined, make_roadmap
from evenroad.robot_roadmap.pockets import Seen, links_of
from evenroad.robot_roadmap.recipe import Recipe, chosen, known_of
from evenroad_studies.arms.problems import ARM_ROBOTS, draw_problem, joins
from evenroad_studies.arms.roadmaps import cell_of, first_free
from evenroad_studies.arms.robots import ARMS, arm_named
from evenroad_studies.arms.scenes import GENERATORS

SWAPPED, FIRST_OF_MORE = "swaps", "beginning"

ARMS["arm7-5"] = lambda: with_group(arm_named("arm7"), arm_named("arm7").group[:5])
ARMS["arm7-6"] = lambda: with_group(arm_named("arm7"), arm_named("arm7").group[:6])


def main() -> None:
    """Print success by generator and the difference from the control, for each recipe."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--robot", default="ur5-5", choices=[*ARM_ROBOTS, "arm7-5", "arm7-6"])
    parser.add_argument("-n", type=int, default=256)
    parser.add_argument("-k", type=int, default=10)
    parser.add_argument(
        "--links", type=int, help="of start and goal; default: as evenroad.robot_roadmap links them"
    )
    parser.add_argument("--problems", type=int, default=60, help="of each generator")
    parser.add_argument("--draws", type=int, default=2)
    parser.add_argument("--stream", default="tune", choices=["tune", "report"])
    parser.add_argument("--recipes", nargs="+", default=["0:0", "4:0", "0:3000", "4:3000"])
    parser.add_argument(
        "--afar", type=int, default=pockets.FIRST, help="configurations that ends are tried with, however far"
    )
    parser.add_argument("--against", default="control", help="the recipe that the others are compared with")
    options = parser.parse_args()
    pockets.FIRST = options.afar
    arm = arm_named(options.robot)
    cell, links, n = cell_of(arm), options.links or links_of(options.n), options.n
    found = [
        draw_problem(options.robot, name, options.stream, i)
        for name in GENERATORS
        for i in range(options.problems)
    ]
    kind = np.repeat(np.arange(len(GENERATORS)), options.problems)
    solved: dict[str, list[list[bool]]] = {}
    room: dict[str, list[float]] = {}
    for draw in range(options.draws):
        rng = 1000 + draw
        recipes = {name: _recipe(name) for name in options.recipes if ":" in name}
        bare = make_roadmap(arm, cell, n, k=options.k, gamma=0.0, ends=0, rng=rng)
        most = Recipe(*(max(values) for values in zip(*recipes.values(), strict=True)))
        known = known_of(bare.world, bare.one_turn, n, most, _streams(rng), _nothing)
        recipe, rows = Recipe(), np.arange(n)
        for name in options.recipes:
            if name == SWAPPED:
                rows, said = swapped(known.seen, len(known.pool), rows)
                anew = known_of(
                    bare.world,
                    bare.one_turn,
                    n,
                    recipe,
                    [*_streams(rng)[:2], _streams(rng + 500)[2]],
                    _nothing,
                )
                fresh = [unseen(anew.seen, each) for each in (chosen(known, recipe, n), rows)]
                made = joined(bare, known.pool[rows], options.k)
                print(f"draw {draw}: {said}; drawn anew {fresh[0]:.1f}, then {fresh[1]:.1f} %", flush=True)
            elif name == FIRST_OF_MORE:
                more = known_of(bare.world, bare.one_turn, 4 * n, recipe, _streams(rng), _nothing)
                made = joined(bare, more.pool[chosen(more, recipe, 4 * n)[:n]], options.k)
            else:
                recipe = recipes[name]
                rows = chosen(known, recipe, n)
                made = joined(bare, known.pool[rows], options.k)
                density = known.chance ** (recipe.gamma * bare.world.space.dim)
                room.setdefault(name, []).append(density.sum() ** 2 / (len(density) * (density**2).sum()))
            solved.setdefault(name, []).append([joins(made, problem, links) for problem in found])
        free = first_free(bare.world, n, np.random.default_rng(2000 + draw))
        control = joined(bare, free, options.k)
        solved.setdefault("control", []).append([joins(control, problem, links) for problem in found])
    shares = {recipe: np.mean(values, axis=0) for recipe, values in solved.items()}
    print(
        f"{options.robot}, N = {n}, {len(found)} problems ({options.stream}), {options.draws} draws,"
        f" links {links}: {' '.join(GENERATORS)} | all | - {options.against} | room"
    )
    for recipe, share in shares.items():
        apart = 100.0 * (share - shares[options.against])
        cells = " ".join(f"{100.0 * share[kind == g].mean():4.0f}" for g in range(len(GENERATORS)))
        error = apart.std(ddof=1) / np.sqrt(len(apart))
        of_room = f"{np.mean(room[recipe]):.2f}" if recipe in room else "-"
        print(
            f"{recipe:10} {cells} | {100.0 * share.mean():5.1f} | {apart.mean():+5.1f} ± {error:.1f} | {of_room}",
            flush=True,
        )


def swapped(seen: Seen, pool: int, rows: np.ndarray) -> tuple[np.ndarray, str]:
    """Return milestones, rows of a pool, swapped for as long as more ends see one, and what came of it."""
    ends, swaps, rows = len(seen.own), 0, rows.copy()
    sees = np.zeros((ends, pool), dtype=np.bool_)
    sees[np.repeat(np.arange(ends), np.diff(seen.first)), seen.which] = True
    before = unseen(seen, rows)
    while True:
        times = sees[:, rows].sum(axis=1)
        gain = sees[times == 0].sum(axis=0)
        loss = sees[times == 1][:, rows].sum(axis=0)
        new, old = int(np.argmax(gain)), int(np.argmin(loss))
        if gain[new] <= loss[old]:
            return rows, f"{swaps} swaps, ends that see none {before:.1f}, then {unseen(seen, rows):.1f} %"
        rows[old], swaps = new, swaps + 1


def unseen(seen: Seen, rows: np.ndarray) -> float:
    """Return the percentage of ends that see none of some rows."""
    hit = np.isin(seen.which, rows)
    return 100.0 * np.mean([not hit[a:b].any() for a, b in itertools.pairwise(seen.first)])


def _streams(rng: int) -> list[np.random.Generator]:
    return np.random.default_rng(rng).spawn(3)


def _nothing(what: str, share: float) -> None:
    """Show no progress."""


def _recipe(name: str) -> Recipe:
    gamma, ends = name.split(":")
    return Recipe(float(gamma), int(ends))


if __name__ == "__main__":
    main()
