"""The page in a browser: opened, its slider moved, and looked at."""

import asyncio
import threading
import time
from contextlib import closing
from http.client import HTTPConnection
from urllib.parse import urlsplit

import numpy as np
import pytest

from evenroad.planning.plan import plan as find_path
from evenroad.planning.read_request import arm_request
from evenroad.robots.kinematics import link_poses
from evenroad.space.path import configuration_at
from tests_peers.chromium import opened

viser = pytest.importorskip("viser")
msgspec = pytest.importorskip("msgspec")
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


@pytest.fixture(scope="module")
def page():
    from evenroad.viz.page import ArmPage

    query = arm_request("ur5", "box-reach", "home", "inside")

    def plan(world, start, goal):
        return find_path(world, start, goal[np.newaxis], seconds=0.5)

    page = ArmPage(query.world, plan(query.world, query.start, query.goals[0]), plan, port=0)
    threading.Thread(target=page.serve, daemon=True).start()
    yield page
    page.close()


def test_the_slider_moves_the_arm_and_the_browser_shows_it(page, tmp_path):
    with opened(page.address, 900, 700) as tab:
        tab.wait_for_selector("canvas", timeout=60_000)
        tab.get_by_text("solved").wait_for(timeout=60_000)
        time.sleep(6.0)
        before = tab.screenshot(path=tmp_path / "before.png")
        box = tab.locator("input[type=text]").first
        box.fill("4")
        box.press("Enter")
        time.sleep(4.0)
        after = tab.screenshot(path=tmp_path / "after.png")
        asked = tab.requests
    assert page.slider.value == 4.0
    assert before != after
    goal = link_poses(page.world.robot, page.result.goal[np.newaxis])[0]
    for link, handle in page._arms["capsules"].items():
        np.testing.assert_allclose(handle.position, goal[page.world.robot.links.index(link), :3, 3], atol=1e-6)
    assert _changed(before, after) > 0.005
    # Nothing from outside of this computer: it works without a network.
    assert all(url.startswith(("http://127.0.0.1", "http://localhost", "data:", "blob:")) for url in asked)


def test_the_trees_are_shown_on_demand(page):
    shown = []
    scene = page._server.scene
    before, scene.add_line_segments = scene.add_line_segments, lambda name, *rest, **more: shown.append(name)
    page.graph.value = True
    page._show_graph()
    page.graph.value = False
    page._show_graph()
    scene.add_line_segments = before
    assert set(shown) == {"/graph"}


def _changed(before, after):
    """Return the share of pixels that differ plainly between two screenshots, the panel at the right left out."""
    from io import BytesIO

    from PIL import Image

    first, second = (np.asarray(Image.open(BytesIO(raw)).convert("RGB"), dtype=float) for raw in (before, after))
    differs = np.abs(first - second).max(axis=2) > 40
    return differs[:, :550].mean()


def test_a_goal_that_is_dragged_is_planned_again_at_least_twenty_times_a_second(page):
    tip = page.world.robot.links.index(page._tips[-1])
    pose = link_poses(page.world.robot, page._endpoints["goal"][np.newaxis])[0, tip]
    from evenroad.viz.follow import wxyz_of

    began, moves = time.perf_counter(), 40
    for i in range(moves):
        away = pose[:3, 3] + [-0.002 * i, 0.0, 0.0]
        result = page.move_endpoint("goal", away, wxyz_of(pose[:3, :3]))
        place = link_poses(page.world.robot, result.goal[np.newaxis])[0, tip, :3, 3]
        assert result.solved
        np.testing.assert_allclose(place, away, atol=2e-3)
    assert moves / (time.perf_counter() - began) > 20.0


def test_obstacles_are_added_moved_and_removed_and_the_plan_follows(page):
    free = page.result.cost
    page.obstacles.add("box")
    assert page.world.scene.names[-1] == "box 0"
    middle = configuration_at(page.result.path, page.world.space, np.array([0.3]))[0]
    tip = link_poses(page.world.robot, middle[np.newaxis])[0, page.world.robot.links.index(page._tips[-1]), :3, 3]
    page.obstacles.move("box 0", tip, (1.0, 0.0, 0.0, 0.0))
    np.testing.assert_allclose(page.world.scene.obstacles[-1].xyz, tip)
    assert page.result.solved
    assert page.world.validate(page.result.path).all()
    assert page.result.cost != free
    page.obstacles.move("box 0", (0.0, 1e12, 0.0), (1.0, 0.0, 0.0, 0.0))
    np.testing.assert_allclose(page.world.scene.obstacles[-1].xyz, tip)
    page.obstacles.remove()
    assert "box 0" not in page.world.scene.names
    assert page.result.solved


def test_sliders_of_joints_set_start_and_goal_and_a_path_is_coloured_by_clearance(page):
    lines = {}
    scene = page._server.scene
    before, scene.add_line_segments = (
        scene.add_line_segments,
        lambda name, points, colours, **_: lines.update({name: colours}),
    )
    page.coloured.value = True
    scene.add_line_segments = before
    assert len(np.unique(lines["/path"].reshape(-1, 3), axis=0)) > 20
    assert "from obstacles at least" in page.status.content
    page.coloured.value = False
    for slider, value in zip(page.joints, page.result.goal, strict=True):
        slider.value = float(value) + 0.01
    result = page.take_joints_as("goal")
    np.testing.assert_allclose(result.goal, [slider.value for slider in page.joints])


def test_what_is_played_moves_at_its_speed_and_stops_unless_it_loops(page):
    page.loop.value, page.speed.value, page.slider.value = False, 4.0, 3.0
    page._playing = True
    time.sleep(1.5)
    assert page.slider.value == page.slider.max
    assert not page._playing


def _status(page, path, **headers):
    with closing(HTTPConnection("127.0.0.1", page._server.get_port(), timeout=10)) as connection:
        connection.request("GET", path, headers=headers)
        answer = connection.getresponse()
        return answer.status, answer.read()


def test_the_page_is_sent_to_its_address_alone(page):
    path = urlsplit(page.address).path
    assert _status(page, path)[0] == _status(page, f"{path}/")[0] == 200
    for foreign in ("/", "/index.html", f"{path}x"):
        assert _status(page, foreign)[0] == 403
    status, content = _status(page, path, Host="evil.example")
    assert (status, content.count(b"\n")) == (403, 1)
    assert _status(page, f"{path}/../../setup.py")[0] == 404


@pytest.mark.parametrize(("origin", "host"), [("http://evil.example", None), (None, "evil.example"), (None, None)])
def test_a_socket_of_another_origin_moves_nothing(page, origin, host):
    websockets = pytest.importorskip("websockets")
    message = msgspec.msgpack.encode(
        {
            "type": "TransformControlsUpdateMessage",
            "name": "/hand of goal",
            "wxyz": [1.0, 0.0, 0.0, 0.0],
            "position": [0.3, 0.3, 0.5],
        }
    )

    async def connect(address, **options):
        protocol = f"viser-v{viser.__version__}"
        async with websockets.connect(address, subprotocols=[protocol], max_size=None, **options) as connection:
            await asyncio.wait_for(connection.recv(), 10)
            await connection.send(message)
            await asyncio.sleep(1.0)

    address = page.address.replace("http", "ws")
    goal = page._endpoints["goal"].copy()
    if origin is host is None:
        with pytest.raises(websockets.exceptions.InvalidStatus, match="403"):
            asyncio.run(connect(address.rpartition("/")[0]))
        # The same message from the page itself moves it.
        own = page.address.rpartition("/")[0]
        asyncio.run(connect(address, origin=own))
        assert (page._endpoints["goal"] != goal).any()
        return
    foreign = {"origin": origin} if origin else {"additional_headers": {"Host": host}}
    with pytest.raises(websockets.exceptions.InvalidStatus, match="403"):
        asyncio.run(connect(address, **foreign))
    assert (page._endpoints["goal"] == goal).all()
