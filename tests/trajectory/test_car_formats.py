"""Files of robots on maps are read back: by evenroad, and by a reader of YAML."""

import json

import numpy as np
import pytest
import yaml

import evenroad as er
from evenroad.errors import BrokenFile, UnknownName
from evenroad.trajectory import load_trajectory
from tests.driving.oracle import BOX


@pytest.fixture(scope="module")
def of_car():
    grid = er.GridMap(np.zeros((60, 60), dtype=bool), resolution=0.1)
    world = grid.world(footprint=BOX, turning_radius=0.5)
    return er.plan(world, (2, 2, 0), (4, 4, 2)).trajectory(speed=1.0, curvature_rate=2.0, step=0.05)


@pytest.fixture(scope="module")
def of_disk():
    grid = er.GridMap(np.zeros((60, 60), dtype=bool), resolution=0.1)
    return er.plan(grid.world(0.2), (1, 1), (4, 3)).trajectory(acceleration=0.5, step=0.05)


@pytest.fixture(scope="module")
def on_the_spot():
    grid = er.GridMap(np.zeros((60, 60), dtype=bool), resolution=0.1)
    return er.plan(grid.world(footprint=BOX), (2, 2, 0), (4, 4, -2)).trajectory(speed=1.0, step=0.05)


@pytest.mark.parametrize("which", ["of_car", "on_the_spot"])
def test_the_json_of_a_car_is_read_back_as_the_same_motion_without_its_proof(which, request, tmp_path):
    made = request.getfixturevalue(which)
    made.save(tmp_path / "go.json")
    read = load_trajectory(tmp_path / "go.json")
    np.testing.assert_array_equal(read.positions, made.positions)
    np.testing.assert_array_equal(read.curvatures, made.curvatures)
    assert (read.limits, read.blends, read.proof) == (made.limits, made.blends, "unchecked")
    record = json.loads((tmp_path / "go.json").read_text())
    np.testing.assert_array_equal(record["poses"], made.positions)


def test_the_csv_has_what_a_controller_of_a_car_takes(of_car, tmp_path):
    of_car.save(tmp_path / "go.csv")
    text = (tmp_path / "go.csv").read_text()
    assert text.splitlines()[0] == "time [s],x,y,angle [rad],speed,angular speed [rad/s],curvature"
    table = np.loadtxt(text.splitlines()[1:], delimiter=",")
    np.testing.assert_array_equal(table[:, 0], of_car.times)
    np.testing.assert_array_equal(table[:, 1:4], of_car.positions)
    moving = np.abs(table[:, 4]) > 1e-6
    np.testing.assert_allclose(table[moving, 5], (table[:, 4] * table[:, 6])[moving], atol=1e-12)


@pytest.mark.parametrize("which", ["of_car", "of_disk"])
def test_the_yaml_is_a_nav_path_with_the_time_of_each_pose(which, request, tmp_path):
    made = request.getfixturevalue(which)
    made.save(tmp_path / "go.yaml")
    message = yaml.safe_load((tmp_path / "go.yaml").read_text())
    assert set(message) == {"header", "poses"}
    for each, time, pose in zip(message["poses"], made.times, made.positions, strict=True):
        stamp, position, turned = each["header"]["stamp"], each["pose"]["position"], each["pose"]["orientation"]
        assert each["header"]["frame_id"] == "map"
        assert stamp["sec"] + 1e-9 * stamp["nanosec"] == pytest.approx(time, abs=1e-9)
        assert list(position.values()) == [*pose[:2], 0.0]
        angle = pose[2] if len(pose) == 3 else 0.0
        np.testing.assert_allclose([*turned.values()], [0, 0, np.sin(angle / 2), np.cos(angle / 2)], atol=1e-15)


def test_a_car_has_no_urscript(of_car, tmp_path):
    with pytest.raises(UnknownName, match=r"format of a trajectory.*script"):
        of_car.save(tmp_path / "go.script")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "change",
    [
        {"pieces": []},
        {"pieces": [[0.0, 0.0, 0.0]]},
        {"pieces": [["inf", "inf", 1.0]]},
        {"pieces": [[0.0, "nan", 1.0]]},
        {"start": [0.0, 0.0]},
        {"limits": {"speed": 0.5}},
        {"limits": {"speed": -1.0}},
        {"limits": {"haste": 1.0}},
        {"step": 0.0},
        {"step": 1e-12},
        {"source": 3},
        {"poses": [[0.0, 0.0, 0.0]]},
    ],
)
def test_a_damaged_file_is_refused_in_one_line(of_car, tmp_path, change):
    of_car.save(tmp_path / "go.json")
    record = json.loads((tmp_path / "go.json").read_text()) | change
    del record["sha256"]
    (tmp_path / "go.json").write_text(json.dumps(record))
    with pytest.raises(BrokenFile) as refused:
        load_trajectory(tmp_path / "go.json")
    assert "\n" not in str(refused.value)
