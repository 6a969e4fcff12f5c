"""A kept scene that asks the robot's own shapes, in coal, where its capsules touch."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from evenroad.geometry import Mesh, PointCloud
from evenroad.geometry.shapes import along_z
from evenroad.robot import ArmWorld, Obstacle, Scene, capsule_endpoints, load_robot
from evenroad.robot_roadmap.build import arm_roadmap
from evenroad.robot_roadmap.recipe import Recipe
from tests_peers.engines.surface import shape_surface

pytest.importorskip("coal")
from evenroad.robot.reference.coal_world import CoalWorld
from evenroad.robot_roadmap.own_shapes import OwnShapesWorld

START, GOAL = np.array([0.0, -1.9, 1.6, -1.3, -1.57, 0.0]), np.array([1.4, -1.6, 1.4, -1.4, -1.57, 0.4])


@pytest.fixture(scope="module")
def robot():
    return load_robot("ur5")


@pytest.fixture(scope="module")
def roadmap(robot):
    return arm_roadmap(ArmWorld(robot), 64, recipe=Recipe(4.0, 30))


def _thin(robot, share=0.7):
    """Meshes within the capsules, of a share of their radius."""
    return [
        Mesh(shape_surface(along_z(replace(capsule, radius=share * capsule.radius))), link=capsule.link)
        for capsule in robot.capsules
    ]


def _beside(robot, q, radius=0.02):
    """A ball that touches the forearm's capsules at a configuration, but not what is in them."""
    at = next(i for i, capsule in enumerate(robot.capsules) if capsule.link == "forearm_link")
    middle = capsule_endpoints(robot, q[np.newaxis])[0, at].mean(axis=0)
    for place in middle + np.random.default_rng(0).uniform(-0.15, 0.15, (1000, 3)):
        ball = Obstacle.of("ball", "sphere", (radius,), tuple(place.tolist()))
        scene = Scene((ball,), name="ball")
        touching = not ArmWorld(robot, scene).valid(q[np.newaxis])[0]
        if touching and CoalWorld(robot, scene, _thin(robot)).valid(q[np.newaxis])[0]:
            return ball
    raise AssertionError("no such ball")


def _fine(world, path):
    """Whether the shapes are free at states a fiftieth of a radian apart."""
    states = [
        world.space.interpolate(np.tile(a, (100, 1)), np.tile(b, (100, 1)), np.linspace(0.0, 1.0, 100))
        for a, b in pairwise(path)
    ]
    return world.valid(np.concatenate(states)).all()


def test_shapes_decide_where_capsules_touch(robot, roadmap):
    ball = _beside(robot, START)
    scene = Scene((ball, Obstacle.of("post", "box", (0.1, 0.1, 0.5), (0.35, 0.45, 0.4))), name="beside")
    blocked = roadmap.within(ArmWorld(robot, scene)).plan(START, GOAL)
    assert blocked.status == "start_invalid"
    result = roadmap.within(OwnShapesWorld(ArmWorld(robot, scene), _thin(robot))).plan(START, GOAL)
    assert result.solved
    assert result.proof == "resolution"
    assert _fine(CoalWorld(robot, scene, _thin(robot)), result.path)
    np.testing.assert_array_equal(result.path[[0, -1]], [START, GOAL])


def test_what_capsules_prove_is_not_asked(robot, roadmap, monkeypatch):
    def asked(*_):
        raise AssertionError("coal was asked")

    known = roadmap.within(OwnShapesWorld(ArmWorld(robot), _thin(robot)))
    monkeypatch.setattr(CoalWorld, "valid", asked)
    monkeypatch.setattr(CoalWorld, "motion_valid", lambda self, a, b: asked() if len(a) else np.empty(0, bool))
    monkeypatch.setattr(CoalWorld, "valid", lambda self, q: asked() if len(q) else np.empty(0, bool))
    result = known.plan(START, GOAL)
    assert result.solved
    assert result.proof == "certified"


def test_verdicts_are_those_of_either(robot):
    rng = np.random.default_rng(5)
    boxes = [Obstacle.of(str(i), "box", (0.15, 0.15, 0.15), tuple(rng.uniform(-0.6, 0.6, 3))) for i in range(8)]
    scene = Scene(tuple(boxes), name="boxes")
    capsules, shapes = ArmWorld(robot, scene), CoalWorld(robot, scene, _thin(robot))
    both = OwnShapesWorld(capsules, _thin(robot))
    q = capsules.space.from_cube(rng.random((1500, 6)))
    free = both.valid(q)
    np.testing.assert_array_equal(free, capsules.valid(q) | shapes.valid(q))
    assert capsules.valid(q).sum() < free.sum() < len(q)
    q = q[free]
    a, b = q[:100], capsules.space.interpolate(q[:100], q[100:200], 0.05)
    free = both.motion_valid(a, b)
    assert free[capsules.motion_certified(a, b, 1e-6)].all()
    assert shapes.motion_valid(a[free], b[free]).all()


def test_clouds_block_as_they_do_for_capsules(robot, roadmap):
    ball = _beside(robot, START)
    cloud = Obstacle("ball", PointCloud(np.array([ball.xyz]), 0.02))
    result = roadmap.within(OwnShapesWorld(ArmWorld(robot, Scene((cloud,), name="scanned")), _thin(robot))).plan(
        START, GOAL
    )
    assert result.status == "start_invalid"
    assert "ball" in result.message


def test_later_queries_go_on_from_what_earlier_ones_found(robot, roadmap):
    scene = Scene(
        tuple(
            Obstacle.of(f"post {i}", "box", (0.08, 0.08, 0.6), (0.45 * np.cos(t), 0.45 * np.sin(t), 0.4))
            for i, t in enumerate((0.5, 1.0))
        ),
        name="posts",
    )
    known = roadmap.within(OwnShapesWorld(ArmWorld(robot, scene), _thin(robot)))
    first = known.plan(START, GOAL)
    assert first.solved
    again = known.plan(first.milestone_path[1], GOAL)
    assert again.solved
    shapes = CoalWorld(robot, scene, _thin(robot))
    assert _fine(shapes, first.path)
    assert _fine(shapes, again.path)
