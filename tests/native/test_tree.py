"""The native tree of configurations against the same in plain NumPy."""

import numpy as np
import pytest

from evenroad._native import planning
from evenroad.errors import InvalidValue

PERIODS = [np.array([np.inf, np.inf, np.inf]), np.array([np.inf, 2 * np.pi, 1.0, np.inf, np.inf])]


def grown(period, count, seed=0):
    """A tree of random nodes, each the child of an earlier one, and what it should hold."""
    rng = np.random.default_rng(seed)
    ranges = np.where(np.isinf(period), 3.0, period)
    nodes = rng.random((count, len(period))) * ranges
    parents = np.array([-1, *(int(rng.integers(i)) for i in range(1, count))])
    tree = planning.Tree(period)
    for i, (node, parent) in enumerate(zip(nodes, parents.tolist(), strict=True)):
        assert tree.add(node, parent) == i
    return tree, nodes, parents, rng.random((40, len(period))) * ranges


def squares(nodes, q, period):
    """Squared distances, of coordinates in single precision as the tree has them."""
    apart = np.abs(nodes.astype(np.float32) - q.astype(np.float32))
    with np.errstate(invalid="ignore"):
        apart = np.where(np.isinf(period), apart, np.minimum(apart, period.astype(np.float32) - apart))
    return (apart.astype(np.float64) ** 2).sum(axis=1)


@pytest.mark.parametrize("period", PERIODS, ids=["straight", "wrapping"])
@pytest.mark.parametrize("count", [1, 15, 16, 17, 1039, 1041, 5000])
def test_the_nearest_node_is_found_in_trees_of_every_size(period, count):
    tree, nodes, parents, queries = grown(period, count)
    kept, of = tree.nodes
    np.testing.assert_array_equal(kept, nodes)
    np.testing.assert_array_equal(of, parents)
    for q in queries:
        squared = squares(nodes, q, period)
        assert squared[tree.nearest(q)] <= squared.min() * (1.0 + 1e-6)


def test_of_equals_the_first_is_nearest():
    tree = planning.Tree(PERIODS[0])
    for i in range(40):
        tree.add(np.array([1.0, 2.0, float(i % 4)]), i - 1)
    for i in range(4):
        assert tree.nearest(np.array([1.0, 2.5, float(i)])) == i


@pytest.mark.parametrize("removed", [1, 7, 39])
def test_a_branch_goes_with_all_that_descends_from_it(removed):
    period = PERIODS[1]
    tree, nodes, parents, queries = grown(period, 40)
    gone = {i for i in range(40) if removed in (i, *up(parents, i))}
    rest = [i for i in range(40) if i not in gone]
    tree.remove_branch(removed)
    kept, of = tree.nodes
    np.testing.assert_array_equal(kept, nodes[rest])
    np.testing.assert_array_equal(of, [rest.index(parents[i]) if parents[i] >= 0 else -1 for i in rest])
    for q in queries:
        squared = squares(nodes[rest], q, period)
        assert squared[tree.nearest(q)] <= squared.min() * (1.0 + 1e-6)


def up(parents, node):
    """All ancestors of a node."""
    while parents[node] >= 0:
        node = int(parents[node])
        yield node


def test_nodes_that_are_not_there_are_refused():
    tree = planning.Tree(PERIODS[0])
    with pytest.raises(InvalidValue, match="empty"):
        tree.nearest(np.zeros(3))
    with pytest.raises(InvalidValue, match="no such node"):
        tree.add(np.zeros(3), 0)
    with pytest.raises(InvalidValue, match=r"q must have shape \(3,\), got \(4,\)"):
        tree.add(np.zeros(4), -1)
    tree.add(np.zeros(3), -1)
    with pytest.raises(InvalidValue, match="no such node"):
        tree.remove_branch(1)
