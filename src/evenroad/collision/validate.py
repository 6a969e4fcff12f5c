"""The last check of a path, with the shapes that the capsules stand for."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from evenroad._arrays import Floats
from evenroad._rng import generator
from evenroad.errors import NotAvailable
from evenroad.geometry.shapes import PointCloud
from evenroad.loading.model import RobotModel
from evenroad.loading.robot_file import RobotFile
from evenroad.robots.pairs import HELD_TOUCHING, TOUCHING
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Scene
from evenroad.space.path import resample

if TYPE_CHECKING:
    from evenroad.collision.coal_world import CoalWorld

MeshStatus = Literal["free", "in collision", "not checked"]
FINER = 10
"""States are this many times as dense as those that a motion was planned with."""
SAMPLES = 100
"""Number of random configurations that find pairs whose shapes are always in contact."""


@dataclass(frozen=True)
class MeshCheck:
    """What the original shapes say about a path.

    Number of `states`, endpoints included, at most a tenth of the resolution apart; 0 where nothing was checked.
    `message` says why not, or which motion is in collision where, and which bodies touch; `configuration` is the first
    state in collision [rad or m].  Pairs in `always_touching` were left out: their shapes touch in each of 100 random
    configurations.
    """

    verdict: MeshStatus
    states: int = 0
    message: str = ""
    configuration: tuple[float, ...] | None = None
    always_touching: tuple[tuple[str, str], ...] = ()

    def __str__(self) -> str:
        if self.verdict == "not checked":
            return f"none ({self.message})"
        text = f"free ({self.states} states)" if self.verdict == "free" else f"in collision {self.message}"
        if self.always_touching:
            text += f"; left out, for they always touch: {_named(self.always_touching)}"
        return text


def has_meshes(model: RobotModel) -> bool:
    """Return whether a robot's URDF gives a mesh for any link; nothing is read for it."""
    return any(shape.startswith("mesh ") for body in model.bodies for shape in body.shapes)


def unseen_pairs(model: RobotModel) -> tuple[tuple[str, str], ...]:
    """Return the pairs of links that are no neighbours and that no planner tests: their capsules touch all the time."""
    return tuple((first, second) for first, second, why in model.dropped if why in (TOUCHING, HELD_TOUCHING))


def validate(
    source: str | os.PathLike[str] | RobotFile,
    robot: Robot,
    scene: Scene,
    path: Floats,
    resolution: float = 0.05,
    unseen: Sequence[tuple[str, str]] = (),
) -> MeshCheck:
    """Check a path with the shapes of the robot's URDF, meshes triangle by triangle, in coal.

    Capsules contain the shapes that they were fitted to, so what is free for them is free here.  Where it is not, two
    links touch whose capsules say nothing about them (`unseen`), or the capsules were given by the user and leave out
    a piece of a shape, or something is wrong with one of the two checkers: the path is not to be driven.  Clouds are
    left out, since coal knows none.

    `source` is the file that `robot` was loaded from; each motion of the path, (p, dim) [rad or m], is divided as
    ArmWorld of this `resolution` divides it, ten times as finely.  `unseen` are pairs of links that are tested beside
    the robot's own, as of `unseen_pairs`; left out are those whose shapes touch whatever the joints do.  Raises
    BrokenFile or InvalidValue if the URDF or a mesh is missing, broken or empty by now.
    """
    # Imported late: shipped robots have no meshes.
    from evenroad.collision.coal_world import CoalWorld, original_shapes

    clouds = [obstacle.name for obstacle in scene.obstacles if isinstance(obstacle.body, PointCloud)]
    scene = scene.without(*clouds)
    every = replace(robot, pairs=(*robot.pairs, *unseen))
    try:
        shapes = original_shapes(source, robot)
        world = CoalWorld(every, scene, shapes, resolution)
    except NotAvailable:
        of_these = f": {_named(unseen)} are never tested without it" if unseen else ""
        return MeshCheck("not checked", message=f"needs evenroad[mesh]{of_these}")
    # Of pairs that nobody gave, those may touch all the time that the group does not move.
    always = _always_touching(world, unseen if robot.pairs_given else every.pairs)
    if always:
        kept = tuple(pair for pair in every.pairs if pair not in always)
        world = CoalWorld(replace(robot, pairs=kept), scene, shapes, resolution)
    states, motions = resample(path, world.space, resolution / FINER)
    blocked = np.flatnonzero(~world.valid(states))
    if len(blocked) == 0:
        return MeshCheck("free", len(states), always_touching=always)
    first = states[blocked[0]]
    return MeshCheck(
        "in collision",
        len(states),
        f"at {_numbers(first)} in motion {motions[blocked[0]]} of the path: {world.explain(first)}",
        tuple(first.tolist()),
        always,
    )


def _always_touching(world: CoalWorld, pairs: Sequence[tuple[str, str]]) -> tuple[tuple[str, str], ...]:
    """Return those of some pairs of links that touch in every one of random configurations."""
    left = set(pairs)
    cube = generator(0).random((SAMPLES, world.space.cube_dim))
    for q in world.space.from_cube(cube):
        if not left:
            break
        left &= world.contacts(q)
    return tuple(pair for pair in pairs if pair in left)


def _named(pairs: Sequence[tuple[str, str]]) -> str:
    return ", ".join(f"{first!r} with {second!r}" for first, second in pairs)


def _numbers(row: Sequence[float] | Floats) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in row) + ")"
