import json
import re
from dataclasses import replace

import numpy as np
import pytest
import yaml

import evenroad as er
from evenroad.errors import BrokenFile, InvalidValue, NotAvailable, UnknownName
from evenroad.trajectory import Limits, load_trajectory, make_trajectory, proved_in, save_trajectory
from evenroad.trajectory.formats import save_trajectories
from evenroad.trajectory.send import send_trajectory
from tests.refused import refused

NAMES = ("a", "b", "c", "d", "e")


@pytest.fixture(scope="module")
def trajectory():
    path = np.random.default_rng(0).uniform(-1.0, 1.0, (4, 5))
    return make_trajectory(path, Limits((1.0,) * 5, (2.0,) * 5), names=NAMES, held={"tool": 0.25})


def test_json_is_read_back_bit_for_bit(trajectory, tmp_path):
    save_trajectory(tmp_path / "t.json", trajectory)
    read = load_trajectory(tmp_path / "t.json")
    for name in ("times", "positions", "velocities", "accelerations", "waypoints"):
        np.testing.assert_array_equal(getattr(read, name), getattr(trajectory, name))
    assert read.controller == (*trajectory.names, *trajectory.held)
    for name in ("names", "held", "limits", "deviation", "stops", "duration", "radii", "highest", "source"):
        assert getattr(read, name) == getattr(trajectory, name)


def test_what_was_read_is_unchecked_until_a_world_has_proved_it(tmp_path):
    world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
    made = er.plan(world, (3, 3), (27, 17)).trajectory(speed=5.0)
    made.save(tmp_path / "t.json")
    read = load_trajectory(tmp_path / "t.json")
    assert (made.proof, read.proof) == ("exact", "unchecked")
    assert proved_in(read, world).proof == "exact"
    wall = np.zeros((20, 30), dtype=bool)
    wall[:, 15] = True
    refused(NotAvailable, "not proved free at .* s", proved_in, read, er.GridMap(wall).world(2))


def test_csv_has_all_joints_with_their_units(trajectory, tmp_path):
    save_trajectory(tmp_path / "t.csv", trajectory, ("tool", *NAMES))
    lines = (tmp_path / "t.csv").read_text().splitlines()
    assert lines[0].split(",")[:3] == ["time [s]", "tool [rad or m]", "a [rad or m]"]
    rows = np.array([line.split(",") for line in lines[1:]], dtype=float)
    np.testing.assert_array_equal(rows[:, 0], trajectory.times)
    np.testing.assert_array_equal(rows[:, 1], 0.25)
    np.testing.assert_array_equal(rows[:, 2:7], trajectory.positions)


def test_yaml_is_the_message_of_ros(trajectory, tmp_path):
    save_trajectory(tmp_path / "t.yaml", trajectory, (*NAMES, "tool"))
    message = yaml.safe_load((tmp_path / "t.yaml").read_text())
    assert list(message) == ["header", "joint_names", "points"]
    assert message["joint_names"] == [*NAMES, "tool"]
    np.testing.assert_allclose([point["positions"][:5] for point in message["points"]], trajectory.positions)
    assert {point["positions"][5] for point in message["points"]} == {0.25}
    assert {point["velocities"][5] for point in message["points"]} == {0.0}
    stamps = [point["time_from_start"] for point in message["points"]]
    assert all(0 <= stamp["nanosec"] < 10**9 for stamp in stamps)
    times = [stamp["sec"] + 1e-9 * stamp["nanosec"] for stamp in stamps]
    np.testing.assert_allclose(times, trajectory.times, atol=1e-9)


def interpret(script):
    """Run the moves of a program, and nothing else of it."""
    calls = re.findall(r"(servoj|movej)\(\[(.*?)\], (.*?)\)\n", script)
    places = np.array([[float(x) for x in row.split(",")] for _, row, _ in calls])
    options = [dict(pair.split("=") for pair in rest.split(", ")) for _, _, rest in calls]
    return places, options


def test_urscript_drives_through_every_state_by_the_clock(trajectory, tmp_path):
    save_trajectory(tmp_path / "t.script", trajectory, (*NAMES, "tool"))
    script = (tmp_path / "t.script").read_text()
    places, options = interpret(script)
    count = len(trajectory.positions) - 1
    np.testing.assert_allclose(places[:count, :5], trajectory.positions[1:], atol=1e-8)
    # Then it waits at the goal for twice the time that servoj looks ahead.
    assert len(places) - count == 25
    np.testing.assert_array_equal(places[count:], places[[count - 1]].repeat(25, axis=0))
    assert {option["t"] for option in options} == {"0.008"}
    start = re.search(r"start = \[(.*?)\]", script).group(1).split(",")
    np.testing.assert_allclose(np.array(start, dtype=float)[:5], trajectory.positions[0], atol=1e-8)
    assert script.index("halt") < script.index("servoj([")


def test_movej_goes_from_waypoint_to_waypoint(trajectory, tmp_path):
    save_trajectory(tmp_path / "t.movej.script", trajectory, (*NAMES, "tool"))
    places, options = interpret((tmp_path / "t.movej.script").read_text())
    np.testing.assert_allclose(places[:, :5], trajectory.waypoints[1:], atol=1e-8)
    assert {option["r"] for option in options} == {"0"}


def test_urscript_needs_six_joints_and_a_controllers_cycle_and_files_are_all_written_or_none(trajectory, tmp_path):
    refused(InvalidValue, "six joints", save_trajectory, tmp_path / "t.script", trajectory, NAMES)
    slow = make_trajectory([[0.0] * 6, [1.0] * 6], Limits((1.0,) * 6, (1.0,) * 6), step=0.01)
    refused(InvalidValue, r"0\.008", save_trajectory, tmp_path / "t.script", slow)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(InvalidValue, match="six joints"):
        save_trajectories([tmp_path / "t.json", tmp_path / "t.script"], trajectory, NAMES)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("order", [(*NAMES, "elbow"), NAMES[:3]])
def test_an_order_must_have_the_joints_that_move(trajectory, tmp_path, order):
    refused((UnknownName, InvalidValue), "joint", save_trajectory, tmp_path / "t.csv", trajectory, order)


@pytest.mark.parametrize("name", ["t.txt", "t", ".json"])
def test_an_unknown_format_is_named(trajectory, tmp_path, name):
    refused(UnknownName, "format of a trajectory", save_trajectory, tmp_path / name, trajectory)


@pytest.mark.parametrize(("change", "said"), [
    ({"format": "other"}, "format"), ({"times": [0.0]}, "belong together"), ({"joint_names": ["a"]}, "waypoints"),
    ({"positions": None}, "belong together"), ({"velocities": [[1e9] * 5]}, "belong together"),
    ({"limits": {"velocity": [0.1] * 5, "acceleration": [1.0] * 5}}, "velocity of"),
    ({"limits": 3}, "mapping"), ({"waypoints": [[0.0] * 4] * 3}, "waypoints"), ({"radii": [0.1] * 9}, "radii"),
    ({"held": {"tool": float("nan")}}, "held"), ({"held": {NAMES[0]: 0.0}}, "named once"),
    (lambda record: record["times"].__setitem__(3, record["times"][2]), "grow"),
    # Sent one a cycle, its last states would be driven far faster than they say.
    (lambda record: record["times"].__setitem__(-1, record["times"][-1] + 10.0), "equal steps"),
])  # fmt: skip
def test_a_damaged_file_is_named(trajectory, tmp_path, change, said):
    file = tmp_path / "t.json"
    save_trajectory(file, trajectory)
    record = json.loads(file.read_text())
    change(record) if callable(change) else record.update(change)
    file.write_text(json.dumps(record))
    refused(BrokenFile, said if said == "format" else "not as it was written", load_trajectory, file)
    del record["sha256"]
    file.write_text(json.dumps(record))
    refused(BrokenFile, said, load_trajectory, file)


@pytest.mark.parametrize("text", ["", "[]", "{", '{"format": "evenroad trajectory 1"}', "\x00"])
def test_what_is_no_trajectory_is_named(tmp_path, text):
    file = tmp_path / "t.json"
    file.write_text(text)
    refused(BrokenFile, "", load_trajectory, file)
    refused(BrokenFile, "cannot read", load_trajectory, tmp_path / "none.json")


def test_sending_asks_how_fast_the_states_are_not_what_they_say():
    made = make_trajectory([[0.0] * 6, [1.0] * 6], Limits((2.0,) * 6, (4.0,) * 6))
    quiet = replace(made, velocities=np.zeros_like(made.velocities), proof="certified")
    refused(InvalidValue, "faster than", send_trajectory, quiet, "127.0.0.1", model="UR5", fastest=0.5)
