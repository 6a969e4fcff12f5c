"""Links that keep more away from obstacles: as the same links nearer by their padding, and nothing else changes."""

from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import EvenroadError, InvalidValue, UnknownName
from evenroad.geometry import Box, Sphere
from evenroad.robot import load_robot
from evenroad.scenes.scene import Scene
from tests.refused import refused
from tests.robots.kernel_arms import edge, random_scene, ur5
from tests.robots.mesh_arms import write_fork_arm
from tests.robots.surface_scenes import all_sorts, cloud_scene, scene_of
from tests.robots.urdf_texts import joint, link, urdf

PADDING = 0.03
WIDE = "<limit lower='-3' upper='3' velocity='2' effort='1'/>"
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


def test_padding_is_refused_where_it_is_none():
    robot = load_robot("ur5")
    refused(UnknownName, "unknown link of 'ur5': 'tip'", robot.with_padding, {"tip": 0.01})
    refused(InvalidValue, "the padding of 'tool0' must be a finite number >= 0", robot.with_padding, {"tool0": -0.01})
    refused(InvalidValue, "must be at most 1", robot.with_padding, {"tool0": 2.0})
    refused(InvalidValue, "padding must be a length, a mapping", robot.with_padding, [0.01])
    assert robot.with_padding(0.01) == robot.with_padding(dict.fromkeys(robot.links, 0.01)) != robot


def test_a_file_of_moveit_pads_links_wherever_its_parameters_lie(tmp_path):
    file, robot = tmp_path / "joint_limits.yaml", load_robot("ur5")
    said = "default_robot_padding: 0.01, default_robot_link_padding: {tool0: 0.02}, default_robot_scale: 1.0"
    file.write_text(
        f"joint_limits: {{}}\nmove_group: {{ros__parameters: {{robot_description_planning: {{{said}}}}}}}\n"
    )
    wanted = robot.with_padding(0.01).with_padding({"tool0": 0.02})
    assert robot.with_padding(file) == load_robot("ur5", padding=file) == wanted
    # As read by what makes worlds, and not kept with the file's robot.
    assert er.plan("box-reach", "home", "inside", robot="ur5", padding=str(file)).world.robot.padding == wanted.padding
    assert load_robot("ur5") == robot
    for text, error in {
        "joint_limits: {}": "it must have default_robot_padding",
        "default_robot_link_padding: {tip: 0.1}": "unknown link in default_robot_link_padding",
        "default_robot_link_padding: [0.1]": "must be a mapping, link -> number",
        "default_robot_padding: 0\na: {default_robot_pading: 1}": "did you mean 'default_robot_padding'",
        "default_robot_padding: -0.1": "the padding of 'base_link' in",
        "default_robot_scale: 0.9": "the scale of 'base_link' in .* must be at least 1, got 0.9",
        "default_robot_scale: 99": "the scale of .*, in metres, must be at most 1",
        "default_object_padding: 0.1": "default_object_padding in .* must be 0, got 0.1: give a clearance",
        "a: {default_robot_padding: 0}\nb: {default_robot_padding: 1}": "has default_robot_padding twice",
    }.items():
        file.write_text(text)
        with pytest.raises(EvenroadError, match=error):
            robot.with_padding(file)


def test_a_scaled_link_is_never_freer_than_the_same_link_with_larger_shapes(tmp_path):
    def arm(scale, bodies="shapes"):
        size, radius, length = " ".join(f"{scale * each:.6f}" for each in (0.05, 0.1, 0.4)), scale * 0.06, scale * 0.1
        shapes = [f"<box size='{size}'/>", f"<cylinder radius='{radius}' length='{length}'/>"]
        here = [
            f"<collision><origin xyz='0 0 {z}'/><geometry>{s}</geometry></collision>"
            for z, s in zip((0.4, 0.9), shapes, strict=True)
        ]
        text = urdf(
            link("base"), link("arm", "".join(here)), joint("turn", "base", "arm", "revolute", WIDE, "0 0 0", "0 1 0")
        )
        (tmp_path / "arm.urdf").write_text(text)
        return load_robot(tmp_path / "arm.urdf", bodies=bodies)

    (tmp_path / "scale.yaml").write_text("default_robot_link_scale: {arm: 1.3}")
    scene = Scene([Sphere(0.1, xyz=(0.55, 0, 0.6), name="ball"), Box((0.2, 1, 0.2), xyz=(-0.9, 0, 0), name="post")])
    q = np.linspace(-1.5, 1.5, 3000)[:, np.newaxis]
    larger = ArmWorld(arm(1.3), scene).valid(q)
    for bodies in ("shapes", "capsules"):
        padded = ArmWorld(arm(1.0, bodies).with_padding(tmp_path / "scale.yaml"), scene).valid(q)
        assert not (padded & ~larger).any()
        assert 0 < padded.sum() < larger.sum() < ArmWorld(arm(1.0), scene).valid(q).sum()


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
    refused(InvalidValue, "clearance", scene.with_clearance, {"glass": -0.1})
    refused(UnknownName, "glass", scene.with_clearance, {"gless": 0.1})
    refused(InvalidValue, "clearance", Scene, {"obstacles": {"glass": entry | {"clearance": 3}}})
