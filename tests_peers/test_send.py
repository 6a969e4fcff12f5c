"""Sending to a controller on loopback that can lie, refuse, and be gone at any byte."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from evenroad import ArmWorld, load_robot
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.trajectory import Limits, make_trajectory, proved_in, save_trajectory
from evenroad.trajectory.send import send_trajectory
from tests_peers.fake_ur import SERVO, STOP_SCRIPT, STOP_SERVO, ArmElsewhere

pytest.importorskip("rtde_control")

HOST = "127.0.0.1"
START = [0.1, -1.5, 0.3, -1.2, 0.2, 0.0]


@pytest.fixture(scope="module")
def trajectory():
    path = [START, np.add(START, [0.1, 0.1, -0.1, 0.05, 0.0, 0.1])]
    made = make_trajectory(path, Limits((1.0,) * 6, (4.0,) * 6), names=load_robot("ur5").group)
    return proved_in(made, ArmWorld("ur5", "empty"))


@pytest.fixture
def arm():
    made = []

    def make(q=START, **options):
        made.append(ArmElsewhere(q=list(map(float, q)), **options))
        return made[-1]

    yield make
    for each in made:
        each.close()


def test_a_dry_run_moves_nothing(trajectory, arm):
    there = arm()
    assert send_trajectory(trajectory, HOST, model="UR5", fastest=1.0).states == 0
    assert there.told() == [[], []]


def test_the_arm_is_driven_through_every_state_and_stopped(trajectory, arm):
    there = arm()
    sent = send_trajectory(trajectory, HOST, model="ur5", fastest=1.0, go=True)
    count = len(trajectory.times)
    assert sent.states == count + 25
    commands, places = there.told()
    np.testing.assert_allclose(places[:count], trajectory.positions, atol=1e-12)
    # It waits at the goal for twice the time that servoj looks ahead.
    np.testing.assert_array_equal(places[count:], np.repeat(places[-1:], 25, axis=0))
    after = commands[len(commands) - commands[::-1].index(SERVO) :]
    assert STOP_SERVO in after
    assert STOP_SCRIPT in after


@pytest.mark.parametrize(
    ("options", "asked", "said"),
    [
        ({"q": np.add(START, [0, 0, 0.02, 0, 0, 0])}, {}, "not at the start: elbow_joint"),
        ({"model": "UR10"}, {}, "is a UR10, not a UR5"),
        ({"safety": 3}, {}, "not ready"),
        ({"mode": 5}, {}, "not ready"),
        ({}, {"fastest": 0.01}, "faster than the 0.01 rad/s allowed"),
    ],
)
def test_it_refuses_to_move(trajectory, arm, options, asked, said):
    there = arm(**options)
    with pytest.raises(InvalidValue, match=said):
        send_trajectory(trajectory, HOST, **({"model": "UR5", "fastest": 1.0, "go": True} | asked))
    assert SERVO not in there.told()[0]


def test_nobody_there_is_one_line(trajectory):
    with pytest.raises(NotAvailable, match="no answer"):
        send_trajectory(trajectory, HOST, model="UR5", fastest=1.0)


def test_an_arm_that_goes_astray_is_stopped(arm):
    far = make_trajectory([START, np.add(START, 0.6)], Limits((2.0,) * 6, (8.0,) * 6))
    there = arm(lags=1.0)
    with pytest.raises(NotAvailable, match="astray"):
        send_trajectory(far, HOST, model="UR5", fastest=3.0, go=True)
    assert STOP_SERVO in there.told()[0]


@pytest.mark.parametrize("count", [0, 1, 45, 60, 100, 200, 400, 1000, 3000, 5000])
def test_a_connection_that_is_lost_at_any_byte_is_one_line_and_ends(trajectory, arm, count):
    there = arm(fails_after=count)
    began = time.monotonic()
    with pytest.raises((NotAvailable, InvalidValue)):
        send_trajectory(trajectory, HOST, model="UR5", fastest=1.0, go=True)
    assert time.monotonic() - began < 30.0
    assert len(there.told()[1]) < len(trajectory.times)


def test_ctrl_c_stops_the_arm(arm, tmp_path):
    names = load_robot("ur5").group
    slow = make_trajectory([START, np.add(START, 0.5)], Limits((0.02,) * 6, (1.0,) * 6), names=names)
    save_trajectory(tmp_path / "t.json", slow)
    there = arm()
    command = [sys.executable, "-m", "evenroad", "send", str(tmp_path / "t.json"), "--host", HOST]
    command += ["--robot", "ur5", "--scene", "empty"]
    process = subprocess.Popen(
        [*command, "--model", "UR5", "--go"], stderr=subprocess.PIPE, env=os.environ, start_new_session=True
    )
    for _ in range(600):
        if len(there.told()[1]) > 20:
            break
        time.sleep(0.1)
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=30)
    assert process.returncode == 130
    assert b"interrupted" in said
    assert b"Traceback" not in said
    assert STOP_SERVO in there.told()[0]
    assert len(there.told()[1]) < len(slow.times)
