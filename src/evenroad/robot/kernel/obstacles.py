"""Obstacles as arrays: what compiled code takes of a scene, checked."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.errors import InvalidValue, UnknownName
from evenroad.robot.kernel.layout import inner
from evenroad.robot.kernel.placed_capsules import FARTHEST, PlacedCapsule
from evenroad.robot.scene import Obstacle, Scene

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]

BOX, SPHERE, CYLINDER, CAPSULE = range(4)
"""Kinds of obstacles in `ObstacleArrays`."""

_KINDS = {"box": (BOX, 3), "sphere": (SPHERE, 1), "cylinder": (CYLINDER, 2), "capsule": (CAPSULE, 2)}
"""Shape -> kind, and how many sizes it has."""

_SOUND, _BAD_SIZE, _BAD_PLACE, _NO_ROTATION, _TOO_FAR = range(5)


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


def tested_contacts(capsules: Sequence[PlacedCapsule], links: Sequence[str], scene: Scene) -> Bools:
    """Return which capsules of a robot of these links are tested against which obstacles: (capsules, obstacles).

    Raises
    ------
    UnknownName
        If an allowed contact names a link or an obstacle that is not there.
    """
    tested = np.ones((len(capsules), len(scene.obstacles)), dtype=np.bool_)
    if scene.allowed:
        numbers = {obstacle.name: k for k, obstacle in enumerate(scene.obstacles)}
        for link, name in scene.allowed:
            if link not in links:
                raise UnknownName.among("link", link, links)
            if name not in numbers:
                raise UnknownName.among("obstacle", name, numbers)
            for i, capsule in enumerate(capsules):
                if capsule.link == link:
                    tested[i, numbers[name]] = False
    return tested


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
        for entry in range(9):
            if not (math.isfinite(rotations[k, entry]) and math.isfinite(translations[k, entry % 3])):
                return k, _BAD_PLACE
        for row in range(3):
            largest = max(largest, abs(translations[k, row]))
            for other in range(3):
                product = -1.0 if row == other else 0.0
                for entry in range(3):
                    product += rotations[k, 3 * row + entry] * rotations[k, 3 * other + entry]
                if abs(product) > 1e-6:
                    return k, _NO_ROTATION
        if largest > FARTHEST and not (kinds[k] == BOX and is_straight(rotations[k])):
            return k, _TOO_FAR
    return -1, _SOUND


@inner
def _size_count(kind: int) -> int:
    if kind == BOX:
        return 3
    return 1 if kind == SPHERE else 2


@inner
def is_straight(rotation: Floats) -> bool:
    """Return whether a rotation (9,) takes axes to axes, up to the rounding of sines of right angles."""
    # Loops here and elsewhere in place of array expressions: those take seconds to compile.
    farthest = 0.0
    for entry in range(9):
        farthest = max(farthest, abs(rotation[entry] - np.rint(rotation[entry])))
    return farthest < 1e-14
