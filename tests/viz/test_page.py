"""The page that plans again: what a browser sends to it, and what it answers."""

import json
import re
import time
from contextlib import closing
from http.client import HTTPConnection
from urllib.parse import urlsplit

import numpy as np
import pytest

import evenroad as er
from evenroad.robots.kinematics import link_poses
from evenroad.space.path import configuration_at
from evenroad.viz.page import ArmPage
from tests.refused import refused


@pytest.fixture(scope="module")
def reach():
    return er.plan("box-reach", "home", "inside", robot="ur5")


@pytest.fixture
def page(reach):
    page = ArmPage(reach.world, reach, lambda world, start, goal: er.plan(world, start, goal), port=0)
    yield page
    page.close()


def ask(page, method="GET", path=None, body=None, **headers):
    """Return status and content of an answer; a record is sent as JSON."""
    address = urlsplit(page.address)
    with closing(HTTPConnection(address.hostname, address.port, timeout=60)) as connection:
        content = body if isinstance(body, bytes | None) else json.dumps(body)
        connection.request(method, address.path if path is None else path, content, headers)
        answer = connection.getresponse()
        return answer.status, answer.read()


def change(page, **record):
    status, content = ask(page, "POST", body=record)
    assert status == 200
    return json.loads(content)


def tip_of(page, q):
    return er.Pose.from_matrix(link_poses(page.world.robot, q[np.newaxis])[0, -1])


def test_the_page_shows_the_plan_and_where_its_start_and_goal_are(page, reach):
    status, content = ask(page)
    assert status == 200
    data = json.loads(re.search(r'type="application/json">(.*?)</script>', content.decode(), re.DOTALL)[1])
    assert data["title"].startswith("solved in")
    assert data["live"] == {"new": ["box", "ball"], "graph": "trees"}
    for name, q in (("start", reach.start), ("goal", reach.goal)):
        shown = np.reshape(data["terminals"][name]["pose"], (4, 4)).T
        np.testing.assert_allclose(shown, link_poses(page.world.robot, q[np.newaxis])[0, -1], atol=1e-5)


def test_a_dragged_goal_is_followed_and_planned_to(page, reach):
    pose = tip_of(page, reach.goal)
    xyz = [pose.xyz[0] - 0.03, *pose.xyz[1:]]
    answer = change(page, do="pose", name="goal", xyz=xyz, xyzw=list(pose.xyzw))
    assert answer["title"].startswith("solved")
    np.testing.assert_allclose(tip_of(page, page.result.goal).xyz, xyz, atol=2e-3)
    assert page.world.validate(page.result.path).all()
    last = [values[-1] for values in answer["values"] if values]
    np.testing.assert_allclose(last, page.result.goal, atol=1e-4)
    assert answer["clearance"] is None
    assert min(change(page, do="measure", coloured=True)["clearance"]) > 0.0


def test_a_goal_that_is_dragged_is_planned_again_at_least_twenty_times_a_second(page, reach):
    pose = tip_of(page, reach.goal)
    began = time.process_time()
    for i in range(40):
        xyz = [pose.xyz[0] - 0.002 * i, *pose.xyz[1:]]
        assert page.change({"do": "pose", "name": "goal", "xyz": xyz, "xyzw": list(pose.xyzw)})["path"]
    assert 40 / (time.process_time() - began) > 20.0


def test_obstacles_are_added_moved_and_removed_and_the_plan_follows(page, reach):
    answer = change(page, do="add", name="box")
    assert answer["names"][-1] == answer["bodies"][0]["name"] == "box 0"
    middle = configuration_at(reach.path, page.world.space, np.array([0.3]))[0]
    there = list(tip_of(page, middle).xyz)
    answer = change(page, do="move", name="box 0", xyz=there, xyzw=[0, 0, 0, 1])
    np.testing.assert_allclose(answer["bodies"][0]["pose"][12:15], there, atol=1e-6)
    assert page.result.solved
    assert page.world.validate(page.result.path).all()
    assert not page.world.validate(reach.path).all()
    answer = change(page, do="move", name="box 0", xyz=[0, 1e12, 0], xyzw=[0, 0, 0, 1])
    assert "xyz must lie between" in answer["title"]
    np.testing.assert_allclose(answer["bodies"][0]["pose"][12:15], there, atol=1e-6)
    assert "box 0" not in change(page, do="remove", name="box 0")["names"]
    np.testing.assert_array_equal(page.result.path, reach.path)


def test_joints_are_taken_as_start_and_a_goal_in_collision_is_reported(page, reach):
    values = dict(zip(page.world.robot.group, reach.goal.tolist(), strict=True))
    assert change(page, do="joints", name="start", values=values)["path"]
    np.testing.assert_array_equal(page.result.start, reach.goal)
    lying = dict.fromkeys(values, 0.0) | {"shoulder_lift_joint": 0.5}
    answer = change(page, do="joints", name="goal", values=lying)
    assert answer["title"].startswith("goal_invalid")
    assert not answer["path"]


def test_trees_are_lines_between_positions_of_the_tip(page):
    lines = np.reshape(change(page, do="graph")["graph"], (-1, 2, 3))
    tips = [tip_of(page, q).xyz for q in (page.result.start, page.result.goal)]
    for tip in tips:
        assert np.abs(lines - tip).max(axis=2).min() < 1e-4


@pytest.mark.parametrize(
    "record",
    [
        {},
        {"do": "fly"},
        {"do": "pose", "name": "middle"},
        {"do": "pose", "name": "goal", "xyz": "near"},
        {"do": "add", "name": "house"},
        {"do": "joints", "name": "goal", "values": {}},
        [1],
        b"{",
    ],
)
def test_what_is_no_change_is_refused_and_nothing_moves(page, reach, record):
    assert ask(page, "POST", body=record)[0] == 400
    assert page.result is reach


def test_the_page_is_sent_to_its_address_alone(page, reach):
    path = urlsplit(page.address).path
    assert ask(page, path=f"{path}/")[0] == 200
    for foreign in ("/", "/index.html", f"{path}x"):
        assert ask(page, path=foreign)[0] == 403
    status, content = ask(page, Host="evil.example")
    assert (status, content.count(b"\n")) == (403, 1)
    assert ask(page, path=f"{path}/../../setup.py")[0] == 404
    moved = {"do": "add", "name": "box"}
    assert ask(page, "POST", body=moved, Origin="http://evil.example")[0] == 403
    assert ask(page, "POST", path="/", body=moved)[0] == 403
    assert ask(page, "POST", body=b" " * 200_000)[0] == 413
    assert page.world is reach.world


def test_a_port_that_is_taken_is_said(page, reach):
    port = urlsplit(page.address).port
    refused(er.errors.NotAvailable, f"port {port}", ArmPage, reach.world, reach, er.plan, port=port)
