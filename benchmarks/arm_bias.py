"""Why a bias by the chance of being free gains or loses: how much room it leaves, whatever the number of joints.

    python -m benchmarks.arm_bias --problems 30 --draws 2 --out arm_bias.csv
    python -m benchmarks.arm_bias --table arm_bias.csv --picture docs/arm_bias.png

Six arms: a UR5 of five joints and the same with a roll of its upper arm put in, which makes it redundant; our arm of
seven, with its redundant joint held, with its last two held, and with its rolls half as wide.  256 milestones are
chosen of 8192 free configurations, without ends in pockets; the gain is the success on the suite's problems minus that
of spacing alone.  Three ways to prefer free space:

* ``power``: spacing in proportion to chance^-gamma, the chance measured in random scenes;
* ``dense``: the same, of scenes with the boxes of four at once, in which the chance varies more;
* ``cut``: spacing alone among the share of configurations whose chance is greatest: neither gamma nor joints.

`room` is the share of the space that milestones are left: (sum of p)^2 / (n sum of p^2) of the density p =
chance^(gamma joints), or the share itself.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad.robot import ArmWorld, Robot, with_group, with_limits
from evenroad.robot.joint import Joint
from evenroad.robot_roadmap.chance import Surroundings, random_scene
from evenroad.robot_roadmap.make import joined, make_roadmap
from evenroad.robot_roadmap.pockets import links_of
from evenroad.robot_roadmap.recipe import SCENES, Recipe, known_of
from evenroad.robot_roadmap.spread import spread_order
from evenroad_studies.arms.problems import draw_problem, joins
from evenroad_studies.arms.roadmaps import cell_of
from evenroad_studies.arms.robots import ARMS, arm_named
from evenroad_studies.arms.scenes import GENERATORS

N, K, POOL = 256, 10, 512
"""Milestones, their neighbours, and milestones that the pool would be enough for."""

AT_ONCE = 4
"""Random scenes whose boxes make a dense one."""

RULES = {
    "power": (0.5, 1.0, 2.0, 4.0, 8.0, 16.0),
    "dense": (0.5, 1.0, 2.0, 4.0),
    "cut": (0.6, 0.3, 0.15, 0.07, 0.04),
}
"""Rule -> gammas, or shares."""

COLUMNS = ("arm", "rule", "value", "room", "deviation", "draw", "problem", "solved", "without")
EDGES = (0.0, 0.06, 0.2, 0.4, 0.65, 0.85, 1.0)
"""Of the bins of room that gains are averaged in."""


def with_roll(robot: Robot) -> Robot:
    """Return a UR5 whose upper arm rolls, too."""
    at = robot.links.index("upper_arm_link")
    roll = Joint(
        "upper_arm_roll",
        "revolute",
        "upper_arm_link",
        "roll_link",
        (0.0, 0.0, 0.0),
        (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        lower=-np.pi,
        upper=np.pi,
        velocity=3.15,
    )
    below = [
        replace(joint, parent="roll_link") if joint.parent == "upper_arm_link" else joint
        for joint in robot.joints
    ]
    wider = replace(
        robot,
        links=(*robot.links[: at + 1], "roll_link", *robot.links[at + 1 :]),
        joints=(*below[:at], roll, *below[at:]),
    )
    return with_group(wider, (*robot.group[:2], "upper_arm_roll", *robot.group[2:]))


def narrowed(robot: Robot) -> Robot:
    """Return a robot whose rolls have ranges half as wide."""
    rolls = [joint for joint in robot.joints if joint.name in robot.group and "roll" in joint.name]
    return with_limits(robot, {joint.name: (0.5 * joint.lower, 0.5 * joint.upper) for joint in rolls})


def _seven(left: tuple[int, ...]) -> Robot:
    robot = arm_named("arm7")
    return with_group(robot, [name for i, name in enumerate(robot.group) if i in left])


ARMS |= {
    "ur5-roll": lambda: with_roll(arm_named("ur5-5")),
    "arm7-held": partial(_seven, (0, 1, 3, 4, 5, 6)),
    "arm7-five": partial(_seven, (0, 1, 2, 3, 4)),
    "arm7-half": lambda: narrowed(arm_named("arm7")),
}
NAMES = {
    "ur5-5": "UR5 of 5 joints",
    "ur5-roll": "UR5 of 5 and a roll",
    "arm7-five": "arm of 7, five move",
    "arm7-held": "arm of 7, one held",
    "arm7-half": "arm of 7, rolls halved",
    "arm7": "arm of 7 joints",
}


def verdicts(robot: Robot, pool: Floats, rng: np.random.Generator) -> Bools:
    """Return which of a pool, (n, dim), each random scene leaves free, (scenes, n)."""
    bare, around = replace(robot, pairs=()), Surroundings.of(robot, pool)
    return np.array([ArmWorld(bare, random_scene(*around, rng)).valid(pool) for _ in range(SCENES)])


def rows(name: str, problems: int, draws: int) -> Iterator[tuple[object, ...]]:
    """Yield a row for each rule, value, draw and problem."""
    arm = arm_named(name)
    found = [draw_problem(name, kind, "report", i) for kind in GENERATORS for i in range(problems)]
    for draw in range(draws):
        bare = make_roadmap(arm, cell_of(arm), 8, gamma=0.0, ends=0, rng=draw)
        streams = np.random.default_rng([draw, 7]).spawn(3)
        known = known_of(bare.world, bare.one_turn, POOL, Recipe(0.0, 0), streams, lambda *_: None)
        free = verdicts(bare.robot, known.pool, streams[1])
        dense = free.reshape(-1, AT_ONCE, free.shape[1]).all(axis=1)
        scaled, periods = known.weights * known.pool, known.weights * known.periods

        def solved(preference: Floats, some: Bools) -> list[bool]:
            order = spread_order(scaled[some], periods, preference[some], N)  # noqa: B023
            made = joined(bare, known.pool[some][order], K)  # noqa: B023
            return [joins(made, problem, links_of(N)) for problem in found]

        every, even = np.ones(len(known.pool), np.bool_), np.ones(len(known.pool))
        without = solved(even, every)
        for rule, values in RULES.items():
            seen = dense if rule == "dense" else free
            chance = np.maximum(seen.mean(axis=0), 1.0 / len(seen))
            for value in values:
                if rule == "cut":
                    room, now = value, solved(even, chance >= np.quantile(chance, 1.0 - value))
                else:
                    density = chance ** (value * bare.world.space.dim)
                    room = density.sum() ** 2 / (len(density) * (density**2).sum())
                    now = solved(chance**value, every)
                spread = np.log(chance).std()
                for i, pair in enumerate(zip(now, without, strict=True)):
                    yield name, rule, value, f"{room:.4f}", f"{spread:.4f}", draw, i, *map(int, pair)


def write(path: Path, names: list[str], problems: int, draws: int) -> None:
    """Write the rows of one arm after the other."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        for name in names:
            writer.writerows(rows(name, problems, draws))
            file.flush()
            print(name, flush=True)


class Gains:
    """Gains by arm, rule and value, paired by problem."""

    def __init__(self, path: Path) -> None:
        self.room: dict[tuple[str, str, float], list[float]] = {}
        self.deviation: dict[tuple[str, str], float] = {}
        sums: dict[tuple[str, str, float], dict[int, list[int]]] = {}
        with path.open() as file:
            for row in csv.DictReader(file):
                key = row["arm"], row["rule"], float(row["value"])
                self.room.setdefault(key, []).append(float(row["room"]))
                self.deviation[row["arm"], row["rule"]] = float(row["deviation"])
                sums.setdefault(key, {}).setdefault(int(row["problem"]), []).append(
                    int(row["solved"]) - int(row["without"])
                )
        self.by_problem = {
            key: np.array([100.0 * np.mean(each) for each in by.values()]) for key, by in sums.items()
        }
        self.arms = [name for name in NAMES if any(key[0] == name for key in sums)]

    def of(self, key: tuple[str, str, float]) -> tuple[float, float, float]:
        """Return room, gain and its standard error over problems."""
        gains = self.by_problem[key]
        return float(np.mean(self.room[key])), gains.mean(), gains.std(ddof=1) / np.sqrt(len(gains))


def table(gains: Gains) -> None:
    """Print gains by arm and value with the room that is left, and averages over bins of room."""
    for rule, values in RULES.items():
        print(f"\n{rule}: gain (room)\n| arm | deviation | " + " | ".join(f"{v:g}" for v in values) + " |")
        print("|---|--:|" + "--:|" * len(values))
        for arm in gains.arms:
            of = [gains.of((arm, rule, value)) for value in values]
            cells = " | ".join(f"{gain:+.1f} ± {error:.1f} ({room:.2f})" for room, gain, error in of)
            print(f"| {NAMES[arm]} | {gains.deviation[arm, rule]:.2f} | {cells} |")
    print("\n| room | " + " | ".join(RULES) + " |\n|---|" + "--:|" * len(RULES))
    for low, high in pairwise(EDGES):
        cells = []
        for rule in RULES:
            some = [k for k in gains.by_problem if k[1] == rule and low < gains.of(k)[0] <= high]
            # The problems of an arm are one sample, those of others another.
            by_arm = [
                np.mean([gains.by_problem[k] for k in some if k[0] == arm], axis=0)
                for arm in gains.arms
                if any(k[0] == arm for k in some)
            ]
            all_of = np.concatenate(by_arm) if by_arm else np.zeros(0)
            error = all_of.std(ddof=1) / np.sqrt(len(all_of)) if by_arm else 0.0
            cells.append(f"{all_of.mean():+.1f} ± {error:.1f} ({len(by_arm)} arms)" if by_arm else "-")
        print(f"| {low:g} .. {high:g} | " + " | ".join(cells) + " |")


def picture(gains: Gains, out: Path) -> None:
    """Draw gains over gamma, and over the room that is left."""
    from matplotlib import pyplot as plt

    figure, panels = plt.subplots(1, 3, figsize=(11, 3.2), sharey=True, layout="constrained")
    for number, arm in enumerate(gains.arms):
        for rule, style in (("power", "o-"), ("dense", "s--"), ("cut", "^:")):
            keys = [(arm, rule, value) for value in RULES[rule]]
            of = np.array([gains.of(key) for key in keys])
            look = dict(color=f"C{number}", markersize=3.5, linewidth=1.0)
            if rule != "cut":
                label = NAMES[arm] if rule == "power" else None
                panels[0].plot([key[2] for key in keys], of[:, 1], style, label=label, **look)
                panels[1].plot(of[:, 0], of[:, 1], style, **look)
            else:
                panels[2].plot(of[:, 0], of[:, 1], style, **look)
    for panel, label in zip(
        panels,
        ("gamma", "room that a power of the chance leaves", "share with the greatest chance, no power"),
        strict=True,
    ):
        panel.axhline(0.0, color="0.7", linewidth=0.8)
        panel.set(xscale="log", xlabel=label)
        panel.minorticks_off()
    for panel, ticks in zip(
        panels, ((0.5, 1, 2, 4, 8, 16), (0.01, 0.03, 0.1, 0.3, 1), (0.04, 0.1, 0.3, 0.6)), strict=True
    ):
        panel.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    panels[0].set_ylabel("gain over spacing alone [%]")
    panels[0].legend(fontsize=6)
    figure.savefig(out, dpi=110)


def main() -> None:
    """Measure, or print and draw what was measured."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--problems", type=int, default=0, help="of each generator")
    parser.add_argument("--draws", type=int, default=3)
    parser.add_argument("--arms", nargs="+", default=list(NAMES), choices=list(NAMES))
    parser.add_argument("--out", type=Path, default=Path("arm_bias.csv"))
    parser.add_argument("--table", type=Path)
    parser.add_argument("--picture", type=Path)
    options = parser.parse_args()
    if options.problems:
        write(options.out, options.arms, options.problems, options.draws)
    gains = Gains(options.table or options.out)
    table(gains)
    if options.picture:
        picture(gains, options.picture)


if __name__ == "__main__":
    main()
