"""Rigid bodies are robots whose first joints slide and then turn: the same code makes their roadmaps."""

import numpy as np
import pytest

from evenroad.geometry.shapes import Capsule
from evenroad.roadmap import Budget
from evenroad.robot import ArmWorld, Joint, Obstacle, Robot, Scene
from evenroad.robot_roadmap.build import arm_roadmap
from evenroad.robot_roadmap.recipe import Recipe
from tests.robot.kernel_arms import STRAIGHT, X, Y, Z
from tests.robot.oracle import clearance
from tests.robot_roadmap.worlds import within

ROOM = 1.5
SHORT = Budget(seconds=0.3)
SLIDES, TURNS = {"x": X, "y": Y, "z": Z}, {"roll": X, "pitch": Y, "yaw": Z}


def _body(*names):
    """An L of two capsules, moved by joints one after the other; pitch has half of a turn, so that poses come once."""
    links, joints = ["room"], []
    for name in names:
        kind, limit = ("prismatic", ROOM) if name in SLIDES else ("continuous", np.inf)
        if name == "pitch":
            kind, limit = "revolute", 0.5 * np.pi
        axis = (SLIDES | TURNS)[name]
        joints.append(Joint(name, kind, links[-1], name, (0.0, 0.0, 0.0), STRAIGHT, axis, -limit, limit, 1.0))
        links.append(name)
    capsules = (
        Capsule((-0.2, 0.0, 0.0), (0.3, 0.0, 0.0), 0.06, link=links[-1]),
        Capsule((-0.2, 0.0, 0.0), (-0.2, 0.25, 0.0), 0.06, link=links[-1]),
    )
    return Robot("body", tuple(links), tuple(joints), capsules, (), names)


BODIES = {"mobile base": ("x", "y", "yaw"), "flying body": ("x", "y", "z", "yaw", "pitch", "roll")}


def _wall(gap):
    """A wall at x = 0 with a window."""
    side = ROOM - 0.5 * gap
    place = 0.5 * (ROOM + 0.5 * gap)
    return (
        Obstacle.of("left", "box", (0.1, side, 3.0), (0.0, place, 0.0)),
        Obstacle.of("right", "box", (0.1, side, 3.0), (0.0, -place, 0.0)),
    )


@pytest.mark.parametrize("names", BODIES.values(), ids=BODIES)
def test_a_body_has_a_roadmap_and_goes_through_a_window(names):
    robot = _body(*names)
    cell = Scene((Obstacle.of("pillar", "box", (0.3, 0.3, 3.0), (0.8, 0.8, 0.0)),), name="room")
    roadmap = arm_roadmap(ArmWorld(robot, cell), 64, recipe=Recipe(4.0, 20))
    assert clearance(robot, cell, roadmap.milestones).min() > 0.0
    start, goal = np.zeros((2, len(names)))
    start[0], goal[0] = -0.9, 0.9
    scene = Scene(_wall(0.8), name="wall")
    result = within(roadmap, scene).plan(start, goal)
    assert result.solved
    assert result.proof == "certified"
    whole = ArmWorld(robot, Scene((*cell.obstacles, *scene.obstacles), name="all"))
    states = [
        whole.space.interpolate(np.tile(a, (50, 1)), np.tile(b, (50, 1)), np.linspace(0.0, 1.0, 50))
        for a, b in zip(result.path[:-1], result.path[1:], strict=True)
    ]
    assert clearance(robot, whole.scene, np.concatenate(states)).min() > 0.0
    assert not within(roadmap, Scene(_wall(0.02), name="shut")).plan(start, goal, budget=SHORT).solved


def test_turning_on_is_a_way_for_a_body():
    """From a heading of 170 to one of -170 degrees it is 20 degrees."""
    roadmap = arm_roadmap(ArmWorld(_body("x", "y", "yaw")), 64, recipe=Recipe(4.0, 20))
    start, goal = np.array([-0.9, 0.0, np.radians(170)]), np.array([0.9, 0.0, np.radians(-170)])
    result = within(roadmap, Scene(name="nothing")).plan(start, goal)
    assert result.cost < 1.9
