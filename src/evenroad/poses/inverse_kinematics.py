"""Inverse kinematics: all configurations found that bring a link to a goal pose."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Protocol

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats
from evenroad._checks import as_row
from evenroad._time_limit import BudgetSpent, look_at_clock
from evenroad.poses.chain import Chain, chain_of, default_tip, frame_pose
from evenroad.poses.closed_form import closed_form
from evenroad.poses.pose_goal import PoseGoal
from evenroad.poses.pose_task import PoseTask
from evenroad.poses.whole_turns import MOST, distinct, with_turns, wrapped
from evenroad.robots.robot import Robot

STARTS = 64
"""Number of even configurations, with the nearest tips, at which numeric solutions begin; then as many again."""

_PICKS = (0, STARTS, 1), (STARTS, 4 * STARTS, 1), (4 * STARTS, 2**31, 4)
"""The even configurations at which they begin, stage by stage: from, to below, every."""
_ENOUGH = 24
"""Number of configurations after which the search ends for an arm with more joints than the pose has numbers."""
_POLISHED = 4
_SAME = 1e-4
"""Distance below which configurations are one posture [rad or m]."""
_SAME_OF_SPARE = 0.1
"""The same for an arm with redundant joints."""
_SIDE, _TOGETHER = 8, 1e-16
"""Number of postures of each link of several, and the largest squared error of those that reach theirs together."""
_COARSE = 1e-2
"""Largest deviation of a solution in closed form [m, rad]."""


class Checks(Protocol):
    """The checks of an arm's world that are used here."""

    @property
    def robot(self) -> Robot: ...  # noqa: D102

    def valid(self, q: Floats) -> Bools: ...  # noqa: D102

    def explain(self, q: Floats) -> str: ...  # noqa: D102


@dataclass(frozen=True, eq=False)
class Reached:
    """The configurations that reach a pose goal."""

    configurations: Floats
    """Free ones, within limits, (n, dim), the nearest to the start first; empty where there is none."""
    branches: int
    """Number of postures that reach the pose within limits."""
    blocked: int
    """Number of these in collision."""
    solver: str
    """``closed form`` or ``numeric``."""
    nearest: Floats
    """Without a free one: a posture in collision, or the nearest configuration, (dim,)."""
    reason: Callable[[], str] = str
    """Without a free one: returns why, which takes longer than to find it out."""
    spent: bool = False
    """Whether the time was over before the search was done; there are no configurations then."""

    @cached_property
    def why(self) -> str:
        """Without a free one: why."""
        try:
            return self.reason()
        except BudgetSpent:
            return "no configuration was found, and there was no time to say why"

    @property
    def in_collision(self) -> bool:
        """Whether the pose is reached, but always in collision."""
        return self.branches > 0 and not len(self.configurations)


def reach(world: Checks, goal: PoseGoal, start: npt.ArrayLike, *, quickly: bool = False) -> Reached:
    """Return the free configurations that bring a link to the goal, whole turns added; `quickly` from few beginnings.

    Coordinates that do not move the link stay as in `start`, (dim,) [rad or m].  Raises UnknownName if tip or frame is
    no link; InvalidValue if nothing moves the tip, something moves the frame, no tip is named and there are several, or
    `start` is no configuration.
    """
    start = np.array(as_row("start", start, len(world.robot.group)))  # type: ignore[arg-type]
    chain, task = task_of(world.robot, goal)
    try:
        return _reached(world, goal, chain, task, start, quickly=quickly)
    except BudgetSpent:
        return _spent(goal, start)


def _reached(world: Checks, goal: PoseGoal, chain: Chain, task: PoseTask, start: Floats, *, quickly: bool) -> Reached:
    solved, best = np.empty((0, len(start))), start
    spare = len(chain.moving) > task.numbers
    solver, free = "numeric", np.empty(0, dtype=np.bool_)
    for found, solver, best in stages(chain, task, start, exact=goal.is_exact):  # noqa: B007
        solved = distinct(chain, np.concatenate([solved, found]), _SAME_OF_SPARE if spare else _SAME)
        free = world.valid(solved)
        if free.any() or quickly:
            break
    if not len(solved):
        return Reached(solved, 0, 0, solver, best, lambda: _why_not(chain, task, goal, best, start))
    if not free.any():
        reason = partial(_why_blocked, world, goal, solved)
        return Reached(solved[:0], len(solved), len(solved), solver, solved[0], reason)
    turned = with_turns(chain, solved[free], start, np.zeros(int(free.sum()), dtype=np.int64))[0]
    if goal.others:
        return _with_others(world, goal, turned, start, solver)
    return Reached(turned, len(solved), int((~free).sum()), solver, turned[0])


def reach_quickly(world: Checks, goals: Sequence[PoseGoal], start: Floats) -> list[Reached]:
    """Return the free configurations that bring links to each of many goals, from few beginnings, as `reach` does.

    Raises as that.
    """
    try:
        return _reached_quickly(world, goals, start)
    except BudgetSpent:
        return [_spent(goal, start) for goal in goals]


def _reached_quickly(world: Checks, goals: Sequence[PoseGoal], start: Floats) -> list[Reached]:
    found: list[Reached | None] = [None] * len(goals)
    together: dict[tuple[int, bool], list[tuple[int, PoseTask]]] = {}
    chains: dict[int, Chain] = {}
    for number, goal in enumerate(goals):
        look_at_clock()
        chain, task = task_of(world.robot, goal)
        if goal.others or (goal.is_exact and closed_form(chain) is not None):
            found[number] = reach(world, goal, start, quickly=True)
            continue
        chains[id(chain)] = chain
        together.setdefault((id(chain), len(chain.moving) > task.numbers), []).append((number, task))
    for (chain_id, spare), some in together.items():
        chain, tasks = chains[chain_id], np.stack([task.row for _, task in some])
        same, enough = (_SAME_OF_SPARE, _ENOUGH) if spare else (_SAME, 2**31)
        solutions = chain.reached_all(start, tasks, _PICKS[0], same=same, enough=enough)
        q, of, nearest = solutions.q, solutions.task, solutions.nearest
        free = world.valid(q)
        turned, whose = with_turns(chain, q[free], start, of[free])
        begins, firsts = (np.searchsorted(numbers, np.arange(len(some) + 1)) for numbers in (of, whose))
        for k, (number, task) in enumerate(some):
            look_at_clock()
            postures, rows = slice(*begins[k : k + 2]), turned[firsts[k] : firsts[k + 1]]
            count, blocked = len(q[postures]), int((~free[postures]).sum())
            reason: Callable[[], str] = str
            near = rows[0] if len(rows) else q[postures][0] if count else nearest[k]
            if not count:
                reason = partial(_why_not, chain, task, goals[number], near, start)
            elif not len(rows):
                reason = partial(_why_blocked, world, goals[number], q[postures])
            found[number] = Reached(rows, count, blocked, "numeric", near, reason)
    return [reached for reached in found if reached is not None]


def _with_others(world: Checks, goal: PoseGoal, rows: Floats, start: Floats, solver: str) -> Reached:
    """Return the configurations that reach the goals of other links, too, from those that reach the first one.

    Each link is brought to its goal by joints that the earlier ones do not move by, or where they stay there.
    """
    alone = replace(goal, others=())
    for other in goal.others:
        reached = [reach(world, other, row) for row in rows[:_SIDE]]
        if any(each.spent for each in reached):
            return _spent(goal, start)
        rows = np.concatenate([each.configurations[:_SIDE] for each in reached])
        if not len(rows):
            return Reached(rows, 0, 0, solver, start, partial(_why_not_both, alone, reached[0].reason))
    kept = np.ones(len(rows), dtype=np.bool_)
    for each in (alone, *goal.others):
        chain, task = task_of(world.robot, each)
        kept &= chain.reached(rows, task.row, steps=0)[1] <= _TOGETHER
    if not kept.any():
        return Reached(rows[:0], 0, 0, solver, start, partial(_why_not_both, alone, lambda: "the links share joints"))
    rows = rows[kept]
    rows = rows[np.argsort(np.linalg.norm(rows - start, axis=1), kind="stable")][:MOST]
    return Reached(rows, len(rows), 0, solver, rows[0])


def _spent(goal: PoseGoal, start: Floats) -> Reached:
    """Return that there was no time to look for all postures of a goal."""

    def why() -> str:
        return f"no free configuration was found for {goal} in the time that there was; give it more"

    return Reached(np.empty((0, len(start))), 0, 0, "numeric", start, why, spent=True)


def _why_not_both(goal: PoseGoal, reason: Callable[[], str]) -> str:
    return f"{goal} is reached, but not with the others: {reason()}"


def _why_blocked(world: Checks, goal: PoseGoal, solved: Floats) -> str:
    """Return, in words, what postures that reach a goal touch, (n, dim)."""
    touching = Counter[str]()
    for q in solved:
        look_at_clock()
        touching[world.explain(q)] += 1
    text = "; ".join(f"{why} in {times}" for why, times in touching.most_common(3))
    return f"{goal} is reached, but only in collision: of {len(solved)} postures found {text}"


def task_of(robot: Robot, goal: PoseGoal) -> tuple[Chain, PoseTask]:
    """Return the chain of a goal's tip, and the goal in the frame of the root."""
    chain = chain_of(robot, goal.tip or default_tip(robot))
    pose, pointing = frame_pose(robot, goal.frame) @ goal.pose, None
    if goal.free_axis is not None:
        x, y, z = (pose.rotation_matrix @ goal.free_axis).tolist()
        pointing = goal.free_axis, (x, y, z)
    near, tilt = goal.position_tolerance, goal.angle_tolerance
    return chain, PoseTask(pose, pointing, True, not goal.position_only, near, tilt)


def stages(chain: Chain, task: PoseTask, start: Floats, *, exact: bool) -> Iterator[tuple[Floats, str, Floats]]:
    """Yield postures within limits that reach a task, (n, dim), their solver, and the nearest configuration: more and
    more.

    A posture stands for all configurations that differ by whole turns.  A closed form yields all at once.
    """
    solve = closed_form(chain) if exact else None
    if solve is not None:
        q = solve(task.pose)
        q[:, chain.still] = start[chain.still]
        q = wrapped(chain, _polished(chain, task, q))
        q = q[((q >= chain.bounds[0]) & (q <= chain.bounds[1])).all(axis=1)]
        if len(q):
            yield distinct(chain, q, _SAME), "closed form", start
            return
        # A numeric solver may still find some at a singularity.
    for q, best in numeric(chain, task, start):
        yield q, "numeric", best


def numeric(chain: Chain, task: PoseTask, start: Floats, *, limits: bool = True) -> Iterator[tuple[Floats, Floats]]:
    """Yield postures found from even starts, (n, dim), and the nearest one: more and more."""
    best, least, row = start, math.inf, task.row[np.newaxis]
    # The start of the query first; then near ones and, where these fail, farther ones.
    for pick in _PICKS:
        found = chain.reached_all(start, row, pick, limits=limits, enough=_enough(chain, task))
        if (missing := float(found.missing[0])) < least:
            least, best = missing, found.nearest[0]
        yield found.q, best


def _enough(chain: Chain, task: PoseTask) -> int:
    """Return after how many solutions a search ends."""
    return _ENOUGH if len(chain.moving) > task.numbers else 2**31


def _polished(chain: Chain, task: PoseTask, q: Floats) -> Floats:
    """Return the configurations that reach a task after a few more steps; closed forms lose digits near
    singularities.
    """
    moved, missing = chain.reached(q, task.row, limits=False, steps=_POLISHED)
    near = np.abs(moved - q).max(axis=1, initial=0.0) < _COARSE
    return np.compress((missing < 1e-18) & near, moved, axis=0)


def _why_not(chain: Chain, task: PoseTask, goal: PoseGoal, best: Floats, start: Floats) -> str:
    """Return, in words, why no configuration reaches a task: out of reach, limits, or unknown."""
    point, far = chain.reach()
    distance = math.dist(task.pose.xyz, point)
    if distance > far + goal.position_tolerance:
        return (
            f"{goal} is out of reach: {distance:.4g} m from where the first joint turns, and no joint angles bring"
            f" {chain.tip!r} farther than {far:.4g} m from there"
        )
    beyond = next(numeric(chain, task, start, limits=False))[0]
    if len(beyond):
        over = np.maximum(chain.bounds[0] - beyond, beyond - chain.bounds[1])
        row = int(over.max(axis=1).argmin())
        k = int(over[row].argmax())
        if over[row, k] > 0.0:
            low, high = chain.bounds[:, k]
            return (
                f"{goal} is reached only beyond the limits of joints: nearest with {chain.group[k]!r} at"
                f" {beyond[row, k]:.4g}, {over[row, k]:.3g} outside [{low:.4g}, {high:.4g}]"
            )
    near, tilt = task.misses(chain.tip_poses(best[np.newaxis])[0])
    return (
        f"no configuration was found for {goal}, and none may exist: the nearest that was tried"
        f" is {1e3 * near:.3g} mm and {math.degrees(tilt):.3g} deg off"
    )
