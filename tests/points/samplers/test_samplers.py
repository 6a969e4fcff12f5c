import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from evenroad.errors import EvenroadError, InvalidValue, NotAvailable, UnknownName
from evenroad.points import SAMPLERS, draw, make_sampler
from evenroad.points.samplers import Halton, Lattice, Sobol, Sukharev, Uniform
from tests.points.samplers.sampler_contract import SamplerContract
from tests.refused import refused


class TestUniform(SamplerContract):
    sampler = Uniform()

    def test_a_missing_seed_is_refused_because_it_would_be_hidden_entropy(self):
        refused(InvalidValue, "rng must be", self.sampler.draw, 4, 2, rng=None)


class TestScrambledHalton(SamplerContract):
    sampler = Halton()


class TestPlainHalton(SamplerContract):
    sampler = Halton(scramble=False)
    draws_depend_on_rng = False

    def test_it_is_the_radical_inverse_of_the_index(self):
        def radical_inverse(index, base):
            value, scale = 0.0, 1.0
            while index:
                scale /= base
                value += scale * (index % base)
                index //= base
            return value

        points = Halton(scramble=False, start=17).draw(30, 3).points
        expected = [[radical_inverse(17 + i, base) for base in (2, 3, 5)] for i in range(30)]
        np.testing.assert_allclose(points, expected, atol=1e-14)


class TestScrambledSobol(SamplerContract):
    sampler = Sobol()


class TestPlainSobol(SamplerContract):
    sampler = Sobol(scramble=False)
    draws_depend_on_rng = False

    def test_each_half_of_the_first_axis_gets_half_of_a_power_of_two(self):
        points = self.sampler.draw(64, 2).points
        assert np.count_nonzero(points[:, 0] < 0.5) == 32

    def test_the_end_of_the_sequence_is_an_error_and_not_a_wrap(self):
        refused(InvalidValue, "ends at index 1073741824", lambda: Sobol(start=2**30 - 1).draw(2, 2))


@pytest.mark.parametrize("sampler", [Halton, Sobol])
@pytest.mark.parametrize("scramble", [False, True])
def test_starting_later_gives_the_rest_of_the_same_sequence(sampler, scramble):
    whole = sampler(scramble=scramble).draw(50, 3, rng=2).points
    rest = sampler(scramble=scramble, start=13).draw(37, 3, rng=2)
    np.testing.assert_array_equal(rest.points, whole[13:])
    assert rest.origin.start == 13


class TestSukharev(SamplerContract):
    sampler = Sukharev()
    shapes = ((1, 1), (7, 1), (64, 2), (27, 3))
    draws_depend_on_rng = False

    def test_points_are_the_centres_of_equal_cells_of_any_cube(self):
        expected = [[0.25, 0.25], [0.25, 0.75], [0.75, 0.25], [0.75, 0.75]]
        np.testing.assert_array_equal(self.sampler.draw(4, 2).points, expected)
        assert (self.sampler.draw(1, 100).points == 0.5).all()

    def test_another_count_is_refused_and_the_two_nearest_are_named(self):
        refused(NotAvailable, r"n=100 .* 64 and 125", self.sampler.draw, 100, 3)

    @given(k=st.integers(1, 40), d=st.integers(1, 4), less=st.booleans())
    def test_the_largest_grid_is_found_exactly_whatever_floats_say(self, k, d, less):
        n = k**d - (1 if less and k > 1 else 0)
        side = k - 1 if n < k**d else k
        if side**d <= 20_000:
            assert Sukharev(allow_fewer=True).draw(n, d).n == side**d


class TestLattice(SamplerContract):
    sampler = Lattice()

    @pytest.mark.parametrize(("n", "d"), [(50, 1), (200, 2), (200, 3), (300, 5)])
    def test_no_two_points_are_nearer_than_the_shortest_vector_of_the_lattice(self, n, d):
        points = self.sampler.draw(n, d, rng=1).points
        # A_d* of unit density has shortest vectors of squared length d / (d + 1) (d + 1)^(1/d).
        shortest = np.sqrt(d / (d + 1) * (d + 1) ** (1 / d))
        # The cube holds n points, so its volume in lattice units is near n; the boundary lets it vary.
        assert pdist(points).min() == pytest.approx(shortest / n ** (1 / d), rel=0.25)

    @pytest.mark.parametrize("d", [2, 3, 4])
    def test_differences_of_neighbours_are_integer_combinations_of_one_basis(self, d):
        points = self.sampler.draw(300, d, rng=3).points
        centre = points[np.argmin(((points - 0.5) ** 2).sum(axis=1))]
        differences = points - centre
        order = np.argsort((differences**2).sum(axis=1))
        basis = []
        for i in order[1:]:
            if np.linalg.matrix_rank(np.array([*basis, differences[i]]), tol=1e-9) > len(basis):
                basis.append(differences[i])
            if len(basis) == d:
                break
        coefficients = differences @ np.linalg.inv(np.array(basis))
        np.testing.assert_allclose(coefficients, np.round(coefficients), atol=1e-8)

    def test_high_dimensions_are_refused(self):
        refused(InvalidValue, "at most 12", self.sampler.draw, 10, 13)


def test_an_unknown_sampler_and_an_option_that_it_does_not_have_are_refused_with_the_list():
    refused(UnknownName, "unknown sampler 'sobel'; did you mean 'sobol'", draw, "sobel", 8, 2)
    refused(UnknownName, "unknown sampler 'best'; known: .*halton.*sobol", draw, "best", 8, 2)
    refused(UnknownName, "option of sampler 'uniform'", make_sampler, "uniform", scramble=True)


@pytest.mark.parametrize("start", [-1, 1.5])
def test_a_start_index_below_zero_is_refused(start):
    refused(InvalidValue, "start", Halton, start=start)


def test_every_name_makes_a_sampler_of_that_name_and_errors_are_ours_and_builtins():
    refused(EvenroadError, "", draw, "uniform", 0, 2)
    refused(ValueError, "", draw, "uniform", 0, 2)
    for name in SAMPLERS:
        assert make_sampler(name).name == name


@pytest.mark.parametrize("name", SAMPLERS)
def test_a_sampler_of_any_n_has_sets_of_all_and_the_others_have_not(name, monkeypatch):
    # The network of the studies trains for seconds else, whatever n is.
    monkeypatch.setattr("evenroad_studies.network.on_demand.STEPS", 300)
    sampler = make_sampler(name)
    refused = []
    for n, d in ((1, 1), (2, 3), (63, 2), (50, 6)):
        try:
            assert sampler.draw(n, d).n == n
        except NotAvailable:
            refused.append(n)
    assert bool(refused) != sampler.any_n
    assert sampler.about
