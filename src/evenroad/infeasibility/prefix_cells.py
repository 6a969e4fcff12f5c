"""Infeasibility proofs for arms: the first joints alone cannot pass from start to goal.

The first joints move the first links, for any values of the others.  Their ranges are divided into cells.  A cell is
blocked if its middle is blocked for thinner bodies.  These are thinner by their movement within half a cell, and by the
excess of the check's spheres.  The other cells form components, and no path leaves the component that it starts in.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats
from evenroad._native.infeasibility import reached_cells
from evenroad._shared import recent
from evenroad._time_limit import look_at_clock
from evenroad.collision.native_robot import shape_speeds
from evenroad.collision.placed_capsules import LARGEST_EXCESS, place_capsule, speed_bounds
from evenroad.collision.prepared_robots import joint_space
from evenroad.robots.moving_tree import moving_tree
from evenroad.robots.robot import Robot

SLACK = 1e-4
"""Extra shrinkage of bodies, besides four times the error of single precision [m]."""
OF_SHAPES = 4e-4
"""Extra shrinkage of obstacles when true shapes are tested [m]: four times the largest growth of convex meshes by
removed corners."""
FARTHEST = 0.5
"""Largest movement of shapes within half a cell of a cell that may count as clear [m]."""
BEYOND = 1e-4
"""Distance of cells beyond the limits of joints, because rounding may put a configuration there [rad or m]."""
_SLOWEST = 0.05
"""Smallest speed of links for the choice of the cells' size [m/rad]."""
_AT_ONCE = 16_384
"""Number of cells that are checked together."""


@dataclass(frozen=True, eq=False)
class Bodies:
    """A robot whose `capsules` are tested in a scene, and the largest error of these checks, >= 0 [m].

    `in_scene` returns which configurations, (n, dim), of such a robot are free there: (n,).  Its second argument is
    the distance by which obstacles are smaller [m].  `shapes` are true shapes of the links, and capsules around them.
    """

    robot: Robot
    in_scene: Callable[..., Callable[[Floats], Bools]]
    margin: float
    shapes: Robot | None = None


@dataclass(frozen=True, eq=False)
class Cells:
    """Equal cells of the ranges of some joints: lower ends, upper ends and numbers along each [rad or m].

    `period` is inf for a joint that does not wrap.
    """

    low: Floats
    high: Floats
    count: npt.NDArray[np.int64]
    period: Floats

    @property
    def size(self) -> Floats:
        """Sides of a cell [rad or m]."""
        return (self.high - self.low) / self.count

    @property
    def whole(self) -> Bools:
        """Which wrapping joints have cells all around the circle."""
        return self.high - self.low >= self.period * (1.0 - 1e-12)

    @property
    def middles(self) -> list[Floats]:
        """Middles of the cells along each joint."""
        axes = zip(self.low, self.size, self.count, strict=True)
        return [low + size * (np.arange(count) + 0.5) for low, size, count in axes]

    def cell(self, q: Floats) -> tuple[int, ...] | None:
        """Return the cell that contains values, (joints,), or None."""
        q = np.where(np.isfinite(self.period), self.low + np.mod(q - self.low, self.period), q)
        number = np.floor((q - self.low) / self.size).astype(int)
        # Rounding must not put values on the boundary outside.
        inside = (number >= -1) & (number <= self.count)
        return tuple(np.clip(number, 0, self.count - 1).tolist()) if inside.all() else None


@dataclass(frozen=True, eq=False)
class Piece:
    """All cells of a robot's first joints that a path from its start may reach."""

    cells: Cells
    reached: Bools

    def holds(self, q: Floats) -> bool:
        """Return whether a configuration, (dim,), is in one of them."""
        cell = self.cells.cell(q[: len(self.cells.count)])
        return cell is not None and bool(self.reached[cell])


def piece_of(bodies: Bodies, configuration: Floats, reach: tuple[float, ...], most: int) -> Piece | None:
    """Return the cells of the first `len(reach)` joints that a path from a free configuration, (dim,), cannot leave.

    About `most` cells lie around it.  `reach` is their extent along each joint, at most to its limits [rad or m].  The
    result is None if nothing is proved: bodies may be too thin for such cells, or a path may leave them all.
    """
    first = first_links(bodies.robot, len(reach))
    if not first.capsules:
        return None
    cells = cells_around(first, configuration[: len(reach)], np.array(reach), most)
    if bodies.shapes is None and not thinner(first, 0.5 * cells.size, SLACK + 4.0 * bodies.margin).capsules:
        return None
    free, cell = _free_cells(bodies, first, cells), cells.cell(configuration[: len(reach)])
    # A configuration in a blocked cell, or in none, contradicts the check.
    if cell is None or not free[cell]:
        return None
    at = int(np.ravel_multi_index(cell, free.shape))
    reached: Bools = reached_cells(free.ravel(), cells.count, cells.whole, at).reshape(free.shape)
    space = joint_space(first)
    open_below = np.where(np.isfinite(cells.period), ~cells.whole, cells.low > space.low)
    open_above = np.where(np.isfinite(cells.period), ~cells.whole, cells.high < space.high)
    for k in range(len(reach)):
        # A component must not reach a side of the cells that is not a limit of a joint.
        below, above = reached.take(0, axis=k).any(), reached.take(-1, axis=k).any()
        if (below and open_below[k]) or (above and open_above[k]):
            return None
    return Piece(cells, reached)


@recent()
def first_links(robot: Robot, joints: int) -> Robot:
    """Return the robot with the bodies that its first joints move: other joints are held, later bodies are removed.

    Its limits are a little wider, so that no cell is blocked because it reaches beyond them.
    """
    moved = set(robot.group[joints:])
    while following := {each.name for each in robot.joints if each.mimic and each.mimic.joint in moved} - moved:
        moved |= following
    behind: set[str] = set()
    for joint in robot.joints:
        if joint.parent in behind or joint.name in moved:
            behind.add(joint.child)
    group = robot.group[:joints]
    return replace(
        robot,
        joints=tuple(
            replace(joint, lower=joint.lower - BEYOND, upper=joint.upper + BEYOND) if joint.name in group else joint
            for joint in robot.joints
        ),
        capsules=tuple(capsule for capsule in robot.capsules if capsule.link not in behind),
        pairs=tuple(pair for pair in robot.pairs if behind.isdisjoint(pair)),
        group=group,
        planes=(),
        hulls=(),
        resting=(),
        inner=None,
        shapes=(),
    )


def thinner(robot: Robot, half: Floats, slack: float) -> Robot:
    """Return the robot with bodies so thin that a contact in the middle of a cell implies one throughout; some vanish.

    `half`, (dim,), are half the sides of a cell [rad or m].
    """
    return _thinner(robot, tuple((_speeds(robot) @ half).tolist()), slack)


@recent()
def _thinner(robot: Robot, moved: tuple[float, ...], slack: float) -> Robot:
    """Return the robot with bodies thinner by the movement of each capsule, and by a slack [m]."""
    kept = []
    for capsule, far in zip(robot.capsules, moved, strict=True):
        radius = capsule.radius - far - slack
        # Spheres that cover a capsule are larger than it, unless it is a sphere.
        radius /= 1.0 if capsule.a == capsule.b else LARGEST_EXCESS
        kept += [replace(capsule, radius=radius)] if radius > 0.0 else []
    return replace(robot, capsules=tuple(kept))


@recent()
def _thicker(robot: Robot, moved: tuple[float, ...]) -> Robot:
    """Return the robot with bodies thicker by the movement of each capsule [m]."""
    thick = [replace(capsule, radius=capsule.radius + far) for capsule, far in zip(robot.capsules, moved, strict=True)]
    return replace(robot, capsules=tuple(thick))


@recent()
def _speeds(robot: Robot) -> Floats:
    """Return the largest speeds at which joints move the segments of capsules, (capsules, dim) [m/rad or m/m]."""
    tree = moving_tree(robot)
    return speed_bounds(tree, [place_capsule(capsule, tree) for capsule in robot.capsules], [], robot)[0]


@recent()
def _moving_links(first: Robot, true: Robot) -> list[tuple[Robot, Floats]]:
    """Return, for each moving link with true shapes, a robot of it alone, and the speeds at which joints move it."""
    links, tree = [], moving_tree(first)
    for link in dict.fromkeys(capsule.link for capsule in first.capsules):
        capsules, inner, shapes = (
            tuple(each for each in true.capsules if each.link == link),
            tuple(each for each in true.inner or () if each.link == link),
            tuple(each for each in true.shapes if each.link == link),
        )
        robot = replace(first, pairs=(), padding=(), capsules=capsules, inner=inner, shapes=shapes)
        speeds = shape_speeds(robot, tree, {link: 0})[0]
        if shapes and speeds.any():
            links.append((robot, speeds))
    return links


class CellTests:
    """Tests of cells of a robot's `first` links: which cells are blocked throughout, and which are free throughout.

    Capsules are thinner by their movement within half a cell.  True shapes are not changed; instead, obstacles are
    smaller by that movement, so that a common point remains one throughout the cell.
    """

    def __init__(self, bodies: Bodies, first: Robot) -> None:
        self._bodies, self._first, self._slack = bodies, first, SLACK + 4.0 * bodies.margin
        self._links = _moving_links(first, bodies.shapes) if bodies.shapes else []

    def unblocked(self, half: Floats, middles: Floats) -> Bools:
        """Return which cells, of these middles, (n, dim), and half sides, (dim,), are not blocked throughout."""
        free, thin = np.ones(len(middles), dtype=np.bool_), thinner(self._first, half, self._slack)
        if thin.capsules:
            free &= self._bodies.in_scene(thin)(middles)
        for robot, speeds in self._links:
            far = float(speeds @ half) + self._slack + OF_SHAPES
            free[free] = self._bodies.in_scene(robot, far)(middles[free])
        return free

    def clear(self, half: Floats, middles: Floats) -> Bools:
        """Return which cells seem free throughout, with obstacles only, or for capsules if there are no true shapes.

        No proof relies on the result.
        """
        if not self._links:
            thick = _thicker(self._first, tuple((_speeds(self._first) @ half).tolist()))
            return self._bodies.in_scene(thick)(middles)
        free = np.ones(len(middles), dtype=np.bool_)
        for robot, speeds in self._links:
            far = float(speeds @ half)
            free[free] = far < FARTHEST and self._bodies.in_scene(robot, -far)(middles[free])
        return free


def cells_around(first: Robot, configuration: Floats, reach: Floats, most: int) -> Cells:
    """Return about `most` cells around a configuration; for a joint that wraps, at most the whole circle."""
    space = joint_space(first)
    period = space.flat.period
    reach = np.minimum(reach, 0.5 * period)
    wraps = np.isfinite(period)
    low = np.where(wraps, configuration - reach, np.maximum(space.low, configuration - reach))
    high = np.where(wraps, configuration + reach, np.minimum(space.high, configuration + reach))
    speeds = _speeds(first).max(axis=0)
    # Half a cell along any joint moves the links by about the same distance; more cells reduce it.
    lengths = np.maximum(speeds, _SLOWEST) * (high - low)
    count = np.ceil(lengths * (most / np.prod(lengths)) ** (1 / len(reach))).astype(int)
    count = np.maximum(count, 2)
    return Cells(low, high, count, period)


def _free_cells(bodies: Bodies, first: Robot, cells: Cells) -> Bools:
    middles, shape, tests = cells.middles, tuple(cells.count.tolist()), CellTests(bodies, first)
    free = np.empty(int(np.prod(shape)), dtype=bool)
    for begin in range(0, len(free), _AT_ONCE):
        rows = np.unravel_index(np.arange(begin, min(begin + _AT_ONCE, len(free))), shape)
        q = np.stack([middles[k][row] for k, row in enumerate(rows)], axis=1)
        look_at_clock()
        free[begin : begin + _AT_ONCE] = tests.unblocked(0.5 * cells.size, q)
    return free.reshape(shape)
