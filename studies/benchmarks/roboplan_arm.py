"""RoboPlan's RRT-Connect and shortcuts on the problems of `arm_problems`: wheels `roboplan-core` and `roboplan-rrt`."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from roboplan.core import (
    Box,
    Cylinder,
    JointConfiguration,
    PathShortcutter,
    PathShortcuttingOptions,
    Scene,
    Sphere,
    loadUrdfSceneDescriptionFromXml,
)
from roboplan.rrt import RRT, RRTOptions
from scipy.spatial.transform import Rotation
from studies.benchmarks.arm_problems import Problem, Vector

import evenroad as er
from evenroad.collision.arm_world import ArmWorld
from evenroad.robots.kinematics import link_poses
from evenroad.robots.robot import Robot

GROUP = "arm"
STEP, OWN_STEP = 0.02, 0.05
"""Largest steps between two states of a motion that is checked [rad]: here, and RoboPlan's default."""
MOST_NODES = 100_000
_CAPSULE = re.compile(
    r'<collision><origin xyz="([^"]*)"(?: rpy="([^"]*)")?/><geometry>'
    r'<capsule radius="(\S+)" length="(\S+)"/></geometry></collision>'
)


def as_read_by_all(urdf: str, robot: Robot) -> str:
    """Return the text of a URDF with the limits of a robot, and a cylinder with a ball at each end for each capsule."""

    def parts(found: re.Match[str]) -> str:
        xyz, rpy, radius, length = found.groups()
        turn = Rotation.from_euler("xyz", [float(each) for each in (rpy or "0 0 0").split()])
        shape = '<collision><origin xyz="{} {} {}" rpy="{}"/><geometry>{}</geometry></collision>'
        text = shape.format(*xyz.split(), rpy or "0 0 0", f'<cylinder radius="{radius}" length="{length}"/>')
        for side in (-0.5, 0.5):
            ball = np.array(xyz.split(), dtype=float) + turn.apply([0.0, 0.0, side * float(length)])
            text += shape.format(*ball, "0 0 0", f'<sphere radius="{radius}"/>')
        return text

    text = _CAPSULE.sub(parts, urdf)
    space = ArmWorld(robot, er.Scene((), name="nothing")).space
    for name, low, high in zip(robot.group, space.low, space.high, strict=True):
        limit = rf'(<joint name="{name}".*?<limit )lower="[^"]*" upper="[^"]*"'
        text = re.sub(limit, rf'\g<1>lower="{low}" upper="{high}"', text, count=1, flags=re.DOTALL)
    return text


def scene_of(problem: Problem, urdf: Path) -> Scene:
    """Return RoboPlan's scene: the same bodies, the same pairs of links, the same obstacles."""
    robot = problem.robot
    scene = Scene("problem", loadUrdfSceneDescriptionFromXml(as_read_by_all(urdf.read_text(), robot)))
    scene.addGroup(GROUP, list(robot.group))
    tested = {frozenset(pair) for pair in robot.pairs}
    apart = [pair for pair in itertools.combinations(robot.links, 2) if frozenset(pair) not in tested]
    for obstacle in problem.scene.obstacles:
        place = np.eye(4)
        place[:3, :3], place[:3, 3] = np.reshape(obstacle.rotation, (3, 3)), obstacle.xyz
        shape, add = {
            "box": (Box, scene.addBoxGeometry),
            "cylinder": (Cylinder, scene.addCylinderGeometry),
            "sphere": (Sphere, scene.addSphereGeometry),
        }[obstacle.shape]
        add(obstacle.name, "universe", shape(*obstacle.size), np.asfortranarray(place), np.ones(4))
    # What only turns in its place may touch what it stands on, and boxes may touch each other.
    poses = link_poses(robot, np.stack([problem.start, problem.goal]))
    still = [name for name, at in zip(robot.links, poses[:, :, :3, 3].swapaxes(0, 1), strict=True) if np.allclose(*at)]
    among = itertools.combinations(problem.scene.names, 2)
    scene.setCollisions([*apart, *itertools.product(still, problem.scene.names), *among], False)
    return scene


def plan(problem: Problem, urdf: Path, seconds: float) -> Vector | None:
    """Return a shortened path, (p, dim), or None."""
    return next(plans(problem, urdf, seconds))


def plans(problem: Problem, urdf: Path, seconds: float) -> Iterator[Vector | None]:
    """Yield shortened paths, (p, dim), or None: plans of the seeds 1, 2, 3 ... of so many seconds at most."""
    yield from plans_in(scene_of(problem, urdf), problem, seconds)


def plans_in(scene: Scene, problem: Problem, seconds: float, step: float = STEP) -> Iterator[Vector | None]:
    """Yield the same in a scene that exists, with another step of checks [rad]."""
    names = list(problem.robot.group)
    options, shorter = RRTOptions(), PathShortcuttingOptions()
    options.group_name, options.rrt_connect, options.max_nodes = GROUP, True, MOST_NODES
    options.max_planning_time, options.collision_check_step_size = seconds, step
    shorter.group_name, shorter.max_step_size = GROUP, step
    start, goal = JointConfiguration(names, problem.start), JointConfiguration(names, problem.goal)
    for seed in itertools.count(1):
        planner = RRT(scene, options)
        planner.setRngSeed(seed)
        shorter.seed = seed - 1
        try:
            path = planner.plan(start, goal)
        except RuntimeError:
            yield None
            continue
        yield np.array(PathShortcutter(scene, shorter).shortcut(path).positions)
