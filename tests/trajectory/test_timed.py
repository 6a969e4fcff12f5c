"""Trajectories of one compiled call against dense samples of themselves, and against times that a finer grid finds."""

import numpy as np
import pytest

from evenroad._native.trajectory import FurtherLimits, JointLimits, PathLimits, distances_to, rounded, timed
from evenroad.trajectory.timing import fastest
from tests.trajectory.curves import curve, limits_from

ANY_SPEED = 1e300


def made(path, deviation, most, steps, highest=ANY_SPEED):
    """What one call makes, from rest to rest."""
    return timed(path, deviation, most, PathLimits(highest, 0.0, 0.0, FurtherLimits(None, None), 1.0), *steps)


def dense(seed, step=2e-4):
    """A path, its deviations, limits, and what one call makes of them in short steps."""
    path, limits = curve(seed)[0], limits_from(seed)
    deviation = np.where(np.random.default_rng(seed).random(len(path)) < 0.3 * (seed % 2), 0.0, 0.08)
    highest = ANY_SPEED if limits.along_path is None else limits.along_path**2
    return path, deviation, limits, made(path, deviation, limits.of_joints, (step, 1_000_000), highest)


@pytest.mark.parametrize("seed", range(12))
def test_no_state_uses_more_of_the_limits_than_it_says_and_some_nearly_as_much(seed):
    _, _, limits, made = dense(seed)
    velocity, acceleration = made.highest.velocity, made.highest.acceleration
    for rows, most, said in (
        (made.velocities, limits.velocity, velocity),
        (made.accelerations, limits.acceleration, acceleration),
    ):
        found = np.max(np.abs(rows) / most)
        assert found * (1 - 1e-12) <= said <= 1.0
        assert said <= 1.01 * found
    if limits.along_path is not None:
        assert np.linalg.norm(made.velocities, axis=1).max() <= limits.along_path * (1 + 1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_it_is_as_fast_as_times_on_a_finer_grid(seed):
    path, deviation, limits, made = dense(seed)
    law = fastest(rounded(path, deviation), limits)
    used = law.largest_shares(limits, 8)
    assert made.duration <= 1.004 * law.duration * max(1.0, used.velocity, np.sqrt(used.acceleration)) + 2e-4


@pytest.mark.parametrize("seed", range(12))
def test_velocities_and_accelerations_are_how_places_change(seed):
    step = 2e-4
    path, _, limits, made = dense(seed, step)
    q, velocities, accelerations = made.positions, made.velocities, made.accelerations
    np.testing.assert_allclose(q[[0, -1]], path[[0, -1]], atol=1e-12)
    np.testing.assert_allclose(velocities[[0, -1]], 0.0, atol=1e-12)
    moved = np.diff(q, axis=0) / step - 0.5 * (velocities[1:] + velocities[:-1])
    # Where the acceleration jumps within a step, the mean of both velocities is off by a quarter of that.
    assert np.all(np.abs(moved) <= 0.5 * step * np.array(limits.acceleration))
    assert np.median(np.abs(np.diff(velocities, axis=0) / step - 0.5 * (accelerations[1:] + accelerations[:-1]))) < 1e-3


@pytest.mark.parametrize("seed", range(12))
def test_lengths_and_the_deviation_are_those_of_the_rounded_path(seed):
    path, deviation, _, made = dense(seed)
    q, lengths, off = made.positions, made.lengths, made.deviation
    bent = rounded(path, deviation)
    np.testing.assert_array_equal(made.corners, bent.corners)
    assert made.stops == len(bent.stops)
    assert (lengths[0], lengths[-1]) == (0.0, pytest.approx(bent.length, rel=1e-12))
    # Chords are hardly shorter than the way, but where a stop lies between them.
    chords, ways = np.linalg.norm(np.diff(q, axis=0), axis=1), np.diff(lengths)
    np.testing.assert_allclose(chords, ways, rtol=1e-3, atol=1e-7)
    found = distances_to(path, q).max()
    assert found <= off + 1e-12
    assert off <= 1.004 * found + 1e-12


@pytest.mark.parametrize(("way", "velocity"), [(4.0, 1.0), (0.3, 5.0)])
def test_a_line_is_driven_as_by_hand(way, velocity):
    most = JointLimits(np.array([velocity]), np.array([2.0]), np.array([2.0]))
    found = made(np.array([[0.0], [way]]), np.zeros(2), most, (1e-5, 1_000_000))
    by_hand = 2.0 * np.sqrt(way / 2.0) if way <= velocity**2 / 2.0 else way / velocity + velocity / 2.0
    assert found.duration == pytest.approx(by_hand, rel=5e-4)
    assert found.deviation == 0.0
    assert found.highest.acceleration == pytest.approx(1.0, abs=1e-3)


def test_too_many_steps_are_none_and_senseless_numbers_are_refused():
    path, rows = np.array([[0.0], [1.0]]), [np.ones(1)] * 3
    most = JointLimits(*rows)
    found = made(path, np.zeros(2), most, (0.1, 10))
    assert found.outcome == "too long"
    assert len(found.positions) == 0
    assert found.duration == pytest.approx(2.0, rel=1e-3)
    assert len(made(path, np.zeros(2), most, (0.1, 21)).positions) in (21, 22)
    for wrong in (*([*rows[:k], np.zeros(1), *rows[k + 1 :]] for k in range(3)), [*rows[:2], np.ones(2)]):
        with pytest.raises(ValueError, match="must"):
            JointLimits(*wrong)
    with pytest.raises(ValueError, match="must"):
        made(path, np.zeros(2), JointLimits(*[np.ones(2)] * 3), (0.1, 10))
    with pytest.raises(ValueError, match="must"):
        made(path, np.zeros(2), most, (0.1, 10), 0.0)
    for steps in ((0.0, 10), (0.1, 0), (np.nan, 10)):
        with pytest.raises(ValueError, match="must"):
            made(path, np.zeros(2), most, steps)
