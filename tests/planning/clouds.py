"""Point clouds for tests of neighbours, and the slow definition of nearness."""

import numpy as np
from hypothesis import strategies as st


def nearest_by_sorting(points, k):
    """The definition: all others, by distance, then by index."""
    rows = []
    for i, point in enumerate(points):
        squared = ((points - point) ** 2).sum(axis=1)
        others = [j for j in np.lexsort((np.arange(len(points)), squared)) if j != i]
        rows.append(others[:k])
    return np.array(rows, dtype=np.int32).reshape(len(points), min(k, max(len(points) - 1, 0)))


@st.composite
def clouds(draw_value):
    """Random points, or points of a coarse grid, which are full of ties and duplicates."""
    n, d = draw_value(st.integers(0, 60)), draw_value(st.integers(1, 5))
    random = np.random.default_rng(draw_value(st.integers(0, 10**6)))
    points = random.random((n, d))
    return np.floor(points * 4) if draw_value(st.booleans()) else points
