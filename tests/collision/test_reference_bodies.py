"""What engines of others are given: every shape of the URDF, and never nothing."""

from dataclasses import replace

import numpy as np
import pytest

from evenroad.collision.coal_world import capsule_shapes, original_shapes, sound_shapes
from evenroad.errors import InvalidValue
from evenroad.geometry.shapes import Capsule, Sphere
from evenroad.loading.load import load_robot
from evenroad.loading.urdf import read_urdf
from tests.refused import refused
from tests.robots.kernel_arms import ur5
from tests.robots.mesh_arms import fork, write_fork_arm
from tests.robots.urdf_texts import joint, link, urdf, write


def test_the_shapes_of_a_urdf_come_as_they_are(tmp_path):
    path = write_fork_arm(tmp_path)
    shapes = original_shapes(path, load_robot(path))
    assert [(shape.link, shape.kind) for shape in shapes] == [
        ("base", "box"),
        ("arm", "cylinder"),
        ("slider", "sphere"),
        ("fork", "mesh"),
        ("nose", "capsule"),
    ]


def test_the_shapes_of_a_shipped_robot_are_found_by_its_name():
    robot = load_robot("ur5")
    assert {shape.link for shape in original_shapes("ur5", robot)} == {c.link for c in robot.capsules}


def test_a_link_without_a_shape_of_its_own_keeps_the_capsules_that_were_given(tmp_path):
    path = write(tmp_path, urdf(link("base"), link("tip", ""), joint("a", "base", "tip")))
    bodies = tmp_path / "bodies.yaml"
    bodies.write_text("tip:\n  - {a: [0, 0, 0], b: [0, 0, 0.1], radius: 0.02}\n")
    robot = load_robot(path, bodies=bodies)
    assert [(shape.link, shape.kind) for shape in original_shapes(path, robot)] == [
        ("base", "sphere"),
        ("tip", "capsule"),
    ]


@pytest.mark.parametrize("b", [(0.4, -0.1, 0.2), (0.1, 0.2, -1.0), (0.1, 0.2, 0.3)])
def test_a_capsule_as_a_shape_has_its_ends_where_they_were(b):
    robot = ur5()
    capsule = Capsule((0.1, 0.2, 0.3), b, 0.05, link="base")
    (shape,) = capsule_shapes(type(robot)("one", ("base",), (), (capsule,), (), ()))
    length = shape.size[1] if shape.kind == "capsule" else 0.0
    assert shape.size[0] == 0.05
    axis = np.reshape(shape.pose.rotation, (3, 3))[:, 2]
    np.testing.assert_allclose(np.array(shape.pose.xyz) - 0.5 * length * axis, capsule.a, atol=1e-15)
    np.testing.assert_allclose(np.array(shape.pose.xyz) + 0.5 * length * axis, capsule.b, atol=1e-15)


@pytest.mark.parametrize(("keep", "add", "says"), [
    (lambda shape: False, (), "one or more; got 0"),
    (lambda shape: shape.link != "forearm", (), "none of forearm"),
    (lambda shape: True, ("hand",), "links that are not there: hand"),
])  # fmt: skip
def test_a_link_without_shapes_is_no_free_pass(keep, add, says):
    robot = ur5()
    shapes = [shape for shape in capsule_shapes(robot) if keep(shape)]
    shapes += [Sphere(0.1, link=name) for name in add]
    refused(InvalidValue, says, sound_shapes, robot, shapes)


@pytest.mark.parametrize("scale", ["1 1 1", "0.001 0.001 0.001", "1 -1 2"])
def test_a_mesh_has_the_scale_of_the_urdf(tmp_path, scale):
    path = write_fork_arm(tmp_path, scale=scale)
    shape = next(shape for shape in read_urdf(path).shapes if shape.link == "fork")
    corners = shape.triangles.vertices
    np.testing.assert_allclose(corners.max(axis=0), fork().vertices.max(axis=0), rtol=1e-6)
    np.testing.assert_allclose(corners.min(axis=0), fork().vertices.min(axis=0), rtol=1e-6)


def test_a_mesh_scaled_flat_is_refused(tmp_path):
    path = write_fork_arm(tmp_path)
    shape = next(shape for shape in read_urdf(path).shapes if shape.link == "fork")
    refused(InvalidValue, r"scale of mesh fork\.stl must not be 0", replace, shape, scale=(1.0, 0.0, 1.0))


def test_capsules_that_are_given_as_shapes_lie_where_they_lie_on_the_robot():
    robot = ur5()
    assert sound_shapes(robot, robot.capsules) == capsule_shapes(robot)
    assert sound_shapes(robot, capsule_shapes(robot)) == capsule_shapes(robot)
