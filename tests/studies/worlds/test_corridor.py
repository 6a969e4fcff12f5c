"""The hypercube corridor: its definition word by word, free volume, motions, and both orders of OMPL's demo."""

import itertools
import math

import numpy as np
import pytest

from evenroad.errors import InvalidValue, UnknownName
from evenroad.testing import WorldContract
from evenroad_studies.problems import source_named
from evenroad_studies.worlds import Corridor


def is_free(x, lam, side="comment"):
    """The definition, read aloud."""
    d = len(x)
    if side == "demo":
        x = x[::-1]
    return any(all(x[i] <= lam for i in range(k)) and all(x[i] >= 1 - lam for i in range(k + 1, d)) for k in range(d))


def straight_way_is_free(a, b, lam):
    """Exactly: the pieces of the way inside the boxes of each k, as intervals, cover all of it."""
    pieces = []
    for k in range(len(a)):
        first, last = 0.0, 1.0
        for i in range(len(a)):
            if i == k:
                continue
            low, high = (0.0, lam) if i < k else (1 - lam, 1.0)
            if a[i] == b[i]:
                first = first if low <= a[i] <= high else 2.0
                continue
            t, u = (low - a[i]) / (b[i] - a[i]), (high - a[i]) / (b[i] - a[i])
            first, last = max(first, min(t, u)), min(last, max(t, u))
        pieces.append((first, last))
    covered = 0.0
    for first, last in sorted(pieces):
        if first <= covered + 1e-12:
            covered = max(covered, last)
    return covered >= 1.0 - 1e-12


class TestCorridorInThePlane(WorldContract):
    world = Corridor(2, 0.3)
    free_between = False


class TestLegacyCorridor(WorldContract):
    world = Corridor(10, 0.5, checked=6, side="demo")
    free_between = False


@pytest.mark.parametrize("side", ["comment", "demo"])
@pytest.mark.parametrize(("d", "lam"), [(1, 0.2), (2, 0.1), (3, 0.2), (4, 0.7), (6, 0.5)])
def test_a_configuration_is_free_by_the_definition(d, lam, side):
    q = np.random.default_rng(0).random((3000, d))
    free = Corridor(d, lam, side=side).valid(q)
    np.testing.assert_array_equal(free, [is_free(x, lam, side) for x in q])
    assert free.any()


@pytest.mark.parametrize("side", ["comment", "demo"])
def test_only_the_first_coordinates_are_tested_where_so_asked(side):
    q = np.random.default_rng(1).random((3000, 5))
    free = Corridor(5, 0.3, checked=3, side=side).valid(q)
    np.testing.assert_array_equal(free, [is_free(x[:3], 0.3, side) for x in q])


def free_volume(m, lam):
    """Either all m coordinates are at most lam, or one k is the first above it and all others are on their side."""
    return m * (1 - lam) * lam ** (m - 1) + lam**m


@pytest.mark.parametrize(
    ("d", "lam", "checked"), [(2, 0.1, None), (3, 0.2, None), (6, 0.37, None), (4, 0.8, None), (10, 0.37, 6)]
)
def test_the_share_of_free_points_is_the_free_volume(d, lam, checked):
    n, volume = 200_000, free_volume(checked or d, lam)
    share = Corridor(d, lam, checked).valid(np.random.default_rng(3).random((n, d))).mean()
    assert abs(share - volume) < 4 * math.sqrt(volume * (1 - volume) / n)


@pytest.mark.parametrize(("d", "lam", "checked"), list(itertools.product([1, 2, 3, 10], [0.01, 0.37], [None, 1])))
@pytest.mark.parametrize("side", ["comment", "demo"])
def test_the_way_along_the_edges_is_free_from_start_to_goal(d, lam, checked, side):
    world = Corridor(d, lam, checked, side)
    corners = np.tri(d + 1, d, -1)  # 0..0, 10..0, 110..0, .., 1..1
    if side == "comment":
        corners = corners[:, ::-1]
    np.testing.assert_array_equal(corners[[0, -1]], [world.start, world.goal])
    assert world.motion_valid(corners[:-1], corners[1:]).all()


def test_up_to_one_half_the_diagonal_is_blocked_and_from_there_on_free():
    for lam, free in ((0.1, False), (0.49, False), (0.5, True), (0.57, True)):
        world = Corridor(10, lam)
        assert world.motion_valid([world.start], [world.goal]).tolist() == [free]


@pytest.mark.parametrize(("d", "lam"), [(2, 0.2), (3, 0.3), (6, 0.55)])
def test_sampled_motions_agree_with_the_exact_answer_but_for_cut_corners(d, lam):
    world = Corridor(d, lam)
    q = np.random.default_rng(4).random((60_000, d))
    q = q[world.valid(q)][:1500]
    a, b = q, np.roll(q, 1, axis=0)
    sampled = world.motion_valid(a, b)
    exact = np.array([straight_way_is_free(x, y, lam) for x, y in zip(a, b, strict=True)])
    assert not (exact & ~sampled).any()
    assert (sampled & ~exact).mean() < 0.01
    assert 0.1 < exact.mean() < 0.9


def test_a_motion_is_tested_at_the_states_of_the_protocol_and_at_no_others():
    # Ways past the corner (0.1, 0.9), some of which cut it by less than the distance of two states.
    rng = np.random.default_rng(5)
    a = [0.09, 0.88] + [0.01, 0.02] * rng.random((500, 2))
    b = [0.1, 0.9] + [0.02, 0.01] * rng.random((500, 2))
    expected = []
    for first, second in zip(a, b, strict=True):
        n = math.ceil(math.dist(first, second) / (0.001 * math.sqrt(2)))
        expected.append(all(is_free(first + k / n * (second - first), 0.1) for k in range(n + 1)))
    np.testing.assert_array_equal(Corridor(2, 0.1).motion_valid(a, b), expected)
    exact = [straight_way_is_free(*ends, 0.1) for ends in zip(a, b, strict=True)]
    assert 0 < sum(exact) < sum(expected) < 500, "some cuts are seen and some are not"


def test_outside_the_cube_nothing_is_free():
    world = Corridor(2, 0.3)
    outside = np.array([[-1e-12, 0.5], [0.2, 1.0 + 1e-12], [1e200, 0.9], [0.1, -1e200]])
    assert not world.valid(outside).any()
    assert not world.motion_valid(outside, np.zeros((4, 2))).any()
    # A coordinate that the legacy checker does not test must still lie within the bounds.
    assert not Corridor(2, 0.3, checked=1).valid([[0.5, 1.5]])[0]


def test_the_legacy_problem_is_the_one_of_the_paper():
    world = source_named("hypercube-legacy6").make(0).world
    assert world == Corridor(10, 0.37, 6, "demo")
    assert world.resolution == 0.001 * math.sqrt(10)


@pytest.mark.parametrize(("arguments", "error", "text"), [
    ((0, 0.1), InvalidValue, "d must"), ((2.5, 0.1), InvalidValue, "d must"), ((2, 0.0), InvalidValue, "lam"),
    ((2, 1.0), InvalidValue, "lam"), ((2, math.nan), InvalidValue, "lam"), ((2, 0.1, 3), InvalidValue, "checked"),
    ((2, 0.1, 0), InvalidValue, "checked"),
    ((2, 0.1, None, "left"), UnknownName, "'left'; known: comment, demo"),
])  # fmt: skip
def test_parameters_that_make_no_corridor_are_refused(arguments, error, text):
    with pytest.raises(error, match=text):
        Corridor(*arguments)
