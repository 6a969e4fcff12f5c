"""The page that plays offline, in a browser: its kinematics are ours, it plays, and it shows what its boxes say."""

import os
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

import evenroad as er
from evenroad.robots.kinematics import link_poses
from evenroad.task import Attach, Detach, MoveTo, Task
from evenroad.viz.player import save_page
from evenroad.viz.task_page import page_of_task
from tests_peers.chromium import opened

BOX = [(-0.45, -0.31), (0.45, -0.31), (0.45, 0.31), (-0.45, 0.31)]


@pytest.fixture(scope="module")
def result():
    return er.plan("box-reach", "home", "inside", robot="ur5")


@pytest.fixture
def tab(result, tmp_path):
    save_page(tmp_path / "page.html", result)
    with opened((tmp_path / "page.html").as_uri(), 1100, 700) as tab:
        tab.evaluate("play(false); go(0)")
        yield tab
    assert tab.wrong == []


def colours(picture):
    """Return the different colours of the middle of a screenshot, where no pane is."""
    shown = np.asarray(Image.open(BytesIO(picture)).convert("RGB"))
    rows, columns, _ = shown.shape
    return np.unique(shown[rows // 4 : -rows // 4, : columns // 2].reshape(-1, 3) // 8, axis=0)


def test_its_kinematics_are_ours(tab, result):
    for state in (0, 100, 239):
        poses = tab.evaluate(f"posesAt((number) => data.joints[number].values[{state}]).map((each) => [...each])")
        values = tab.evaluate(f"data.joints.filter((each) => each.planned).map((each) => each.values[{state}])")
        ours = link_poses(result.world.robot, [values])[0]
        np.testing.assert_allclose(np.reshape(poses, (-1, 4, 4)).transpose(0, 2, 1), ours, atol=1e-6)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [(1280, 800), (390, 780)])
def test_the_first_picture_comes_soon_in_every_window_and_scheme_and_plays(result, size, scheme, tmp_path):
    save_page(tmp_path / "page.html", result)
    with opened((tmp_path / "page.html").as_uri(), *size, scheme) as tab:
        # A browser without a graphics card draws on the processors: where others keep them busy, the time says nothing.
        assert tab.evaluate("state.drawn") < 1500 or os.getloadavg()[0] > 2 * os.cpu_count()
        tab.wait_for_function("state.time > 0.1")
        assert tab.inner_text("#play") == "Pause"
        tab.click("#play")
        shown = colours(tab.screenshot())
        assert len(shown) > 40
        assert (shown.mean() < 16) == (scheme == "dark")
        assert tab.evaluate("document.documentElement.scrollWidth") <= size[0]
        bar, said, side = (tab.locator(f"#{name}").bounding_box() for name in ("bar", "said", "side"))
        assert bar["x"] + bar["width"] <= size[0]
        assert said["x"] + said["width"] <= side["x"]
        assert tab.wrong == []


def test_the_scene_fills_the_free_area_again_after_fit_and_the_camera_stays_above_the_floor(tab):
    def spread():
        low, high = tab.evaluate("""(() => { const matrix = camera.view().matrix, box = shownArm.points();
            const seen = box.map((p) => seenBy(matrix, p));
            return [0, 1].map((k) => seen.map((p) => p[k])).map((c) => [Math.min(...c), Math.max(...c)]); })()""")
        return max(low[1] - low[0], high[1] - high[0])

    first = spread()
    assert 1.2 < first <= 2.0
    tab.mouse.move(500, 300)
    tab.mouse.down()
    tab.mouse.move(700, 40, steps=3)
    tab.mouse.up()
    height = "camera.view().from[2] - shownArm.ground"
    assert tab.evaluate(height) > 0.01
    tab.mouse.wheel(0, 600)
    tab.wait_for_function("camera.eye.own")
    assert tab.evaluate(height) > 0.01
    assert spread() < 0.8 * first
    tab.click("#fit")
    assert spread() == pytest.approx(first, rel=1e-3)


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
    tab.check("#show-collision-bodies")
    over = tab.screenshot()
    assert over != coloured
    tab.uncheck("#show-visual")
    assert tab.screenshot() not in (over, coloured)


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


def test_a_thing_of_a_task_is_where_it_was_put_at_the_end(tmp_path):
    """The arm ends where it began, so the two pictures differ only where the can was and is."""
    home, can = [0.0, -1.57, 1.57, -1.57, -1.57, 0.0], er.Cylinder(0.03, 0.16, xyz=(0.5, 0.2, 0.06), name="can")
    table = er.Box((0.8, 1.2, 0.04), xyz=(0.5, 0, -0.04), name="table")
    world = er.ArmWorld("ur5", er.Scene([table, can], allowed={("base_link", "table")}))
    grasp = er.PoseGoal(er.Pose((0.5, 0.2, 0.145), rpy=(np.pi, 0, 0)), tip="tool0", free_axis="z")
    place = er.PoseGoal(er.Pose((0.5, -0.3, 0.061)), tip="can", free_axis="z")
    carry = MoveTo(place, retreat=0.05, approach=0.05, away="up")
    steps = [MoveTo(grasp, approach=0.1), Attach("can"), carry, Detach("can", onto="table"), MoveTo(home, retreat=0.1)]
    (tmp_path / "page.html").write_text(page_of_task(Task(steps).plan(world, home)))
    with opened((tmp_path / "page.html").as_uri(), 1100, 700) as tab:
        tab.evaluate("play(false); go(0)")
        before = np.asarray(Image.open(BytesIO(tab.screenshot())).convert("RGB"))[80:600].astype(int)
        tab.evaluate("go(end)")
        after = np.asarray(Image.open(BytesIO(tab.screenshot())).convert("RGB"))[80:600].astype(int)
        assert tab.wrong == []
    changed = (np.abs(before - after).max(axis=2) > 30).mean()
    assert 0.001 < changed < 0.05
