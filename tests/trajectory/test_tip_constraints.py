import numpy as np
import pytest

import evenroad as er
from evenroad.constraints.tip import KeepUpright
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.planning.read_problem import arm_problem
from evenroad.poses.cartesian_line import CartesianLine
from evenroad.scenes.scene import Scene
from evenroad.trajectory import arm_trajectory
from evenroad.trajectory.tip_constraints import constrained_world

DOWN = np.array([0.0, -1.2, 1.2, -1.57, -1.57, 0.0])
"""Of a UR5 whose tool points down."""

STRAIGHT = CartesianLine(0.1)

TURNING = """<robot name="turning">
<link name="base"/>
<link name="arm"><collision><origin xyz="0.3 0 0" rpy="0 1.5708 0"/>
<geometry><cylinder radius="0.03" length="0.5"/></geometry></collision></link>
<joint name="a" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
<limit effort="1" velocity="1"/></joint>
</robot>"""
"""An arm that turns for ever."""


def free_world():
    return arm_problem("ur5", Scene((), name="nothing"), DOWN, DOWN).world


@pytest.mark.parametrize(("tilt", "kept"), [(0.04, True), (0.2, False)])
def test_what_is_driven_keeps_upright_as_the_path_was_asked_to(tilt, kept):
    world, goal = free_world(), DOWN + np.array([0.5, 0.0, 0.0, tilt, 0.0, 0.0])
    assert arm_trajectory(world, [DOWN, goal]).duration > 0.0
    if kept:
        assert arm_trajectory(world, [DOWN, goal], constraints=KeepUpright(0.05)).proof == "certified"
        return
    with pytest.raises(NotAvailable, match="not proved"):
        arm_trajectory(world, [DOWN, goal], constraints=KeepUpright(0.05))


@pytest.fixture(scope="module")
def straight_path():
    result = er.plan("box-reach", "home", "inside", robot="ur5", constraints=STRAIGHT)
    assert result.solved
    return arm_problem("ur5", "box-reach", "home", "inside").world, result.path


def test_what_is_driven_comes_straight(straight_path):
    world, path = straight_path
    assert arm_trajectory(world, path, constraints=STRAIGHT, rounded_by_controller=True).stops == 0


def test_a_way_that_is_not_straight_is_told(straight_path):
    world, path = straight_path
    asked = constrained_world(world, path, STRAIGHT)
    assert asked.validate(path).all()
    bent = path.copy()
    bent[-5, 0] += 0.01
    np.testing.assert_array_equal(np.flatnonzero(~asked.validate(bent)), len(path) - 6 + np.arange(2))
    # Backwards the line leaves the start.
    back = constrained_world(world, path[::-1], CartesianLine(0.0, 0.1))
    np.testing.assert_array_equal(np.flatnonzero(~back.validate(bent[::-1])), [3, 4])


def test_a_path_without_places_is_named():
    with pytest.raises(InvalidValue, match="two different waypoints"):
        arm_trajectory(free_world(), np.zeros((0, 6)), constraints=KeepUpright(0.1))


@pytest.mark.parametrize("blocked", [False, True])
def test_a_joint_that_turns_for_ever_goes_the_short_way_as_its_path_does(tmp_path, blocked):
    file = tmp_path / "turning.urdf"
    file.write_text(TURNING)
    scene = tmp_path / "post.yaml"
    at = 0.5 if blocked else 5.0
    scene.write_text(f"obstacles: {{post: {{shape: box, size: [0.1, 0.1, 0.5], xyz: [{at}, 0, 0]}}}}\n")
    result = er.plan(scene, [2.6], [-2.6], robot=file)
    world = arm_problem(file, scene, [2.6], [-2.6]).world
    made = arm_trajectory(world, result.path)
    way = 2.0 * (np.pi - 2.6)
    assert made.positions[-1, 0] - made.positions[0, 0] == pytest.approx(way)
    np.testing.assert_allclose(made.waypoints[[0, -1], 0], [2.6, 2.6 + way])
    again = arm_trajectory(world, [[2.6], [-2.6], [-1.1], [-2.6], [2.6]])
    np.testing.assert_allclose(again.waypoints[:, 0], [2.6, 2.0 * np.pi - 1.1, 2.6])
    assert again.positions[-1, 0] == pytest.approx(2.6)


def test_a_plan_that_stays_upright_is_driven_by_its_arm():
    """With its names and limits, and upright: not as a point in a space, one unit a second."""
    home = [-1.2, -2.0, 1.9, -1.5, -np.pi / 2, 0.0]
    world = er.ArmWorld("ur5", er.Scene([]))
    upright = er.constraints.KeepUpright(0.05)
    trajectory = er.plan(world, home, [1.2, *home[1:]], constraints=upright).trajectory()
    assert trajectory.names == world.robot.group
    assert trajectory.limits == arm_trajectory(world, [home, [1.2, *home[1:]]], constraints=upright).limits
