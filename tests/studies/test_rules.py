import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import InvalidValue, UnknownName
from evenroad.points import draw
from evenroad.roadmap import KNearest, Radius
from evenroad_studies.rules import KEarlier, RadiusStar, prm_star_gamma, rule_named
from tests.planning.clouds import clouds
from tests.refused import refused


def _as_set(edges):
    return {tuple(edge) for edge in edges.tolist()}


@settings(max_examples=100, deadline=None)
@given(points=clouds(), k=st.integers(1, 6), terminals=st.integers(0, 2))
def test_earlier_edges_join_each_to_the_nearest_before_it_and_the_ends_were_there_first(points, k, terminals):
    n = len(points)
    terminals = min(terminals, n)
    order = [*range(n - terminals, n), *range(n - terminals)]
    expected = set()
    for place, i in enumerate(order):
        before = sorted((((points[i] - points[j]) ** 2).sum(), rank, j) for rank, j in enumerate(order[:place]))
        expected |= {(min(i, j), max(i, j)) for _, _, j in before[:k]}
    assert _as_set(KEarlier(k).edges(points, terminals=terminals)) == expected


def test_the_two_ends_are_neighbours_of_one_another_under_earlier():
    milestones = draw("sobol", 64, 2).points
    terminals = np.array([[0.0, 0.0], [1.0, 1.0]])
    edges = _as_set(KEarlier(5).edges(np.concatenate([milestones, terminals]), terminals=2))
    assert (64, 65) in edges
    assert {(0, 64), (0, 65)} <= edges


def test_the_radius_of_prm_star_is_the_formula_of_karaman_and_frazzoli():
    points = draw("sobol", 200, 3).points
    radius = 1.2 * (math.log(200) / 200) ** (1 / 3)
    assert _as_set(RadiusStar(1.2).edges(points)) == _as_set(Radius(radius).edges(points))
    assert prm_star_gamma(2, 1.0) == pytest.approx(2 * math.sqrt(1.5 / math.pi))


def test_names_lead_back_to_the_rules_of_the_studies_and_to_evenroads():
    for rule in (KEarlier(10), RadiusStar(2.0), KNearest(4), Radius(0.5)):
        assert rule_named(str(rule)) == rule
    refused(UnknownName, "k=K earlier, k=K symmetrised", rule_named, "k=10")
    refused(InvalidValue, "gamma", RadiusStar, 0.0)
