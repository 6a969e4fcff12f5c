"""A UR5 reaches into an open box on its table: 5 joints, the last held at 0."""

from __future__ import annotations

from functools import partial

import numpy as np

from evenroad.research.bench.problem import Problem, ProblemSource
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.load import load_robot
from evenroad.robot.robot import in_scene, with_group
from evenroad.robot.scene_file import load_scene

SCENES = {"ur5-c": "box-reach", "ur5-a": "box-reach-narrow"}
"""Name of the problem -> shipped scene."""
RESOLUTION = 0.05
"""Largest step of a motion check, in the Euclidean metric of the joint angles [rad]."""


def _reach(scene_name: str, instance: int) -> Problem:
    robot = load_robot("ur5")
    group = robot.group[:5]
    scene = load_scene(scene_name)
    # The scene has the protocol's bounds: the lift in [-1.3 pi, 0.3 pi], the others in [-pi, pi].
    robot = in_scene(with_group(robot, group), scene)
    start, goal = (np.array([scene.states[name][joint] for joint in group]) for name in ("home", "inside"))
    return Problem(ArmWorld(robot, scene, resolution=RESOLUTION), start, goal, set_dim=len(group))


UR5 = tuple(
    ProblemSource(
        name,
        5,
        partial(_reach, scene),
        about=f"UR5, 5 joints, out of its home into a box: scene {scene}, capsules",
    )
    for name, scene in SCENES.items()
)
