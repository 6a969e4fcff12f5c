"""Spheres that stand for a capsule contain it, and are few."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evenroad.collision.placed_capsules import LARGEST_EXCESS, cover_capsule


@given(st.floats(0.0, 2.0), st.floats(0.005, 0.5), st.integers(0, 2**32 - 1))
def test_every_point_of_a_capsule_is_in_a_sphere(half_length, radius, seed):
    cover = cover_capsule(half_length, radius)
    rng = np.random.default_rng(seed)
    along = half_length * np.concatenate([rng.uniform(-1.0, 1.0, 100), [-1.0] * 50, [1.0] * 50])
    directions = rng.normal(size=(200, 3))
    surface = radius * directions / np.linalg.norm(directions, axis=1, keepdims=True)
    points = surface + along[:, None] * np.array([1.0, 0.0, 0.0])
    centres = np.outer(half_length * np.array(cover.positions), [1.0, 0.0, 0.0])
    nearest = np.linalg.norm(points[:, None] - centres, axis=2).min(axis=1)
    assert nearest.max() <= cover.radius * (1.0 + 1e-9)


@given(st.floats(0.0, 2.0), st.floats(0.005, 0.5))
def test_spheres_exceed_the_capsule_by_no_more_than_a_tenth(half_length, radius):
    cover = cover_capsule(half_length, radius)
    assert radius <= cover.radius <= LARGEST_EXCESS * radius
    assert max(map(abs, cover.positions)) <= 1.0


@pytest.mark.parametrize("half_length", [0.05, 0.2, 0.5])
def test_one_sphere_fewer_would_not_do(half_length):
    radius = 0.05
    gaps = len(cover_capsule(half_length, radius).positions) - 2
    most = LARGEST_EXCESS * radius
    assert gaps * math.sqrt(most**2 - radius**2) + (most - radius) < half_length


def test_a_ball_is_covered_by_itself_and_what_is_nearly_one_by_one_sphere():
    cover = cover_capsule(0.0, 0.04)
    assert cover.positions == (0.0,)
    assert cover.radius == 0.04
    assert len(cover_capsule(0.001, 0.04).positions) == 1
