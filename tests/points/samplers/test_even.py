"""Tests of evenroad.points.samplers.even."""

import tracemalloc
from itertools import combinations, product
from math import gcd

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from evenroad.points import draw
from evenroad.points.measures.rank_one import generating_vector
from evenroad.points.pointset import below_one
from evenroad.points.samplers.even import Even
from evenroad.points.samplers.lattice import Lattice
from evenroad.points.samplers.rank_one import rank_one_vector
from evenroad.roadmap.rules import KNearest, default_rule
from evenroad.space import BoxSpace
from tests.points.samplers.sampler_contract import SamplerContract


class TestEven(SamplerContract):
    sampler = Even()
    shapes = ((5, 1), (3, 2), (5, 3), (6, 4), (1, 6), (20, 7), (60, 9), (100, 10), (7, 30))

    def test_in_one_two_and_from_four_dimensions_on_it_is_a_rank_1_lattice(self):
        for n, d in ((5, 1), (30, 2), (50, 4), (40, 5), (60, 8), (100, 12), (2**20 + 1, 3)):
            points = self.sampler.draw(n, d, rng=3)
            assert np.array_equal(below_one(points.points), draw("even", n, d, rng=3).points)
            assert points.origin.method.startswith("rank-1 lattice z=")
            assert d > 4 or generating_vector(points) is not None

    def test_in_space_it_is_the_lattice_of_all_directions_under_its_own_name(self):
        assert self.sampler.draw(50, 3, rng=3) == Lattice().draw(50, 3, rng=3).with_origin(family="even")

    def test_no_two_axes_are_on_one_line_and_where_a_lattice_has_too_few_it_is_sobols_set(self):
        lattices = 0
        for n, d in product((5, 9, 16, 24, 30, 31, 42, 60, 97), (4, 7, 10)):
            points = self.sampler.draw(n, d, rng=3)
            units = sum(gcd(i, n) == 1 for i in range(1, n)) // 2
            assert points.origin.method.startswith("rank-1" if units >= d else "scrambled"), (n, d)
            assert units >= d or np.array_equal(points.points, draw("sobol", n, d, rng=3).points)
            for one, other in combinations(points.points.T, 2):
                for sum_or_difference in (one - other, one + other):
                    # On one line of the torus it is the same number for all points.
                    turns = np.exp(2j * np.pi * sum_or_difference)
                    assert abs(turns.mean()) < 1.0 - 1e-9, (n, d)
            lattices += units >= d
        assert 5 < lattices < 22

    @pytest.mark.parametrize("d", [2, 6])
    def test_a_large_set_takes_hardly_more_memory_than_its_points(self, d):
        n = 2**20 + 7
        tracemalloc.start()
        try:
            assert self.sampler.draw(n, d).points.nbytes == 8 * n * d
            assert tracemalloc.get_traced_memory()[1] < 1.25 * 8 * n * d
        finally:
            tracemalloc.stop()

    def test_each_set_has_its_axes_in_another_order(self):
        n, d = 50, 6
        orders = set()
        for seed in range(6):
            points = self.sampler.draw(n, d, rng=seed).points
            step = np.rint(((points[1] - points[0]) % 1.0) * n).astype(int).tolist()
            assert sorted(step) == sorted(rank_one_vector(n, d))
            orders.add(tuple(step))
        assert len(orders) > 1


@pytest.mark.parametrize("d", range(2, 11))
def test_without_obstacles_neighbours_lead_everywhere_and_in_all_directions(d):
    default = default_rule(BoxSpace([0.0] * d, [1.0] * d)).k
    # From four dimensions on no lattice has its four or six nearest points on all sides: see which-points.md.
    rules = {4, 6, default} if d <= 3 else {default}
    for n in (128, 256, 777):
        points = draw("even", n, d, rng=n).points
        for k in rules:
            first, last = KNearest(k).edges(points).T
            pieces, _ = connected_components(coo_array((np.ones(len(first)), (first, last)), shape=(n, n)))
            assert pieces == 1, (n, k)
            edges = points[last] - points[first]
            edges /= np.linalg.norm(edges, axis=1, keepdims=True)
            # Directions that are all alike have a least eigenvalue of 1, those in a plane of 0.
            assert d * np.linalg.eigvalsh(edges.T @ edges / len(edges))[0] > (0.5 if d <= 3 else 0.15), (n, k)
