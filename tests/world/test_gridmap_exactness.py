"""Verdicts of the disk world against the slow oracle, on thousands of small maps and motions."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from evenroad.world import GridMap
from tests.world.gridmap_oracle import distance_to_obstacles

ROUNDING = 1e-9
DENSITIES = (0.0, 0.01, 0.03, 0.1, 0.3, 0.7, 1.0)


def random_map(rng, largest):
    rows, cols = rng.integers(1, largest + 1, 2)
    return rng.random((rows, cols)) < rng.choice(DENSITIES)


def random_ends(rng, occupied, count, style):
    """Ends (count, 2), (count, 2) of motions, the border included."""
    size = np.array(occupied.shape[::-1])
    if style == "anywhere":
        a, b = rng.random((count, 2)) * size, rng.random((count, 2)) * size
    else:  # on the grid lines and on the middles between them
        a, b = (rng.integers(0, 2 * size + 1, (count, 2)) / 2 for _ in range(2))
    if style == "past a corner":
        corner = (rng.choice(np.argwhere(occupied)) + rng.integers(0, 2, 2))[::-1]
        angle = rng.uniform(0, 2 * math.pi)
        along, aside = np.array([(math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))])
        a = corner + rng.uniform(-0.3, 0.3) * aside - rng.uniform(3, 25, (count, 1)) * along
        b = a + rng.uniform(25, 50) * along
    if style == "straight":
        axis = rng.integers(0, 2, count)
        b[np.arange(count), axis] = a[np.arange(count), axis]
    if style == "diagonal":
        b = a + rng.integers(-10, 11, (count, 1)) / 2 * rng.choice([-1, 1], (count, 2))
    return a, b


def assert_verdicts_of(occupied, radius, a, b):
    """Compare points and motions with the oracle; return how many motions were free."""
    world = GridMap(occupied).world(radius)
    points, motions = world.valid(a), world.motion_valid(a, b)
    np.testing.assert_array_equal(motions, world.motion_valid(b, a))
    for i, (start, end) in enumerate(zip(a.tolist(), b.tolist(), strict=True)):
        for verdict, distance in (
            (points[i], distance_to_obstacles(start, start, occupied)),
            (motions[i], distance_to_obstacles(start, end, occupied)),
        ):
            if abs(distance - radius) > ROUNDING:
                assert verdict == (distance >= radius), (occupied, radius, start, end, distance)
    return int(motions.sum())


@pytest.mark.parametrize("style", ["anywhere", "grid", "straight", "diagonal"])
def test_random_maps_radii_and_motions_agree_with_the_oracle(style):
    rng = np.random.default_rng(3)
    free = 0
    for _ in range(400):
        occupied = random_map(rng, largest=9)
        radius = float(rng.choice([1e-6, 0.25, 0.5, 1.0, 1.5, 2.0, 2.5, 20.0, 3.0 * rng.random() + 1e-3]))
        free += assert_verdicts_of(occupied, radius, *random_ends(rng, occupied, 6, style))
    assert free > 50


@pytest.mark.parametrize("style", ["anywhere", "grid", "straight", "diagonal", "past a corner"])
def test_a_radius_just_below_the_distance_is_free_and_just_above_is_blocked(style):
    rng = np.random.default_rng(4)
    tried = 0
    while tried < 500:
        # Past the corner of a lone square a motion leaps over what is clear, and must not leap over the corner.
        lone = style == "past a corner"
        occupied = np.arange(41 * 57).reshape(41, 57) == 1150 if lone else random_map(rng, largest=12)
        a, b = random_ends(rng, occupied, 1, style)
        distance = distance_to_obstacles(a[0].tolist(), b[0].tolist(), occupied)
        if distance < 1e-3:
            continue
        tried += 1
        for radius, free in ((distance - 1e-7, True), (distance + 1e-7, False)):
            world = GridMap(occupied).world(radius)
            assert world.motion_valid(a, b)[0] == free, (occupied, a, b, radius)


def test_wide_maps_with_few_obstacles_where_motions_leap_agree_with_the_oracle():
    rng = np.random.default_rng(5)
    free = 0
    for _ in range(60):
        occupied = rng.random((50, 70)) < rng.choice([0.0, 0.001, 0.004])
        radius = float(rng.choice([0.5, 1.0, 3.0, 6.0, 7.3]))
        free += assert_verdicts_of(occupied, radius, *random_ends(rng, occupied, 10, "anywhere"))
    assert free > 100


MAPS = st.tuples(st.integers(1, 7), st.integers(1, 7)).flatmap(lambda shape: arrays(np.bool_, shape))
HALVES = st.integers(0, 14).map(lambda half: half / 2)
PLACES = st.tuples(HALVES | st.floats(0.0, 7.0), HALVES | st.floats(0.0, 7.0))


@settings(deadline=None, max_examples=300)
@given(occupied=MAPS, radius=st.floats(1e-6, 4.0), a=PLACES, b=PLACES)
@example(occupied=np.zeros((1, 1), np.bool_), radius=0.5, a=(0.5, 0.5), b=(0.5, 0.5))
@example(occupied=np.eye(2, dtype=np.bool_), radius=1e-6, a=(0.5, 1.5), b=(1.5, 0.5))
def test_any_small_map_agrees_with_the_oracle(occupied, radius, a, b):
    rows, cols = occupied.shape
    size = np.array([cols, rows])
    assert_verdicts_of(occupied, radius, np.minimum([a], size), np.minimum([b], size))
