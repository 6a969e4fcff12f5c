"""The native kernel's robot, of the arrays that it names."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints
from evenroad._native import robot as native
from evenroad.collision.placed_capsules import PlacedCapsule, PlacedHulls, speed_bounds
from evenroad.collision.robot_tables import PADDING, RobotTables
from evenroad.geometry.parts import Parts, spread
from evenroad.geometry.pose import Vector
from evenroad.geometry.shapes import Capsule
from evenroad.robots.hull_trees import hull_arrays
from evenroad.robots.moving_tree import MovingTree
from evenroad.robots.robot import Robot

MOST_BALLS = 8
"""Largest number of balls, but for one, that stand for a capsule within a shape."""


def native_robot(robot: Robot, tables: RobotTables, bounds: Floats) -> native.Robot:
    """Return a robot; `bounds`, (3, dim), are low, high and period of each coordinate."""
    return native.Robot(**robot_arrays(robot, tables, bounds))


def robot_arrays(robot: Robot, tables: RobotTables, bounds: Floats) -> dict[str, dict[str, npt.NDArray[np.generic]]]:
    """Return the arrays that a native robot is made of."""
    frames, capsules = tables.tree.frames, tables.capsules
    bodies = list(dict.fromkeys(capsule.link for capsule in capsules))
    number = {link: i for i, link in enumerate(bodies)}
    trees = {link: i for i, link in enumerate(tables.hulls)}
    return {
        "frames": {
            "parent": _ints([frame.parent for frame in frames]),
            "coordinate": _ints([frame.coordinate for frame in frames]),
            "slides": np.array([frame.slides for frame in frames], dtype=np.bool_),
            "multiplier": np.array([frame.multiplier for frame in frames], dtype=np.float64),
            "offset": np.array([frame.offset for frame in frames], dtype=np.float64),
            "rotation": np.array([frame.rotation for frame in frames], dtype=np.float64).reshape(-1, 3, 3),
            "translation": np.array([frame.translation for frame in frames], dtype=np.float64).reshape(-1, 3),
        },
        "bodies": {
            "frame": _ints([tables.tree.links[link].frame for link in bodies]),
            "hulls": _ints([trees.get(link, -1) for link in bodies]),
        },
        "capsules": _capsules(capsules, number, dict(robot.padding))
        | {"speeds": np.ascontiguousarray(tables.speeds.T)},
        "pairs": {
            "bodies": _ints([(number[a], number[b]) for a, b in tables.body_pairs]).reshape(-1, 2),
            "by_hulls": _ints([tables.by_hulls]),
            "speeds": np.ascontiguousarray(tables.pair_speeds.T),
        },
        "hulls": hull_arrays([placed.leaves for placed in tables.hulls.values()])._asdict(),
        "shapes": _shapes(robot, tables.tree, number),
        "limits": {
            "bounds": np.ascontiguousarray(bounds),
            "padding": np.array([PADDING * max(1.0, tables.reach)]),
            "reach": np.array([tables.reach]),
        },
    }


@dataclass(frozen=True)
class _PlacedParts:
    """The parts of one shape in the moving frame that it is fixed to."""

    parts: Parts
    rotation: Floats
    translation: Floats
    frame: int

    @property
    def endpoints(self) -> Floats:
        """Points, (n, 3), in whose hull the parts lie that are not widened by the radius."""
        return spread(self.parts) @ self.rotation.T + self.translation

    @property
    def around(self) -> Floats:
        """Points, (n, 3), in whose hull the parts lie but for a width."""
        around = self.parts.around
        return around @ self.rotation.T + self.translation if len(around) else self.endpoints


def _placed(robot: Robot, tree: MovingTree, number: dict[str, int]) -> list[_PlacedParts]:
    placed = []
    for parts in sorted((each for each in robot.shapes if each.link in number), key=lambda each: number[each.link]):
        at = tree.links[parts.link]
        placed.append(_PlacedParts(parts, at.rotation, at.translation, at.frame))
    return placed


def shape_speeds(robot: Robot, tree: MovingTree, number: dict[str, int]) -> Floats:
    """Return how fast each coordinate moves the true shapes of each body at most, (bodies, dim) [m/rad or m/m]."""
    speeds, placed = np.zeros((len(number), len(robot.group))), _placed(robot, tree, number)
    hulls = [PlacedHulls(each.frame, ((each.endpoints[np.newaxis], 0.0),)) for each in placed]
    for each, row in zip(placed, speed_bounds(tree, hulls, [], robot)[0], strict=True):
        body = number[each.parts.link]
        speeds[body] = np.maximum(speeds[body], row)
    return speeds


def _shapes(robot: Robot, tree: MovingTree, number: dict[str, int]) -> dict[str, npt.NDArray[np.generic]]:
    """Return the parts of all true shapes, body by body, and how fast each coordinate moves those of each body."""
    placed = _placed(robot, tree, number)
    speeds = shape_speeds(robot, tree, number)
    counts = [each.parts.corners.shape[:2] for each in placed]
    of_part = np.repeat(np.arange(len(placed)), [parts for parts, _ in counts])
    corners = [each.parts.corners.reshape(-1, 3) @ each.rotation.T + each.translation for each in placed]
    return {
        "body": np.array([number[each.parts.link] for each in placed], dtype=np.int64)[of_part],
        "first_point": _ints([0, *np.cumsum([many for parts, many in counts for _ in range(parts)])]),
        "points": np.concatenate([np.zeros((0, 3)), *corners]),
        "widths": np.array([each.parts.radius for each in placed])[of_part],
        "discs": np.array([each.rotation @ each.parts.disc for each in placed]).reshape(-1, 3)[of_part],
        "enclosing": np.array([each.parts.closed for each in placed], dtype=np.bool_)[of_part],
        "speeds": np.ascontiguousarray(speeds.T),
        **_around(placed, number),
        **_inside(robot, tree, number),
    }


def _around(placed: Sequence[_PlacedParts], number: dict[str, int]) -> dict[str, npt.NDArray[np.generic]]:
    """Return, for each body, points in whose hull its shape lies but for a width."""
    points, counts, widths = [np.zeros((0, 3))], [0], []
    for link in number:
        of_link = [each for each in placed if each.parts.link == link]
        here = [each.around for each in of_link]
        points += here
        counts.append(counts[-1] + sum(map(len, here)))
        widths.append(max((max(each.parts.radius, each.parts.beyond) for each in of_link), default=0.0))
    return {"around_first": _ints(counts), "around": np.concatenate(points), "around_widths": np.array(widths)}


def _inside(robot: Robot, tree: MovingTree, number: dict[str, int]) -> dict[str, npt.NDArray[np.generic]]:
    """Return, for each body, balls within its shape: those of the capsules that are."""
    rows, counts = [np.zeros((0, 4))], [0]
    of_link: dict[str, list[Capsule]] = {link: [] for link in number}
    for capsule in robot.inner or ():
        of_link.get(capsule.link, []).append(capsule)
    for link, capsules in of_link.items():
        at = tree.links[link]
        for capsule in capsules:
            balls = _balls(capsule.a, capsule.b, capsule.radius)
            rows.append(np.column_stack([balls[:, :3] @ at.rotation.T + at.translation, balls[:, 3]]))
        counts.append(counts[-1] + sum(map(len, rows[len(rows) - len(capsules) :])))
    return {"inside_first": _ints(counts), "inside": np.concatenate(rows)}


@lru_cache(maxsize=4096)
def _balls(start: Vector, end: Vector, radius: float) -> Floats:
    """Return balls, (n, 4), along a capsule: their centres and radii."""
    a, b = np.array(start), np.array(end)
    share = np.linspace(0.0, 1.0, 1 + min(math.ceil(np.linalg.norm(b - a) / radius), MOST_BALLS))
    balls = np.column_stack([a + share[:, np.newaxis] * (b - a), np.full(len(share), radius)])
    balls.setflags(write=False)
    return balls


def _ints(values: Sequence[object]) -> Ints:
    return np.array(values, dtype=np.int64)


def _capsules(
    capsules: Sequence[PlacedCapsule], number: dict[str, int], padding: dict[str, float]
) -> dict[str, npt.NDArray[np.generic]]:
    counts = [len(capsule.cover.positions) for capsule in capsules]
    return {
        "body": _ints([number[capsule.link] for capsule in capsules]),
        "first_sample": _ints([0, *np.cumsum(counts)]),
        "centre": np.array([capsule.centre for capsule in capsules]),
        "half": np.array([capsule.half for capsule in capsules]),
        "radius": np.array([capsule.radius for capsule in capsules]),
        "covering": np.array([capsule.cover.radius for capsule in capsules]),
        # What does not move cannot keep away.
        "padding": np.array([padding.get(capsule.link, 0.0) if capsule.frame else 0.0 for capsule in capsules]),
        "samples": np.concatenate([np.array(capsule.cover.positions) for capsule in capsules]),
    }
