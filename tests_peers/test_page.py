"""The page that plans again, in a browser: start, goal and obstacles are dragged, added and removed."""

import numpy as np
import pytest

import evenroad as er
from evenroad.robots.kinematics import link_poses
from evenroad.viz.page import ArmPage
from tests_peers.chromium import opened


@pytest.fixture
def page():
    result = er.plan("box-reach", "home", "inside", robot="ur5")
    page = ArmPage(result.world, result, lambda world, start, goal: er.plan(world, start, goal), port=0)
    yield page
    page.close()


@pytest.fixture
def tab(page):
    with opened(page.address, 1100, 700) as tab:
        tab.evaluate("play(false); go(0)")
        yield tab
    assert tab.wrong == []
    # Nothing from outside of this computer: it works without a network.
    assert all(url.startswith(("http://127.0.0.1", "data:")) for url in tab.requests)


def arrow(tab):
    """Return a pixel on the steepest arrow of the start's handle."""
    arrows = [each["pixels"] for each in tab.evaluate("handles.handlePixels()") if each["name"] == "start"]
    steepest = max(arrows, key=lambda pixels: abs(pixels[-1][1] - pixels[0][1]))
    return steepest[4]


def pixel_of(tab, name):
    """Return a pixel near the middle of a body where no handle is."""
    return tab.evaluate(f"""(() => {{ const body = shownArm.bodies.find((each) => each.name === "{name}");
        for (const off of [[0, 0, 0], [0.08, 0.08, 0], [-0.08, 0.08, 0], [0.08, -0.08, 0], [-0.08, -0.08, 0]]) {{
            const [x, y] = seenBy(camera.view().matrix, moved(body.pose || posesAt(valueOf)[body.link], off));
            const pixel = [innerWidth * (0.5 + 0.5 * x), innerHeight * (0.5 - 0.5 * y)];
            if (!handles.pressed(...pixel)) return pixel;
            handles.pressed(null);
        }} }})()""")


def drag(tab, pixel, by):
    """Drag something by some pixels, and wait for the plan."""
    tab.mouse.move(*pixel)
    tab.mouse.down()
    tab.mouse.move(pixel[0] + by[0], pixel[1] + by[1], steps=4)
    tab.mouse.up()
    tab.wait_for_function("!isBusy")


def tip_of(page, q):
    return link_poses(page.world.robot, q[np.newaxis])[0, -1]


def test_a_start_that_is_dragged_moves_and_is_planned_from(page, tab):
    before = tip_of(page, page.result.start)
    picture = tab.screenshot()
    drag(tab, arrow(tab), (0, 60))
    after = tip_of(page, page.result.start)
    assert page.result.solved
    assert after[2, 3] < before[2, 3] - 0.03
    shown = tab.evaluate("data.terminals.start.pose")
    np.testing.assert_allclose(np.reshape(shown, (4, 4)).T, after, atol=1e-5)
    assert tab.screenshot() != picture


def test_an_obstacle_is_chosen_by_a_click_and_only_if_nothing_is_before_it(page, tab):
    top = pixel_of(tab, "box top")
    tab.mouse.click(*top)
    assert tab.inner_text("#chosen").strip() == "box top"
    tab.click("#remove")
    tab.wait_for_function("!isBusy && state.chosen === null")
    assert "box top" not in page.world.scene.names
    tab.mouse.click(*top)
    assert tab.inner_text("#chosen").strip() in ("box left", "box right", "box back", "box floor")
    tab.mouse.click(*pixel_of(tab, "upper_arm_link"))
    assert "click an obstacle" in tab.inner_text("#chosen")


def test_an_obstacle_is_added_chosen_and_moved(page, tab):
    tab.get_by_role("button", name="ball").click()
    tab.wait_for_function("!isBusy && state.chosen === 'ball 0'")
    assert page.world.scene.names[-1] == "ball 0"
    assert page.world.validate(page.result.path).all()
    assert "solved" in tab.inner_text("#said")


def test_trees_and_clearances_are_shown_and_joints_are_taken_as_the_goal(page, tab):
    before = tab.screenshot()
    tab.check("#show-trees")
    tab.wait_for_function("data.graph && data.graph.length > 0")
    grown = tab.screenshot()
    assert grown != before
    tab.check("#show-colour-by-clearance")
    tab.wait_for_function("!isBusy && data.clearance")
    assert tab.screenshot() != grown
    tab.evaluate("inputs[0][1].value = 1; inputs[0][1].oninput()")
    tab.get_by_role("button", name="goal").click()
    tab.wait_for_function("!isBusy")
    np.testing.assert_allclose(page.result.goal[0], 1.0, atol=1e-3)
