"""The sequence of proofs that there is no path, and their messages about bodies, joints and the query."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad._shared import recent
from evenroad._time_limit import look_at_clock
from evenroad.infeasibility.adaptive_cells import search_cells
from evenroad.infeasibility.blocking_values import pieces_between_walls
from evenroad.infeasibility.prefix_cells import BEYOND, Bodies, Piece, piece_of
from evenroad.poses.chain import Chain
from evenroad.poses.inverse_kinematics import task_of
from evenroad.poses.pose_goal import PoseGoal
from evenroad.poses.pose_task import PoseTask
from evenroad.robots.robot import Robot
from evenroad.world.protocol import Apart

ONE = (1, (np.inf,), 2_000)
QUICK = (ONE, (2, (np.inf, np.inf), 20_000))
"""Tries of a quick proof, some milliseconds together.  Each has a number of leading joints, the extent of the cells
along each from the start or a goal [rad or m], and the number of cells."""
THOROUGH = (
    ONE,
    (2, (np.inf, np.inf), 60_000),
    (3, (np.inf, np.inf, np.inf), 500_000),
    (3, (0.35, 0.35, np.inf), 500_000),
)
"""Tries of a full proof, tenths of a second together."""

SPLIT, QUICK_SPLIT, MOST_SPLIT = 2, 200_000, 1_000_000
"""`SPLIT`: number of leading joints also tried with adaptive cells, since some passages are closed by millimetres.
`QUICK_SPLIT`, `MOST_SPLIT`: largest number of cells of the quick and the full proof."""

MOST_GOALS = 4
"""Largest number of goals around which cells are also tried. They may prove what cells around the start cannot."""

_NEAR = 1e-3
"""Distance by which a posture may miss its pose and still reach it [m]."""

PROVED = "proved: there is no path"

Task = tuple[Chain, PoseTask]
"""A pose goal in the form of inverse kinematics."""

Tries = Sequence[tuple[int, tuple[float, ...], int]]


class InScene(Protocol):
    """The parts of an arm's world that proofs use."""

    @property
    def robot(self) -> Robot: ...  # noqa: D102

    @property
    def margin(self) -> float: ...  # noqa: D102

    @property
    def clearance(self) -> float: ...  # noqa: D102

    def with_bodies(self, robot: Robot, spare: float = 0.0) -> Callable[[Floats], Bools]:
        """Return a check of configurations, (n, dim), for a robot with other bodies, obstacles smaller by `spare`."""


def apart(
    world: InScene,
    start: Floats,
    goals: Floats,
    poses: Sequence[PoseGoal] = (),
    *,
    quickly: bool = False,
    whole: bool = True,
) -> Apart | None:
    """Return the reason why no path leads from a start, (dim,), to any of the goals, (g, dim), or None.

    It is `proved` if it holds for bodies inside the robot's true shapes and for all postures that reach the `poses`.
    The goals are given postures, and those found for the poses; they are `whole` if there can be no others.
    """
    robot, (tries, split) = world.robot, (QUICK, QUICK_SPLIT) if quickly else (THOROUGH, MOST_SPLIT)
    tasks = [task_of(robot, goal) for goal in poses]
    bodies, others = outer_bodies(world), False
    names: tuple[str, ...] = ()
    if robot.inner is not None:
        names, others = shown_by(inner_bodies(world), start, goals, tasks, tries, split)
    truly = bool(names) or robot.inner is None
    if not names and not robot.shapes:
        names, others = shown_by(bodies, start, goals, tasks, tries, split)
    if not names:
        return None
    alone = (
        f"joint {names[0]} alone cannot get there, whatever the others do"
        if len(names) == 1
        else f"joints {', '.join(names)} alone cannot get there, whatever the others do"
    )
    if not truly:
        message = (
            f"no path is found for the capsules that stand for the robot's shapes: {alone}; of the shapes themselves"
            " that is not proved"
        )
        return Apart(message, proved=False)
    of = "the robot's capsules" if robot.inner is None else "bodies inside of the robot's shapes"
    of += f", {world.clearance:g} m from obstacles" if world.clearance else ""
    if others or not whole:
        found = "the posture found cannot" if len(goals) == 1 else f"none of the {len(goals)} postures found can"
        return Apart(f"{found} be reached: {alone} (shown for {of}); others may be", proved=False)
    return Apart(f"{PROVED}: {alone} (shown for {of})", proved=True)


def inner_bodies(world: InScene) -> Bodies:
    """Return bodies inside the robot's true shapes, and these shapes."""
    robot = world.robot
    return Bodies(_inner_robot(robot, _held(robot)), world.with_bodies, world.margin, robot)


def outer_bodies(world: InScene) -> Bodies:
    """Return the bodies of planning, without the pairs that hulls decide."""
    robot = world.robot
    return Bodies(_outer_robot(robot, _held(robot)), world.with_bodies, world.margin)


def _held(robot: Robot) -> tuple[tuple[str, float], ...]:
    """Return the values of joints outside the group, the only part of a robot that can change, as a key."""
    return tuple(sorted(robot.held.items()))


@recent()
def _inner_robot(robot: Robot, held: tuple[tuple[str, float], ...]) -> Robot:
    return replace(robot, held=dict(held), capsules=robot.inner or (), inner=None, shapes=())


@recent()
def _outer_robot(robot: Robot, held: tuple[tuple[str, float], ...]) -> Robot:
    sharp = {hull.link for hull in robot.hulls if not hull.is_round}
    pairs = tuple(pair for pair in robot.pairs if sharp.isdisjoint(pair))
    return replace(robot, held=dict(held), pairs=pairs)


def shown_by(
    bodies: Bodies, start: Floats, goals: Floats, tasks: Sequence[Task], tries: Tries, split: int = MOST_SPLIT
) -> tuple[tuple[str, ...], bool]:
    """Return the joints that cannot reach any goal, if that is shown, and whether other postures of poses may.

    Walls come first: each shows that a single joint cannot pass.
    """
    group = bodies.robot.group
    used, shown = dict[str, None](), tuple[str, ...]()
    unreached, undecided = list(goals), list(tasks)
    for k, enclosure in pieces_between_walls(bodies.robot, start):
        before = len(unreached) + len(undecided)
        unreached = [goal for goal in unreached if enclosure.holds(goal)]
        undecided = [task for task in undecided if not is_beyond(enclosure, *task)]
        if len(unreached) + len(undecided) < before:
            used[group[k]] = None
    if used and not unreached:
        shown = tuple(used)
        if not undecided:
            return shown, False
    for joints, reach, cells in tries:
        if joints > len(group):
            break
        look_at_clock()
        ended = search_cells(bodies, start, np.array(unreached), joints, split) if joints == SPLIT and unreached else ""
        if ended == "apart":
            unreached = []
        # Where clear cells lead to a goal, equal cells prove nothing either.
        is_open = ended == "joined" and len(unreached) == 1
        piece = piece_of(bodies, start, reach, cells) if (unreached and not is_open) or undecided else None
        if piece is not None:
            unreached = [goal for goal in unreached if piece.holds(goal)]
            undecided = [task for task in undecided if not is_beyond(piece, *task)]
        if np.isfinite(reach).any() and len(unreached) <= MOST_GOALS:
            unreached = [goal for goal in unreached if not _is_walled(bodies, goal, start, reach, cells)]
        if not unreached:
            names = tuple(dict.fromkeys((*group[:joints], *used)))
            if not undecided:
                return names, False
            shown = shown or names
    return shown, bool(undecided)


def _is_walled(bodies: Bodies, goal: Floats, start: Floats, reach: tuple[float, ...], cells: int) -> bool:
    piece = piece_of(bodies, goal, reach, cells)
    return piece is not None and not piece.holds(start)


def is_beyond(piece: Piece, chain: Chain, task: PoseTask) -> bool:
    """Return whether no posture in a piece brings a tip to a pose, for all values of the other joints.

    The first joints place the next one's axis.  From there the tip is at most as far as the sum of the links' lengths,
    and at least as far as one of them is longer than all others together.
    """
    known, coordinates = len(piece.cells.count), chain.coordinates.tolist()
    first_free = next((i for i, coordinate in enumerate(coordinates) if coordinate >= known), len(coordinates))
    bars, target = np.linalg.norm(chain.rows[first_free + 1 :, 9:12], axis=1).tolist(), np.array(task.pose.xyz)
    if bars and task.turns_fully and task.angle_tolerance == 0.0:
        # The pose of the last joint is known, too.
        turn = task.pose.rotation_matrix @ chain.rows[-1, :9].reshape(3, 3).T
        target, bars = target - turn @ chain.rows[-1, 9:12], bars[:-1]
    slides = _slides(chain)
    most = sum(bars) + sum(slides[first_free:])
    least = max([0.0, *(2.0 * bar - most for bar in bars)])
    away, moved = _distances(piece, chain, first_free, target, slides)
    near = _NEAR + task.position_tolerance
    return bool(((away - moved > most + near) | (away + moved < least - near)).all())


def _slides(chain: Chain) -> list[float]:
    """Return the largest slide of each frame; 0 for a frame that turns [m]."""
    lengths = []
    for coordinate, slides, row in zip(chain.coordinates, chain.slides, chain.rows, strict=False):
        (low, high), (multiplier, offset) = chain.bounds[:, coordinate] + (-BEYOND, BEYOND), row[12:]
        extremes = abs(multiplier * low + offset), abs(multiplier * high + offset)
        lengths.append(float(max(extremes)) if slides else 0.0)
    return lengths


def _distances(
    piece: Piece, chain: Chain, first_free: int, target: Floats, slides: list[float]
) -> tuple[Floats, float]:
    """Return distances of a frame's origin from a point, (n,), in the cells' middles, and its motion in half a cell."""
    cells, rows, coordinates = piece.cells, chain.rows, chain.coordinates
    where = np.nonzero(piece.reached)
    q = np.stack([cells.middles[k][row] for k, row in enumerate(where)], axis=1)
    rotation, origin = np.broadcast_to(np.eye(3), (len(q), 3, 3)), np.zeros((len(q), 3))
    for i in range(first_free):
        origin = origin + rotation @ rows[i, 9:12]
        rotation = rotation @ rows[i, :9].reshape(3, 3)
        value = rows[i, 12] * q[:, coordinates[i]] + rows[i, 13]
        if chain.slides[i]:
            origin = origin + rotation[:, :, 2] * value[:, np.newaxis]
            continue
        cosine, sine, zero = np.cos(value), np.sin(value), np.zeros_like(value)
        turn = np.stack([cosine, -sine, zero, sine, cosine, zero, zero, zero, zero + 1.0], axis=1)
        rotation = rotation @ turn.reshape(-1, 3, 3)
    origin = origin + rotation @ rows[first_free, 9:12]
    straight, moved = float(np.linalg.norm(rows[first_free, 9:12])), 0.0
    for i in range(first_free - 1, -1, -1):
        half = 0.5 * float(cells.size[coordinates[i]]) * abs(float(rows[i, 12]))
        moved += half * (1.0 if chain.slides[i] else straight)
        straight += float(np.linalg.norm(rows[i, 9:12])) + slides[i]
    return np.linalg.norm(origin - target, axis=1), moved
