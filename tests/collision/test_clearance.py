"""Arms that keep a distance from obstacles: no body nearer than the clearance, and none farther off than it has to."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue
from evenroad.planning import plan
from evenroad.planning.arm_trees import connect, shorten
from evenroad.robot import configuration, load_robot, load_scene
from evenroad.scenes.scene import Obstacle, Scene
from tests.robots.kernel_arms import box_scene, edge, random_scene, random_tree, ur5
from tests.robots.oracle import clearance
from tests.robots.paths import GOAL, START, dense_states
from tests.robots.surface_oracle import all_clearance
from tests.robots.surface_scenes import BOXES, cloud_scene, scene_of

BAND = 2e-4
"""Verdicts of single precision may be on the safe side by this [m]."""
ROUNDING = 1e-12
CASES = {
    "ur5 in a box": (ur5(np.pi), box_scene()),
    "ur5 among everything": (ur5(np.pi), random_scene(5)),
    "tree with a joint that wraps": (random_tree(13), random_scene(113, spread=0.7, clear=0.45)),
}


@pytest.mark.parametrize("case", CASES)
def test_free_is_what_keeps_the_clearance_from_obstacles_and_does_not_touch_itself(case):
    (robot, scene), kept = CASES[case], 0.01
    world = ArmWorld(robot, scene, clearance=kept)
    q = world.space.from_cube(np.random.default_rng(0).random((3000, world.space.dim)))
    # Half of them on either side of the edge.
    q = np.concatenate([q[:500], *edge(world, q, 300)])
    free = world.valid(q)
    obstacles = clearance(replace(robot, pairs=()), scene, q)
    itself = clearance(robot, Scene(name="nothing"), q)
    assert not free[(obstacles < kept - ROUNDING) | (itself < -ROUNDING)].any()
    assert free[(obstacles > kept + BAND) & (itself > BAND)].all()
    assert np.sum(free & (obstacles < kept + 10.0 * BAND)) > 10
    # Bodies come nearer than that to each other.
    assert case == "ur5 in a box" or np.any(free & (itself < kept))


def test_every_state_of_a_path_keeps_the_clearance():
    robot, scene, kept = ur5(np.pi, joints=5), box_scene(), 0.01
    world = ArmWorld(robot, scene, clearance=kept)
    alone = replace(robot, pairs=())
    found = connect(world, START, [GOAL])
    assert found.goal == 0
    short, _ = shorten(world, found.path)
    near = clearance(alone, scene, dense_states(world, short)).min()
    assert kept <= near < 2.0 * kept
    assert world.validate(short).all()
    # Without, the way is cut as far as it goes.
    plain = ArmWorld(robot, scene)
    tight, _ = shorten(plain, connect(plain, START, [GOAL]).path)
    assert clearance(alone, scene, dense_states(plain, tight)).min() < kept
    assert not world.validate(tight).all()


@pytest.mark.parametrize("scene", [cloud_scene(3, 257, 0.05), scene_of(*BOXES)], ids=["cloud", "mesh"])
def test_clouds_and_meshes_are_kept_clear_of(scene):
    robot, kept = replace(ur5(np.pi), pairs=()), 0.02
    world = ArmWorld(robot, scene, clearance=kept)
    q = world.space.from_cube(np.random.default_rng(2).random((600, 6)))
    q = np.concatenate([q[:200], *edge(world, q, 100)])
    free, near = world.valid(q), all_clearance(robot, scene, q)
    assert not free[near < kept - ROUNDING].any()
    assert free[near > kept + BAND].all()
    # What is given up lies near.
    assert np.sum((near > 0.0) & ~free) > 50


def test_what_is_nearer_than_the_clearance_is_told_so_and_what_touches_is_told_that():
    robot, scene = (ur5(np.pi), Scene((Obstacle.of("wall", "box", (0.1, 2.0, 2.0), (0.9, 0.0, 0.5)),), name="s"))
    world, plain = ArmWorld(robot, scene, clearance=0.3), ArmWorld(robot, scene)
    q = world.space.from_cube(np.random.default_rng(0).random((600, 6)))
    told = [world.explain(each) for each in q]
    free = plain.valid(q)
    for row, text, within in zip(q, told, world.valid(q), strict=True):
        assert (text == "it is free") == within
        if "clearance" in text:
            said, away = text.removesuffix(" m away").split(" is nearer than the clearance 0.3 to 'wall', ")
            assert said.startswith("'")
            assert float(away) == pytest.approx(plain._distances(row[np.newaxis], to_itself=False)[0][0], rel=0.01)
    nearer = np.array(["clearance" in text for text in told])
    np.testing.assert_array_equal(nearer, free & ~world.valid(q))
    assert nearer.sum() > 20
    result = plan(scene, q[world.valid(q)][0], q[nearer][0], robot=robot, clearance=0.3)
    assert result.status == "goal_invalid"
    assert "is nearer than the clearance 0.3 to 'wall'" in result.message


def test_an_obstacle_that_is_to_be_kept_away_from_is_not_said_to_be_touched():
    robot, scene = ur5(np.pi), Scene((Obstacle.of("wall", "box", (0.1, 2.0, 2.0), (0.9, 0.0, 0.5)),), name="s")
    q = ArmWorld(robot).space.from_cube(np.random.default_rng(0).random((600, 6)))
    some = q[ArmWorld(robot, scene).valid(q) & ~ArmWorld(robot, scene.with_clearance({"wall": 0.2})).valid(q)][0]
    told = ArmWorld(robot, scene.with_clearance({"wall": 0.2})).explain(some)
    assert "is nearer than the clearance 0.2 to 'wall', 0." in told
    told = ArmWorld(robot, scene.with_clearance({"wall": 0.2}), clearance=0.1).explain(some)
    assert "is nearer than the clearance 0.3 to 'wall', 0." in told


def test_a_world_with_a_clearance_is_another_world():
    robot, scene = ur5(), box_scene()
    plain = ArmWorld(robot, scene)
    assert ArmWorld(robot, scene, clearance=0.0).fingerprint() == plain.fingerprint()
    assert len({ArmWorld(robot, scene, clearance=c).fingerprint() for c in (0.0, 0.01, 0.02)}) == 3
    # The robot's own tables are as they were.
    q = plain.space.from_cube(np.random.default_rng(0).random((500, 6)))
    np.testing.assert_array_equal(ArmWorld(robot, scene).valid(q), plain.valid(q))


@pytest.mark.parametrize("value", [-0.01, float("nan"), 2.0, "near"])
def test_a_clearance_that_makes_no_sense_is_refused(value):
    with pytest.raises(InvalidValue, match="clearance must be"):
        ArmWorld(ur5(), box_scene(), clearance=value)


def test_a_plan_keeps_the_clearance_it_is_asked_for():
    result = plan("box-reach", "home", "inside", robot="ur5", clearance=0.005)
    assert result.solved
    assert plan("box-reach", "home", "inside", robot="ur5").solved
    world = ArmWorld(load_robot("ur5"), load_scene("box-reach"), clearance=0.005)
    assert world.validate(result.path).all()


def test_the_clearance_of_a_path_is_that_of_its_links_with_all_that_they_were_to_keep():
    scene, robot = load_scene("box-reach"), load_robot("ur5")
    path = plan(scene, "home", "inside", robot=robot, clearance=0.01).path
    bare = ArmWorld(robot, scene)
    kept = (
        ArmWorld(robot, scene.with_clearance(dict.fromkeys(scene.names, 0.008))),
        ArmWorld(robot.with_padding(0.008), scene),
        ArmWorld(robot, scene, clearance=0.008),
    )
    for world in kept:
        assert world.validate(path).all()
        assert world.path_clearance(path) == pytest.approx(bare.path_clearance(path), abs=2e-4)
        assert world.path_clearance(path) > 0.0099
        assert world.nearest_along(path) == bare.nearest_along(path)


def test_a_path_tells_a_clearance_that_it_keeps_and_hardly_more():
    world = ArmWorld(load_robot("ur5"), load_scene("box-reach"))
    scene = load_scene("box-reach")
    ends = [configuration(world.robot, name, scene) for name in ("home", "inside")]
    result = plan(world, *ends)
    assert result.clearance is not None
    along = np.concatenate([a + np.linspace(0.0, 1.0, 60)[:, np.newaxis] * (b - a) for a, b in pairwise(result.path)])
    nearest = clearance(replace(world.robot, pairs=()), scene, along).min()
    assert result.clearance < nearest < result.clearance + 0.002
    # Without the pair that it names it has more room.
    without = ArmWorld(world.robot, replace(scene, allowed=scene.allowed | {result.nearest}))
    assert without.path_clearance(result.path) > result.clearance + 1e-4
