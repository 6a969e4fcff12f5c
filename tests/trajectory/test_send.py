"""What `evenroad send` moves, and what it does not: against an arm that ur_rtde would tell of, here in this process.

That the bytes of ur_rtde mean the same is shown by tests_peers/test_send.py, against a controller on loopback.
"""

import multiprocessing
import queue
import threading
import types
from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.cli import main
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.trajectory import Limits, make_trajectory, save_trajectory, send
from evenroad.trajectory.send import ASTRAY, AT_START, send_trajectory
from tests.refused import refused

START = [0.1, -1.5, 0.3, -1.2, 0.2, 0.0]
RUNNING, NORMAL, REDUCED = 7, 1, 2
STATES = 10
LIMITS = Limits((1.0,) * 6, (4.0,) * 6)


class Arm:
    """A UR arm by the three interfaces of ur_rtde: it is where it was told to be, plus `off` from state `since` on."""

    def __init__(self, q=START, model="UR5", mode=RUNNING, safety=NORMAL, off=0.0, since=0, stops=None, lost=None):
        self.q, self.model, self.mode, self.safety = np.array(q, dtype=float), model, mode, safety
        self.off, self.since, self.stops, self.lost = off, since, stops, lost
        self.places, self.calls = [], []

    # Dashboard.
    def connect(self, _):
        self.calls.append("connect")

    def getRobotModel(self):
        return f"{self.model}\n"

    # Both other interfaces.
    def disconnect(self):
        self.calls.append("disconnect")

    def isConnected(self):
        return self.lost is None or len(self.places) <= self.lost

    # What it says of itself.
    def getActualQ(self):
        q = self.q.copy()
        q[2] += self.off if len(self.places) > self.since else 0.0
        return q.tolist()

    def getRobotMode(self):
        return self.mode

    def getSafetyMode(self):
        return 3 if self.stops is not None and len(self.places) > self.stops else self.safety

    # What it is told.
    def initPeriod(self):
        return len(self.places)

    def waitPeriod(self, began):
        assert began == len(self.places) - 1

    def servoJ(self, q, *_):
        self.places.append(q)
        self.q = np.array(q)
        return True

    def servoStop(self, deceleration):
        assert deceleration > 0.0
        self.calls.append("servoStop")

    def stopScript(self):
        self.calls.append("stopScript")


class Pipes:
    """What `multiprocessing` does for sending, within this process."""

    @staticmethod
    def Pipe():
        line = queue.Queue()
        return types.SimpleNamespace(
            poll=lambda patience: True, recv=line.get, close=lambda: None
        ), types.SimpleNamespace(send=line.put, close=lambda: None)

    @staticmethod
    def Process(*, target, args, daemon):
        thread = threading.Thread(target=target, args=args, daemon=daemon)
        thread.kill = lambda: None
        return thread


@pytest.fixture
def there(monkeypatch):
    """Put an arm where ur_rtde's modules would find one."""

    def make(**options):
        arm = Arm(**options)
        made = {
            "rtde_receive": ("RTDEReceiveInterface", lambda *_: arm),
            "rtde_control": ("RTDEControlInterface", lambda *_: arm.calls.append("control") or arm),
            "dashboard_client": ("DashboardClient", lambda host: arm),
        }
        modules = {name: types.SimpleNamespace(**{kind: meet}) for name, (kind, meet) in made.items()}
        monkeypatch.setattr(send, "require_extra", lambda module, *_: modules[module])
        monkeypatch.setattr(multiprocessing, "get_context", lambda how: Pipes)
        return arm

    return make


def trajectory(away=0.02):
    """From `START`, every joint by so much."""
    return make_trajectory([START, np.add(START, away)], LIMITS)


def sent(moves=None, **options):
    moves = trajectory() if moves is None else moves
    # What an arm does is the question here, not what it touches.
    return send_trajectory(
        replace(moves, proof="certified"), "arm", **({"model": "UR5", "fastest": 1.0, "go": True} | options)
    )


def stopped(arm):
    """Whether the arm was told to stop after all it was told."""
    return arm.calls[-3:-1] == ["servoStop", "stopScript"]


def test_without_go_nothing_is_told(there):
    arm = there()
    assert sent(go=False).states == 0
    assert (arm.places, "control" in arm.calls) == ([], False)


@pytest.mark.parametrize("safety", [NORMAL, REDUCED])
def test_every_state_is_told_in_its_order_then_the_goal_until_it_is_there_and_stop(there, safety):
    moves, arm, seen = trajectory(), there(safety=safety), []
    done = sent(moves, progress=lambda *counts: seen.append(counts))
    count = len(moves.times)
    assert count > STATES > 1
    np.testing.assert_array_equal(arm.places[:count], moves.positions)
    np.testing.assert_array_equal(arm.places[count:], np.repeat(moves.positions[-1:], 25, axis=0))
    assert done == send.Sent(count + 25, 0.0)
    assert seen == [(i + 1, count + 25) for i in range(count + 25)]
    assert stopped(arm)


@pytest.mark.parametrize("joint", range(6))
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_nothing_moves_from_another_place_than_the_start(there, joint, side):
    for share, moved in ((0.99, True), (1.01, False)):
        arm = there(q=np.add(START, side * share * AT_START * np.eye(6)[joint]))
        if moved:
            assert sent().states > STATES
            continue
        refused(InvalidValue, f"not at the start: joint_{joint + 1} is at .* more than 0.01", sent)
        assert (arm.places, "control" in arm.calls) == ([], False)


def test_the_start_is_that_of_the_trajectory_not_its_goal(there):
    moves = trajectory(away=0.1)
    arm = there(q=moves.positions[-1])
    refused(InvalidValue, "not at the start", sent, moves)
    assert arm.places == []


@pytest.mark.parametrize(("mode", "safety"), [
    *((RUNNING, safety) for safety in (0, *range(3, 14))), *((mode, NORMAL) for mode in (-1, *range(7), 8)),
])  # fmt: skip
def test_nothing_moves_in_any_other_mode_of_the_robot_or_of_its_safety(there, mode, safety):
    arm = there(mode=mode, safety=safety)
    refused(InvalidValue, f"not ready to move: robot mode {mode}, safety mode {safety}", sent)
    assert (arm.places, "control" in arm.calls) == ([], False)


@pytest.mark.parametrize(("options", "asked", "said"), [
    ({"model": "UR10"}, {}, "is a UR10, not a UR5"), ({}, {"fastest": 0.01}, "faster than the 0.01 rad/s allowed"),
])  # fmt: skip
def test_another_arm_is_not_moved_nor_faster_than_allowed(there, options, asked, said):
    arm = there(**options)
    refused(InvalidValue, said, sent, make_trajectory([START, np.add(START, 0.02 * np.eye(6)[1])], LIMITS), **asked)
    assert arm.places == []


def test_an_arm_that_its_safety_stops_is_told_no_more(there):
    arm = there(stops=STATES - 1)
    refused(NotAvailable, "stopped after .* by its safety", sent)
    assert len(arm.places) == STATES
    assert stopped(arm)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_an_arm_that_goes_astray_is_stopped_at_once(there, side):
    arm = there(off=side * 1.01 * ASTRAY, since=STATES - 1)
    refused(NotAvailable, "joint_3 is 0.303 rad astray", sent)
    assert len(arm.places) == STATES
    assert stopped(arm)


def test_one_that_lags_by_less_goes_on_and_is_told_by_how_much(there):
    arm = there(off=0.99 * ASTRAY)
    done = sent()
    assert done.states == len(arm.places)
    assert done.largest_error == pytest.approx(0.99 * ASTRAY)
    assert stopped(arm)


def test_a_connection_that_is_lost_ends_it_and_stop_is_tried(there):
    arm = there(lost=STATES - 1)
    refused(NotAvailable, "lost the connection after", sent)
    assert len(arm.places) == STATES
    assert stopped(arm)


@pytest.mark.parametrize("go", [False, True])
def test_what_nobody_has_checked_in_a_world_is_not_sent(there, go):
    arm = there()
    refused(InvalidValue, "nobody has checked", send_trajectory, trajectory(), "arm", model="UR5", fastest=1.0, go=go)
    assert arm.calls == []


def test_the_command_dry_runs_refuses_and_moves(there, tmp_path, capsys):
    group = er.load_robot("ur5").group
    moves = make_trajectory([START, np.add(START, 0.02)], LIMITS, names=group)
    save_trajectory(tmp_path / "t.json", moves)
    line = ["send", str(tmp_path / "t.json"), "--robot", "ur5", "--scene", "empty", "--host", "arm", "--model", "UR5"]
    arm = there()
    assert main(line) == 0
    assert "dry run" in capsys.readouterr().out
    assert arm.places == []
    assert main([*line, "--go"]) == 0
    assert "states sent" in capsys.readouterr().out
    assert len(arm.places) > STATES
    arm = there(safety=5)
    assert main([*line, "--go"]) == 2
    assert "safety mode 5" in capsys.readouterr().err
    assert arm.places == []
