"""Torques of joints: against Lagrange's equation with numeric derivatives, and kept by trajectories."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import BrokenFile, InvalidValue, NotAvailable
from evenroad.robot import link_poses
from evenroad.trajectory import Limits, TipLimits, load_dynamics, make_trajectory
from tests.trajectory.heavy_arm import urdf
from tests.trajectory.newton_euler import torques_by_newton


@pytest.fixture(scope="module")
def dynamics(tmp_path_factory):
    file = tmp_path_factory.mktemp("slanted") / "slanted.urdf"
    file.write_text(urdf())
    return load_dynamics(er.load_robot(file), file)


def centres_and_turns(dynamics, q):
    poses = link_poses(dynamics.robot, q[np.newaxis])[0]
    for mass in dynamics.masses:
        pose = poses[dynamics.robot.links.index(mass.link)]
        yield mass, pose[:3, 3] + pose[:3, :3] @ mass.centre, pose[:3, :3]


def mass_matrix(dynamics, q):
    """Of the kinetic energy, by central differences of the links' poses."""
    step, total = 1e-5, np.zeros((len(q), len(q)))
    rows = [[*centres_and_turns(dynamics, q + sign * step * e)] for e in np.eye(len(q)) for sign in (1.0, -1.0)]
    for i, (mass, _, turn) in enumerate(centres_and_turns(dynamics, q)):
        moves, turns = [], []
        for ahead, behind in zip(rows[::2], rows[1::2], strict=True):
            moves.append((ahead[i][1] - behind[i][1]) / (2.0 * step))
            spin = (ahead[i][2] - behind[i][2]) / (2.0 * step) @ turn.T
            turns.append([spin[2, 1], spin[0, 2], spin[1, 0]])
        moves, turns = np.array(moves), np.array(turns)
        inertia = turn @ np.array(mass.inertia).reshape(3, 3) @ turn.T
        total += mass.mass * moves @ moves.T + turns @ inertia @ turns.T
    return total


def by_lagrange(dynamics, q, velocity, acceleration):
    """Torques of d/dt (M v) - 1/2 d/dq (v' M v) + dV/dq."""
    step = 1e-4
    changes, falls = [], []
    for e in np.eye(len(q)):
        ahead, behind = q + step * e, q - step * e
        changes.append((mass_matrix(dynamics, ahead) - mass_matrix(dynamics, behind)) / (2.0 * step))
        heights = [
            sum(9.81 * mass.mass * at[2] for mass, at, _ in centres_and_turns(dynamics, each))
            for each in (ahead, behind)
        ]
        falls.append((heights[0] - heights[1]) / (2.0 * step))
    rate = np.einsum("kij,k->ij", np.array(changes), velocity)
    swing = 0.5 * np.einsum("kij,i,j->k", np.array(changes), velocity, velocity)
    return mass_matrix(dynamics, q) @ acceleration + rate @ velocity - swing + np.array(falls)


def test_torques_are_those_of_lagranges_equation(dynamics):
    rng = np.random.default_rng(0)
    for q in dynamics.robot.random(rng, 12):
        velocity, acceleration = rng.normal(size=(2, 4))
        found = dynamics.torques(*(row[np.newaxis] for row in (q, velocity, acceleration)))[0]
        np.testing.assert_allclose(found, by_lagrange(dynamics, q, velocity, acceleration), atol=2e-5)


def test_a_mass_that_is_carried_counts(dynamics):
    q, still = dynamics.robot.random(np.random.default_rng(1), 5), np.zeros((5, 4))
    loaded = dynamics.carrying("finger", 1.5, (0.1, 0.0, 0.05))
    for row in range(5):
        expected = by_lagrange(loaded, q[row], still[row], still[row])
        np.testing.assert_allclose(loaded.torques(q, still, still)[row], expected, atol=2e-5)
    assert np.abs(loaded.torques(q, still, still) - dynamics.torques(q, still, still)).max() > 1.0


def test_torques_are_those_of_newton_and_euler_to_the_last_digits(dynamics):
    rng = np.random.default_rng(2)
    q, velocity, acceleration = dynamics.robot.random(rng, 61), *rng.normal(size=(2, 61, 4))
    q[::2] += 2.0 * math.pi * rng.integers(-3, 4, (31, 4)) * [1.0, 1.0, 0.0, 1.0]
    for each in (
        dynamics,
        dynamics.carrying("rail", 2.0, (0.1, 0.2, 0.3)),
        replace(dynamics, gravity=(3.0, -5.0, 1.0)),
    ):
        expected = torques_by_newton(each, q, velocity, acceleration)
        np.testing.assert_allclose(each.torques(q, velocity, acceleration), expected, rtol=1e-12, atol=1e-12)


def test_dynamics_and_limits_of_a_tip_can_be_sent_to_another_process(dynamics):
    tip = TipLimits(dynamics.robot, "finger", speed=1.0)
    q, still = np.zeros((1, 4)), np.zeros((1, 4))
    before = dynamics.torques(q, still, still)
    assert tip.native is tip.native
    again, other = pickle.loads(pickle.dumps((dynamics, tip)))
    assert (again.torques(q, still, still) == before).all()
    assert other == tip


PATH = np.array([[-1.0, 0.5, 0.0, 0.3], [0.2, -0.8, 0.3, -0.5], [1.1, 0.4, -0.2, 0.9], [0.3, 1.2, 0.1, -1.0]])
FAST = Limits((3.0,) * 4, (40.0,) * 4)


@pytest.mark.parametrize("jerk", [None, (8000.0,) * 4])
def test_a_trajectory_keeps_torques_and_uses_them(dynamics, jerk):
    limits = replace(FAST, jerk=jerk)
    free, kept = make_trajectory(PATH, limits), make_trajectory(PATH, replace(limits, torque=dynamics))

    def largest(trajectory):
        rows = trajectory.positions, trajectory.velocities, trajectory.accelerations
        heavy = np.argsort(-np.abs(dynamics.torques(*rows) / dynamics.efforts).max(axis=1))[:12]
        some = [*range(0, len(rows[0]), 25), *heavy]
        each = np.array([by_lagrange(dynamics, *(row[i] for row in rows)) for i in some])
        return np.abs(each / dynamics.efforts).max()

    assert largest(free) > 1.3
    assert 0.9 < largest(kept) <= 1.0 + 1e-5
    assert 0.95 < kept.highest["torque"] <= 1.0
    assert kept.duration > free.duration


@pytest.mark.parametrize("jerk", [None, (8000.0,) * 4])
def test_a_trajectory_keeps_the_acceleration_of_a_tip_and_uses_it(dynamics, jerk):
    limits = replace(FAST, jerk=jerk)
    tip = TipLimits(dynamics.robot, "finger", acceleration=4.0)
    free, kept = make_trajectory(PATH, limits), make_trajectory(PATH, replace(limits, tip=tip))
    finger = dynamics.robot.links.index("finger")

    def largest(trajectory):
        """By central differences of the tip's place over half a millisecond about each state."""
        step, rows = 5e-4, (trajectory.positions, trajectory.velocities, trajectory.accelerations)
        q, velocity, acceleration = rows
        places = [
            link_poses(dynamics.robot, q + at * velocity + 0.5 * at**2 * acceleration)[:, finger, :3, 3]
            for at in (-step, 0.0, step)
        ]
        return np.linalg.norm(places[0] - 2.0 * places[1] + places[2], axis=1).max() / step**2

    assert largest(free) > 6.0
    assert 3.6 < largest(kept) <= 4.0 + 1e-3
    assert 0.9 < kept.highest["tip acceleration"] <= 1.0


def test_a_tip_that_no_joint_moves_is_refused(dynamics):
    with pytest.raises(InvalidValue, match="no joint of the group, turn,bend,slide,finger, moves the link 'base'"):
        make_trajectory(PATH, replace(FAST, tip=TipLimits(dynamics.robot, "base", speed=1.0)))


def test_an_arm_that_is_too_weak_to_hold_itself_is_refused(dynamics):
    weak = replace(dynamics, efforts=(40.0, 3.0, 60.0, 2.0))
    with pytest.raises(NotAvailable, match=r"joint 'bend' needs \d+\.?\d* N m to hold the robot still .* of 3: "):
        make_trajectory(PATH, replace(FAST, torque=weak))


def test_files_without_sound_masses_are_refused(tmp_path):
    file = tmp_path / "arm.urdf"
    file.write_text(urdf())
    robot = er.load_robot(file)
    for mass in ("nan", "-1", "heavy", "1 2"):
        file.write_text(urdf(mass))
        with pytest.raises(BrokenFile, match="'lower'"):
            load_dynamics(robot, file)
    file.write_text(urdf().replace("inertial>", "inertia_of_no_kind>"))
    with pytest.raises(InvalidValue, match="no link of 'slanted' has a mass"):
        load_dynamics(robot, file)


def test_a_joint_without_effort_has_no_limit(dynamics, tmp_path):
    file = tmp_path / "arm.urdf"
    file.write_text(urdf().replace('effort="30.0"', 'effort="0"'))
    assert load_dynamics(dynamics.robot, file).efforts == (40.0, math.inf, 60.0, 2.0)
