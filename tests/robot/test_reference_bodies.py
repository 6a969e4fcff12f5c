"""What engines of others are given: every shape of the URDF, and never nothing."""

import math

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.robot.capsule import Capsule
from evenroad.robot.geometry import Geometry
from evenroad.robot.kinematics import link_poses
from evenroad.robot.load import load_robot
from evenroad.robot.reference.bodies import (
    capsule_geometries,
    original_geometries,
    scaled_mesh,
    sound_geometries,
)
from evenroad.robot.reference.urdf_text import as_urdf
from evenroad.robot.rotation import rotation_from_rpy
from evenroad.robot.urdf import read_urdf
from tests.robot.kernel_arms import random_tree, ur5
from tests.robot.mesh_arms import fork, write_fork_arm
from tests.robot.urdf_texts import joint, link, urdf, write


def test_the_shapes_of_a_urdf_come_as_they_are(tmp_path):
    path = write_fork_arm(tmp_path)
    shapes = original_geometries(path, load_robot(path))
    assert [(shape.link, shape.shape) for shape in shapes] == [
        ("base", "box"),
        ("arm", "cylinder"),
        ("slider", "sphere"),
        ("fork", "mesh"),
        ("nose", "capsule"),
    ]


def test_the_shapes_of_a_shipped_robot_are_found_by_its_name():
    robot = load_robot("ur5")
    assert {shape.link for shape in original_geometries("ur5", robot)} == {c.link for c in robot.capsules}


def test_a_link_without_a_shape_of_its_own_keeps_the_capsules_that_were_given(tmp_path):
    path = write(tmp_path, urdf(link("base"), link("tip", ""), joint("a", "base", "tip")))
    bodies = tmp_path / "bodies.yaml"
    bodies.write_text("tip:\n  - {a: [0, 0, 0], b: [0, 0, 0.1], radius: 0.02}\n")
    robot = load_robot(path, bodies=bodies)
    assert [(shape.link, shape.shape) for shape in original_geometries(path, robot)] == [
        ("base", "sphere"),
        ("tip", "capsule"),
    ]


@pytest.mark.parametrize("b", [(0.4, -0.1, 0.2), (0.1, 0.2, -1.0), (0.1, 0.2, 0.3)])
def test_a_capsule_as_a_shape_has_its_ends_where_they_were(b):
    robot = ur5()
    capsule = Capsule("base", (0.1, 0.2, 0.3), b, 0.05)
    (shape,) = capsule_geometries(type(robot)("one", ("base",), (), (capsule,), (), ()))
    length = shape.size[1] if shape.shape == "capsule" else 0.0
    assert shape.size[0] == 0.05
    axis = np.reshape(shape.rotation, (3, 3))[:, 2]
    np.testing.assert_allclose(np.array(shape.xyz) - 0.5 * length * axis, capsule.a, atol=1e-15)
    np.testing.assert_allclose(np.array(shape.xyz) + 0.5 * length * axis, capsule.b, atol=1e-15)


@pytest.mark.parametrize(
    ("keep", "add", "says"),
    [
        (lambda shape: False, (), "one or more; got 0"),
        (lambda shape: shape.link != "forearm", (), "none of forearm"),
        (lambda shape: True, ("hand",), "links that are not there: hand"),
    ],
)
def test_a_link_without_shapes_is_no_free_pass(keep, add, says):
    robot = ur5()
    shapes = [shape for shape in capsule_geometries(robot) if keep(shape)]
    shapes += [Geometry(name, "sphere", (0.1,), (0, 0, 0), (1, 0, 0, 0, 1, 0, 0, 0, 1)) for name in add]
    with pytest.raises(InvalidValue, match=says):
        sound_geometries(robot, shapes)


@pytest.mark.parametrize("scale", ["1 1 1", "0.001 0.001 0.001", "1 -1 2"])
def test_a_mesh_has_the_scale_of_the_urdf(tmp_path, scale):
    path = write_fork_arm(tmp_path, scale=scale)
    shape = next(shape for shape in read_urdf(path).geometries if shape.link == "fork")
    corners = scaled_mesh(shape).vertices
    np.testing.assert_allclose(corners.max(axis=0), fork().vertices.max(axis=0), rtol=1e-6)
    np.testing.assert_allclose(corners.min(axis=0), fork().vertices.min(axis=0), rtol=1e-6)


def test_a_mesh_scaled_flat_is_refused(tmp_path):
    path = write_fork_arm(tmp_path)
    shape = next(shape for shape in read_urdf(path).geometries if shape.link == "fork")
    flat = Geometry(shape.link, "mesh", (1.0, 0.0, 1.0), shape.xyz, shape.rotation, shape.file)
    with pytest.raises(InvalidValue, match=r"scale of mesh fork\.stl of link 'fork' must not be 0"):
        scaled_mesh(flat)


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
    (read,) = read_urdf(write(tmp_path, as_urdf(robot))).joints
    np.testing.assert_allclose(read.rotation, rotation, atol=1e-14)
