"""What one does with a plan: look at it, keep it, walk along it, drive it."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

import evenroad as er
from evenroad.io import load_plan
from evenroad.trajectory.limits import Limits

CELLS = np.zeros((40, 60), dtype=bool)
CELLS[:25, 30:34] = True
WORLD = er.GridMap(CELLS, resolution=0.1).world(radius=0.2)
RESULT = er.plan(WORLD, (0.5, 3.5), (5.5, 3.5))
BLOCKED = er.plan(WORLD, (3.2, 3.5), (5.5, 3.5))


def test_states_along_the_path_lie_on_it_and_close_together():
    states = RESULT.resample(0.05)
    gaps = np.linalg.norm(np.diff(states, axis=0), axis=1)
    assert gaps.max() <= 0.05 * (1 + 1e-9)
    assert gaps.sum() == pytest.approx(RESULT.cost)
    assert {tuple(row) for row in RESULT.path} <= {tuple(row) for row in states}


def html_of(result):
    """Return the page in a notebook, read as XML: one that is broken is not shown at all."""
    return ElementTree.fromstring(f"<div>{result._repr_html_()}</div>")


def test_a_notebook_shows_the_answer_and_one_line_a_coordinate_or_why_there_is_none():
    page = html_of(RESULT)
    assert "solved" in "".join(page.itertext())
    lines = page.findall(".//polyline")
    assert len(lines) == 2
    assert all(len(line.get("points").split()) == len(RESULT.path) for line in lines)
    page = html_of(BLOCKED)
    assert "start" in "".join(page.itertext())
    assert page.findall(".//polyline") == []


def test_what_is_saved_is_read_again(tmp_path):
    for name in ("way.json", "way.csv", "way.png"):
        RESULT.save(tmp_path / name)
    again, _ = load_plan(tmp_path / "way.json")
    assert np.array_equal(again.path, RESULT.path)
    assert (again.cost, again.length) == (RESULT.cost, RESULT.length)
    assert again.seconds == pytest.approx(RESULT.seconds, abs=1e-5)
    rows = np.loadtxt(tmp_path / "way.csv", delimiter=",", skiprows=1)
    assert np.array_equal(rows, RESULT.path)
    assert np.array_equal(np.asarray(Image.open(tmp_path / "way.png")), np.asarray(RESULT.plot()))


def test_a_plan_that_failed_is_drawn_too():
    assert BLOCKED.path is None
    assert BLOCKED.plot().size > (100, 100)


def test_a_path_gets_times_by_limits_that_are_given_or_its_robots_or_the_speed_on_a_map():
    limits = Limits((1.0, 1.0), (2.0, 2.0))
    fast, slow = RESULT.trajectory(limits), RESULT.trajectory(limits, speed=0.5)
    assert slow.duration == pytest.approx(2 * fast.duration, rel=0.02)
    assert fast.duration >= np.abs(np.diff(RESULT.path[[0, -1]], axis=0)).max()
    speeds = np.linalg.norm(RESULT.trajectory(speed=0.5).velocities, axis=1)
    assert 0.99 * 0.5 <= speeds.max() <= 0.5 * (1 + 1e-9)
    assert RESULT.trajectory(speed=2.5).duration < RESULT.length
    world = er.ArmWorld("ur5")
    result = er.plan(world, (0, -1.5, 0, -1.5, 0, 0), (1, -1.5, 0.5, -1.5, 0, 0))
    trajectory = result.trajectory(speed=0.3)
    assert trajectory.names[:6] == world.robot.joint_names
    assert trajectory.duration > 0.0


def test_a_result_is_one_line():
    assert repr(RESULT).startswith(f"PlanResult(solved, cost {RESULT.cost:.4g}, {len(RESULT.path)} waypoints, exact, ")
    assert repr(BLOCKED).startswith("PlanResult(start_invalid, ")
    assert "\n" not in repr(RESULT) + repr(WORLD) + repr(WORLD.grid)


@pytest.mark.parametrize(("call", "words"), [
    (lambda: BLOCKED.resample(0.1), "no path"),
    (lambda: BLOCKED.trajectory(), "no path"),
    (lambda: BLOCKED.save("way.csv"), "no path"),
    (lambda: RESULT.save("way.txt"), "known: .csv, .json, .png"),
    (lambda: RESULT.resample(0), "step must be"),
    (lambda: RESULT.trajectory("limits.yaml"), "Limits(velocity"),
    (lambda: RESULT.trajectory(speed=0), "speed must be"),
    (lambda: RESULT.plot(world=3), "a int"),
])  # fmt: skip
def test_what_cannot_be_done_is_told(call, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(er.errors.EvenroadError) as error:
        call()
    assert words in str(error.value)


def test_a_map_of_an_array_lies_as_ros_has_them():
    grid = WORLD.grid
    low, high = grid.bounds
    assert grid.shape == (40, 60)
    assert grid.resolution == 0.1
    assert low.tolist() == [0, 0] == list(grid.origin)
    assert np.allclose(high, (6, 4))
    assert not WORLD.valid((3.2, 3.5))
    assert WORLD.valid((3.2, 0.5))
    assert np.asarray(grid.plot()).shape == (400, 600)


def test_a_plan_is_its_path_to_numpy_and_true_if_it_is_solved():
    assert RESULT
    assert len(RESULT) == len(RESULT.path)
    np.testing.assert_array_equal(np.asarray(RESULT), RESULT.path)
    np.testing.assert_array_equal(RESULT[-1], RESULT.goal)
    assert [row.tolist() for row in RESULT] == RESULT.path.tolist()
    assert not BLOCKED
    assert len(BLOCKED) == 0
    with pytest.raises(er.errors.InvalidValue, match="there is no path in PlanResult"):
        np.asarray(BLOCKED)
    touching = replace(RESULT, status=er.Status.MESH_COLLISION)
    assert not touching
    assert len(touching) == len(RESULT)


def test_a_trajectory_is_called_with_times_and_sampled():
    trajectory = RESULT.trajectory(speed=1.0)
    np.testing.assert_array_equal(trajectory(0.3), trajectory.at(0.3))
    np.testing.assert_array_equal(np.asarray(trajectory), trajectory.positions)
    rows = trajectory.sample(0.25)
    times = [*np.arange(0, trajectory.duration, 0.25), trajectory.duration]
    np.testing.assert_allclose(rows, [trajectory.at(t) for t in times], atol=1e-12)
    assert len(trajectory.sample(trajectory.duration)) == 2
    for dt in (0.0, 1e-9, "a"):
        with pytest.raises(er.errors.InvalidValue, match="dt must be"):
            trajectory.sample(dt)


def test_what_is_not_free_is_in_collision():
    q = [(3.2, 3.5), (0.5, 3.5)]
    assert WORLD.in_collision(q).tolist() == [True, False]
    assert WORLD.in_collision(q[0]) is True
    assert er.ArmWorld("ur5", "box-reach").in_collision("home") is False
