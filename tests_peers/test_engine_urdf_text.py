"""A robot written as a URDF for other engines is the same robot when it is read again."""

import math

import numpy as np
import pytest
from tests.robot.kernel_arms import random_tree, ur5
from tests.robot.urdf_texts import write

from evenroad.geometry.rotation import rotation_from_rpy
from evenroad.robot.kinematics import link_poses
from evenroad.robot.urdf import read_urdf
from tests_peers.engines.urdf_text import as_urdf


@pytest.mark.parametrize("robot", [ur5(), *map(random_tree, range(6))], ids=lambda robot: robot.name)
def test_a_robot_written_as_a_urdf_and_read_again_has_its_links_at_the_same_places(tmp_path, robot):
    """Every joint is set, mimics by hand: the text has none."""
    read = read_urdf(write(tmp_path, as_urdf(robot)))
    names = tuple(joint.name for joint in read.joints if joint.kind != "fixed")
    again = type(robot)(read.name, read.links, read.joints, (), (), names)
    free = type(robot)(
        robot.name,
        robot.links,
        tuple(type(j)(**vars(j) | {"mimic": None}) for j in robot.joints),
        (),
        (),
        names,
    )
    q = np.random.default_rng(3).uniform(-2.0, 2.0, (20, len(names)))
    places, before = link_poses(again, q), link_poses(free, q)
    for i, name in enumerate(robot.links):
        np.testing.assert_allclose(places[:, read.links.index(name)], before[:, i], atol=1e-13)


@pytest.mark.parametrize("pitch", [math.pi / 2, -math.pi / 2, math.pi / 2 - 1e-9, 1.5707, math.pi / 2 + 3e-8])
def test_a_joint_that_points_straight_up_keeps_its_rotation(tmp_path, pitch):
    rotation = rotation_from_rpy(0.7, pitch, -1.1)
    first = ur5().joints[0]
    turned = type(first)(**vars(first) | {"rotation": rotation})
    robot = type(ur5())("up", ur5().links[:2], (turned,), (), (), (first.name,))
    # The first one fixes the robot to the world.
    _, read = read_urdf(write(tmp_path, as_urdf(robot))).joints
    np.testing.assert_allclose(read.rotation, rotation, atol=1e-14)
