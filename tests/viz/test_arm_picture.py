from dataclasses import replace

import numpy as np
import pytest
from PIL import Image, ImageColor

from evenroad.planning import PRM, plan
from evenroad.points import draw
from evenroad.robot import ArmWorld, Obstacle, Scene, capsule_endpoints, configuration, in_scene, load_robot, load_scene
from evenroad.viz import style
from evenroad.viz.arm import draw_arm_view, save_arm_picture
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


def _view(world, result, pair):
    """A view of what is within 1.5 m, as colours (rows, columns, 3), and where points are in it: column, row."""
    view = View(np.full(2, -1.5), np.full(2, 1.5), 400 / 3)
    draw_arm_view(view, result, world, pair)
    return np.asarray(view.image).astype(int), lambda points: (points * [1, -1] + 1.5) * FINER * 400 / 3


def test_the_arm_is_drawn_where_its_capsules_are(reach):
    """Pixels are as bright as paper outside of all that is shown, and are not within the goal's capsules."""
    result = plan(reach, *[configuration(reach.robot, "home", reach.scene)] * 2, draw("korobov", 8, 6))
    bare = ArmWorld(reach.robot, Scene((), name="bare"))
    shown, place = _view(bare, result, (0, 2))
    ends = capsule_endpoints(reach.robot, result.goal[np.newaxis])[0][:, :, [0, 2]]
    radii = np.array([each.radius for each in reach.robot.capsules])
    points = np.random.default_rng(0).uniform(-1.2, 1.2, (4000, 2))
    a, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    t = np.einsum("pck,ck->pc", points[:, np.newaxis] - a, along) / np.maximum((along**2).sum(axis=1), 1e-12)
    nearest = a + np.clip(t, 0, 1)[:, :, np.newaxis] * along
    depth = (radii - np.linalg.norm(points[:, np.newaxis] - nearest, axis=2)).max(axis=1)
    column, row = place(points).astype(int).T
    dark = shown[row, column].min(axis=1) < 220
    assert np.count_nonzero(depth > 0.02) > 50
    assert dark[depth > 0.02].all()
    assert not dark[depth < -0.02].any()


def test_a_solved_plan_shows_the_way_of_the_tip_from_start_to_goal(reach):
    from evenroad.robot import link_poses

    result = _planned(reach)
    shown, place = _view(reach, result, (0, 1))
    fractions = np.linspace(0, 1, 20)[:, np.newaxis]
    dense = np.concatenate([a + fractions * (b - a) for a, b in zip(result.path, result.path[1:], strict=False)])
    tips = link_poses(reach.robot, dense)[:, -1, :2, 3]
    red = np.argwhere(np.abs(shown - ImageColor.getrgb(style.PATH)).sum(axis=2) < 30)[:, ::-1]
    gaps = np.linalg.norm(place(tips)[:, np.newaxis] - red, axis=2).min(axis=1)
    # The dots at both ends lie on the line.
    assert gaps.max() < FINER * 8
    assert np.median(gaps) < FINER
    for tip, colour in ((tips[0], style.START), (tips[-1], style.GOAL)):
        column, row = place(tip).astype(int)
        assert tuple(shown[row, column]) == ImageColor.getrgb(colour)


def test_a_view_of_something_long_and_flat_has_both_sides():
    assert View(np.zeros(2), np.array([1000.0, 0.1]), 0.4).image.size == (400 * FINER, FINER)


@pytest.mark.parametrize(("low", "high"), [(-0.3, 0.9), (0.0, 1e-3), (-5e4, 7e4), (0.94, 1.06)])
def test_ticks_are_a_handful_of_round_numbers(low, high):
    marks = ticks(low, high)
    assert 2 <= len(marks) <= 7
    assert low <= marks[0] < marks[-1] <= high
    np.testing.assert_allclose(np.diff(marks), marks[1] - marks[0])
    assert len(f"{marks[1] - marks[0]:.6g}".strip("0.e-+")) <= 4


def _pixels_of(picture, colour):
    rgb = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)])
    return (np.abs(np.asarray(picture.convert("RGB")).astype(int) - rgb).sum(axis=2) < 30).sum()


def test_the_saved_picture_shows_start_goal_and_path(reach, tmp_path):
    save_arm_picture(tmp_path / "a.png", _planned(reach), reach)
    with Image.open(tmp_path / "a.png") as picture:
        for colour in (style.START, style.GOAL, style.PATH):
            assert _pixels_of(picture, colour) > 50
        assert picture.size[0] < 2500


def test_without_a_path_there_is_no_red_and_in_collision_the_two_bodies_are_red(reach, tmp_path):
    save_arm_picture(tmp_path / "none.png", _planned(reach, n=8), reach)
    hit = _planned(reach, goal="shoulder_lift_joint=0.3")
    assert hit.status == "goal_invalid"
    save_arm_picture(tmp_path / "hit.png", hit, reach)
    with Image.open(tmp_path / "none.png") as none, Image.open(tmp_path / "hit.png") as picture:
        assert _pixels_of(none, style.COLLISION) < 50
        assert _pixels_of(picture, style.COLLISION) > 500


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
