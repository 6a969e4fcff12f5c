"""Proofs that an arm cannot get from one configuration to another: its first links alone cannot.

The first joints move the first links, whatever the others do.  Their ranges are cut into cells.  A cell is blocked
throughout where its middle is, with capsules thinner by what half a cell can move them, and by how much the spheres of
the check may be thicker.  If start and goal lie in two pieces of what is left, there is no path.  Contacts of links
with each other are left out, which only makes more of it free.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy.ndimage import label

from evenroad._arrays import Bools, Floats
from evenroad.robot.kernel.placed_capsules import LARGEST_EXCESS
from evenroad.robot.known_robots import prepared
from evenroad.robot.robot import Robot, with_group
from evenroad.space import JointSpace

TRIES = (
    (2, (np.inf, np.inf), 60_000),
    (3, (np.inf, np.inf, np.inf), 500_000),
    (3, (0.35, 0.35, np.inf), 500_000),
)
"""How many of the first joints are looked at, how far cells reach from an end along each [rad or m], how many cells.
Together they take a tenth of a second."""

SLACK = 1e-4
"""More than a verdict of single precision can be wrong by [m]."""

_SLOWEST = 0.05
"""Joints that move the links less than this are cut no coarser [m/rad]."""

InScene = Callable[[Robot], Callable[[Floats], Bools]]
"""Says of a robot which of its configurations, (n, dim), are free in the scene that is asked about: (n,)."""


def locked_by(in_scene: InScene, robot: Robot, a: Floats, b: Floats) -> int:
    """Return by how many of a robot's first joints it is proved that no path joins two free places; 0: by none."""
    for joints, reach, cells in TRIES:
        if joints <= len(robot.group):
            # A grid around the one end may show what one around the other does not.
            ends = ((a, b), (b, a)) if np.isfinite(reach).any() else ((a, b),)
            if any(is_locked(in_scene, robot, *each, reach, cells) for each in ends):
                return joints
    return 0


def is_locked(
    in_scene: InScene, robot: Robot, a: Floats, b: Floats, reach: tuple[float, ...], cells: int
) -> bool:
    """Return whether the first joints, as many as `reach` has, show that no path joins two free places.

    So many cells lie around `a`; `reach` says how far they go along each joint, to its limits at most.
    """
    first = first_links(robot, len(reach))
    if not first.capsules:
        return False
    space, speeds = prepared(first).space, prepared(first).tables.speeds
    low, high, end = _window(space, a[: len(reach)], np.array(reach))
    # Half a cell along any joint moves the links by about as much, the finer the better.
    fastest = np.maximum(speeds.max(axis=0), _SLOWEST) * (high - low)
    count = np.ceil(fastest * (cells / np.prod(fastest)) ** (1 / len(reach))).astype(int)
    count = np.maximum(count, 2)
    size = (high - low) / count
    thin = thinner(first, 0.5 * size)
    if not thin.capsules:
        return False
    pieces, _ = label(_free_cells(in_scene(thin), low, size, count))
    number = pieces[_cell(end, low, size, count)]
    if number == 0:
        # The end would be blocked: it is not as free as was said.
        return False
    piece = pieces == number
    other = np.array(b[: len(reach)])
    period = space.flat.period
    wraps = np.isfinite(period)
    other[wraps] = low[wraps] + np.mod(other[wraps] - low[wraps], period[wraps])
    if ((low <= other) & (other <= high)).all() and piece[_cell(other, low, size, count)]:
        return False
    # It must not leave by a side of the cells that is no limit of a joint.
    for k in range(len(reach)):
        sides = np.moveaxis(piece, k, 0)[[0, -1]].reshape(2, -1).any(axis=1)
        if (sides[0] and (wraps[k] or low[k] > space.low[k])) or (
            sides[1] and (wraps[k] or high[k] < space.high[k])
        ):
            return False
    return True


def first_links(robot: Robot, joints: int) -> Robot:
    """Return the robot with what its first joints alone move: the others are held, the bodies behind them are gone."""
    moved = set(robot.group[joints:])
    while (
        following := {each.name for each in robot.joints if each.mimic and each.mimic.joint in moved} - moved
    ):
        moved |= following
    behind: set[str] = set()
    for joint in robot.joints:
        if joint.parent in behind or joint.name in moved:
            behind.add(joint.child)
    capsules = tuple(capsule for capsule in robot.capsules if capsule.link not in behind)
    held = with_group(robot, robot.group[:joints], robot.held)
    return replace(held, capsules=capsules, pairs=(), hulls=(), resting=())


def thinner(robot: Robot, half: Floats) -> Robot:
    """Return the robot with capsules so thin that where one touches, it does throughout the cell; some vanish.

    `half`, (dim,), are half the sides of a cell [rad or m].
    """
    kept = []
    for capsule in robot.capsules:
        speeds = prepared(replace(robot, capsules=(capsule,))).tables.speeds
        radius = (capsule.radius - float((speeds @ half)[0]) - SLACK) / LARGEST_EXCESS
        kept += [replace(capsule, radius=radius)] if radius > 0.0 else []
    return replace(robot, capsules=tuple(kept))


def _window(space: JointSpace, end: Floats, reach: Floats) -> tuple[Floats, Floats, Floats]:
    """Return lowest and highest values of the cells, and the end among them; around it where a joint wraps."""
    low, high, period = np.array(space.low), np.array(space.high), space.flat.period
    reach = np.minimum(reach, 0.5 * period)
    low = np.where(np.isfinite(period), end - reach, np.maximum(low, end - reach))
    high = np.where(np.isfinite(period), end + reach, np.minimum(high, end + reach))
    return low, high, end


def _cell(place: Floats, low: Floats, size: Floats, count: npt.NDArray[np.int64]) -> tuple[int, ...]:
    return tuple(np.clip(np.floor((place - low) / size).astype(int), 0, count - 1).tolist())


def _free_cells(
    valid: Callable[[Floats], Bools], low: Floats, size: Floats, count: npt.NDArray[np.int64]
) -> Bools:
    middles = [low[k] + size[k] * (np.arange(count[k]) + 0.5) for k in range(len(count))]
    free = np.empty(count, dtype=bool)
    for i, first in enumerate(middles[0]):
        rest = np.stack(np.meshgrid([first], *middles[1:], indexing="ij"), axis=-1).reshape(-1, len(count))
        free[i] = valid(rest).reshape(free.shape[1:])
    return free
