import base64
import json
import re
from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import NotAvailable, UnknownName
from evenroad.loading.robot_file import RobotFile
from evenroad.robot import find_robot
from evenroad.robots.kinematics import joint_values
from evenroad.space.path import configuration_at
from evenroad.viz.bodies import robot_sets
from evenroad.viz.player import page_of, save_page
from evenroad.world import MapFrame


@pytest.fixture(scope="module")
def reach():
    return er.plan("box-reach", "home", "inside", robot="ur5")


def _data(text):
    return json.loads(re.search(r'type="application/json">(.*?)</script>', text, re.DOTALL)[1])


def test_a_page_holds_the_joints_along_the_path_and_each_body_once(reach):
    data = _data(page_of(reach, file=RobotFile(find_robot("ur5")[0])))
    first, last = ([values[i] for values in data["values"] if values] for i in (0, -1))
    robot = reach.world.robot
    expected = joint_values(robot, np.stack([reach.start, reach.goal]))
    moving = [joint.name for joint in robot.joints if joint.kind != "fixed"]
    np.testing.assert_allclose([first, last], np.transpose([expected[name] for name in moving]), atol=1e-5)
    assert data["sets"] == ["visual", "collision"]
    assert data["note"] == ""
    assert [body["name"] for body in data["bodies"] if body["set"] == "scene"] == list(reach.world.scene.names)
    for link, part in robot_sets(robot).sets["collision"].items():
        vertices = part.corners.reshape(-1, 3)
        (body,) = [each for each in data["bodies"] if each["name"] == link and each["set"] == "collision"]
        kept = np.frombuffer(base64.b64decode(body["v"]), "<f4").reshape(-1, 3)
        np.testing.assert_allclose([kept.min(0), kept.max(0)], [vertices.min(0), vertices.max(0)], atol=1e-5)
        triangles = np.frombuffer(base64.b64decode(body["t"]), "<u4")
        assert triangles.max() == len(kept) - 1


def test_a_page_needs_no_network_and_no_text_of_a_plan_ends_its_script(reach):
    text = page_of(replace(reach, message="</script><script>alert(1)"))
    assert not re.search(r"https?://", text)
    assert text.count("</script>") == 2
    assert _data(text)["title"].startswith("solved: </script><script>alert(1); keeps")


def test_what_cannot_be_played_is_refused(reach, tmp_path):
    none = er.plan("box-reach", "home", "inside", robot="ur5", limits={"motions": 1})
    with pytest.raises(NotAvailable, match="no path to play"):
        page_of(none)
    with pytest.raises(NotAvailable, match="another world"):
        page_of(replace(reach, world=None))
    with pytest.raises(UnknownName, match="html"):
        save_page(tmp_path / "page.pdf", reach)


def test_the_page_names_the_link_and_the_obstacle_that_come_nearest_and_how_far(reach):
    link, obstacle = reach.nearest
    said = _data(page_of(reach))["title"]
    assert said.endswith(f"keeps {1e3 * reach.clearance:.1f} mm from obstacles: {link} from {obstacle}")


def test_the_page_says_at_each_state_what_a_path_that_stays_there_keeps(reach):
    data = _data(page_of(reach))
    for row in (0, 120, -1):
        state = configuration_at(reach.path, reach.world.space, np.linspace(0.0, 1.0, len(data["clearance"])))[row]
        kept = reach.world.path_clearance(np.stack([state, state]))
        assert data["clearance"][row] == pytest.approx(kept, abs=2e-4)


@pytest.mark.parametrize("y_up", [True, False])
def test_a_page_of_a_car_puts_its_footprint_where_the_car_is(y_up):
    frame = MapFrame(rows=60, cols=80, resolution=0.1, y_up=y_up, origin=(1.0, -2.0), yaw=0.3 if y_up else 0.0)
    grid = er.GridMap(np.zeros((60, 80), dtype=bool), frame)
    car = grid.world(footprint=[(-0.5, -0.3), (0.7, -0.3), (0.4, 0.3), (-0.5, 0.3)], turning_radius=0.5)
    start, goal = car.space.from_cube(np.array([[0.3, 0.3, 0.1], [0.7, 0.6, 0.7]]))
    result = er.plan(car, start, goal)
    made = result.trajectory(speed=1.0, step=0.05)
    data = _data(page_of(result, timed=(made.times, made.positions)))
    assert len(data["states"]) == len(data["times"]) == len(data["clearance"])
    for (x, y, angle), pose in zip(data["states"], made.positions, strict=True):
        (placed,) = car.footprint.placed(pose, car.footprint.outlines)
        (outline,) = np.array(data["outlines"])
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        np.testing.assert_allclose(outline @ turn + [x, y], frame.to_pixels(placed), atol=2e-3)
    assert np.abs(np.diff(np.array(data["states"])[:, 2])).max() < 0.5
    np.testing.assert_allclose(data["clearance"], car.distance(made.positions), atol=1e-4)


def test_a_page_without_times_follows_the_curves_of_a_car(reach):
    grid = er.GridMap(np.zeros((60, 60), dtype=bool), resolution=0.1)
    car = grid.world(footprint=[(-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3)], turning_radius=0.5)
    result = er.plan(car, (2, 2, 0), (4, 4, 2))
    states = np.array(_data(page_of(result))["states"])
    on_path = grid.frame.to_pixels(result.path[:, :2])
    assert max(np.linalg.norm(on_path - state[:2], axis=1).min() for state in states) < 1.0


def test_a_page_of_a_car_among_polygons_has_their_borders():
    hole = [(3.0, 1.0), (4.0, 1.0), (4.0, 2.0)]
    yard = er.PolygonMap([[[(2.5, 0.5), (4.5, 0.5), (4.5, 3.0)], hole]], bounds=((0, 0), (8, 8)))
    car = yard.world(footprint=[(-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3)], turning_radius=0.5)
    data = _data(page_of(er.plan(car, (1, 1, 0), (7, 1, 0))))
    ((outer, inner),) = data["polygons"]
    assert len(outer) == 3
    corners = car.grid.frame.to_map(np.array(inner)).round(3).tolist()
    assert sorted(corners) == sorted([list(each) for each in hole])
    assert "picture" not in data
