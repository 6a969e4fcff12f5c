"""Tests of evenroad.points.samplers.even."""

import tracemalloc

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from evenroad.points import PointSet, draw
from evenroad.points.measures.rank_one import generating_vector
from evenroad.points.pointset import below_one
from evenroad.points.samplers.even import Even, contracted
from evenroad.points.samplers.lattice import Lattice
from evenroad.points.samplers.rank_one import rank_one_vector
from evenroad.roadmap.rules import KNearest, default_rule
from evenroad.space import BoxSpace
from tests.points.samplers.sampler_contract import SamplerContract


class TestEven(SamplerContract):
    sampler = Even()
    shapes = ((5, 1), (3, 2), (5, 3), (6, 4), (1, 6), (20, 7), (60, 9), (100, 10), (7, 30))

    def test_in_one_two_and_from_five_dimensions_on_it_is_a_rank_1_lattice(self):
        for n, d in ((5, 1), (30, 2), (40, 5), (60, 9), (100, 12), (2**20 + 1, 3)):
            points = self.sampler.draw(n, d, rng=3)
            assert np.array_equal(below_one(points.points), draw("even", n, d, rng=3).points)
            assert points.origin.method.startswith("rank-1 lattice z=")
            assert d > 4 or generating_vector(points) is not None

    @pytest.mark.parametrize("d", [3, 4])
    def test_in_three_and_four_dimensions_it_is_the_lattice_of_all_directions_under_its_own_name(self, d):
        points = self.sampler.draw(50, d, rng=3)
        assert points == Lattice().draw(50, d, rng=3).with_origin(family="even")

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


class TestDrawnIn:
    @pytest.mark.parametrize("share", [1.0, 0.85, 0.5])
    def test_all_distances_shrink_by_the_share_and_the_middle_stays(self, share):
        points = draw("even", 20, 3, rng=1)
        near = contracted(points, share)
        for first, second in (
            (points.points - 0.5, near.points - 0.5),
            (np.diff(points, axis=0), np.diff(near, axis=0)),
        ):
            np.testing.assert_allclose(
                np.linalg.norm(second, axis=1), share * np.linalg.norm(first, axis=1), rtol=1e-12
            )

    def test_the_set_says_so(self):
        origin = contracted(draw("even", 8, 12, rng=1)).origin
        assert origin.family == "even"
        assert origin.method.endswith("axes permuted, shifted, drawn in to 0.9")

    def test_corners_stay_in_the_cube(self):
        corner = PointSet(np.full((1, 5), np.nextafter(1.0, 0.0)))
        assert contracted(corner, 1.0).points.max() < 1.0


@pytest.mark.parametrize("d", range(2, 11))
def test_without_obstacles_neighbours_lead_everywhere_and_in_all_directions(d):
    default = default_rule(BoxSpace([0.0] * d, [1.0] * d)).k
    # From five dimensions on no lattice has its four or six nearest points on all sides: see which-points.md.
    rules = {4, 6, default} if d <= 4 else {default}
    for n in (128, 256, 777):
        points = draw("even", n, d, rng=n).points
        for k in rules:
            first, last = KNearest(k).edges(points).T
            pieces, _ = connected_components(coo_array((np.ones(len(first)), (first, last)), shape=(n, n)))
            assert pieces == 1, (n, k)
            edges = points[last] - points[first]
            edges /= np.linalg.norm(edges, axis=1, keepdims=True)
            # Directions that are all alike have a least eigenvalue of 1, those in a plane of 0.
            assert d * np.linalg.eigvalsh(edges.T @ edges / len(edges))[0] > (0.5 if d <= 4 else 0.15), (n, k)
