from dataclasses import replace

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.geometry import Box, Pose
from evenroad.loading.cache import cached, keep
from evenroad.robot import ArmWorld, Obstacle, Scene, load_model, load_robot
from evenroad.robots.kinematics import link_poses
from evenroad.robots.planes import Plane
from evenroad.scenes.robot_in_scene import scene_around

UR5 = load_robot("ur5")
TILTED = Pose.from_quaternion((0.1, -0.2, -0.3), xyzw=(np.sin(0.2), 0.0, 0.0, np.cos(0.2)))
FLOOR = Plane("floor", TILTED.xyz, TILTED.rotation, ("base_link", "shoulder_link", "upper_arm_link"))
ON_FLOOR = replace(UR5, planes=(FLOOR,))
EMPTY = Scene(name="empty")


def test_what_reaches_below_a_plane_is_blocked_and_nothing_else_is_by_it():
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (4000, 6))
    without, world = ArmWorld(UR5, EMPTY), ArmWorld(ON_FLOOR, EMPTY)
    poses = link_poses(UR5, q)
    height = np.full(len(q), np.inf)
    for capsule in UR5.capsules:
        if capsule.link not in FLOOR.untested:
            of = poses[:, UR5.links.index(capsule.link)]
            for end in (capsule.a, capsule.b):
                place = of[:, :3, :3] @ np.array(end) + of[:, :3, 3] - np.array(TILTED.xyz)
                height = np.minimum(height, place @ TILTED.rotation_matrix[:, 2] - capsule.radius)
    free, among = without.valid(q), world.valid(q)
    assert not among[height < 0.0].any()
    assert (among == free)[height > world.excess + 1e-4].all()
    assert (free & (height < 0.0)).sum() > 500


def test_a_plane_comes_with_the_robot_once_and_only_under_its_own_name():
    world = ArmWorld(ON_FLOOR, EMPTY)
    assert [obstacle.name for obstacle in world.scene.obstacles] == ["floor"]
    assert scene_around(ON_FLOOR, world.scene) == world.scene
    assert scene_around(UR5, EMPTY) is EMPTY
    with pytest.raises(InvalidValue, match="'floor', which is the name of a plane in the robot's file"):
        ArmWorld(ON_FLOOR, EMPTY.with_(Obstacle("floor", Box((1.0, 1.0, 0.1)))))


def test_planes_tell_robots_apart_and_are_kept_with_them():
    assert ON_FLOOR.fingerprint() != UR5.fingerprint()
    assert replace(ON_FLOOR, planes=()).fingerprint() == UR5.fingerprint()
    keep("on a floor", replace(load_model("ur5"), robot=ON_FLOOR, file=None))
    assert cached("on a floor").robot == ON_FLOOR
