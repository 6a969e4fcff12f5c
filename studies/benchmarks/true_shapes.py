"""Plans of arms in shelves, boxes and cages, on tables and under them, with the makers' shapes and with capsules.

    python -m studies.benchmarks.true_shapes OUT.csv ROBOT.urdf ... [--each 25]
    python -m studies.benchmarks.true_shapes OUT.csv --table

Ends are near obstacles and free by `CLEAR` in coal, on the triangles of the files.  For each robot and family: how
many problems either solves, how many ends it refuses, how many states of its paths touch an obstacle in coal by more
than `DEEP`, and how long a plan with shapes takes in parts of the same with capsules, where both solve it.

More ratios say where that comes from.  ``same`` is the time that shapes take for the motions between nodes of the
trees that they grow, in parts of what capsules take for the same motions: what a test costs.  ``back`` is the time that
capsules take from goal to start, in parts of that from start to goal, and ``own`` the same of shapes: what is luck of a
search.  ``motions`` is how many more motions a plan with shapes looks at.  The last row is of all problems together.
``--table`` prints the rows as docs/guides/robots.md has them.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from studies.benchmarks.obstacle_truth import CLEAR, DEEP, held_joints, touching
from studies.benchmarks.robot_truth import Truth
from studies.benchmarks.rows import given_or_table, parser_of, write_rows

import evenroad as er
from evenroad.planning.arm_trees import grown_trees
from evenroad.robot import ArmWorld, Robot, Scene, load_robot
from evenroad.scenes.scene import Obstacle
from evenroad.space.path import resample

REACH = 1.5
"""Length of a motion of trees at most [rad]."""
NEAR = 0.04
"""Ends are those that are blocked for capsules with this clearance [m]."""
COLUMNS = (
    *("robot", "family", "problems", "solved", "solved_capsules", "refused", "refused_capsules"),
    *("states", "states_that_touch", "ms", "ms_capsules", "ratio_median", "ratio_95"),
    *("same_median", "same_95", "back_median", "back_95", "motions_median", "motions_95", "own_median", "own_95"),
)
RATIOS = ("ratio", "same", "back", "motions", "own")


def box(name: str, size: tuple[float, ...], *xyz: float) -> Obstacle:
    """Return a box along the axes."""
    return Obstacle.of(name, "box", size, xyz)


def shelves(rng: np.random.Generator) -> list[Obstacle]:
    """Return three boards with a back and sides, and cans on them."""
    x, gap = rng.uniform(0.5, 0.65), rng.uniform(0.28, 0.4)
    boards = [box(f"board{i}", (0.3, 0.8, 0.02), x, 0.0, 0.05 + gap * i) for i in range(3)]
    sides = [box(f"side{i}", (0.3, 0.02, 0.8), x, side, 0.4) for i, side in enumerate((-0.4, 0.4))]
    cans = [
        Obstacle.of(f"can{i}", "cylinder", (0.035, 0.12), (x, rng.uniform(-0.35, 0.35), 0.12 + gap * (i % 2)))
        for i in range(4)
    ]
    return [*boards, *sides, box("back", (0.02, 0.8, 0.8), x + 0.16, 0.0, 0.4), *cans]


def box_with_lid(rng: np.random.Generator) -> list[Obstacle]:
    """Return a box that a lid covers by half."""
    x, y, side, high = rng.uniform(0.4, 0.5), rng.uniform(-0.3, 0.3), rng.uniform(0.35, 0.45), rng.uniform(0.2, 0.35)
    walls = [
        box(f"wall{i}", size, x + dx * side / 2, y + dy * side / 2, high / 2)
        for i, (dx, dy) in enumerate(((1, 0), (-1, 0), (0, 1), (0, -1)))
        for size in [(0.02, side, high) if dx else (side, 0.02, high)]
    ]
    return [
        *walls,
        box("bottom", (side, side, 0.02), x, y, 0.0),
        box("lid", (side, side / 2, 0.02), x, y + side / 4, high),
    ]


def cage(rng: np.random.Generator) -> list[Obstacle]:
    """Return upright bars around the robot, and a ring of beams."""
    radius, count = rng.uniform(0.5, 0.6), 9
    turn = np.arange(count) * 2.0 * np.pi / count + rng.uniform(0.0, 1.0)
    bars = [
        Obstacle.of(f"bar{i}", "cylinder", (0.02, 1.0), (radius * np.cos(a), radius * np.sin(a), 0.5))
        for i, a in enumerate(turn)
    ]
    beams = [box(f"beam{i}", size, *place, 0.45) for i, (size, place) in enumerate((
        ((1.2, 0.04, 0.04), (0.0, radius)), ((1.2, 0.04, 0.04), (0.0, -radius)), ((0.04, 1.2, 0.04), (radius, 0.0)),
    ))]  # fmt: skip
    return [*bars, *beams]


def table(rng: np.random.Generator) -> list[Obstacle]:
    """Return a table top at the robot's shoulder with its legs, and things on it."""
    x, z = rng.uniform(0.45, 0.6), rng.uniform(0.2, 0.35)
    legs = [
        box(f"leg{i}", (0.04, 0.04, z), x + dx, dy, z / 2) for i, (dx, dy) in enumerate(((-0.2, 0.4), (-0.2, -0.4)))
    ]
    things = [
        Obstacle.of(f"thing{i}", *(("box", (0.08, 0.06, 0.2)) if i % 2 else ("sphere", (0.06,))),
                    (x + rng.uniform(-0.2, 0.2), rng.uniform(-0.4, 0.4), z + 0.1))
        for i in range(5)
    ]  # fmt: skip
    return [box("top", (0.5, 1.0, 0.03), x, 0.0, z), *legs, *things]


def under_a_table(rng: np.random.Generator) -> list[Obstacle]:
    """Return a table top before the robot, under which it reaches, with four legs and a beam along its front."""
    x, z = rng.uniform(0.5, 0.65), rng.uniform(0.45, 0.65)
    legs = [
        box(f"leg{i}", (0.05, 0.05, z), x + dx, dy, z / 2)
        for i, (dx, dy) in enumerate((dx, dy) for dx in (-0.25, 0.25) for dy in (-0.45, 0.45))
    ]
    return [box("top", (0.6, 1.0, 0.03), x, 0.0, z), box("beam", (0.03, 0.9, 0.08), x - 0.25, 0.0, z - 0.06), *legs]


FAMILIES = {each.__name__: each for each in (shelves, box_with_lid, cage, table, under_a_table)}
"""What the problems are of; the seed of each is its number."""


def problems(robot: Robot, truth: Truth, family: str, each: int) -> list[tuple[Scene, np.ndarray, np.ndarray]]:
    """Return scenes of a family, each with a start and a goal that coal calls free."""
    found, rng = [], np.random.default_rng(sorted(FAMILIES).index(family))
    while len(found) < each:
        scene = Scene(tuple(FAMILIES[family](rng)), name=family)
        lean = ArmWorld(robot, Scene((), name="empty"))
        near = ArmWorld(replace(robot, shapes=()), scene, clearance=NEAR)
        q = lean.space.from_cube(rng.random((3000, lean.space.cube_dim)))
        q = q[lean.valid(q) & ~near.valid(q)][:60]
        q = q[~touching(truth, scene, q, CLEAR)]
        found += [(scene, q[i], q[i + 1]) for i in range(0, min(len(q) - 1, 8), 2)]
    return found[:each]


def planned(robot: Robot, scene: Scene, start: np.ndarray, goal: np.ndarray) -> tuple[er.PlanResult, float]:
    """Return a plan, and the least of its processor's seconds of three tries after the first."""
    world = ArmWorld(robot, scene)
    result = er.plan(world, start, goal)
    return result, seconds(lambda: er.plan(world, start, goal)) if result.solved else np.nan


def seconds(call: Callable[[], object]) -> float:
    """Return the least of the processor's seconds of three calls."""
    took = []
    for _ in range(3):
        began = time.process_time()
        call()
        took.append(time.process_time() - began)
    return min(took)


def same_motions(shaped: ArmWorld, capsules: ArmWorld, start: np.ndarray, goal: np.ndarray) -> float:
    """Return the time that shapes take for motions between nodes of their trees, in parts of that of capsules.

    Of each node: the motion to the node before, which is free, and one to a node at random, for at most `REACH`.
    """
    nodes, edges = grown_trees(shaped, start, goal[np.newaxis])
    others = nodes[np.random.default_rng(0).permutation(len(nodes))]
    far = np.linalg.norm(others - nodes, axis=1, keepdims=True)
    tried = nodes + (others - nodes) * np.minimum(1.0, REACH / np.maximum(far, 1e-9))
    a, b = np.concatenate([nodes[edges[:, 0]], nodes]), np.concatenate([nodes[edges[:, 1]], tried])
    times = max(1, 400 // len(a))
    a, b = np.tile(a, (times, 1)), np.tile(b, (times, 1))
    return seconds(lambda: shaped.motion_valid(a, b)) / seconds(lambda: capsules.motion_valid(a, b))


def motions_of(result: er.PlanResult) -> int:
    """Return how many motions a plan looked at."""
    return result.counts["edges_checked"] + result.counts["shortcut_motions"]


def shares_of(rows: np.ndarray) -> dict[str, float]:
    """Return the median times and the quantiles of the ratios of problems that both solve, (n, 6)."""
    found: dict[str, float] = {}
    shares = np.c_[rows[:, 0] / rows[:, 1], rows[:, 2:]]
    for key, column in zip(RATIOS, shares.T, strict=True):
        middle, most = np.nanquantile(column, (0.5, 0.95)) if len(column) else (np.nan, np.nan)
        found |= {f"{key}_median": round(float(middle), 3), f"{key}_95": round(float(most), 3)}
    times = (1e3 * np.median(rows[:, :2], axis=0)).round(2).tolist()
    return found | dict(zip(("ms", "ms_capsules"), times, strict=True))


def measured(file: Path, each: int) -> Iterator[tuple[dict[str, object], np.ndarray]]:
    """Yield the rows of one robot, each with the times and ratios of its problems, (n, 6)."""
    robot = load_robot(file)
    arm = [name for name in robot.group if not any(word in name for word in ("finger", "robotiq", "gripper", "drive"))]
    robot = load_robot(file, group=arm)
    capsules, truth = replace(robot, shapes=()), Truth(file, robot.group, held_joints(robot))
    for family in FAMILIES:
        count = dict.fromkeys(COLUMNS[2:9], 0)
        rows = []
        for scene, start, goal in problems(robot, truth, family, each):
            (result, spent), (plain, spent_plain) = (planned(of, scene, start, goal) for of in (robot, capsules))
            count["problems"] += 1
            for end, found in (("", result), ("_capsules", plain)):
                count["solved" + end] += found.solved
                count["refused" + end] += str(found.status).endswith("invalid")
            if result.solved:
                world = ArmWorld(robot, scene)
                states = resample(result.path, world.space, 0.05)[0]
                count["states"] += len(states)
                count["states_that_touch"] += int(touching(truth, scene, states, -DEEP).sum())
            if result.solved and plain.solved:
                back = planned(capsules, scene, goal, start)[1] / spent_plain
                same = same_motions(world, ArmWorld(capsules, scene), start, goal)
                own = planned(robot, scene, goal, start)[1] / spent
                more = motions_of(result) / max(1, motions_of(plain))
                rows.append((spent, spent_plain, same, back, more, own))
        both = np.array(rows).reshape(-1, 6)
        yield {"robot": file.stem, "family": family, **count, **shares_of(both)}, both


def printed(rows: list[dict[str, str]]) -> str:
    """Return the rows as a table of a page."""
    head = ("robot", "family", "problems", "solved", "by capsules", "touching", "ms", "ratio", "same", "back")
    lines = [f"| {' | '.join(head)} |", "|" + "---|" * len(head)]
    for row in rows:
        cells = (
            *(row["robot"], row["family"].replace("_", " "), row["problems"], row["solved"], row["solved_capsules"]),
            *(f"{row['states_that_touch']} of {row['states']}", f"{float(row['ms']):.2f}"),
            *(f"{float(row[f'{key}_median']):.2f} / {float(row[f'{key}_95']):.2f}" for key in RATIOS[:3]),
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    """Write a row for each robot and family as soon as it is there, or print the table of a file's rows."""
    parser = parser_of(__doc__)
    parser.add_argument("--each", type=int, default=25)
    given = given_or_table(parser, printed)
    done: list[dict[str, object]] = []
    problems_of_all: list[np.ndarray] = []
    for file in given.robots:
        for row, both in measured(file, given.each):
            print(row, flush=True)
            done.append(row)
            problems_of_all.append(both)
            total = {key: sum(int(str(each[key])) for each in done) for key in COLUMNS[2:9]}
            every = {"robot": "all", "family": "all", **total, **shares_of(np.concatenate(problems_of_all))}
            write_rows(given.out, COLUMNS, [*done, every])


if __name__ == "__main__":
    main()
