from dataclasses import replace

import numpy as np
import pytest
import trimesh
from PIL import Image

import evenroad as er
from evenroad.planning import PRM, plan
from evenroad.points import draw
from evenroad.robot import ArmWorld, Obstacle, Scene, configuration, in_scene, load_model, load_robot, load_scene
from evenroad.viz import style
from evenroad.viz.arm import SIZE, draw_arm_plan, save_arm_picture
from evenroad.viz.bodies import robot_parts, robot_sets
from evenroad.viz.sheet import FINER, View, ticks


@pytest.fixture(scope="module")
def reach(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("EVENROAD_CACHE", str(tmp_path_factory.mktemp("cache")))
        scene = load_scene("box-reach")
        return ArmWorld(in_scene(load_robot("ur5"), scene), scene)


def _planned(world, start="home", goal="inside", n=512):
    ends = [configuration(world.robot, text, world.scene) for text in (start, goal)]
    return plan(world, *ends, draw("korobov", n, 6))


def test_a_view_of_something_long_and_flat_has_both_sides():
    assert View(np.zeros(2), np.array([1000.0, 0.1]), 0.4).image.size == (400 * FINER, FINER)


@pytest.mark.parametrize(("low", "high"), [(-0.3, 0.9), (0.0, 1e-3), (-5e4, 7e4), (0.94, 1.06)])
def test_ticks_are_a_handful_of_round_numbers(low, high):
    marks = ticks(low, high)
    assert 2 <= len(marks) <= 7
    assert low <= marks[0] < marks[-1] <= high
    np.testing.assert_allclose(np.diff(marks), marks[1] - marks[0])
    assert len(f"{marks[1] - marks[0]:.6g}".strip("0.e-+")) <= 4


def _coloured(picture, colour):
    """Number of pixels that have about the hue of a colour."""
    shown = np.asarray(picture.convert("RGB"), dtype=float)
    wanted = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)], dtype=float)
    shown, wanted = shown - shown.mean(axis=-1, keepdims=True), wanted - wanted.mean()
    strength = np.linalg.norm(shown, axis=-1)
    alike = shown @ wanted / np.maximum(strength * np.linalg.norm(wanted), 1e-9)
    return np.count_nonzero((alike > 0.93) & (strength > 25))


def test_the_saved_picture_shows_start_goal_and_path(reach, tmp_path):
    save_arm_picture(tmp_path / "a.png", _planned(reach), reach)
    with Image.open(tmp_path / "a.png") as picture:
        for colour in (style.START, style.GOAL, style.PATH):
            assert _coloured(picture, colour) > 500
        assert picture.size[0] == SIZE[0]


def test_without_a_path_there_is_no_red_and_in_collision_both_bodies_are_red(reach):
    none, hit = _planned(reach, n=8), _planned(reach, goal="shoulder_lift_joint=0.3")
    assert hit.status == "goal_invalid"
    assert _coloured(draw_arm_plan(none, reach), style.COLLISION) < 50
    assert _coloured(draw_arm_plan(hit, reach), style.COLLISION) > 5000


def test_the_robot_looks_as_its_file_draws_it_and_large_meshes_lose_small_details(tmp_path):
    """A fine ball is drawn in place of a box, from the cache the second time, and nothing of it is far off."""
    ball = trimesh.creation.icosphere(subdivisions=6, radius=0.1)
    ball.export(tmp_path / "ball.stl")
    (tmp_path / "arm.urdf").write_text(
        '<robot name="arm"><link name="base"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>'
        '</link><link name="tip"><visual><geometry><mesh filename="ball.stl"/></geometry></visual><collision><geometry>'
        '<box size="0.3 0.1 0.1"/></geometry></collision></link><joint name="turn" type="revolute">'
        '<parent link="base"/>'
        '<child link="tip"/><origin xyz="0 0 0.5"/><axis xyz="0 0 1"/>'
        '<limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>'
    )
    robot = load_model(tmp_path / "arm.urdf")
    first, second = (robot_parts(robot.robot, robot.file) for _ in range(2))
    assert len(ball.faces) == 81920 > 2.0 * len(first["tip"].corners) > 2000
    away = np.linalg.norm(first["tip"].corners, axis=2)
    assert abs(away - 0.1).max() < 0.003
    for name in ("corners", "normals"):
        np.testing.assert_allclose(getattr(first["tip"], name), getattr(second["tip"], name), atol=1e-3)
    assert list(robot_sets(robot.robot, robot.file).sets) == ["visual", "collision", "capsules"]


def test_dollars_in_names_are_dollars(tmp_path):
    robot = load_robot("arm7")
    tip = robot.links[-1]
    named = replace(
        robot,
        links=(*robot.links[:-1], "$tip_{$"),
        joints=tuple(replace(each, child="$tip_{$") if each.child == tip else each for each in robot.joints),
        capsules=tuple(replace(each, link="$tip_{$") if each.link == tip else each for each in robot.capsules),
        pairs=tuple((a if a != tip else "$tip_{$", b if b != tip else "$tip_{$") for a, b in robot.pairs),
    )
    ball = Obstacle.of("$\\frac{$", "sphere", (0.5,), (0, 0, 0.5))
    far = Obstacle.of("$\\frac{$", "sphere", (0.05,), (9, 9, 9))
    for obstacle, status in ((ball, "start_invalid"), (far, "solved")):
        world = ArmWorld(named, Scene((obstacle,), name="$\\sqrt{$"))
        result = plan(world, np.zeros(7), np.full(7, 0.05), draw("halton", 8, 7))
        assert result.status == status
        save_arm_picture(tmp_path / "a.png", result, world)


def test_an_empty_scene_and_a_huge_floor_are_drawn_too(tmp_path):
    robot = load_robot("arm7")
    floor = Obstacle.of("floor", "box", (100.0, 100.0, 0.1), (0, 0, -0.05), cell=True)
    for scene in (Scene((), name="empty"), Scene((floor,), name="floor", allowed=frozenset({("base_link", "floor")}))):
        world = ArmWorld(robot, scene)
        goal = np.full(7, 0.5)
        save_arm_picture(tmp_path / "a.png", plan(world, np.zeros(7), goal, PRM(draw("halton", 8, 7))), world)
        assert (tmp_path / "a.png").exists()


def test_what_a_robot_holds_is_drawn_as_its_own_shape_in_every_way():
    box = er.Box((0.3, 0.2, 0.1), xyz=(0.0, 0.0, 0.1))
    model = load_model("ur5")
    robot = model.robot.holding(box, "tool0", name="can")
    for links in (robot_parts(robot), robot_parts(robot, model.file), robot_sets(robot, model.file).sets["collision"]):
        corners = links["can"].corners.reshape(-1, 3)
        np.testing.assert_allclose(np.ptp(corners, axis=0), box.size, atol=1e-9)
        assert len(links["can"].corners) == 12
