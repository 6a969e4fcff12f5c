"""Problems under constraints along the whole path: how many are solved, how soon, and how far off their paths are.

    python -m studies.benchmarks.kept --count 200          # problems of each kind for a UR5, and two of them

``tray``: an axis of the flange tilts by 0.1 rad at most.  ``line``: the flange stays on a line of 1 m, and keeps its
rotation.  ``door``: it turns a handle by 60 degrees.  ``box``: two arms carry a box.  Lines, circles and hands are
kept within 0.1 mm.  Scenes have boxes of random places and sizes; both ends of a problem are free and keep the
constraint, but a path need not exist.

Each is planned with 3000 motions, about a second.  What is left open is asked again.  Of lines and doors the
configurations that keep the constraint are a curve: it is followed from the start both ways until it ends at a limit
or at what touches, so that it is known whether a goal is on it.  Trays and boxes get ten times as many motions; what
these do not solve stays open.  `solvable` are those solved either way.  Times are processor time of ``er.plan``; `off`
is the largest distance from the constraint at twenty states of each motion, as a share of what is allowed.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from studies.benchmarks.rows import parser_of

import evenroad as er
from evenroad.constraints.constrained_world import KeptWorld, keeps_of, kept_world
from evenroad.poses.inverse_kinematics import reach
from evenroad.robot import with_group

TUNING, REPORTING = 1_000, 2_000
"""First seeds: constants were chosen on the one, figures come from the other."""
MOTIONS, LONG = 3_000, 30_000
"""Numbers of motions that a problem gets, and that one which stays open gets after that."""
FINE, MOST_STATES = 0.01, 5_000
"""Length of the steps along a curve [rad], and the largest number of its states."""
FORWARD = (np.pi / 2, 0.0, np.pi / 2)
"""Roll, pitch and yaw of a flange that points along x."""


@dataclass(frozen=True)
class Kept:
    """A world, both ends of a path, and what it keeps."""

    world: er.ArmWorld
    start: Any
    goal: Any
    constraints: Any


def _scene(rng: np.random.Generator, count: int, clear: Callable[[np.ndarray], bool]) -> er.Scene:
    boxes: list[Any] = []
    while len(boxes) < count:
        at = rng.uniform([-0.8, -0.8, 0.0], [0.9, 0.8, 1.0])
        if np.hypot(*at[:2]) > 0.3 and clear(at):
            boxes.append(er.Box(tuple(rng.uniform(0.05, 0.2, 3)), xyz=tuple(at), name=f"box {len(boxes)}"))
    return er.Scene(boxes)


def _posture(world: er.ArmWorld, goal: er.PoseGoal, rng: np.random.Generator) -> Any:
    rows = reach(world, goal, np.zeros(world.dim)).configurations
    return rows[rng.integers(min(len(rows), 4))] if len(rows) else None


def tray(rng: np.random.Generator) -> Kept | None:
    """Carry a glass from a pose to another."""
    world = er.ArmWorld("ur5", _scene(rng, 5, lambda at: True))
    poses = []
    for _ in range(2):
        angle, away = rng.uniform(-2.0, 2.0), rng.uniform(0.35, 0.65)
        xyz = away * np.cos(angle), away * np.sin(angle), rng.uniform(0.15, 0.7)
        poses.append(er.PoseGoal(er.Pose(xyz, rpy=(np.pi, 0.0, 0.0)), free_axis="z"))
    start = _posture(world, poses[0], rng)
    return None if start is None else Kept(world, start, poses[1], er.constraints.KeepUpright(0.1, "-z"))


def line(rng: np.random.Generator) -> Kept | None:
    """Slide along a line of 1 m."""
    x, z = rng.uniform(0.3, 0.5), rng.uniform(0.25, 0.6)
    world = er.ArmWorld("ur5", _scene(rng, 5, lambda at: abs(at[0] - x) > 0.3 or abs(at[2] - z) > 0.35))
    start = _posture(world, er.PoseGoal(er.Pose((x, -0.5, z), rpy=FORWARD)), rng)
    constraints = er.constraints.KeepOnLine("y") & er.constraints.KeepOrientation(1e-3)
    return None if start is None else Kept(world, start, er.Pose((x, 0.5, z), rpy=FORWARD), constraints)


def door(rng: np.random.Generator) -> Kept | None:
    """Open a door by 60 degrees at its handle."""
    hinge = np.array([rng.uniform(0.7, 0.9), rng.uniform(0.2, 0.5), 0.0])
    radius, height, first = rng.uniform(0.35, 0.55), rng.uniform(0.3, 0.6), rng.uniform(-1.8, -1.4)
    ends = []
    for angle in (first, first - np.pi / 3.0):
        at = hinge + radius * np.array([np.cos(angle), np.sin(angle), height / radius])
        # The flange looks against the door, and turns as it does.
        ends.append(
            er.Pose(
                tuple(at), er.Pose(rpy=(0.0, 0.0, angle - first)).rotation_matrix @ er.Pose(rpy=FORWARD).rotation_matrix
            )
        )
    world = er.ArmWorld("ur5", _scene(rng, 5, lambda at: np.linalg.norm(at - hinge) > radius + 0.3))
    start = _posture(world, er.PoseGoal(ends[0]), rng)
    return None if start is None else Kept(world, start, ends[1], er.constraints.KeepOnCircle(tuple(hinge), "z"))


ARM = er.load_robot("ur5")
BOTH = ARM.with_tool(ARM, "base_link", pose=er.Pose((0.0, 0.9, 0.0), rpy=(0.0, 0.0, np.pi)), prefix="left_")
BOTH = with_group(BOTH, (*ARM.group, *(f"left_{joint}" for joint in ARM.group)))


def box(rng: np.random.Generator) -> Kept | None:
    """Carry a box with two arms that face each other."""
    world = er.ArmWorld(BOTH, _scene(rng, 3, lambda at: abs(at[1] - 0.45) > 0.4 or at[0] < 0.0))
    rows = []
    for _ in range(2):
        x, y, z = rng.uniform([0.3, 0.35, 0.25], [0.55, 0.55, 0.6])
        turn = rng.uniform(-0.4, 0.4)
        hands = [
            er.Pose((x, y, z), rpy=(0.0, 0.0, turn))
            @ er.Pose((0.0, side * 0.15, 0.0), rpy=(side * np.pi / 2, 0.0, 0.0))
            for side in (-1.0, 1.0)
        ]
        right = reach(world, er.PoseGoal(hands[0], tip="tool0"), rows[0] if rows else np.zeros(12)).configurations
        if not len(right):
            return None
        both = reach(world, er.PoseGoal(hands[1], tip="left_tool0"), right[0]).configurations
        if not len(both):
            return None
        rows.append(both[0])
    return Kept(world, rows[0], rows[1], er.constraints.KeepTogether("tool0", "left_tool0"))


KINDS = {"tray": tray, "line": line, "door": door, "box": box}
CURVES = {"line", "door"}
"""Kinds whose configurations that keep the constraint are a curve."""


def _is_free(kept: KeptWorld, goal: Any) -> bool:
    if isinstance(goal, np.ndarray):
        return bool(kept.valid(goal[np.newaxis])[0])
    goal = goal if isinstance(goal, er.PoseGoal) else er.PoseGoal(goal)
    return len(reach(kept.world, goal, np.zeros(kept.world.dim)).configurations) > 0


def problems(kind: str, count: int, first: int) -> Iterator[Kept]:
    """Yield problems of a kind whose ends exist and are free."""
    seed, made = first, 0
    while made < count:
        problem = KINDS[kind](np.random.default_rng([seed, len(kind)]))
        seed += 1
        if problem is not None:
            kept = kept_world(problem.world, keeps_of(problem.constraints), problem.start, "")
            if kept.valid(problem.start[np.newaxis])[0] and _is_free(kept, problem.goal):
                made += 1
                yield problem


def _curve(kept: KeptWorld, start: np.ndarray, sign: float) -> np.ndarray:
    """Return the free states of a curve, (n, dim), from a start on in one direction: to where it ends, or closes."""
    states, ahead = [start], np.zeros(kept.world.dim)
    while len(states) < MOST_STATES:
        # The direction that no residual changes with.
        direction = np.linalg.svd(kept.native.derivative(states[-1]))[2][-1]
        direction *= np.sign(direction @ ahead) if ahead.any() else sign
        ahead = direction
        moved, good = kept.projected((states[-1] + FINE * direction)[np.newaxis])
        if not good[0] or not kept.world.valid(moved)[0]:
            break
        states.append(moved[0])
        if len(states) > 3 and np.linalg.norm(moved[0] - start) < FINE:
            break
    return np.array(states)


def is_on_curve(problem: Kept, goals: np.ndarray) -> bool:
    """Return whether one of the goals, (g, dim), is on the free piece of the curve that the start is on."""
    kept = kept_world(problem.world, keeps_of(problem.constraints), problem.start, "")
    curve = np.concatenate([_curve(kept, problem.start, sign) for sign in (-1.0, 1.0)])
    return bool(np.linalg.norm(curve[:, np.newaxis] - goals, axis=2).min() < 2.0 * FINE)


def given_options(doc: str | None, count: int) -> tuple[list[str], int, int]:
    """Return the kinds of problems, how many of each, and their seed, of a command line with this help."""
    parser = parser_of(doc)
    parser.add_argument("--count", type=int, default=count, help="problems of each kind")
    parser.add_argument("--only", choices=[*KINDS], help="one kind alone")
    parser.add_argument("--tuning", action="store_true", help="the seeds that constants were chosen on")
    given = parser.parse_args()
    return [given.only] if given.only else [*KINDS], given.count, TUNING if given.tuning else REPORTING


def main() -> None:
    """Plan all, print a row a kind."""
    kinds, count, seed = given_options(__doc__, 50)
    for kind in kinds:
        times, solved, solvable, off = [], [], [], 0.0
        for problem in problems(kind, count, seed):

            def planned(motions: int, problem: Kept = problem) -> er.PlanResult:
                limits = {"motions": motions}
                world, constraints = problem.world, problem.constraints
                return er.plan(world, problem.start, problem.goal, constraints=constraints, limits=limits, seconds=600)

            began = time.process_time()
            result = planned(MOTIONS)
            times.append(1e3 * (time.process_time() - began))
            solved.append(result.solved)
            more = solved[-1] or (is_on_curve(problem, result.goals) if kind in CURVES else planned(LONG).solved)
            solvable.append(more)
            if result.path is not None:
                kept = kept_world(problem.world, keeps_of(problem.constraints), result.path[0], "")
                states = np.linspace(result.path[:-1], result.path[1:], 20).reshape(-1, problem.world.dim)
                off = max(off, float(kept.shares(states).max()))
                assert problem.world.validate(result.path).all()
        some = np.array(times)[np.array(solved)] if any(solved) else np.array([np.nan])
        left = "not one of the others can be" if kind in CURVES else "the others stay open"
        print(
            f"{kind}: {sum(solved)} of {sum(solvable)} solvable ones of {len(solved)}, {left};"
            f" {np.median(some):.1f} ms in the median, {np.quantile(some, 0.95):.1f} at 95 %;"
            f" off by {off:.2f} of what is allowed",
            flush=True,
        )


if __name__ == "__main__":
    main()
