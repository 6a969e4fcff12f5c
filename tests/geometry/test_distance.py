import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from evenroad.geometry.distance import segment_distance

ENDS = arrays(np.float64, (2, 3), elements=st.floats(-1, 1, width=16))


@settings(max_examples=50, deadline=None)
@given(first=ENDS, second=ENDS)
def test_the_distance_of_segments_does_not_depend_on_names(first, second):
    found = [
        segment_distance(a[np.newaxis], b[np.newaxis])[0]
        for a, b in ((first, second), (second, first), (first[::-1], second), (first, second[::-1]))
    ]
    assert found == pytest.approx([found[0]] * 4, abs=1e-7)


@given(st.integers(0, 2**32 - 1), st.sampled_from(["skew", "parallel", "points", "crossing", "nearly parallel"]))
def test_the_distance_of_segments_is_the_least_between_sampled_points(seed, case):
    rng = np.random.default_rng(seed)
    a, b, c, d = rng.uniform(-1.0, 1.0, (4, 3))
    if case == "parallel":
        d = c + rng.uniform(-2.0, 2.0) * (b - a)
    elif case == "nearly parallel":
        d = c + rng.uniform(-2.0, 2.0) * (b - a) + 10.0 ** rng.uniform(-12.0, -3.0) * rng.normal(size=3)
    elif case == "points":
        b, d = a, (d if seed % 2 else c)
    elif case == "crossing":
        d = 2.0 * (a + 0.3 * (b - a)) - c
    shares = np.linspace(0.0, 1.0, 201)[:, None]
    first, second = a + shares * (b - a), c + shares * (d - c)
    sampled = np.linalg.norm(first[:, None] - second, axis=2).min()
    exact = segment_distance(np.array([[a, b]]), np.array([[c, d]]))[0]
    step = 0.005 * (np.linalg.norm(b - a) + np.linalg.norm(d - c)) / 2.0
    assert sampled - step - 1e-12 <= exact <= sampled + 1e-12
