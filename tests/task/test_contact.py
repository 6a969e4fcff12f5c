import numpy as np
import pytest

import evenroad as er
from evenroad.geometry.distance import point_distance
from evenroad.geometry.shapes import Capsule, Cylinder, Mesh, PointCloud, Sphere
from evenroad.robot import Obstacle
from evenroad.robots.kinematics import link_poses
from evenroad.task.contact import core_of, depth_in, distance_of
from evenroad.viz.surfaces import surface_of

AT = er.Pose((0.3, -0.2, 0.5), rpy=(0.4, -0.3, 1.1))
SHAPES = [
    er.Box((0.1, 0.2, 0.3), pose=AT),
    Sphere(0.1, pose=AT),
    Cylinder(0.05, 0.2, pose=AT),
    Capsule(0.05, 0.2, pose=AT),
]


@pytest.mark.parametrize("body", SHAPES, ids=lambda each: each.kind)
@pytest.mark.parametrize("as_capsule", [False, True])
def test_a_core_lies_inside_by_the_depth_and_is_no_smaller_than_that(body, as_capsule):
    core = core_of(body, 0.01, as_capsule=as_capsule)
    around = np.random.default_rng(0).normal(size=(400, 3))
    around *= 0.0099 / np.linalg.norm(around, axis=1, keepdims=True)
    corners = surface_of(core)[0]
    assert point_distance(body, (corners[:, np.newaxis] + around).reshape(-1, 3)).max() == 0.0
    if not as_capsule:
        assert point_distance(core, surface_of(body)[0]).min() >= 0.0099
        assert point_distance(core, surface_of(body)[0]).min() <= 0.0101 * (3**0.5 if body.kind == "box" else 1.0)


def test_of_a_mesh_the_core_is_inside_and_of_what_is_thin_a_fifth_is_left():
    mesh = Mesh(surface_of(er.Box((0.1, 0.2, 0.3))), pose=AT)
    low, high = (np.array(core_of(mesh, 0.01, as_capsule=False).triangles.vertices) for _ in (0, 1))
    np.testing.assert_allclose(high.max(axis=0) - low.min(axis=0), [0.08, 0.18, 0.28])
    np.testing.assert_allclose(core_of(er.Box((0.01, 0.2, 0.3)), 0.01, as_capsule=False).size, (0.002, 0.18, 0.28))
    assert core_of(PointCloud([(0, 0, 0)]), 0.01, as_capsule=False) is None


def test_the_distance_of_a_gripper_is_that_of_its_capsules_and_frames():
    robot, q = er.load_robot("ur5"), np.array([0.0, -2.0, 1.9, -1.5, -1.5, 0.0])
    tip = link_poses(robot, q[np.newaxis])[0, robot.links.index("tool0"), :3, 3]
    for body in (Sphere(0.1, xyz=tip + np.array([0.3, 0.0, 0.0])), PointCloud([tip + np.array([0.2, 0.0, 0.0])])):
        assert distance_of(body, robot, q, ["tool0"]) == pytest.approx(0.2)
        assert distance_of(body, robot, q, ["tool0", "wrist_3_link"]) <= 0.2
    assert distance_of(Sphere(0.1, xyz=tip), robot, q, ["tool0"]) == 0.0


@pytest.mark.parametrize("body", [*SHAPES, Mesh(surface_of(er.Box((0.1, 0.2, 0.3))), pose=AT)], ids=lambda b: b.kind)
def test_a_contact_is_as_deep_as_the_obstacle_had_to_move_along_the_axis_that_needs_least(body):
    robot = er.load_robot("ur5")
    q = np.array([0.3, -1.2, 1.4, -0.8, 0.9, 0.2])
    elbow = link_poses(robot, q[np.newaxis])[0, robot.links.index("forearm_link")]
    placed = er.Pose(tuple((elbow[:3, 3] - AT.xyz + 0.02).tolist())) @ body.pose
    scene = er.Scene([Obstacle("body", body), Obstacle("far", er.Box((0.1, 0.1, 0.1), xyz=(3.0, 0.0, 0.0)))])
    scene = scene.moved({"body": placed})
    deep = depth_in(er.ArmWorld(robot, scene), q)
    assert 0.01 < deep < 0.5

    def frees(share):
        shifts = [er.Pose(tuple((share * deep * sign * axis).tolist())) for axis in np.eye(3) for sign in (1.0, -1.0)]
        return [bool(er.ArmWorld(robot, scene.moved({"body": each @ placed})).valid(q)) for each in shifts]

    assert any(frees(1.001))
    assert not any(frees(0.99))
    assert depth_in(er.ArmWorld(robot), q) is None
