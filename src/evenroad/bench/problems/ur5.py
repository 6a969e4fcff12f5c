"""A UR5 reaches into an open box on its table: 5 joints, the last held at 0."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from evenroad.bench.problem import Problem, ProblemSource
from evenroad.robot.alter import with_group, with_limits
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.load import load_robot
from evenroad.robot.scene_file import load_scene

SCENES = {"ur5-c": "box-reach", "ur5-a": "box-reach-narrow"}
"""Name of the problem -> shipped scene."""
RESOLUTION = 0.05
"""Largest step of a motion check, in the Euclidean metric of the joint angles [rad]."""
_LIFT = (-1.3 * math.pi, 0.3 * math.pi)


def _reach(scene_name: str, instance: int) -> Problem:
    robot = load_robot("ur5")
    group = robot.group[:5]
    # Half the range of the joints: a full turn more would only give every posture several names.
    limits = dict.fromkeys(group, (-math.pi, math.pi)) | {"shoulder_lift_joint": _LIFT}
    robot = with_limits(with_group(robot, group), limits)
    scene = load_scene(scene_name)
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
