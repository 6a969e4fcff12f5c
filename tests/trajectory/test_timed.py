"""Trajectories of one compiled call against dense samples of themselves, and against times that a finer grid finds."""

import numpy as np
import pytest

from evenroad._native.trajectory import distances_to, timed
from evenroad.trajectory.blends import rounded
from evenroad.trajectory.timing import fastest
from tests.trajectory.curves import curve, limits_from

ANY_SPEED = 1e300


NOTHING = None, None


def made(path, deviation, most, steps, highest=ANY_SPEED):
    """What one call makes: positions, velocities, accelerations, and the rest of what it says."""
    said = timed(path, deviation, most, (highest, 0.0, 0.0, NOTHING, 1.0), steps)
    return *said[1], *said[2:8]


def dense(seed, step=2e-4):
    """A path, its deviations, limits, and what one call makes of them in short steps."""
    path, limits = curve(seed)[0], limits_from(seed)
    deviation = np.where(np.random.default_rng(seed).random(len(path)) < 0.3 * (seed % 2), 0.0, 0.08)
    highest = ANY_SPEED if limits.along_path is None else limits.along_path**2
    return path, deviation, limits, made(path, deviation, limits.most, (step, 1_000_000), highest)


@pytest.mark.parametrize("seed", range(12))
def test_no_state_uses_more_of_the_limits_than_it_says_and_some_nearly_as_much(seed):
    _, _, limits, (_, velocities, accelerations, *_, used) = dense(seed)
    for rows, most, said in zip((velocities, accelerations), (limits.velocity, limits.acceleration), used, strict=True):
        found = np.max(np.abs(rows) / most)
        assert found * (1 - 1e-12) <= said <= 1.0
        assert said <= 1.01 * found
    if limits.along_path is not None:
        assert np.linalg.norm(velocities, axis=1).max() <= limits.along_path * (1 + 1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_it_is_as_fast_as_times_on_a_finer_grid(seed):
    path, deviation, limits, (*_, duration, _, _) = dense(seed)
    law = fastest(rounded(path, deviation), limits)
    velocity, acceleration = law.largest_shares(limits, 8)
    assert duration <= 1.004 * law.duration * max(1.0, velocity, np.sqrt(acceleration)) + 2e-4


@pytest.mark.parametrize("seed", range(12))
def test_velocities_and_accelerations_are_how_places_change(seed):
    step = 2e-4
    path, _, limits, (q, velocities, accelerations, *_) = dense(seed, step)
    np.testing.assert_allclose(q[[0, -1]], path[[0, -1]], atol=1e-12)
    np.testing.assert_allclose(velocities[[0, -1]], 0.0, atol=1e-12)
    moved = np.diff(q, axis=0) / step - 0.5 * (velocities[1:] + velocities[:-1])
    # Where the acceleration jumps within a step, the mean of both velocities is off by a quarter of that.
    assert np.all(np.abs(moved) <= 0.5 * step * np.array(limits.acceleration))
    assert np.median(np.abs(np.diff(velocities, axis=0) / step - 0.5 * (accelerations[1:] + accelerations[:-1]))) < 1e-3


@pytest.mark.parametrize("seed", range(12))
def test_lengths_and_the_deviation_are_those_of_the_rounded_path(seed):
    path, deviation, _, (q, _, _, lengths, corners, stops, _, off, _) = dense(seed)
    bent = rounded(path, deviation)
    np.testing.assert_array_equal(corners, bent.corners)
    assert stops == len(bent.stops)
    assert (lengths[0], lengths[-1]) == (0.0, pytest.approx(bent.length, rel=1e-12))
    # Chords are hardly shorter than the way, but where a stop lies between them.
    chords, ways = np.linalg.norm(np.diff(q, axis=0), axis=1), np.diff(lengths)
    np.testing.assert_allclose(chords, ways, rtol=1e-3, atol=1e-7)
    found = distances_to(path, q).max()
    assert found <= off + 1e-12
    assert off <= 1.004 * found + 1e-12


@pytest.mark.parametrize(("way", "velocity"), [(4.0, 1.0), (0.3, 5.0)])
def test_a_line_is_driven_as_by_hand(way, velocity):
    most = np.array([velocity]), np.array([2.0]), np.array([2.0])
    *_, duration, off, used = made(np.array([[0.0], [way]]), np.zeros(2), most, (1e-5, 1_000_000))
    by_hand = 2.0 * np.sqrt(way / 2.0) if way <= velocity**2 / 2.0 else way / velocity + velocity / 2.0
    assert duration == pytest.approx(by_hand, rel=5e-4)
    assert off == 0.0
    assert used[1] == pytest.approx(1.0, abs=1e-3)


def test_too_many_steps_are_none_and_senseless_numbers_are_refused():
    path, most = np.array([[0.0], [1.0]]), (np.ones(1), np.ones(1), np.ones(1))
    positions, *_, duration, _, _ = made(path, np.zeros(2), most, (0.1, 10))
    assert len(positions) == 0
    assert duration == pytest.approx(2.0, rel=1e-3)
    assert len(made(path, np.zeros(2), most, (0.1, 21))[0]) in (21, 22)
    zero = np.zeros(1)
    for wrong in (
        *((*most[:k], zero, *most[k + 1 :]) for k in range(3)), (*most[:2], np.ones(2)), most[:2],
    ):  # fmt: skip
        with pytest.raises(ValueError, match="must"):
            made(path, np.zeros(2), wrong, (0.1, 10))
    with pytest.raises(ValueError, match="must"):
        made(path, np.zeros(2), most, (0.1, 10), 0.0)
    for steps in ((0.0, 10), (0.1, 0), (np.nan, 10)):
        with pytest.raises(ValueError, match="must"):
            made(path, np.zeros(2), most, steps)
