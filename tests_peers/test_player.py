"""The page that plays offline, in a browser: its kinematics are ours, it plays, and it shows what its boxes say."""

import numpy as np
import pytest

import evenroad as er
from evenroad.robots.kinematics import link_poses
from evenroad.viz.player import save_page
from tests_peers.chromium import opened

BOX = [(-0.45, -0.31), (0.45, -0.31), (0.45, 0.31), (-0.45, 0.31)]


@pytest.fixture(scope="module")
def result():
    return er.plan("box-reach", "home", "inside", robot="ur5")


@pytest.fixture
def tab(result, tmp_path):
    save_page(tmp_path / "page.html", result)
    with opened((tmp_path / "page.html").as_uri(), 1100, 700) as tab:
        yield tab
    assert tab.wrong == []


def test_its_kinematics_are_ours(tab, result):
    for state in (0, 100, 239):
        poses = tab.evaluate(f"posesAt((number) => data.joints[number].values[{state}]).map((each) => [...each])")
        values = tab.evaluate(f"data.joints.filter((each) => each.planned).map((each) => each.values[{state}])")
        ours = link_poses(result.world.robot, [values])[0]
        np.testing.assert_allclose(np.reshape(poses, (-1, 4, 4)).transpose(0, 2, 1), ours, atol=1e-6)


def test_it_plays_stops_and_follows_a_joint_s_slider(tab):
    before = tab.screenshot()
    tab.click("#play")
    tab.wait_for_function("state.time > 0.3")
    tab.click("#play")
    assert not tab.evaluate("state.playing")
    assert tab.screenshot() != before
    tab.evaluate("inputs[0][1].value = 1; inputs[0][1].oninput()")
    assert tab.evaluate("valueOf(inputs[0][0])") == pytest.approx(1, abs=1e-3)
    assert "by hand" in tab.inner_text("#now")


def test_bodies_and_colours_are_shown_as_the_boxes_say(tab):
    before = tab.screenshot()
    tab.check("#show-colour-by-clearance")
    coloured = tab.screenshot()
    assert coloured != before
    tab.uncheck("#show-collision")
    assert tab.screenshot() != coloured


@pytest.mark.parametrize(
    ("moves", "size"), [({"footprint": BOX, "turning_radius": 0.6}, (1280, 800)), ({"radius": 0.25}, (390, 780))]
)
def test_a_robot_on_a_map_drives_in_the_browser(moves, size, tmp_path):
    world = er.load_map("office.yaml").world(**moves)
    result = er.plan(world, (1.0, 2.0, 1.57)[: world.space.dim], (8.5, 3.0, 0.0)[: world.space.dim])
    made = result.trajectory(speed=1.0, acceleration=0.5)
    save_page(tmp_path / "page.html", result, timed=(made.times, made.positions))
    with opened((tmp_path / "page.html").as_uri(), *size) as tab:
        tab.wait_for_function("document.getElementById('now').value.includes('clear')")
        before = tab.screenshot()
        tab.click("#play")
        tab.wait_for_function("state.time > 0.5")
        tab.click("#play")
        assert tab.screenshot() != before
        tab.click("summary")
        there = tab.screenshot()
        tab.uncheck("#show-swept-area")
        assert tab.screenshot() != there
        assert tab.evaluate("document.documentElement.scrollWidth") <= size[0]
        assert tab.wrong == []
        assert [each for each in tab.requests if not each.startswith(("file:", "data:"))] == []
