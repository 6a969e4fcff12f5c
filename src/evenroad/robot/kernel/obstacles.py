"""Obstacles as rows of numbers: what compiled code takes of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue, UnknownName
from evenroad.robot.kernel.placed_capsules import FARTHEST, PlacedCapsule
from evenroad.robot.scene import Obstacle, Scene

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

BOX, SPHERE, CYLINDER, CAPSULE = range(4)
"""Kinds of obstacles, numbered as in ``shapes.PRIMITIVES``."""

SIZE, ROTATION, TRANSLATION, ROW = 1, 4, 13, 16
"""Where the parts of a row begin, after its kind, and its length."""


def obstacle_rows(scene: Scene) -> Floats:
    """Return the obstacles of a scene but clouds and meshes, (n, 16): kind; full extents of a box, or radius and length
    without caps, and zeros [m]; rotation to the root link's frame, row by row; centre in that frame [m].
    """
    return np.frombuffer(b"".join([obstacle.row for obstacle in scene.obstacles])).reshape(-1, ROW)


def refuse(obstacle: Obstacle) -> NoReturn:
    """Raise InvalidValue: an obstacle is so far, or so large, that too few digits are left.

    Boxes along the axes may be: they are cut off where the robot never comes.
    """
    raise InvalidValue(
        f"obstacle {obstacle.name!r} must be within {FARTHEST:g} m, got size {obstacle.size!r} at {obstacle.xyz!r}"
    )


def tested_contacts(capsules: Sequence[PlacedCapsule], links: Sequence[str], scene: Scene) -> Bools:
    """Return which capsules of a robot of these links are tested against which obstacles: (capsules, obstacles).

    Raises UnknownName if an allowed contact names a link or an obstacle that is not there.
    """
    # Bytes, of which each is soon set.
    count = len(scene.obstacles)
    tested = bytearray(b"\1") * (len(capsules) * count)
    if scene.allowed:
        bodied = [each.link for each in capsules]
        for link, name in scene.allowed:
            if link not in links:
                raise UnknownName.among("link", link, links)
            index = next((k for k, each in enumerate(scene.obstacles) if each.name == name), -1)
            if index < 0:
                raise UnknownName.among("obstacle", name, [each.name for each in scene.obstacles])
            for other in bodied:
                if other == link:
                    tested[index] = 0
                index += count
    return np.frombuffer(tested, dtype=np.bool_).reshape(len(capsules), count)
