"""The native time law against slow oracles in NumPy: states at times, the largest shares, and the fastest speeds."""

import itertools

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from evenroad._native.trajectory import distances_to, largest_share, rounded
from evenroad.trajectory.timing import fastest, paused, slowed
from tests.trajectory.curves import curve, limits_from

INTERVALS, OF_ARC, OF_LINE, WITHIN = 400, 12, 4, 1.0 - 1e-3


def on_curve(path, s, piece):
    """Positions and their first two derivatives at lengths, each on a piece."""
    after, bend = (s - path.starts[piece])[:, None], path.bend[piece][:, None]
    out, along = path.out[piece], path.along[piece]
    cosine, sine = np.cos(after * bend), np.sin(after * bend)
    radius = np.divide(1.0, bend, out=np.zeros_like(bend), where=bend > 0.0)
    position = path.origin[piece] + radius * cosine * out + np.where(bend > 0.0, radius * sine, after) * along
    return position, cosine * along - sine * out, -bend * (cosine * out + sine * along)


def states(law, t):
    inside = (t >= 0.0) & (t <= law.duration)
    now = np.clip(t, 0.0, law.duration)
    i = np.clip(np.searchsorted(law.times, now, side="right") - 1, 0, len(law.accelerations) - 1)
    after, push = now - law.times[i], law.accelerations[i]
    s = np.clip(law.lengths[i] + after * (law.speeds[i] + push * after / 2), law.lengths[i], law.lengths[i + 1])
    middle = 0.5 * (law.lengths[i] + law.lengths[i + 1])
    piece = np.clip(np.searchsorted(law.path.starts, middle, side="right") - 1, 0, len(law.path.bend) - 1)
    position, direction, bend = on_curve(law.path, s, piece)
    speed = np.where(inside, np.maximum(law.speeds[i] + push * after, 0.0), 0.0)[:, None]
    return position, direction * speed, direction * np.where(inside, push, 0.0)[:, None] + bend * speed**2


@pytest.mark.parametrize("seed", range(6))
def test_states_are_those_of_the_oracle_also_outside_and_in_pauses(seed):
    law = slowed(paused(fastest(curve(seed)[1], limits_from(seed)), 0.1), 1.3)
    t = np.random.default_rng(seed).uniform(-0.2, law.duration + 0.2, 700)
    t[:5] = 0.0, law.duration, -1.0, law.times[300], law.duration + 1.0
    at = law.at(t)
    for found, expected in zip((at.positions, at.velocities, at.accelerations), states(law, t), strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("seed", range(6))
def test_the_largest_shares_are_those_of_all_samples(seed):
    limits = limits_from(seed)
    law = fastest(curve(seed)[1], limits)
    within = law.times[:-1, None] + np.diff(law.times)[:, None] * np.linspace(0.0, 1.0 - 1e-9, 8)
    _, velocities, accelerations = states(law, within.ravel())
    expected = [np.max(np.abs(velocities) / limits.velocity), np.max(np.abs(accelerations) / limits.acceleration)]
    used = law.largest_shares(limits, 8)
    np.testing.assert_allclose((used.velocity, used.acceleration), expected, rtol=1e-8)


def pushes(side, square, step, following, acceleration):
    """The least and the most acceleration along an interval from a squared speed to at most the following one."""
    ahead, ahead_bend, behind, behind_bend = side
    slopes = np.concatenate([ahead, behind + 2.0 * step * behind_bend])
    rests = square * np.concatenate([ahead_bend, behind_bend])
    most = np.tile(acceleration, 2)
    flat = np.abs(slopes) < 1e-12
    if np.any(np.abs(rests[flat]) > most[flat]):
        return 1.0, 0.0
    both = np.stack([(-most - rests)[~flat] / slopes[~flat], (most - rests)[~flat] / slopes[~flat]])
    return max(-square / (2 * step), *both.min(axis=0)), min((following - square) / (2 * step), *both.max(axis=0))


@pytest.mark.parametrize("seed", range(4))
def test_speeds_are_the_fastest_that_halving_finds(seed):
    path, limits = curve(seed)[1], limits_from(seed)
    acceleration, velocity = WITHIN * np.array(limits.acceleration), np.array(limits.velocity)
    counts = np.maximum(
        np.ceil(INTERVALS * np.diff(path.starts) / path.length),
        np.where(path.bend > 0, np.maximum(OF_ARC, np.ceil(np.diff(path.starts) * path.bend / 0.05)), OF_LINE),
    )
    counts = counts.astype(int)
    parts = zip(path.starts[:-1], path.starts[1:], counts, strict=True)
    grid = np.concatenate([[0.0], *(np.linspace(a, b, n + 1)[1:] for a, b, n in parts)])
    piece, steps = np.repeat(np.arange(len(counts)), counts), np.diff(grid)
    _, ahead, ahead_bend = on_curve(path, grid[:-1], piece)
    _, behind, behind_bend = on_curve(path, grid[1:], piece)
    with np.errstate(divide="ignore"):
        most = [np.min(velocity / np.abs(side), axis=1) ** 2 for side in (ahead, behind)]
    ceiling = np.zeros(len(grid))
    ceiling[1:-1] = np.minimum(most[0][1:], most[1][:-1])
    ceiling = np.minimum(ceiling, np.inf if limits.along_path is None else limits.along_path**2)
    ceiling[np.isin(grid, path.stops)] = 0.0

    sides = list(zip(ahead, ahead_bend, behind, behind_bend, strict=True))
    highest = np.zeros(len(grid))
    for i in range(len(steps) - 1, -1, -1):

        def is_possible(square, i=i):
            least, most = pushes(sides[i], square, steps[i], highest[i + 1], acceleration)
            return least <= most

        low, high = 0.0, ceiling[i]
        if not is_possible(high):
            for _ in range(40):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if is_possible(middle) else (low, middle)
            high = low
        highest[i] = high
    squares = np.zeros(len(grid))
    for i, step in enumerate(steps):
        push = pushes(sides[i], squares[i], step, highest[i + 1], acceleration)[1]
        squares[i + 1] = min(max(squares[i] + 2.0 * step * push, 0.0), highest[i + 1])

    law = fastest(path, limits)
    np.testing.assert_allclose(law.lengths, grid, rtol=1e-14)
    np.testing.assert_allclose(law.speeds**2, squares, rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(np.diff(law.times), 2.0 * steps / (law.speeds[:-1] + law.speeds[1:]), rtol=1e-6)
    np.testing.assert_allclose(law.accelerations, np.diff(law.speeds**2) / (2.0 * steps), rtol=1e-9, atol=1e-9)


def test_points_are_as_far_as_the_nearest_motion_is():
    path, points = curve(3)[0], np.random.default_rng(1).uniform(-2.5, 2.5, (50, 4))
    shares = np.linspace(0.0, 1.0, 20_001)[:, None]
    dense = np.concatenate([a + shares * (b - a) for a, b in itertools.pairwise(path)])
    expected = [np.linalg.norm(dense - point, axis=1).min() for point in points]
    np.testing.assert_allclose(distances_to(path, points), expected, atol=1e-4)
    assert distances_to(path, path).max() < 1e-12


def rounded_slowly(path, deviation):
    """The columns of a rounded path, corner by corner."""
    steps = np.diff(path, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    directions = steps / lengths[:, None]
    before, after = directions[:-1], directions[1:]
    half = np.arctan2(np.linalg.norm(after - before, axis=1), np.linalg.norm(after + before, axis=1))
    turns = half > 0.5e-6
    is_round = turns & (half < 0.5 * np.pi - 1e-3) & (deviation[1:-1] > 0.0)
    cut = np.zeros(len(path))
    for i in np.flatnonzero(is_round):
        by_deviation = deviation[i + 1] * np.sin(half[i]) / (1.0 - np.cos(half[i]))
        cut[i + 1] = min(lengths[i] / 2, lengths[i + 1] / 2, by_deviation)
    pieces, corners, stops, total = [], [], [], 0.0
    for i, (length, direction) in enumerate(zip(lengths, directions, strict=True)):
        if i and is_round[i - 1]:
            radius = cut[i] / np.tan(half[i - 1])
            inward = after[i - 1] - before[i - 1]
            centre = path[i] + inward / np.linalg.norm(inward) * radius / np.cos(half[i - 1])
            out = (path[i] - cut[i] * before[i - 1] - centre) / radius
            pieces.append((total, *centre, *out, *before[i - 1], 1.0 / radius))
            corners.append(total + radius * half[i - 1])
            total += radius * 2.0 * half[i - 1]
        elif i:
            corners.append(total)
            stops += [total] if turns[i - 1] else []
        if (line := length - cut[i] - cut[i + 1]) > 1e-12 * length:
            pieces.append((total, *(path[i] + cut[i] * direction), *np.zeros(len(direction)), *direction, 0.0))
            total += line
    return np.array(pieces), corners, stops, total


@pytest.mark.parametrize("seed", range(8))
def test_corners_are_rounded_as_one_by_one(seed):
    rng = np.random.default_rng(seed)
    path, dim = curve(seed)[0], 4
    path[-1] = path[-3] if seed == 3 else path[-1]  # a reversal
    deviation = np.where(rng.random(len(path)) < 0.3, 0.0, rng.choice([0.02, 0.5], len(path)))
    found, (pieces, corners, stops, total) = rounded(path, deviation), rounded_slowly(path, deviation)
    columns = np.column_stack([found.starts[:-1], found.origin, found.out, found.along, found.bend])
    np.testing.assert_allclose(columns, pieces, rtol=1e-9, atol=1e-12)
    assert columns.shape == (len(pieces), 2 + 3 * dim)
    np.testing.assert_allclose(found.corners, corners, rtol=1e-12)
    np.testing.assert_allclose(found.stops, stops, rtol=1e-12)
    assert found.length == pytest.approx(total, rel=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_averages_are_those_of_splines(seed):
    window, law = 0.17, fastest(curve(seed)[1], limits_from(seed))
    t = np.linspace(0.0, law.duration + window, 1501)
    grid = np.linspace(-window, law.duration + window, len(t) + 1)
    travelled = CubicHermiteSpline(grid, *states(law, grid)[:2]).antiderivative()
    now, before = states(law, t), states(law, t - window)
    positions = (travelled(t) - travelled(t - window)) / window
    positions[[0, -1]] = now[0][[0, -1]]
    found = law.averages(window, t)
    np.testing.assert_allclose(found.positions, positions, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(found.velocities, (now[0] - before[0]) / window, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(found.accelerations, (now[1] - before[1]) / window, rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize("shape", [(0, 3), (1, 3), (57, 3), (40, 20), (5, 0), (0, 0)])
def test_the_largest_share_is_that_of_all_entries_also_of_none(shape):
    rng = np.random.default_rng(7)
    rows, most = rng.normal(size=shape), rng.uniform(0.5, 2.0, shape[1])
    assert largest_share(rows, most) == np.max(np.abs(rows) / most, initial=0.0)
    steps = np.diff(rows, axis=0)
    assert largest_share(rows, most, of_steps=True) == np.max(np.abs(steps) / most, initial=0.0)
