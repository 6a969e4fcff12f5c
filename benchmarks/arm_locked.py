"""Proofs that an arm cannot get from one configuration to another: its first links alone cannot.

    python -m benchmarks.arm_locked                  # cages that trees do not solve, of the problems of arm_planner

The joints next to the base move the links next to the base, whatever the others do.  Their ranges are cut into cells.
A cell is blocked throughout where its middle is, with capsules thinner by what half a cell can move them (and by the
tenth that the spheres of the check may be thicker).  If start and goal lie in two pieces of what is left, there is no
path.  Contacts of links with each other are left out, which only makes more of it free.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
from scipy.ndimage import label

from benchmarks.arm_problems import REPORTING, Pool, Problem, arm, problems
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.kernel.placed_capsules import LARGEST_EXCESS
from evenroad.robot.robot import Robot, with_group
from evenroad.robot.scene import Scene

TRIES = (
    (2, (np.inf, np.inf), 1_000_000),
    (3, (0.35, 0.35, np.inf), 20_000_000),
    (4, (0.35, 0.7, 1.4, np.inf), 40_000_000),
    (4, (0.35, 0.35, np.inf, np.inf), 100_000_000),
    (4, (0.5, 0.5, np.inf, np.inf), 300_000_000),
)
"""How many of the first joints are looked at, how far from an end the cells reach along each [rad], how many cells."""

_SLACK = 1e-4
"""More than single precision can be wrong by [m]."""


def first_links(robot: Robot, joints: int) -> Robot:
    """Return the robot with what its first joints alone move: the others, and the bodies behind them, are gone."""
    group = robot.group[:joints]
    behind: set[str] = set()
    for joint in robot.joints:
        if joint.parent in behind or (joint.name in robot.group and joint.name not in group):
            behind.add(joint.child)
    capsules = tuple(capsule for capsule in robot.capsules if capsule.link not in behind)
    return replace(with_group(robot, group), capsules=capsules, pairs=(), hulls=(), resting=())


def is_locked(problem: Problem, backwards: bool, joints: int, reach: tuple[float, ...], cells: int) -> bool:
    """Return whether it is proved by the first joints that no path leads from one end to the other."""
    end, goal = (problem.goal, problem.start) if backwards else (problem.start, problem.goal)
    robot = first_links(problem.robot, joints)
    tables = ArmWorld(robot, Scene("nothing", ())).robot_tables
    space = ArmWorld(robot, problem.scene).space
    least, most = np.array(space.low), np.array(space.high)
    low = np.maximum(least, end[:joints] - reach)
    high = np.minimum(most, end[:joints] + reach)
    # Half a cell along any joint moves the links by about as much, the finer the better.
    fastest = np.maximum(tables.speeds.max(axis=0), 0.05)
    count = np.ceil((high - low) * fastest * (cells / np.prod((high - low) * fastest)) ** (1 / joints))
    count = np.maximum(count.astype(int), 2)
    size = (high - low) / count
    world = ArmWorld(thinner(robot, 0.5 * size), problem.scene)
    middles = [low[k] + size[k] * (np.arange(count[k]) + 0.5) for k in range(joints)]
    free = np.empty(count, dtype=bool)
    for i, first in enumerate(middles[0]):
        rest = np.stack(np.meshgrid([first], *middles[1:], indexing="ij"), axis=-1).reshape(-1, joints)
        free[i] = world.valid(rest).reshape(free.shape[1:])
    pieces, _ = label(free)
    here, other = (np.floor((q[:joints] - low) / size).astype(int) for q in (end, goal))
    number = pieces[tuple(np.minimum(here, count - 1))]
    assert number > 0, "the end is free, so its cell is not blocked throughout"
    piece = pieces == number
    if ((other >= 0) & (other < count)).all() and piece[tuple(other)]:
        return False
    # It must not leave by a side of the cells that is no limit of a joint.
    for k in range(joints):
        sides = np.moveaxis(piece, k, 0)[[0, -1]].reshape(2, -1).any(axis=1)
        if (sides[0] and low[k] > least[k]) or (sides[1] and high[k] < most[k]):
            return False
    return True


def thinner(robot: Robot, half: np.ndarray) -> Robot:
    """Return the robot with capsules so thin that where one touches, it does throughout the cell; some vanish."""
    kept = []
    for capsule in robot.capsules:
        alone = replace(robot, capsules=(capsule,))
        moved = float((ArmWorld(alone, Scene("nothing", ())).robot_tables.speeds @ half)[0])
        radius = (capsule.radius - moved - _SLACK) / LARGEST_EXCESS
        kept += [replace(capsule, radius=radius)] if radius > 0.0 else []
    return replace(robot, capsules=tuple(kept))


def locked_by(problem: Problem) -> int:
    """Return by how many of the first joints it is proved that there is no path; 0 where that is not proved."""
    tries = ((way, *grid) for grid in TRIES for way in (False, True))
    return next((joints for way, joints, *grid in tries if is_locked(problem, way, joints, *grid)), 0)


def main() -> None:
    from benchmarks.arm_planner import MOST_MOTIONS
    from evenroad.robot.trees import connect

    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=30, help="cages for each arm, at most 100")
    parser.add_argument("--arms", nargs="*", default=["ur5", "arm7"])
    options = parser.parse_args()
    for name in options.arms:
        unsolved, solved = {}, 0
        for problem in problems(Pool(arm(name)), REPORTING[: options.count], ("cage",)):
            world = ArmWorld(problem.robot, problem.scene)
            goals = problem.goal[np.newaxis]
            if connect(world, problem.start, goals, most_motions=MOST_MOTIONS, seconds=60).goal >= 0:
                solved += 1
                continue
            unsolved[problem.seed] = joints = locked_by(problem)
            print(name, problem.seed, f"no path: {joints} joints show it" if joints else "open", flush=True)
        locked = sum(joints > 0 for joints in unsolved.values())
        print(
            f"{name}: {options.count} cages, {locked} proved to have no path; of the others {solved} are solved within"
            f" {MOST_MOTIONS} motions, open: {[seed for seed, joints in unsolved.items() if not joints]}"
        )


if __name__ == "__main__":
    main()
