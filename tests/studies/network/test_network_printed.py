"""The network as printed: batches, graphs of the initial points, and positions in the cube."""

import numpy as np
import pytest

from evenroad.errors import InvalidValue, UnknownName
from evenroad.points.measures import MEASURES
from evenroad_studies.network.printed import Printed, neighbours_of, train_printed
from tests.refused import refused

SMALL = {"n": 16, "d": 2, "sets": 3, "width": 16, "steps": 150}


@pytest.mark.parametrize("options", [{}, {"radius": None}, {"end": "sigmoid", "objective": "star"}])
def test_a_batch_gets_better_and_its_sets_come_best_first(options):
    sets, curve = train_printed(Printed(**SMALL | options), rng=3)
    again, _ = train_printed(Printed(**SMALL | options), rng=3)
    assert [each.hash for each in sets] == [each.hash for each in again]
    values = [MEASURES[options.get("objective", "hickernell")].rooted(each) for each in sets]
    assert values == sorted(values)
    assert np.mean(values) <= curve[-10:].mean() < 0.7 * curve[0]
    assert (sets[0].origin.family, sets[0].origin.method) == ("mpmc", "network as printed")


def test_a_radius_joins_the_first_32_points_within_it_and_each_with_itself():
    points = np.random.default_rng(1).random((90, 2))
    for radius in (0.2, 0.6):
        graph = neighbours_of(points, Printed(90, 2, radius=radius))
        near = np.linalg.norm(points[:, None] - points, axis=2) <= radius
        np.fill_diagonal(near, False)
        for own, (row, others) in enumerate(zip(graph, near, strict=True)):
            assert row[row >= 0].tolist() == [own, *np.flatnonzero(others).tolist()[:31]]
    nearest = neighbours_of(points, Printed(90, 2, radius=None, k=3))
    gaps = np.linalg.norm(points[:, None] - points, axis=2)
    assert all(set(row) == set(np.argsort(gap)[:4]) for row, gap in zip(nearest, gaps, strict=True))


def test_options_out_of_range_are_refused():
    refused(InvalidValue, "sets", Printed, 8, 2, sets=0)
    refused(InvalidValue, "radius", Printed, 8, 2, radius=-1.0)
    refused(UnknownName, "clamp", Printed, 8, 2, end="wrap")
