"""The trajectory of a flight: states at any time, and files with the numbers that are flown."""

import csv
import json

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue, UnknownName
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
