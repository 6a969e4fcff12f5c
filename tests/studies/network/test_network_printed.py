"""The network as printed: batches, graphs of the initial points, and positions in the cube."""

import numpy as np
import pytest

from evenroad.errors import InvalidValue, UnknownName
from evenroad.points.measures import MEASURES
from evenroad_studies.network.config import NetworkConfig
from evenroad_studies.network.layers import Graph
from evenroad_studies.network.printed import Printed, neighbours_of, train_printed
from evenroad_studies.network.train import Network
from tests.refused import refused

SMALL = {"n": 16, "d": 2, "sets": 3, "width": 16, "steps": 150}


@pytest.mark.parametrize("options", [{}, {"radius": 0.35}, {"end": "sigmoid", "objective": "star"}])
def test_a_batch_gets_better_and_its_sets_come_best_first(options):
    sets, curve = train_printed(Printed(**SMALL | options), rng=3)
    again, _ = train_printed(Printed(**SMALL | options), rng=3)
    assert [each.hash for each in sets] == [each.hash for each in again]
    values = [MEASURES[options.get("objective", "hickernell")].rooted(each) for each in sets]
    assert values == sorted(values)
    assert np.mean(values) <= curve[-10:].mean() < 0.7 * curve[0]
    assert (sets[0].origin.family, sets[0].origin.method) == ("mpmc", "network as printed")


def test_a_radius_joins_all_points_within_it_and_nothing_else():
    points = np.random.default_rng(1).random((30, 2))
    graph = neighbours_of(points, Printed(30, 2, radius=0.2))
    near = np.linalg.norm(points[:, None] - points, axis=2) <= 0.2
    np.fill_diagonal(near, False)
    for row, others in zip(graph, near, strict=True):
        assert sorted(row[row >= 0]) == np.flatnonzero(others).tolist()


def test_a_row_that_is_filled_up_sends_the_messages_of_its_beginning():
    points, graph = np.random.default_rng(2).random((12, 3)), np.tile(np.arange(3), (12, 1))
    filled = np.hstack([graph, np.full((12, 2), -1)])
    first, second = (Network(NetworkConfig(12, 3), np.random.default_rng(0)) for _ in range(2))
    np.testing.assert_allclose(first.moves(points, Graph.of(graph)), second.moves(points, Graph.of(filled)), rtol=1e-4)
    slope = np.random.default_rng(4).random((12, 3))
    np.testing.assert_allclose(first.slope_of(slope), second.slope_of(slope), rtol=1e-3, atol=1e-3)


def test_options_out_of_range_are_refused():
    refused(InvalidValue, "sets", Printed, 8, 2, sets=0)
    refused(InvalidValue, "radius", Printed, 8, 2, radius=-1.0)
    refused(UnknownName, "clamp", Printed, 8, 2, end="wrap")
