"""Inverse kinematics: all configurations found that bring a link to a goal pose."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats
from evenroad._checks import as_row
from evenroad.geometry.pose import Pose
from evenroad.robot.chain import TURN, Chain, chain_of, default_tip, frame_pose
from evenroad.robot.closed_form import branches, closed_form
from evenroad.robot.pose_goal import PoseGoal
from evenroad.robot.robot import Robot

STARTS = 64
"""Number of even configurations, with the nearest tips, at which numeric solutions begin; then as many again."""

MOST = 64
"""Largest number of configurations of one goal, the nearest of all with their whole turns."""

_ENOUGH = 24
"""Number of configurations after which the search ends for an arm with more joints than the pose has numbers."""
_STEPS = 60
_POLISHED = 4
_SAME = 1e-4
"""Distance below which configurations are one posture [rad or m]."""
_APART = 0.1
"""The same for an arm with redundant joints."""
_MOST_TURNING = 8
"""Largest number of joints that are tried in other turns, too."""
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
    why: str = ""
    """Without a free one: why."""

    @property
    def in_collision(self) -> bool:
        """Whether the pose is reached, but always in collision."""
        return self.branches > 0 and not len(self.configurations)


def reach(world: Checks, goal: PoseGoal, start: npt.ArrayLike) -> Reached:
    """Return the free configurations that bring a link to the goal, whole turns added.

    Coordinates that do not move the link stay as in `start`, (dim,) [rad or m].  Raises UnknownName if tip or frame is
    no link; InvalidValue if nothing moves the tip, something moves the frame, no tip is named and there are several, or
    `start` is no configuration.
    """
    start = np.array(as_row("start", start, len(world.robot.group)))  # type: ignore[arg-type]
    chain, task = task_of(world.robot, goal)
    solved, best = np.empty((0, len(start))), start
    spare = len(chain.moving) > _numbers(task)
    solver, free = "numeric", np.empty(0, dtype=np.bool_)
    for found, solver, best in stages(chain, task, start, exact=goal.is_exact):  # noqa: B007
        solved = distinct(chain, np.concatenate([solved, found]), _APART if spare else _SAME)
        free = world.valid(solved)
        if free.any():
            break
    if not len(solved):
        return Reached(solved, 0, 0, solver, best, _why_not(chain, task, goal, best, start))
    if not free.any():
        touching = Counter(world.explain(q) for q in solved)
        text = "; ".join(f"{why} in {times}" for why, times in touching.most_common(3))
        why = f"{goal} is reached, but only in collision: of {len(solved)} postures found {text}"
        return Reached(solved[:0], len(solved), len(solved), solver, solved[0], why)
    turned = _with_turns(chain, solved[free], start)
    return Reached(turned, len(solved), int((~free).sum()), solver, turned[0])


def task_of(robot: Robot, goal: PoseGoal) -> tuple[Chain, Floats]:
    """Return the chain of a goal's tip, and the goal in the frame of the root, for compiled code."""
    chain = chain_of(robot, goal.tip or default_tip(robot))
    pose = frame_pose(robot, goal.frame) @ goal.pose
    return chain, task(pose, goal.free_axis, goal.position_only, goal.position_tolerance, goal.angle_tolerance)


def task(
    pose: Pose,
    axis: tuple[float, ...] | None = None,
    position_only: bool = False,
    near: float = 0.0,
    tilt: float = 0.0,
) -> Floats:
    """Return a goal for compiled code."""
    from evenroad.robot.kernel import reach as at

    row = np.zeros(at.GOAL)
    row[:12] = *pose.rotation, *pose.xyz
    row[at.PLACED], row[at.TURNED], row[at.NEAR], row[at.TILT] = 1.0, at.ALL, near, tilt
    if position_only:
        row[at.TURNED] = at.NOT
    elif axis is not None:
        row[at.TURNED] = at.BY_AXIS
        row[at.AXIS : at.AXIS + 3], row[at.DIRECTION : at.DIRECTION + 3] = axis, pose.rotation_matrix @ axis
    return row


def stages(chain: Chain, task: Floats, start: Floats, *, exact: bool) -> Iterator[tuple[Floats, str, Floats]]:
    """Yield postures within limits that reach a task, (n, dim), their solver, and the nearest configuration: more and
    more.

    A posture stands for all configurations that differ by whole turns.  A closed form yields all at once.
    """
    robot = closed_form(chain) if exact else None
    if robot is not None:
        q = branches(chain, robot, task[:9], task[9:12])
        still = np.setdiff1d(np.arange(len(start)), chain.moving)
        q[:, still] = start[still]
        q = wrapped(chain, _polished(chain, task, q))
        q = q[((q >= chain.bounds[0]) & (q <= chain.bounds[1])).all(axis=1)]
        if len(q):
            yield distinct(chain, q, _SAME), "closed form", start
            return
        # A numeric solver may still find some at a singularity.
    for q, best in numeric(chain, task, start):
        yield q, "numeric", best


def numeric(chain: Chain, task: Floats, start: Floats, *, limits: bool = True) -> Iterator[tuple[Floats, Floats]]:
    """Yield postures found from even starts, (n, dim), and the nearest one: more and more."""
    from evenroad.robot.kernel import reach as kernel

    starts, tips = chain.even
    away = task[kernel.PLACED] * np.square(tips[:, 9:] - task[9:12]).sum(axis=1)
    if task[kernel.TURNED] == kernel.ALL:
        away += 0.25 * np.square(tips[:, :9] - task[:9]).sum(axis=1)
    elif task[kernel.TURNED] == kernel.BY_AXIS:
        axis = tips[:, :9].reshape(-1, 3, 3) @ task[kernel.AXIS : kernel.AXIS + 3]
        away += 0.5 * np.square(axis - task[kernel.DIRECTION : kernel.DIRECTION + 3]).sum(axis=1)
    nearest = np.argsort(away, kind="stable")
    still = np.setdiff1d(np.arange(len(start)), chain.moving)
    enough = _ENOUGH if len(chain.moving) > _numbers(task) else len(starts)
    best, least = start, math.inf
    # The start of the query first; then near ones and, where these fail, farther ones.
    for rows in (nearest[:STARTS], nearest[STARTS : 4 * STARTS], nearest[4 * STARTS :: 4]):
        q = np.concatenate([start[np.newaxis], starts[rows]])
        q[:, still] = start[still]
        missing = solved_from(chain, task, q, enough=enough, limits=limits)
        k = int(missing.argmin())
        if missing[k] < least:
            least, best = float(missing[k]), wrapped(chain, q[k : k + 1])[0]
        yield wrapped(chain, q[missing == 0.0]), best


def solved_from(
    chain: Chain, task: Floats, q: Floats, *, enough: int = 2**31, limits: bool = True, steps: int = _STEPS
) -> Floats:
    """Move configurations, (n, dim), in place, until they reach a task; return the squared errors, (n,)."""
    from evenroad.robot.kernel import reach as kernel

    none = np.full(q.shape[1], np.inf)
    low, high = (chain.low, chain.high) if limits else (-none, none)
    missing = np.full(len(q), np.inf)
    tables, bounds = (chain.ints, chain.rows), (low, high)
    kernel.solve(q, tables, bounds, task[np.newaxis], steps, enough, 0.0, missing)
    return missing


def followed_from(chain: Chain, tasks: Floats, q: Floats, longest: float, wraps: Bools) -> tuple[Floats, int]:
    """Return configurations, (n, dim), that reach one of `tasks`, (n, tasks), after the other, and their number.

    The first begins at `q`, (dim,), each at the one before, within limits unless a joint `wraps`; none steps farther
    than `longest`.
    """
    from evenroad.robot.kernel import reach as kernel

    low, high = np.where(wraps, [[-np.inf], [np.inf]], chain.bounds)
    waypoints, missing = np.repeat(q[np.newaxis], len(tasks), axis=0), np.empty(len(tasks))
    tables, bounds = (chain.ints, chain.rows), (low, high)
    return waypoints, kernel.solve(waypoints, tables, bounds, tasks, _STEPS, len(tasks) + 1, longest, missing)


def _numbers(task: Floats) -> int:
    """Return the number of numbers that a task fixes; those with a tolerance do not count."""
    from evenroad.robot.kernel import reach as at

    turned = 0 if task[at.TILT] else {at.NOT: 0, at.BY_AXIS: 2, at.ALL: 3}[int(task[at.TURNED])]
    return turned + (0 if task[at.NEAR] else int(3 * task[at.PLACED]))


def _polished(chain: Chain, task: Floats, q: Floats) -> Floats:
    """Return the configurations that reach a task after a few more steps; closed forms lose digits near
    singularities.
    """
    first = q.copy()
    missing = solved_from(chain, task, q, limits=False, steps=_POLISHED)
    return q[(missing < 1e-18) & (np.abs(q - first).max(axis=1, initial=0.0) < _COARSE)]


def wrapped(chain: Chain, q: Floats) -> Floats:
    """Return postures in the turn nearest to the middle of the limits, moved to a limit by at most 1e-9."""
    middle = 0.5 * chain.bounds.sum(axis=0)
    q = np.where(chain.turns, q - TURN * np.round((q - middle) / TURN), q)
    nearest = np.clip(q, *chain.bounds)
    return np.where(np.abs(q - nearest) <= 1e-9, nearest, q)


def distinct(chain: Chain, q: Floats, apart: float) -> Floats:
    """Return postures of which no two are nearer than `apart`, modulo turns; the first of each stays."""
    kept: list[Floats] = []
    for row in q:
        if kept:
            gap = np.abs(np.array(kept) - row)
            gap = np.where(chain.turns, np.minimum(gap, np.abs(TURN - gap)), gap)
            if gap.max(axis=1).min() < apart:
                continue
        kept.append(row)
    return np.array(kept).reshape(-1, q.shape[1])


def _with_turns(chain: Chain, q: Floats, start: Floats) -> Floats:
    """Return postures in all turns that are within limits, the nearest to the start first, at most `MOST`.

    Of every posture the nearest is there.
    """
    low, high = chain.bounds
    wide = chain.turns & (high - low >= TURN)
    nearest = np.where(wide, q - TURN * np.round((q - start) / TURN), q)
    # A turn back where that is beyond a limit, which rounding alone does not reach.
    for _ in range(2):
        nearest -= np.where(wide, TURN * (nearest > high + 1e-9), 0.0)
        nearest += np.where(wide, TURN * (nearest < low - 1e-9), 0.0)
    other = nearest + np.where(nearest > start, -TURN, TURN)
    other = np.where(wide & (other >= low - 1e-9) & (other <= high + 1e-9), other, nearest)
    two = np.flatnonzero((other != nearest).any(axis=0))[:_MOST_TURNING]
    takes = np.zeros((2 ** len(two), len(start)), dtype=np.bool_)
    takes[:, two] = np.arange(len(takes))[:, np.newaxis] >> np.arange(len(two)) & 1
    every = np.where(takes, other[:, np.newaxis], nearest[:, np.newaxis])
    # The same once more is the other choice of a joint that has none.
    doubled = (takes & (other == nearest)[:, np.newaxis]).any(axis=2)
    far = np.linalg.norm(every - start, axis=2) + np.where(doubled, np.inf, 0.0)
    kept = np.argsort(far, axis=None, kind="stable")[:MOST]
    kept = kept[np.isfinite(far.ravel()[kept])]
    first = np.arange(len(q)) * len(takes)
    kept = np.concatenate([kept, np.setdiff1d(first, kept)])
    rows = np.clip(every.reshape(-1, len(start))[kept], low, high)
    return rows[np.argsort(far.ravel()[kept], kind="stable")]


def _why_not(chain: Chain, task: Floats, goal: PoseGoal, best: Floats, start: Floats) -> str:
    """Return, in words, why no configuration reaches a task: out of reach, limits, or unknown."""
    point, far = chain.reach()
    distance = math.dist(task[9:12], point)
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
    near, tilt = misses(chain, task, best)
    return (
        f"no configuration was found for {goal}, and none may exist: the nearest that was tried"
        f" is {1e3 * near:.3g} mm and {math.degrees(tilt):.3g} deg off"
    )


def misses(chain: Chain, task: Floats, q: Floats) -> tuple[float, float]:
    """Return the deviations of a configuration, (dim,), from the position [m] and rotation [rad] of a task."""
    from evenroad.robot.kernel import reach as at

    tip = chain.tip_poses(q[np.newaxis])[0]
    near = math.dist(tip[9:], task[9:12]) if task[at.PLACED] else 0.0
    turn = tip[:9].reshape(3, 3)
    if task[at.TURNED] == at.BY_AXIS:
        axis, wanted = turn @ task[at.AXIS : at.AXIS + 3], task[at.DIRECTION : at.DIRECTION + 3]
        return near, math.atan2(float(np.linalg.norm(np.cross(axis, wanted))), float(axis @ wanted))
    if task[at.TURNED] == at.NOT:
        return near, 0.0
    between = task[:9].reshape(3, 3) @ turn.T
    sine = 0.5 * np.linalg.norm(
        [between[2, 1] - between[1, 2], between[0, 2] - between[2, 0], between[1, 0] - between[0, 1]]
    )
    return near, math.atan2(float(sine), 0.5 * (float(np.trace(between)) - 1.0))
