"""What every World must do: subclass `WorldContract` and give it a `world` fixture."""

from __future__ import annotations

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.world import World


class WorldContract:
    """Batch = loop, symmetry, free motions have free ends, and errors for bad batches.

    The world must have free and blocked places, and free and blocked motions, among 400 random ones.
    """

    @pytest.fixture
    def world(self) -> World:
        raise NotImplementedError

    @pytest.fixture
    def q(self, world):
        """Four hundred configurations, (400, dim)."""
        return world.space.from_cube(np.random.default_rng(11).random((400, world.space.dim)))

    @pytest.fixture
    def motions(self, world, q):
        """The two ends of 400 motions, short ones and long ones."""
        reach = np.random.default_rng(12).random(len(q)) ** 3
        return q, world.space.interpolate(q, np.roll(q, 1, axis=0), reach)

    def test_answers_are_booleans_one_a_row(self, world, q, motions):
        for answer in (world.valid(q), world.motion_valid(*motions)):
            assert answer.shape == (len(q),)
            assert answer.dtype == np.bool_
            assert 0 < answer.sum() < len(q), "the contract needs both verdicts to mean anything"

    def test_a_batch_gives_what_its_rows_give(self, world, q, motions):
        a, b = motions
        rows = range(len(q))
        np.testing.assert_array_equal(world.valid(q), [world.valid(q[i : i + 1])[0] for i in rows])
        np.testing.assert_array_equal(
            world.motion_valid(a, b), [world.motion_valid(a[i : i + 1], b[i : i + 1])[0] for i in rows]
        )

    def test_a_motion_and_its_reverse_get_one_verdict(self, world, motions):
        a, b = motions
        np.testing.assert_array_equal(world.motion_valid(a, b), world.motion_valid(b, a))

    def test_a_free_motion_has_free_ends(self, world, motions):
        a, b = motions
        free = world.motion_valid(a, b)
        assert world.valid(a[free]).all()
        assert world.valid(b[free]).all()

    def test_a_free_motion_is_free_along_its_way(self, world, motions):
        a, b = motions
        free = world.motion_valid(a, b)
        for t in np.linspace(0.0, 1.0, 21):
            assert world.valid(world.space.interpolate(a[free], b[free], t)).all()

    def test_a_motion_of_no_length_is_free_where_its_place_is(self, world, q):
        np.testing.assert_array_equal(world.motion_valid(q, q), world.valid(q))

    def test_an_empty_batch_gives_an_empty_answer(self, world):
        empty = np.empty((0, world.space.dim))
        assert world.valid(empty).shape == (0,)
        assert world.motion_valid(empty, empty).shape == (0,)

    def test_arguments_are_left_alone_and_may_be_read_only_or_strided(self, world, motions):
        a, b = motions
        expected = world.motion_valid(a, b)
        a_before, b_before = a.copy(), b.copy()
        a.setflags(write=False)
        b.setflags(write=False)
        np.testing.assert_array_equal(world.motion_valid(a, b), expected)
        np.testing.assert_array_equal(world.motion_valid(np.asfortranarray(a), b), expected)
        np.testing.assert_array_equal(world.motion_valid(a[::2], b[::2]), expected[::2])
        np.testing.assert_array_equal(world.valid(np.repeat(a, 2, axis=0)[::2]), world.valid(a))
        np.testing.assert_array_equal(a, a_before)
        np.testing.assert_array_equal(b, b_before)

    def test_a_wrong_shape_is_refused(self, world, q):
        for wrong in (q[0], q[:, :-1], np.hstack([q, q]), q[None]):
            with pytest.raises(InvalidValue, match="shape"):
                world.valid(wrong)
            with pytest.raises(InvalidValue, match="shape"):
                world.motion_valid(q, wrong)
        with pytest.raises(InvalidValue, match="length"):
            world.motion_valid(q[:3], q[:4])

    @pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
    def test_an_entry_that_is_not_finite_is_refused_and_named(self, world, q, bad):
        wrong = q.copy()
        wrong[5, 0] = bad
        with pytest.raises(InvalidValue, match=r"\[5, 0\]"):
            world.valid(wrong)
        with pytest.raises(InvalidValue, match=r"b must be finite"):
            world.motion_valid(q, wrong)
