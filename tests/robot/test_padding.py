"""Links that keep more away from obstacles: as the same links nearer by their padding, and nothing else changes."""

from dataclasses import replace

import numpy as np
import pytest

from evenroad.errors import InvalidValue, UnknownName
from evenroad.geometry import Box, Sphere
from evenroad.robot import load_robot
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.scene import Scene
from evenroad.robot_roadmap.build import build_roadmap
from evenroad.robot_roadmap.static_scene import require_agrees
from tests.refused import refused
from tests.robot.kernel_arms import edge, random_scene, ur5
from tests.robot.mesh_arms import write_fork_arm
from tests.robot.surface_scenes import all_sorts, cloud_scene, scene_of

PADDING = 0.03
BAND = 1.2e-5


@pytest.fixture(scope="module")
def fork(tmp_path_factory):
    """An arm whose true shapes decide."""
    return load_robot(write_fork_arm(tmp_path_factory.mktemp("fork")), bodies="shapes")


@pytest.mark.parametrize("what", ["primitives", "points", "triangles", "true shapes"])
def test_a_padded_link_is_nearer_by_its_padding(what, fork):
    scenes = {"points": cloud_scene(3, 200), "triangles": scene_of(all_sorts(2))}
    scene = scenes.get(what, random_scene(4, 8, spread=0.6))
    robot, link = (fork, "fork") if what == "true shapes" else (ur5(), "forearm")
    alone = {(other, each.name) for other in robot.links if other != link for each in scene.obstacles}
    scene, robot = replace(scene, allowed=frozenset(alone)), replace(robot, pairs=())
    plain, padded = ArmWorld(robot, scene), ArmWorld(robot.with_padding({link: PADDING}), scene)
    q = plain.space.from_cube(np.random.default_rng(1).random((300, plain.dim)))
    before, after = plain.distance(q).metres, padded.distance(q).metres
    near = before < 1.0
    np.testing.assert_allclose(after[near], np.maximum(before[near] - PADDING, 0.0), atol=BAND)
    # Near contact: never free where the padding is not kept, and free where more is.
    free, blocked = edge(padded, plain.space.from_cube(np.random.default_rng(2).random((4000, plain.dim))))
    assert (plain.distance(free).metres >= PADDING - BAND).all()
    assert (plain.distance(blocked).metres <= PADDING + BAND).all()
    assert padded.fingerprint() != plain.fingerprint()


def test_padding_is_kept_all_along_what_is_proved_and_from_what_lies_beyond_the_reach():
    robot = replace(ur5(), pairs=())
    every = dict.fromkeys(robot.links[1:], PADDING)
    scene = random_scene(5)
    padded, clear = ArmWorld(robot.with_padding(every), scene), ArmWorld(robot, scene, clearance=PADDING)
    q = padded.space.from_cube(np.random.default_rng(3).random((400, 6)))
    a, b = q[:200], q[:200] + 0.1 * (q[200:] - q[:200])
    np.testing.assert_array_equal(padded.motion_certified(a, b, 1e-4), clear.motion_certified(a, b, 1e-4))
    reach = padded.robot_tables.reach - PADDING
    beyond = Scene([Sphere(0.05, xyz=(0.0, 0.0, reach + 0.05 + 0.01), name="ball")])
    np.testing.assert_array_equal(
        ArmWorld(robot.with_padding(every), beyond).valid(q), ArmWorld(robot, beyond, clearance=PADDING).valid(q)
    )


def test_links_are_tested_against_each_other_as_they_are_and_so_is_what_stands_still():
    robot = load_robot("ur5")
    padded = robot.with_padding(dict.fromkeys(robot.links, 0.05))
    q = ArmWorld(robot).space.from_cube(np.random.default_rng(4).random((2000, 6)))
    np.testing.assert_array_equal(ArmWorld(padded).valid(q), ArmWorld(robot).valid(q))
    table = Scene([Box((1, 1, 0.1), xyz=(0, 0, -0.17), name="table")])
    for world in (ArmWorld(robot, table), ArmWorld(padded, table), ArmWorld(robot, table, clearance=0.05)):
        assert world.fixed_contact is None
    higher = Scene([Box((1, 1, 0.1), xyz=(0, 0, -0.05), name="table")])
    assert "allowed: {table: [base_link]}" in ArmWorld(padded, higher).explain("home")
    # The last word stays, 0 takes it back, and a tool brings its own.
    assert padded.with_padding(dict.fromkeys(robot.links, 0.0)).padding == ()
    assert robot.with_tool(robot.with_padding({"tool0": 0.01}), "tool0", prefix="t_").padding == (("t_tool0", 0.01),)


def test_padding_is_refused_where_it_is_none_and_by_a_roadmap_that_was_made_with_another():
    robot = load_robot("ur5")
    made = build_roadmap(ArmWorld(robot), 16)
    with pytest.raises(InvalidValue, match="link 'tool0' had a padding of 0 m, now 0.01 m"):
        made.within(ArmWorld(robot.with_padding({"tool0": 0.01})))
    refused(UnknownName, "unknown link of 'ur5': 'tip'", robot.with_padding, {"tip": 0.01})
    refused(InvalidValue, "the padding of 'tool0' must be a finite number >= 0", robot.with_padding, {"tool0": -0.01})
    refused(InvalidValue, "must be at most 1", robot.with_padding, {"tool0": 2.0})
    refused(InvalidValue, "padding must be a mapping", robot.with_padding, 0.01)


@pytest.mark.parametrize("what", ["primitives", "points", "triangles", "true shapes"])
def test_from_an_obstacle_with_a_clearance_robots_keep_that_much_more_away(what, fork):
    scenes = {"points": cloud_scene(3, 200), "triangles": scene_of(all_sorts(2))}
    scene = scenes.get(what, random_scene(4, 8, spread=0.6))
    robot = replace(fork if what == "true shapes" else ur5(), pairs=())
    name = scene.names[0]
    alone = replace(scene, allowed=frozenset((link, other) for link in robot.links for other in scene.names[1:]))
    plain, roomy = ArmWorld(robot, alone), ArmWorld(robot, alone.with_clearance({name: PADDING}))
    q = plain.space.from_cube(np.random.default_rng(1).random((300, plain.dim)))
    before, after = plain.distance(q).metres, roomy.distance(q).metres
    near = before < 1.0
    np.testing.assert_allclose(after[near], np.maximum(before[near] - PADDING, 0.0), atol=BAND)
    assert not roomy.valid(q[before < PADDING - BAND]).any()
    assert roomy.valid(q[before > PADDING + BAND]).all()


def test_a_clearance_of_an_obstacle_is_read_checked_and_part_of_what_a_scene_is():
    entry = {"shape": "box", "size": [0.1, 0.1, 0.1], "clearance": 0.02}
    scene = Scene({"obstacles": {"glass": entry}})
    assert scene.obstacles[0].clearance == 0.02
    assert scene.fingerprint() != scene.with_clearance({"glass": 0.0}).fingerprint()
    with pytest.raises(InvalidValue, match="with a clearance of 0.02 m, in the roadmap's"):
        require_agrees(scene.with_clearance({"glass": 0.0}), scene)
    refused(InvalidValue, "clearance", scene.with_clearance, {"glass": -0.1})
    refused(UnknownName, "glass", scene.with_clearance, {"gless": 0.1})
    refused(InvalidValue, "clearance", Scene, {"obstacles": {"glass": entry | {"clearance": 3}}})
