"""ArmTables: a robot's tables with the rows of a scene's obstacles behind them; compiled, since scenes change often."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.errors import InvalidValue, UnknownName
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.layout import inner
from evenroad.robot.kernel.placed_capsules import FARTHEST
from evenroad.robot.kernel.robot_tables import PADDING, RobotTables
from evenroad.robot.scene import Obstacle, Scene

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]

OBSTACLE_PADDING = 2.5e-7
"""Single precision makes an obstacle uncertain by less than this share of its farthest point's distance from the
origin."""

BOX, SPHERE, CYLINDER, CAPSULE = range(4)
"""Kinds of obstacles in `ObstacleArrays`."""

_KINDS = {"box": (BOX, 3), "sphere": (SPHERE, 1), "cylinder": (CYLINDER, 2), "capsule": (CAPSULE, 2)}
"""Shape -> kind, and how many sizes it has."""

_SOUND, _BAD_SIZE, _BAD_PLACE, _NO_ROTATION, _TOO_FAR = range(5)

_NEVER_HIT = -1e30
"""Half extent that fills unused places of a block of obstacles."""


@dataclass(frozen=True, eq=False)
class ObstacleArrays:
    """Obstacles as compiled code takes them.

    Attributes
    ----------
    kinds : int64 ndarray, shape (n,)
        BOX, SPHERE, CYLINDER or CAPSULE.
    sizes : float64 ndarray, shape (n, 3)
        Full extents of a box; radius, or radius and length without the caps, and zeros [m].
    rotations : float64 ndarray, shape (n, 9)
        From the obstacle's frame to the root link's, row by row.
    translations : float64 ndarray, shape (n, 3)
        Centres in the frame of the root link [m].
    """

    kinds: Ints
    sizes: Floats
    rotations: Floats
    translations: Floats


@dataclass(frozen=True, eq=False)
class ArmTables:
    """What the compiled code reads of a robot in a scene; the order is that of ``layout.py``.

    Attributes
    ----------
    ints : int64 ndarray
        Header and integers.
    floats : float64 ndarray
        Robot and obstacles as they are.
    lanes : int64 ndarray
        For the lanes, in one piece: the integers, and behind them, as float32, robot and obstacles with larger radii,
        so that rounding never makes a verdict optimistic.
    margin : float
        A capsule and an obstacle nearer to each other than this may touch by `lanes` [m].
    kept : int64 ndarray
        Numbers of the obstacles that the robot can reach, in the order of the tables.
    fixed_contact : tuple of 2 int, or None
        A capsule that does not move and an obstacle, of all, that it touches.
    """

    ints: Ints
    floats: Floats
    lanes: Ints
    margin: float
    kept: Ints
    fixed_contact: tuple[int, int] | None


def obstacle_arrays(scene: Scene) -> ObstacleArrays:
    """Return the obstacles of a scene as arrays.

    Raises
    ------
    InvalidValue
        If an obstacle has a size that is not a finite number > 0, no finite place or no rotation, or is larger or
        farther than 1e6 m (boxes along the axes may be: they are cut off where the robot never comes).
    UnknownName
        If there is no such shape.
    """
    obstacles = scene.obstacles
    n = len(obstacles)
    kinds, sizes = np.empty(n, dtype=np.int64), []
    for i, obstacle in enumerate(obstacles):
        if obstacle.shape not in _KINDS:
            raise UnknownName.among("shape of an obstacle", obstacle.shape, _KINDS)
        kinds[i], wanted = _KINDS[obstacle.shape]
        if len(obstacle.size) != wanted:
            raise _unsound(obstacle, _BAD_SIZE)
        if len(obstacle.rotation) != 9 or len(obstacle.xyz) != 3:
            raise _unsound(obstacle, _BAD_PLACE)
        sizes.append((*obstacle.size, 0.0, 0.0)[:3])
    arrays = ObstacleArrays(
        kinds,
        np.array(sizes, dtype=np.float64).reshape(n, 3),
        np.array([obstacle.rotation for obstacle in obstacles], dtype=np.float64).reshape(n, 9),
        np.array([obstacle.xyz for obstacle in obstacles], dtype=np.float64).reshape(n, 3),
    )
    number, fault = _first_unsound(arrays.kinds, arrays.sizes, arrays.rotations, arrays.translations)
    if fault != _SOUND:
        raise _unsound(obstacles[number], fault)
    return arrays


def tested_contacts(robot: RobotTables, links: tuple[str, ...], scene: Scene) -> Bools:
    """Return which capsules of a robot of these links are tested against which obstacles: (capsules, obstacles).

    Raises
    ------
    UnknownName
        If an allowed contact names a link or an obstacle that is not there.
    """
    tested = np.ones((len(robot.capsules), len(scene.obstacles)), dtype=np.bool_)
    if scene.allowed:
        numbers = {obstacle.name: k for k, obstacle in enumerate(scene.obstacles)}
        for link, name in scene.allowed:
            if link not in links:
                raise UnknownName.among("link", link, links)
            if name not in numbers:
                raise UnknownName.among("obstacle", name, numbers)
            for i, capsule in enumerate(robot.capsules):
                if capsule.link == link:
                    tested[i, numbers[name]] = False
    return tested


def arm_tables(robot: RobotTables, obstacles: ObstacleArrays, tested: Bools) -> ArmTables:
    """Return a robot's tables with those of obstacles behind them.

    Parameters
    ----------
    robot : RobotTables
        Of the robot.
    obstacles : ObstacleArrays
        Sound ones, as `obstacle_arrays` makes them.
    tested : bool ndarray, shape (capsules, n)
        Which capsules are tested against which obstacles.
    """
    ints, floats, lanes, added, kept, capsule, obstacle = _pack(
        robot.ints,
        robot.floats,
        robot.singles,
        robot.reach,
        obstacles.kinds,
        obstacles.sizes,
        obstacles.rotations,
        obstacles.translations,
        tested,
    )
    for array in (ints, floats, lanes, kept):
        array.setflags(write=False)
    # Once for what is added, once more for what rounding may add to that.
    margin = 2.0 * (PADDING * max(1.0, robot.reach) + added)
    return ArmTables(ints, floats, lanes, margin, kept, None if capsule < 0 else (capsule, obstacle))


def _unsound(obstacle: Obstacle, fault: int) -> InvalidValue:
    """Return the error that says what is wrong with an obstacle."""
    what = f"obstacle {obstacle.name!r}"
    if fault == _BAD_SIZE:
        wanted = _KINDS[obstacle.shape][1]
        return InvalidValue(
            f"{what}, a {obstacle.shape}, must have {wanted} finite size(s) > 0, got {obstacle.size!r}"
        )
    if fault == _BAD_PLACE:
        return InvalidValue(f"{what} must have a finite place, got {obstacle!r}")
    if fault == _NO_ROTATION:
        return InvalidValue(f"{what} must have a rotation, got {obstacle.rotation!r}")
    return InvalidValue(
        f"{what} must be within {FARTHEST:g} m, got size {obstacle.size!r} at {obstacle.xyz!r}"
    )


@njit(cache=True, nogil=True)
def _first_unsound(kinds: Ints, sizes: Floats, rotations: Floats, translations: Floats) -> tuple[int, int]:
    """Return the first obstacle that is not sound, and its fault."""
    for k in range(len(kinds)):
        largest = 0.0
        for entry in range(_size_count(kinds[k])):
            if not 0.0 < sizes[k, entry] < np.inf:
                return k, _BAD_SIZE
            largest = max(largest, sizes[k, entry])
        if not (np.isfinite(rotations[k]).all() and np.isfinite(translations[k]).all()):
            return k, _BAD_PLACE
        for row in range(3):
            largest = max(largest, abs(translations[k, row]))
            for other in range(3):
                product = -1.0 if row == other else 0.0
                for entry in range(3):
                    product += rotations[k, 3 * row + entry] * rotations[k, 3 * other + entry]
                if abs(product) > 1e-6:
                    return k, _NO_ROTATION
        if largest > FARTHEST and not (kinds[k] == BOX and _is_straight(rotations[k])):
            return k, _TOO_FAR
    return -1, _SOUND


@inner
def _size_count(kind: int) -> int:
    if kind == BOX:
        return 3
    return 1 if kind == SPHERE else 2


@inner
def _is_straight(rotation: Floats) -> bool:
    """Return whether a rotation (9,) takes axes to axes, up to the rounding of sines of right angles."""
    return np.abs(rotation - np.rint(rotation)).max() < 1e-14


@inner
def _distance(point: Floats, kind: int, size: Floats, rotation: Floats, translation: Floats) -> float:
    """Return the distance of a point (3,) from an obstacle, 0 inside [m]."""
    local = np.zeros(3)
    for axis in range(3):
        for entry in range(3):
            local[axis] += rotation[3 * entry + axis] * (point[entry] - translation[entry])
    if kind == BOX:
        squared = 0.0
        for axis in range(3):
            squared += max(abs(local[axis]) - 0.5 * size[axis], 0.0) ** 2
        return math.sqrt(squared)
    aside = math.sqrt(local[0] ** 2 + local[1] ** 2)
    if kind == SPHERE:
        return max(math.sqrt(aside**2 + local[2] ** 2) - size[0], 0.0)
    above = max(abs(local[2]) - 0.5 * size[1], 0.0)
    if kind == CAPSULE:
        return max(math.sqrt(aside**2 + above**2) - size[0], 0.0)
    return math.sqrt(max(aside - size[0], 0.0) ** 2 + above**2)


@njit(cache=True, nogil=True)
def _pack(
    robot_ints: Ints,
    robot_floats: Floats,
    robot_singles: npt.NDArray[np.float32],
    reach: float,
    kinds: Ints,
    sizes: Floats,
    rotations: Floats,
    translations: Floats,
    tested: Bools,
) -> tuple[Ints, Floats, Ints, float, Ints, int, int]:
    """Return what `ArmTables` holds, and by how much the lanes' obstacles are larger at most [m]."""
    origin = np.zeros(3)
    kept = np.empty(len(kinds), dtype=np.int64)
    count = 0
    for k in range(len(kinds)):
        if _distance(origin, kinds[k], sizes[k], rotations[k], translations[k]) <= reach:
            kept[count] = k
            count += 1
    kept = kept[:count].copy()
    blocks = (count + at.LANES - 1) // at.LANES
    capsules = robot_ints[at.CAPSULES]
    first_int, first_float = len(robot_ints), len(robot_floats)
    block_floats = first_float + at.OBSTACLE_FLOAT_ROW * count
    length = first_int + count + capsules * blocks
    floats = np.empty(block_floats + at.BLOCK_FLOAT_ROW * blocks)
    floats[:first_float] = robot_floats
    lanes = np.zeros(length + (len(floats) + 1) // 2, dtype=np.int64)
    ints, singles = lanes[:length], lanes[length:].view(np.float32)
    ints[:first_int] = robot_ints
    singles[:first_float] = robot_singles
    ints[at.OBSTACLES], ints[at.BLOCKS] = count, blocks
    ints[at.OBSTACLE_INTS], ints[at.TESTED] = first_int, first_int + count
    ints[at.OBSTACLE_FLOATS], ints[at.BLOCK_FLOATS] = first_float, block_floats
    ints[at.INTEGERS] = length
    added = 0.0
    for row in range(count):
        k = kept[row]
        data = first_float + at.OBSTACLE_FLOAT_ROW * row
        ints[first_int + row] = _write_obstacle(
            floats[data : data + at.OBSTACLE_FLOAT_ROW],
            kinds[k],
            sizes[k],
            rotations[k],
            translations[k],
            reach,
        )
        box = block_floats + row // at.LANES * at.BLOCK_FLOAT_ROW + row % at.LANES
        padding = _write_bounds(floats, data, box, ints[first_int + row])
        for entry in range(at.OBSTACLE_FLOAT_ROW):
            singles[data + entry] = floats[data + entry]
        singles[data + 15] = floats[data + 15] + padding
        added = max(added, (floats[data + 15] + padding) - floats[data + 15])
        for axis in range(3):
            centre, half = box + axis * at.LANES, box + (3 + axis) * at.LANES
            singles[centre], singles[half] = floats[centre], floats[half] + padding
    for row in range(count, blocks * at.LANES):
        box = block_floats + row // at.LANES * at.BLOCK_FLOAT_ROW + row % at.LANES
        for axis in range(3):
            centre, half = box + axis * at.LANES, box + (3 + axis) * at.LANES
            floats[centre], floats[half] = 0.0, _NEVER_HIT
            singles[centre], singles[half] = 0.0, _NEVER_HIT
    for i in range(capsules):
        for row in range(count):
            if tested[i, kept[row]]:
                ints[first_int + count + i * blocks + row // at.LANES] |= 1 << (row % at.LANES)
    capsule, obstacle = _fixed_contact(
        robot_ints, robot_floats, kept, kinds, sizes, rotations, translations, tested
    )
    return ints.copy(), floats, lanes, added, kept, capsule, obstacle


@inner
def _write_obstacle(
    row: Floats, kind: int, size: Floats, rotation: Floats, translation: Floats, reach: float
) -> int:
    """Write all points within a rounding of a box, or a cylinder, and return the kind that the kernels know.

    A box along the axes loses what lies far beyond `reach`, where the robot never comes: a floor of a hundred metres
    would else cost digits, of which single precision has seven.
    """
    half = np.zeros(3)
    row[15] = 0.0
    if kind == BOX:
        half[:] = 0.5 * size
    elif kind == CYLINDER:
        half[:] = size[0], size[0], 0.5 * size[1]
    else:
        half[2] = 0.5 * size[1]
        row[15] = size[0]
    aligned = kind == SPHERE or (kind != CYLINDER and _is_straight(rotation))
    for axis in range(3):
        row[axis], row[3 + axis] = translation[axis], half[axis]
        for entry in range(3):
            row[6 + 3 * axis + entry] = rotation[3 * axis + entry]
    if not aligned:
        return at.CYLINDER if kind == CYLINDER else at.ROTATED
    for axis in range(3):
        extent = 0.0
        for entry in range(3):
            row[6 + 3 * axis + entry] = 1.0 if axis == entry else 0.0
            extent += abs(np.rint(rotation[3 * axis + entry])) * half[entry]
        row[3 + axis] = extent if kind != SPHERE else 0.0
        if kind == BOX:
            low = max(translation[axis] - extent, -2.0 * reach)
            high = min(translation[axis] + extent, 2.0 * reach)
            row[axis], row[3 + axis] = 0.5 * (low + high), 0.5 * (high - low)
    return at.ALIGNED


@inner
def _write_bounds(floats: Floats, data: int, box: int, kind: int) -> float:
    """Write the box around an obstacle whose row is at `data`, and return its padding in single precision [m]."""
    squared = 0.0
    for axis in range(3):
        extent = 0.0
        if kind == at.CYLINDER:
            upright = abs(floats[data + 6 + 3 * axis + 2])
            extent = upright * floats[data + 5] + math.sqrt(max(1.0 - upright**2, 0.0)) * floats[data + 3]
        else:
            for entry in range(3):
                extent += abs(floats[data + 6 + 3 * axis + entry]) * floats[data + 3 + entry]
            extent += floats[data + 15]
        floats[box + axis * at.LANES] = floats[data + axis]
        floats[box + (3 + axis) * at.LANES] = extent
        squared += (abs(floats[data + axis]) + extent) ** 2
    return OBSTACLE_PADDING * math.sqrt(squared)


@inner
def _fixed_contact(
    ints: Ints,
    floats: Floats,
    kept: Ints,
    kinds: Ints,
    sizes: Floats,
    rotations: Floats,
    translations: Floats,
    tested: Bools,
) -> tuple[int, int]:
    """Return a capsule that does not move and an obstacle that a sphere of it touches, or -1, -1."""
    centre = np.empty(3)
    for i in range(ints[at.FIXED_CAPSULES]):
        row = ints[at.CAPSULE_INTS] + at.CAPSULE_INT_ROW * i
        data = ints[at.CAPSULE_FLOATS] + at.CAPSULE_FLOAT_ROW * i
        for k in kept:
            if not tested[i, k]:
                continue
            for sample in range(ints[row + 1], ints[row + 2]):
                along = floats[ints[at.SAMPLES] + sample]
                for axis in range(3):
                    centre[axis] = floats[data + axis] + along * floats[data + 3 + axis]
                if _distance(centre, kinds[k], sizes[k], rotations[k], translations[k]) < floats[data + 6]:
                    return i, k
    return -1, -1
