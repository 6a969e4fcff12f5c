"""Obstacles as rows of numbers: what compiled code takes of a scene."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue, UnknownName
from evenroad.robot.kernel.placed_capsules import FARTHEST, PlacedCapsule
from evenroad.robot.scene import Scene

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

BOX, SPHERE, CYLINDER, CAPSULE = range(4)
"""Kinds of obstacles."""

SIZE, ROTATION, TRANSLATION, ROW = 1, 4, 13, 16
"""Where the parts of a row begin, after its kind, and its length."""

_KINDS = {"box": (BOX,), "sphere": (SPHERE,), "cylinder": (CYLINDER,), "capsule": (CAPSULE,)}
_PADDING = {"box": (), "sphere": (0.0, 0.0), "cylinder": (0.0,), "capsule": (0.0,)}


def obstacle_rows(scene: Scene) -> Floats:
    """Return the obstacles of a scene but clouds and meshes, (n, 16): kind; full extents of a box, or radius and length
    without caps, and zeros [m]; rotation to the root link's frame, row by row; centre in that frame [m].

    Raises
    ------
    InvalidValue
        If an obstacle is larger or farther than 1e6 m (boxes along the axes may be: they are cut off where the robot
        never comes).
    """
    numbers: list[float] = []
    obstacles = [obstacle for obstacle in scene.obstacles if obstacle.shape in _KINDS]
    for obstacle in obstacles:
        body = obstacle.body
        numbers += (*_KINDS[body.kind], *body.size, *_PADDING[body.kind], *body.pose.rotation, *body.pose.xyz)
    rows = np.array(numbers, dtype=np.float64).reshape(-1, ROW)
    if max(numbers, default=0.0) > FARTHEST or min(numbers, default=0.0) < -FARTHEST:
        far = (np.abs(rows) > FARTHEST).any(axis=1)
        turned = (
            np.abs(rows[:, ROTATION:TRANSLATION] - np.rint(rows[:, ROTATION:TRANSLATION])).max(axis=1)
            >= 1e-14
        )
        for k in np.flatnonzero(far & ((rows[:, 0] != BOX) | turned)):
            obstacle = obstacles[k]
            raise InvalidValue(
                f"obstacle {obstacle.name!r} must be within {FARTHEST:g} m, got size {obstacle.size!r} at"
                f" {obstacle.xyz!r}"
            )
    return rows


def tested_contacts(capsules: Sequence[PlacedCapsule], links: Sequence[str], scene: Scene) -> Bools:
    """Return which capsules of a robot of these links are tested against which obstacles: (capsules, obstacles).

    Raises UnknownName if an allowed contact names a link or an obstacle that is not there.
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
