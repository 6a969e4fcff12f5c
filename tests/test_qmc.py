"""The engines: what users of scipy.stats.qmc expect of one, and that a set has an end."""

import numpy as np
import pytest
from scipy.integrate import qmc_quad
from scipy.stats import qmc as scipy_qmc

from evenroad import qmc
from evenroad.errors import Exhausted, InvalidValue, NotAvailable, UnknownName
from evenroad.points import draw
from evenroad.points.measures import MEASURES, riesz_rooted, separation
from tests.refused import refused

SEED = 170382760648021597650530316304495310428


SEEDS = {
    "int": lambda: 5,
    "generator": lambda: np.random.default_rng(5),
    "seed sequence": lambda: np.random.SeedSequence(5),
    "random state": lambda: np.random.RandomState(5),
    "entropy": lambda: None,
}


class EngineContract:
    """What every engine owes: subclass it as ``class TestMine(SetContract): engine_class = Mine``."""

    engine_class: type[qmc.FamilyEngine | qmc.SequenceEngine]
    n = 64
    d = 2

    def engine(self, **options):
        return self.engine_class(**{"d": self.d, "rng": SEED, **options})

    def test_it_is_an_engine_of_scipy_whose_points_lie_in_the_cube(self):
        engine = self.engine()
        assert isinstance(engine, scipy_qmc.QMCEngine)
        assert (engine.d, engine.num_generated) == (self.d, 0)
        sample = engine.random(self.n)
        assert sample.shape == (self.n, self.d)
        assert sample.dtype == np.float64
        assert ((sample >= 0) & (sample < 1)).all()

    def test_no_points_and_one_point_have_two_axes(self):
        engine = self.engine()
        assert engine.random(0).shape == (0, self.d)
        assert engine.num_generated == 0
        assert engine.random().shape == (1, self.d)
        assert engine.num_generated == 1

    def test_parts_are_the_whole_and_what_was_handed_out_can_be_changed(self):
        whole, engine, parts = self.engine().random(self.n), self.engine(), []
        for n in (0, 1, self.n // 2, np.int64(self.n - self.n // 2 - 1)):
            part = engine.random(n)
            parts.append(part.copy())
            part[:] = 0.5
        np.testing.assert_array_equal(np.concatenate(parts), whole)
        assert engine.num_generated == self.n
        np.testing.assert_array_equal(engine.reset().random(self.n), whole)

    @pytest.mark.parametrize("seed", SEEDS)
    def test_reset_goes_back_to_the_first_point_and_fast_forward_skips(self, seed):
        engine = self.engine(rng=SEEDS[seed]())
        first = engine.random(40)
        assert engine.reset() is engine
        assert engine.num_generated == 0
        assert engine.fast_forward(13) is engine
        assert engine.num_generated == 13
        np.testing.assert_array_equal(engine.random(27), first[13:])

    def test_a_passed_generator_is_spawned_so_that_engines_differ_and_the_stream_stays(self):
        given, untouched = np.random.default_rng(6), np.random.default_rng(6)
        first = [self.engine(rng=given).random(9).tobytes() for _ in range(6)]
        assert len(set(first)) > 3
        assert given.random() == untouched.random()
        assert self.engine(rng=np.random.default_rng(6)).random(9).tobytes() == first[0]

    def test_the_old_name_of_the_seed_works_but_not_beside_the_new_one(self):
        np.testing.assert_array_equal(self.engine(rng=None, seed=3).random(9), self.engine(rng=3).random(9))
        refused(InvalidValue, "not both", self.engine, rng=3, seed=3)

    @pytest.mark.parametrize("bad", [0, -1, 1.5, "2", None, True])
    def test_a_dimension_that_is_no_positive_integer_is_refused(self, bad):
        refused(InvalidValue, "d must be an integer >= 1", self.engine, d=bad)

    @pytest.mark.parametrize("bad", [-1, 1.5, "2", None])
    def test_a_number_of_points_that_is_no_count_is_refused(self, bad):
        engine = self.engine()
        for ask in (engine.random, engine.fast_forward):
            refused(InvalidValue, "n must be an integer >= 0", ask, bad)
        assert engine.num_generated == 0

    @pytest.mark.parametrize("bad", [-1, "7", 0.5, True])
    def test_a_seed_of_another_kind_is_refused(self, bad):
        refused(InvalidValue, "rng must be", self.engine, rng=bad)

    def test_scipys_own_tools_take_it(self):
        quadrature = qmc_quad(
            lambda x: np.prod(x, axis=0), [0] * self.d, [1] * self.d, n_points=self.n, qrng=self.engine()
        )
        assert quadrature.integral == pytest.approx(0.5**self.d, rel=0.15)
        normal = scipy_qmc.MultivariateNormalQMC(np.zeros(self.d), engine=self.engine())
        assert normal.random(self.n).shape == (self.n, self.d)
        assert self.engine(optimization="random-cd").random(16).shape == (16, self.d)


class SetContract(EngineContract):
    """What an engine owes whose points are a set of n: n and d are ones that it has."""

    def engine(self, **options):
        return super().engine(**{"n": self.n, **options})

    def test_all_points_are_the_set(self):
        engine = self.engine()
        assert engine.n == self.n
        np.testing.assert_array_equal(engine.random(self.n), engine.points.points)
        assert engine.points.origin.family == self.engine_class.family

    def test_asking_for_more_than_is_left_raises_and_hands_out_nothing(self):
        engine = self.engine()
        engine.random(self.n - 3)
        for ask in (engine.random, engine.fast_forward, lambda n: engine.integers(10, n=n)):
            refused(Exhausted, f"asked for 4 more points, but 3 of the {self.n} are left", ask, 4)
        assert engine.num_generated == self.n - 3
        np.testing.assert_array_equal(engine.random(3), engine.points.points[-3:])
        assert engine.random(0).shape == (0, self.d)
        refused(Exhausted, "", engine.random)

    def test_the_same_seed_gives_the_same_bits_and_others_differ_as_those_without_do(self):
        for seed in (SEED, 0):
            assert self.engine(rng=seed).points == self.engine(rng=seed).points
        assert len({self.engine(rng=seed).points.hash for seed in range(8)}) > 4
        assert len({self.engine(rng=None).points.hash for _ in range(8)}) > 1

    def test_integers_are_the_points_scaled_and_rounded_down(self):
        points = self.engine().random(self.n)
        engine = self.engine()
        integers = engine.integers([-3] * self.d, u_bounds=[4] * self.d, n=self.n, endpoint=True)
        assert integers.dtype == np.int64
        np.testing.assert_array_equal(integers, np.floor(points * 8 - 3))
        assert engine.num_generated == self.n

    def test_options_that_there_are_not_are_refused(self):
        for bad in (0, -1, 1.5, "2", None, True):
            refused(InvalidValue, "n must be an integer >= 1", self.engine, n=bad)
        refused(UnknownName, "scramble", self.engine, scramble=True)
        refused(ValueError, "'toto' is not a valid optimization method", self.engine, optimization="toto")

    def test_scipys_optimization_is_applied_to_what_is_handed_out(self):
        plain, optimised = self.engine(), self.engine(optimization="random-cd")
        sample = optimised.random(self.n)
        assert scipy_qmc.discrepancy(sample) <= scipy_qmc.discrepancy(plain.random(self.n))
        np.testing.assert_array_equal(np.sort(sample, axis=0), np.sort(plain.points.points, axis=0))


class TestGrowing(EngineContract):
    engine_class = qmc.Growing
    d = 5

    def test_its_points_are_those_of_the_sampler_and_its_end_is_said(self):
        engine = self.engine()
        np.testing.assert_array_equal(engine.random(601), draw("growing", 601, self.d, rng=SEED).points)
        engine.fast_forward(2**30 - 603)
        for ask in (engine.random, engine.fast_forward):
            refused(Exhausted, "asked for 3 more points, but the sequence ends 2 points on", ask, 3)
        assert engine.num_generated == 2**30 - 2


class TestHickernell(SetContract):
    engine_class = qmc.Hickernell

    def test_its_sets_have_the_discrepancy_of_the_bank(self):
        for seed in range(4):
            assert MEASURES["hickernell"].rooted(self.engine(rng=seed).points) < 0.0115

    def test_a_size_that_takes_long_is_refused_and_those_that_ship_are_named(self):
        refused(NotAvailable, "n=9000 in d=2; it has n = .*64", self.engine, n=9000)


class TestKorobov(SetContract):
    engine_class = qmc.Korobov
    n, d = 97, 5

    def test_all_seeds_are_equally_good(self):
        energies = [riesz_rooted(self.engine(rng=seed).points) for seed in range(5)]
        np.testing.assert_allclose(energies, energies[0], rtol=1e-11)


class TestLattice(SetContract):
    engine_class = qmc.Lattice

    def test_seeds_keep_points_apart(self):
        for seed in range(4):
            # A_2* of unit density has its shortest vector at 1.07, in a cube of about 64.
            assert separation(self.engine(rng=seed).points) > 0.9 / 8


class TestEven(SetContract):
    engine_class = qmc.Even
    n, d = 128, 6

    def test_it_is_the_default_family_whatever_the_dimension(self):
        assert self.engine(d=9, n=50).points.origin.family == "even"


def test_every_name_of_scipys_module_is_there():
    assert [name for name in scipy_qmc.__all__ if not hasattr(qmc, name)] == []


@pytest.mark.parametrize("engine", [qmc.Even, qmc.Korobov])
def test_points_are_below_one_in_single_precision_too(engine):
    # Of a lattice without a shift coordinates are 0: reflected, they were the largest float64 below 1.
    class Unshifted(engine):
        family = "sukharev"

    highest = [Unshifted(2, n=16, rng=seed).random(16).astype(np.float32).max() for seed in range(8)]
    assert max(highest) < 1.0
