"""What every sampler owes its users: a subclass sets `sampler`, and the counts it can draw."""

import dataclasses

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.points import PointSet, Sampler
from tests.refused import refused


class SamplerContract:
    """Subclass it as ``class TestMine(SamplerContract): sampler = Mine()``."""

    sampler: Sampler
    shapes = ((1, 1), (7, 1), (64, 2), (100, 3))
    draws_depend_on_rng = True

    def test_points_have_the_shape_that_was_asked_for_and_lie_in_the_half_open_cube(self):
        for n, d in self.shapes:
            points = self.sampler.draw(n, d, rng=5).points
            assert points.shape == (n, d)
            assert ((points >= 0) & (points < 1)).all()

    def test_the_same_seed_gives_the_same_bits_and_the_default_is_zero(self):
        for n, d in self.shapes:
            first, second = self.sampler.draw(n, d), self.sampler.draw(n, d, rng=0)
            assert first.hash == second.hash
            assert first == second

    def test_another_seed_gives_other_points_exactly_when_the_sampler_is_random(self):
        n, d = self.shapes[-1]
        drawn = {self.sampler.draw(n, d, rng=seed).hash for seed in range(20)}
        assert (len(drawn) > 1) == self.draws_depend_on_rng

    def test_a_passed_generator_is_spawned_and_not_consumed(self):
        n, d = self.shapes[-1]
        given, untouched = np.random.default_rng(4), np.random.default_rng(4)
        first = self.sampler.draw(n, d, rng=given)
        assert given.random() == untouched.random()
        assert first.hash == self.sampler.draw(n, d, rng=np.random.default_rng(4)).hash

    def test_the_global_generator_is_left_alone(self):
        n, d = self.shapes[-1]
        state = np.random.get_state()[1].copy()  # noqa: NPY002
        self.sampler.draw(n, d)
        assert (np.random.get_state()[1] == state).all()  # noqa: NPY002

    def test_the_set_says_where_it_came_from(self):
        n, d = self.shapes[-1]
        points = self.sampler.draw(n, d, rng=9)
        assert isinstance(points, PointSet)
        assert points.origin.family == self.sampler.name
        assert points.origin.seed == (9 if self.draws_depend_on_rng else None)

    @pytest.mark.parametrize("bad", [0, -1, 2.5, True, "8", None])
    def test_a_count_that_is_no_positive_integer_is_refused_by_name(self, bad):
        n, d = self.shapes[-1]
        refused(InvalidValue, "n must be an integer >= 1", self.sampler.draw, bad, d)
        refused(InvalidValue, "d must be an integer >= 1", self.sampler.draw, n, bad)

    def test_the_sampler_is_a_frozen_value(self):
        assert dataclasses.is_dataclass(self.sampler)
        with pytest.raises(dataclasses.FrozenInstanceError):
            self.sampler.anything = 1
