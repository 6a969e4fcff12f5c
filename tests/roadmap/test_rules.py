import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import InvalidValue, UnknownName
from evenroad.points import draw
from evenroad.roadmap import Complete, KNearest, Radius, default_rule, rule_named
from evenroad.roadmap.rules import ascending
from evenroad.space import BoxSpace, Rectangle
from tests.planning.clouds import clouds, nearest_by_sorting
from tests.refused import refused

SQUARE = Rectangle((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
WIDE = Rectangle((0.0, 0.0), (640.0, 0.0), (0.0, 480.0))
RULES = [KNearest(3), Radius(0.3), Complete()]


def _as_set(edges):
    return {tuple(edge) for edge in edges.tolist()}


@settings(max_examples=100, deadline=None)
@given(points=clouds(), k=st.integers(1, 6))
def test_symmetrised_edges_join_i_and_j_when_either_is_near_the_other(points, k):
    near = nearest_by_sorting(points, k)
    expected = {(min(i, j), max(i, j)) for i, row in enumerate(near.tolist()) for j in row}
    assert _as_set(KNearest(k).edges(points)) == expected


@pytest.mark.parametrize(("count", "pairs"), [(1, 3), (5, 200), (1000, 4000), (1000, 0)])
def test_pairs_are_sorted_and_each_once_as_numpy_sorts_them(count, pairs):
    given = np.random.default_rng(count).integers(0, count, (pairs, 2)).astype(np.int32)
    ours = ascending(given, count)
    assert ours.dtype == np.int32
    assert ours.tolist() == np.unique(np.sort(given, axis=1), axis=0).tolist()


def test_rules_say_their_name_and_a_name_leads_back_to_its_rule():
    named = {
        "k=10 symmetrised": KNearest(10),
        "radius=0.5": Radius(0.5),
        "radius=0.30000000000000004": Radius(0.1 + 0.2),
        "complete": Complete(),
    }
    assert [str(rule) for rule in named.values()] == list(named)
    for rule in (*named.values(), *RULES):
        assert rule_named(str(rule)) == rule
    refused(UnknownName, "k=K symmetrised", rule_named, "k=10")


@pytest.mark.parametrize("rule", RULES, ids=str)
def test_edges_are_sorted_unique_and_smaller_index_first(rule):
    edges = rule.edges(draw("sukharev", 64, 2).points, SQUARE, terminals=2)
    assert len(edges) > 60
    assert edges.dtype == np.int32
    assert (edges[:, 0] < edges[:, 1]).all()
    assert edges.tolist() == np.unique(edges, axis=0).tolist()


@pytest.mark.parametrize("count", [0, 1, 2])
@pytest.mark.parametrize("rule", [*RULES, Radius(2.0)], ids=str)
def test_tiny_sets_have_the_edges_that_they_can_have(rule, count):
    edges = rule.edges(np.linspace(0, 0.1, 2 * count).reshape(count, 2), SQUARE, terminals=min(count, 2))
    assert edges.shape == (1 if count == 2 else 0, 2)
    assert edges.dtype == np.int32


@pytest.mark.parametrize(("rule", "bad", "text"), [
    *((rule, dict(k=k), "k must be") for rule in (KNearest,) for k in (0, -3, 2.5, True)),
    *((Radius, dict(r=r), "radius") for r in (0, -1, np.nan, np.inf, "1")),
])  # fmt: skip
def test_what_is_no_rule_is_refused(rule, bad, text):
    refused(InvalidValue, text, rule, **bad)


@pytest.mark.parametrize(("d", "k"), [(2, 10), (5, 10), (6, 20), (10, 20), (14, 28)])
def test_the_default_k_spans_all_directions_of_a_lattice(d, k):
    assert default_rule(BoxSpace([0.0] * d, [1.0] * d)) == KNearest(k)
