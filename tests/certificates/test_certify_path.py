"""Paths of other planners: the first touch of a ball on a turning arm is where the law of cosines puts it."""

import math

import numpy as np
import pytest

import evenroad as er
from evenroad.certificates.certify_path import certify_path
from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from tests.certificates.small import URDF

AWAY = 1.5
"""Angle at which the obstacle is, as far from the axis as the arm's ball of 0.1 m [rad]."""


def world_with(obstacle, folder, urdf=URDF, **of_world):
    (folder / "arm.urdf").write_text(urdf)
    return er.ArmWorld(er.load_robot(folder / "arm.urdf"), er.Scene([obstacle]), **of_world)


def ball(radius, away=AWAY):
    return er.Sphere(radius, xyz=(math.cos(away), math.sin(away), 0.0), name="ball")


@pytest.mark.parametrize("clearance", [0.0, 0.01])
def test_the_first_touch_is_where_two_balls_meet(clearance, tmp_path):
    world = world_with(ball(0.2), tmp_path, clearance=clearance)
    check = certify_path([[-2.0], [0.0], [3.0]], world)
    meeting = AWAY - 2.0 * math.asin(0.5 * (0.3 + clearance))
    assert check.status == "touches"
    assert not check.free
    touch = check.touch
    assert touch.bodies == ("ball", "ball")
    assert touch.waypoint == 1
    assert touch.share == pytest.approx(meeting / 3.0, abs=1e-6)
    assert touch.configuration[0] >= meeting - 1e-8
    assert touch.free_until[0] == 1
    assert touch.share - 1e-6 <= touch.free_until[1] <= meeting / 3.0
    assert certify_path([[-2.0], [0.0], [meeting - 1e-6]], world).free


@pytest.mark.parametrize(("gap", "status"), [(2e-7, "free"), (2e-9, "undecided"), (-5e-8, "touches"), (0.0, "touches")])
def test_a_path_that_grazes_is_decided_by_how_near_it_comes(gap, status, tmp_path):
    # The arm's ball passes straight above this one.
    sphere = er.Sphere(0.2, xyz=(math.cos(0.3), math.sin(0.3), -0.3 - gap), name="ball")
    found = certify_path([[-1.0], [1.0]], world_with(sphere, tmp_path))
    assert found.status == status
    if found.touch is not None:
        assert found.touch.share == pytest.approx(0.65, abs=1e-3)
        assert ("1e-07 m" in str(found)) == (status == "undecided")


def test_a_slow_approach_is_proved_until_right_before_its_touch(tmp_path):
    # For 1e-5 of the motion the two are nearer than 1e-7 m before they touch.
    sphere = er.Sphere(0.2, xyz=(math.cos(0.3), math.sin(0.3), -0.3 + 1e-4), name="ball")
    touch = certify_path([[-1.0], [1.0]], world_with(sphere, tmp_path)).touch
    meeting = 0.3 - 2.0 * math.asin(0.5 * math.sqrt(0.3**2 - (0.3 - 1e-4) ** 2))
    assert touch.share == pytest.approx(0.5 * (meeting + 1.0), abs=1e-6)
    assert touch.share - 1e-6 <= touch.free_until[1] < 0.5 * (meeting + 1.0)


def test_a_touch_behind_a_place_that_is_undecided_is_found(tmp_path):
    (tmp_path / "arm.urdf").write_text(URDF)
    near = er.Sphere(0.2, xyz=(math.cos(0.3), math.sin(0.3), -0.3 - 2e-9), name="near")
    world = er.ArmWorld(er.load_robot(tmp_path / "arm.urdf"), er.Scene([near, ball(0.2)]))
    touch = certify_path([[-1.0], [1.4]], world).touch
    assert touch.bodies == ("ball", "ball")
    assert touch.configuration[0] == pytest.approx(AWAY - 2.0 * math.asin(0.15), abs=1e-5)
    assert -1.0 + 2.4 * touch.free_until[1] == pytest.approx(0.3, abs=1e-3)


def test_a_ball_that_begins_inside_of_a_closed_mesh_touches_it(tmp_path):
    corners = [(x, y, z) for x in (-2, 2) for y in (-2, 2) for z in (-1, 1)]
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
    faces += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    check = certify_path([[0.0], [1.0]], world_with(er.Mesh((corners, faces), name="room"), tmp_path))
    assert check.status == "touches"
    assert check.touch.bodies == ("ball", "room")
    assert check.touch.share == 0.0
    # Without its ceiling it is a surface.
    assert certify_path([[0.0], [1.0]], world_with(er.Mesh((corners, faces[:-2]), name="room"), tmp_path)).free


def test_the_shapes_of_the_file_decide_where_it_is_given():
    world = er.ArmWorld("ur5", "box-reach")
    path = er.plan(world, "home", "inside").path
    assert certify_path(path, world).bodies == "capsules"
    assert certify_path(path, world, robot="ur5").free
    assert certify_path(path[:1], world).free


def test_a_cloud_is_touched_by_its_balls(tmp_path):
    cloud = er.PointCloud([(math.cos(AWAY), math.sin(AWAY), 0.0)], radius=0.2, name="scan")
    touch = certify_path([[0.0], [3.0]], world_with(cloud, tmp_path)).touch
    assert touch.share == pytest.approx((AWAY - 2.0 * math.asin(0.15)) / 3.0, abs=1e-6)
    assert touch.bodies == ("ball", "scan")


TWO = URDF.replace("</robot>", "") + (
    """<link name="tip"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <joint name="bend" type="revolute"><parent link="base"/><child link="tip"/><origin xyz="0 0 2"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3"/></joint></robot>"""
)


def test_columns_are_taken_by_their_names_and_others_are_held(tmp_path):
    (tmp_path / "arm.urdf").write_text(TWO)
    world = er.ArmWorld(er.load_robot(tmp_path / "arm.urdf", group="turn"), er.Scene([ball(0.2)]))
    file = tmp_path / "path.csv"
    file.write_text("time,bend,turn\n0,0.5,0\n1,0.5,1\n")
    assert certify_path(file, world).free
    file.write_text("turn\n0\n1.4\n")
    assert certify_path(file, world).status == "touches"
    for text, error, said in (
        ("bend,turn\n0.5,0\n0.6,1\n", InvalidValue, "moves joint 'bend'"),
        ("bend\n0.5\n", UnknownName, "lacks joint 'turn'"),
        ("turn,bond\n0,1\n", UnknownName, "did you mean 'bend'"),
        ("turn\n0\nx\n", BrokenFile, "waypoint 1"),
        ("turn [deg]\n0\n", BrokenFile, "radians"),
    ):
        file.write_text(text)
        with pytest.raises(error, match=said):
            certify_path(file, world)


def test_degrees_and_values_outside_of_limits_are_refused(tmp_path):
    world = world_with(ball(0.2), tmp_path)
    with pytest.raises(InvalidValue, match="waypoint 1 .* outside its limits -3 .. 3; are these degrees"):
        certify_path([[0.0], [90.0]], world)
    with pytest.raises(InvalidValue, match=r"outside its limits -3 .. 3$"):
        certify_path([[0.0], [1000.0]], world)
    with pytest.raises(InvalidValue, match="one waypoint or more"):
        certify_path(np.zeros((0, 1)), world)


def test_a_joint_without_limits_goes_as_the_numbers_say(tmp_path):
    endless = URDF.replace("revolute", "continuous").replace('<limit lower="-3" upper="3"/>', "")
    check = certify_path([[-0.1], [2.0 * math.pi - 0.2]], world_with(ball(0.2), tmp_path, endless))
    assert check.status == "touches"
    assert "not the shorter way" in check.notes[0]
