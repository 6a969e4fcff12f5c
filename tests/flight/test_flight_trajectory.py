"""The trajectory of a flight: states at any time, and files with the numbers that are flown."""

import csv
import json

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from tests.flight.oracle import flown

WORLD = er.FlightWorld(er.Scene([er.Cylinder(0.3, 4, xyz=(5, 0, 2))]), speed=6.0, acceleration=8.0)
RESULT = er.plan(WORLD, er.State((0, 0, 2), (1, 0, 0)), er.State((10, 0.1, 2), (2, 1, 0)))
FLIGHT = RESULT.trajectory()


def test_it_leads_from_the_start_to_the_goal_and_takes_the_cost_of_the_plan():
    along, times = flown(RESULT.start, FLIGHT.pieces)
    assert FLIGHT.duration == pytest.approx(RESULT.cost, abs=1e-9)
    np.testing.assert_allclose(along[-1], RESULT.goal, atol=1e-9)
    np.testing.assert_allclose(FLIGHT.at(np.minimum(times, FLIGHT.duration)), along[:, :3], atol=1e-9)
    assert FLIGHT.proof == RESULT.proof == "certified"


def test_states_are_at_equal_steps_and_are_the_derivatives_of_each_other():
    assert np.diff(FLIGHT.times).max() <= FLIGHT.step
    assert np.ptp(np.diff(FLIGHT.times)) < 1e-12
    middle = 0.5 * (FLIGHT.velocities[1:] + FLIGHT.velocities[:-1]) * np.diff(FLIGHT.times)[:, np.newaxis]
    np.testing.assert_allclose(np.diff(FLIGHT.positions, axis=0), middle, atol=8 * FLIGHT.step**2)
    assert np.abs(FLIGHT.accelerations).max() == 8.0


def test_a_csv_has_the_states_and_a_json_the_coefficients(tmp_path):
    FLIGHT.save(tmp_path / "go.csv")
    FLIGHT.save(tmp_path / "go.json")
    rows = list(csv.reader((tmp_path / "go.csv").read_text().splitlines()))
    assert rows[0][:4] == ["time [s]", "x [m]", "y [m]", "z [m]"]
    np.testing.assert_array_equal(np.array(rows[1:], dtype=float)[:, 1:4], FLIGHT.positions)
    record = json.loads((tmp_path / "go.json").read_text())
    begin = 0.0
    for piece in record["pieces"]:
        t = 0.4 * piece["duration"]
        position = [sum(c * t**k for k, c in enumerate(piece[axis])) for axis in "xyz"]
        np.testing.assert_allclose(FLIGHT.at(begin + t), position, atol=1e-12)
        begin += piece["duration"]
    assert begin == pytest.approx(record["duration"])


def test_what_it_cannot_do_is_refused(tmp_path):
    for wrong in (-0.1, FLIGHT.duration + 1, np.nan, "soon"):
        with pytest.raises(InvalidValue, match="t must be from 0"):
            FLIGHT.at(wrong)
    with pytest.raises(UnknownName, match="csv"):
        FLIGHT.save(tmp_path / "go.yaml")
    with pytest.raises(InvalidValue, match="step"):
        RESULT.trajectory(step=0.0)
    with pytest.raises(InvalidValue, match="step must be larger"):
        RESULT.trajectory(step=1e-9)
    with pytest.raises(InvalidValue, match="speeds from the world"):
        RESULT.trajectory(speed=3.0)
    with pytest.raises(UnknownName, match="flight"):
        RESULT.trajectory(acceleration=3.0)


def test_thrust_and_tilt_are_those_of_the_sampled_motion_and_attitudes_point_along_the_thrust():
    step, t = 1e-4, np.random.default_rng(0).uniform(1e-3, FLIGHT.duration - 1e-3, 4000)
    pushes = (FLIGHT.at(t + step) - 2 * FLIGHT.at(t) + FLIGHT.at(t - step)) / step**2 + (0, 0, 9.80665)
    tilts = np.arccos(pushes[:, 2] / np.linalg.norm(pushes, axis=1))
    assert np.linalg.norm(pushes, axis=1).max() == pytest.approx(FLIGHT.most_thrust, abs=1e-4)
    assert tilts.max() == pytest.approx(FLIGHT.most_tilt, abs=1e-4)
    turns = FLIGHT.attitudes(yaw=0.4)
    np.testing.assert_allclose(turns @ turns.transpose(0, 2, 1), np.broadcast_to(np.eye(3), turns.shape), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(turns), 1.0)
    thrust = FLIGHT.accelerations + np.array((0, 0, 9.80665))
    np.testing.assert_allclose(turns[:, :, 2] * np.linalg.norm(thrust, axis=1)[:, None], thrust, atol=1e-12)
    forward = turns[:, :, 0] @ (np.cos(0.4), np.sin(0.4), 0.0)
    np.testing.assert_allclose(turns[:, :, 1] @ (np.cos(0.4), np.sin(0.4), 0.0), 0.0, atol=1e-12)
    assert (forward > 0.0).all()
    with pytest.raises(InvalidValue, match="yaw"):
        FLIGHT.attitudes(yaw=np.nan)


def test_a_saved_flight_is_loaded_as_it_was_and_a_damaged_one_refused(tmp_path):
    FLIGHT.save(tmp_path / "go.json")
    again = er.load(tmp_path / "go.json")
    np.testing.assert_array_equal(again.pieces, FLIGHT.pieces)
    assert (again.world, again.proof) == (None, "unchecked")
    record = json.loads((tmp_path / "go.json").read_text())
    for change in (
        {"pieces": []},
        {"pieces": 3},
        {"pieces": [{**record["pieces"][0], "x": [0, 1]}]},
        {"pieces": [{**record["pieces"][0], "duration": -1}]},
        {"pieces": [{**record["pieces"][0], "duration": float("nan")}]},
        {"pieces": record["pieces"][:1] + record["pieces"][2:]},
        {"pieces": [{**record["pieces"][0], "duration": 100.0, "x": [0, -1e307, 1e306]}, *record["pieces"][1:]]},
    ):
        (tmp_path / "bad.json").write_text(json.dumps({**record, **change}))
        with pytest.raises(BrokenFile, match=r"bad\.json is a damaged flight"):
            er.load(tmp_path / "bad.json")
