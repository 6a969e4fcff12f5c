"""The growing lattice beside its formula, digit by digit, and beside other sequences."""

import numpy as np
import pytest
from scipy.special import logsumexp

from evenroad.errors import InvalidValue
from evenroad.points import draw
from evenroad.points.measures import riesz_rooted, separation
from evenroad.points.samplers import Growing
from evenroad.points.samplers.growing import _log_sums, growing_vector
from tests.points.samplers.sampler_contract import SamplerContract
from tests.refused import refused


def slow_inverse(i):
    """Return van der Corput's radical inverse in base 2 from the digits as text."""
    return sum(int(digit) * 2.0 ** -(place + 1) for place, digit in enumerate(reversed(f"{i:b}")))


class TestGrowing(SamplerContract):
    sampler = Growing()
    shapes = ((1, 1), (7, 1), (64, 2), (100, 3), (33, 10))

    @pytest.mark.parametrize(("n", "d"), [(50, 1), (77, 2), (130, 5)])
    def test_its_points_are_multiples_of_one_vector_in_the_order_of_van_der_corput(self, n, d):
        points, vector = self.sampler.draw(n, d, rng=4).points, growing_vector(d)
        lattice = np.array([[slow_inverse(i) * int(z) % 1.0 for z in vector] for i in range(n)])
        # Whatever the order of the axes and the shift.
        steps = np.sort((points[1:] - points[0]) % 1.0, axis=1)
        np.testing.assert_allclose(steps, np.sort(lattice[1:] % 1.0, axis=1), atol=1e-12)

    @pytest.mark.parametrize("m", [1, 4, 7])
    def test_the_first_powers_of_two_are_a_lattice_and_each_axis_takes_equally_spaced_values(self, m):
        points = self.sampler.draw(2**m, 3, rng=2).points
        np.testing.assert_allclose(np.diff(np.sort(points, axis=0), axis=0), 2.0**-m, rtol=1e-9)
        differences = (points[:, None] - points[None]).reshape(-1, 3) % 1.0
        found = {tuple(row) for row in (np.rint(differences * 2**m).astype(int) % 2**m).tolist()}
        assert len(found) == 2**m

    @pytest.mark.parametrize("d", [2, 5, 10])
    def test_sets_of_one_seed_begin_with_the_smaller_ones_and_go_on_from_any_index(self, d):
        longest = self.sampler.draw(70_000, d, rng=3).points
        for n in (1, 63, 64, 2048, 2049, 5000):
            np.testing.assert_array_equal(self.sampler.draw(n, d, rng=3).points, longest[:n])
        np.testing.assert_array_equal(Growing(start=60_001).draw(99, d, rng=3).points, longest[60_001:60_100])

    def test_it_has_no_two_equal_points_far_out_and_says_where_it_ends(self):
        far = Growing(start=2**30 - 4000).draw(4000, 2).points
        assert len(np.unique(far, axis=0)) == 4000
        refused(InvalidValue, f"ends at index {2**30}, asked for {2**30 + 1}", lambda: Growing(start=2**30).draw(1, 2))

    @pytest.mark.parametrize("start", [-1, 0.5, "3"])
    def test_a_start_that_is_no_index_is_refused(self, start):
        refused(InvalidValue, "start", Growing, start=start)


@pytest.mark.parametrize("d", [2, 3, 5, 7])
@pytest.mark.parametrize("n", [64, 100, 181, 256, 3000])
def test_every_beginning_is_spread_far_better_than_sobols(n, d):
    if n == 3000:
        # Beyond what was searched together.
        mine, others = (separation(draw(name, n, d, rng=1), periodic=True) for name in ("growing", "sobol"))
        assert mine > 1.5 * others
        return
    sobol = np.mean([riesz_rooted(draw("sobol", n, d, rng=seed)) for seed in range(4)])
    assert riesz_rooted(draw("growing", n, d, rng=1)) < 0.87 * sobol


def test_fewer_digits_of_the_vector_are_those_of_more():
    whole = growing_vector(5)
    assert whole[0] == 1
    for digits in (13, 16):
        np.testing.assert_array_equal(growing_vector(5, digits) % 2**digits, whole % 2**digits)


def test_sums_of_very_many_dimensions_are_those_of_their_logs():
    rng = np.random.default_rng(0)
    ratios, often = rng.uniform(0.3, 0.9, (5, 7)), rng.integers(0, 3, (2, 7)).astype(float)
    for d in (3, 1024):
        expected = [[logsumexp(d * np.log(row), b=times) for times in often] for row in ratios]
        np.testing.assert_allclose(_log_sums(ratios, d, often), expected, rtol=1e-12)
    refused(InvalidValue, "d must be at most 1024", draw, "growing", 8, 1025)
