"""Short vectors, minima and neighbours of rank-1 lattices, against brute force on copies of the points."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import InvalidValue, NotAvailable
from evenroad.points import draw
from evenroad.points.measures import separation
from evenroad.points.measures.rank_one import (
    generating_vector,
    least_neighbours,
    neighbour_directions,
    successive_minima,
)
from evenroad.points.measures.short_vectors import lattice_basis, short_vectors
from evenroad.points.samplers.korobov import korobov_generator
from tests.refused import refused


def korobov_vector(n, d):
    return [pow(korobov_generator(n, d), i, n) for i in range(d)]


def all_vectors(n, z, copies=2):
    """Return every vector of the lattice with coordinates of at most `copies` - 1/2 cubes, in units of 1/n."""
    points = np.arange(n)[:, np.newaxis] * np.array(z) % n
    points = (points + n // 2) % n - n // 2
    shifts = n * np.array(list(itertools.product(range(-copies, copies + 1), repeat=len(z))))
    vectors = (points[:, np.newaxis] + shifts).reshape(-1, len(z))
    return vectors[(vectors != 0).any(axis=1)]


def slow_minima(n, z, scale):
    vectors = all_vectors(n, z) * np.array(scale)
    vectors = vectors[np.argsort((vectors**2).sum(axis=1), kind="stable")]
    found = []
    for vector in vectors:
        if len(found) < len(z) and np.linalg.matrix_rank([*found, vector]) > len(found):
            found.append(vector)
    return np.linalg.norm(found, axis=1) / n


CASES = [(21, (1, 13)), (34, (1, 21)), (64, (1, 19, 41)), (30, (7, 1, 11)), (45, (1, 2, 4, 8)), (12, (3, 5, 6))]


@pytest.mark.parametrize(("n", "z"), CASES)
@pytest.mark.parametrize("stretched", [False, True])
def test_the_successive_minima_are_those_of_a_search_among_copies(n, z, stretched):
    scale = [1.0, 0.7, 1.3, 0.9][: len(z)] if stretched else [1.0] * len(z)
    np.testing.assert_allclose(
        successive_minima(n, z, scale if stretched else None), slow_minima(n, z, scale), rtol=1e-12
    )


@pytest.mark.parametrize(("n", "z"), CASES)
def test_short_vectors_are_all_up_to_the_last_one_of_each_pair(n, z):
    vectors, rank = short_vectors(n, z, pairs=9)
    squared = (vectors**2).sum(axis=1)
    assert len(vectors) >= 9
    assert (np.diff(squared) >= 0).all()
    assert (np.diff(rank) == (np.diff(squared) > 0)).all()
    among = {tuple(each) for each in all_vectors(n, z, copies=3) if (each**2).sum() <= squared[-1]}
    ours = {tuple(each) for each in vectors.tolist()}
    assert len(ours) == len(vectors)
    assert not ours & {tuple(-x for x in each) for each in ours}
    assert ours | {tuple(-x for x in each) for each in ours} == among


@settings(max_examples=60)
@given(n=st.integers(1, 5000), d=st.integers(1, 9), data=st.data())
def test_a_reduced_basis_generates_the_lattice_and_nothing_else(n, d, data):
    z = [1, *(data.draw(st.integers(0, n)) for _ in range(d - 1))]
    basis = lattice_basis(n, z)
    assert round(abs(np.linalg.det(basis / n)) * n) == 1
    # Each row is a multiple of z: the one that its first number names.
    assert ((basis - basis[:, :1] * np.array(z)) % n == 0).all()


def test_fibonacci_lattices_have_minima_of_fibonacci_numbers():
    # 610 = 13^2 + 21^2: square cells; 987 = 21 (13 + 34).
    np.testing.assert_allclose(successive_minima(610, (1, 377)), [610**-0.5] * 2)
    np.testing.assert_allclose(successive_minima(987, (1, 610)), np.hypot([21, 13], [21, 34]) / 987)
    assert least_neighbours(610, (1, 377)) == 1
    assert least_neighbours(987, (1, 610)) == 3


def draw_points(n, z):
    return (np.arange(n)[:, np.newaxis] * np.array(z) / n + 0.123) % 1.0


@pytest.mark.parametrize("d", [2, 3, 5, 7, 9])
def test_the_first_minimum_is_the_smallest_distance_on_the_torus(d):
    z = korobov_vector(500, d)
    assert successive_minima(500, z)[0] == pytest.approx(separation(draw_points(500, z), periodic=True))


def test_the_grid_of_one_point_has_minima_of_one():
    np.testing.assert_allclose(successive_minima(1, (0, 0, 0)), 1.0)
    assert neighbour_directions(1, (0, 0), 4).connected


def test_axes_in_another_order_and_mirrored_change_no_figure():
    n, z = 200, np.array(korobov_vector(200, 5))
    turned = (-z[[3, 0, 4, 2, 1]]) % n
    np.testing.assert_allclose(successive_minima(n, turned), successive_minima(n, z))
    assert least_neighbours(n, turned) == least_neighbours(n, z)
    for k in (4, 9, 12):
        ours, theirs = neighbour_directions(n, z, k), neighbour_directions(n, turned, k)
        assert (ours.rank, ours.sheets) == (theirs.rank, theirs.sheets)


def test_a_graph_that_generates_half_the_lattice_has_two_sheets():
    # Of points (0, 0) and (1/2, 1/2) in cells of 1 x 1 x .. in five dimensions the sides are shorter than the middle.
    n, z = 2, (1, 1, 1, 1, 1)
    directions = neighbour_directions(n, z, 10)
    assert (directions.rank, directions.sheets) == (5, 2)
    assert not directions.connected
    assert least_neighbours(n, z) == 11
    assert neighbour_directions(n, z, 11).sheets == 1


@settings(max_examples=40)
@given(n=st.integers(2, 2000), d=st.integers(2, 7), a=st.integers(1, 10**6))
def test_one_neighbour_less_than_the_least_is_not_enough(n, d, a):
    z = [pow(a, i, n) for i in range(d)]
    k = least_neighbours(n, z)
    assert k >= 2 * d - 1 or len(neighbour_directions(n, z, k).vectors) >= d
    assert neighbour_directions(n, z, k).connected
    assert k == 1 or not neighbour_directions(n, z, k - 1).connected


@pytest.mark.parametrize("family", ["korobov", "even"])
@pytest.mark.parametrize(("n", "d"), [(2, 2), (100, 5), (128, 7)])
def test_the_vector_of_a_drawn_lattice_is_found_again(family, n, d):
    points = draw(family, n, d, rng=3)
    z = generating_vector(points)
    steps = (np.arange(n)[:, np.newaxis] * z / n + points.points[0] - points.points + 0.5) % 1.0
    np.testing.assert_allclose(steps, 0.5, atol=1e-12)


@pytest.mark.parametrize("family", ["sobol", "uniform", "lattice", "growing"])
def test_other_points_have_no_generating_vector(family):
    assert generating_vector(draw(family, 65, 3, rng=1)) is None
    assert generating_vector(np.zeros((1, 2))) is None


@pytest.mark.parametrize(("arguments", "said"), [
    ((0, (1, 2)), "n must be"), ((2**26 + 1, (1, 2)), "n must be at most 67108864"),
    ((8, (2, 4)), "without common divisor with n=8"),
    ((8, (1.0, 3.0)), "vector must be 1 .. 16 whole numbers"),
    ((8, [1] * 17), "vector must be 1 .. 16 whole numbers"),
    ((8, (1, 3), (1.0,)), "scale must be 2 finite numbers > 0"),
    ((8, (1, 3), (1.0, 0.0)), "scale must be 2 finite numbers > 0"),
])  # fmt: skip
def test_what_is_no_lattice_is_refused(arguments, said):
    refused(InvalidValue, said, lattice_basis, *arguments)
    refused(InvalidValue, "k must be", neighbour_directions, 8, (1, 3), 0)


def test_lattices_of_all_too_many_short_vectors_are_refused():
    # All points lie on the diagonal.
    refused(NotAvailable, "too many are short", successive_minima, 2**24, (1, 1, 1))
    assert successive_minima(500, (1, 1, 1))[0] == pytest.approx(3**0.5 / 500)
