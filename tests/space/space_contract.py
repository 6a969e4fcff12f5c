"""What every Space must do: subclass `SpaceContract` and give it a `space` fixture."""

from __future__ import annotations

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.space import Space


class SpaceContract:
    """Metric axioms, end points, batch = loop, and errors for bad batches."""

    @pytest.fixture
    def space(self) -> Space:
        raise NotImplementedError

    @pytest.fixture
    def q(self, space):
        """Sixty configurations, (60, dim), as three groups of twenty for the axioms."""
        return space.from_cube(np.random.default_rng(7).random((60, space.dim)))

    def test_from_cube_gives_one_finite_configuration_a_point(self, space, q):
        assert q.shape == (60, space.dim)
        assert np.isfinite(q).all()

    def test_from_cube_of_a_batch_is_that_of_its_rows(self, space):
        u = np.random.default_rng(1).random((23, space.dim))
        np.testing.assert_array_equal(
            space.from_cube(u), np.concatenate([space.from_cube(row[None]) for row in u])
        )

    def test_distance_is_zero_to_itself_and_positive_to_others(self, space, q):
        np.testing.assert_allclose(space.distance(q, q), 0.0, atol=1e-7)
        assert (space.distance(q, np.roll(q, 1, axis=0)) > 0.0).all()

    def test_distance_is_symmetric(self, space, q):
        np.testing.assert_array_equal(space.distance(q[:30], q[30:]), space.distance(q[30:], q[:30]))

    def test_distance_satisfies_the_triangle_inequality(self, space, q):
        a, b, c = q[:20], q[20:40], q[40:]
        assert (space.distance(a, c) <= space.distance(a, b) + space.distance(b, c) + 1e-9).all()

    def test_interpolation_starts_and_ends_at_its_ends(self, space, q):
        a, b = q[:30], q[30:]
        np.testing.assert_allclose(space.distance(space.interpolate(a, b, 0.0), a), 0.0, atol=1e-7)
        np.testing.assert_allclose(space.distance(space.interpolate(a, b, 1.0), b), 0.0, atol=1e-7)

    def test_interpolation_covers_the_distance_evenly(self, space, q):
        a, b = q[:30], q[30:]
        t = np.linspace(0.0, 1.0, 30)
        middle, whole = space.interpolate(a, b, t), space.distance(a, b)
        np.testing.assert_allclose(space.distance(a, middle), t * whole, atol=1e-7)
        np.testing.assert_allclose(space.distance(middle, b), (1 - t) * whole, atol=1e-7)

    def test_a_scalar_fraction_is_the_same_for_all_rows(self, space, q):
        a, b = q[:30], q[30:]
        np.testing.assert_array_equal(
            space.interpolate(a, b, 0.3), space.interpolate(a, b, np.full(len(a), 0.3))
        )

    def test_batches_give_what_their_rows_give(self, space, q):
        a, b, t = q[:30], q[30:], np.linspace(0.0, 1.0, 30)
        rows = range(len(a))
        np.testing.assert_array_equal(
            space.distance(a, b), [space.distance(a[i : i + 1], b[i : i + 1])[0] for i in rows]
        )
        np.testing.assert_array_equal(
            space.interpolate(a, b, t),
            [space.interpolate(a[i : i + 1], b[i : i + 1], t[i : i + 1])[0] for i in rows],
        )

    def test_an_empty_batch_gives_an_empty_answer(self, space):
        empty = np.empty((0, space.dim))
        assert space.from_cube(empty).shape == (0, space.dim)
        assert space.distance(empty, empty).shape == (0,)
        assert space.interpolate(empty, empty, 0.5).shape == (0, space.dim)

    def test_arguments_are_left_alone(self, space, q):
        u = np.random.default_rng(2).random((5, space.dim))
        arguments = [u, q[:5].copy(), q[5:10].copy()]
        before = [argument.copy() for argument in arguments]
        for argument in arguments:
            argument.setflags(write=False)
        space.from_cube(arguments[0])
        space.distance(arguments[1], arguments[2])
        space.interpolate(arguments[1], arguments[2], 0.25)
        for argument, copy in zip(arguments, before, strict=True):
            np.testing.assert_array_equal(argument, copy)

    def test_a_wrong_shape_is_refused(self, space, q):
        for wrong in (q[0], q[:, :-1], np.hstack([q, q])):
            with pytest.raises(InvalidValue, match="shape"):
                space.from_cube(wrong)
            with pytest.raises(InvalidValue, match="shape"):
                space.distance(wrong, wrong)
        with pytest.raises(InvalidValue, match="length"):
            space.distance(q[:3], q[:4])

    @pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
    def test_an_entry_that_is_not_finite_is_refused(self, space, q, bad):
        wrong = q.copy()
        wrong[3, -1] = bad
        with pytest.raises(InvalidValue, match=rf"\[3, {space.dim - 1}\]"):
            space.distance(wrong, q)
        with pytest.raises(InvalidValue, match="finite"):
            space.interpolate(q, wrong, 0.5)

    def test_a_fraction_outside_zero_to_one_is_refused(self, space, q):
        for wrong in (-0.1, 1.1, np.nan):
            with pytest.raises(InvalidValue, match=r"\[0, 1\]"):
                space.interpolate(q, q, wrong)
        with pytest.raises(InvalidValue, match="shape"):
            space.interpolate(q, q, np.zeros(len(q) + 1))
