"""SpaceContract: what every space must do, as tests."""

# ruff: noqa: D102 -- the name of a test says what it tests

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue
from evenroad.space import Space

_TOLERANCE = 1e-7
"""Tolerance of distances, as a share of the largest: arccos and the like lose half of their digits near zero."""
_VOLUME_TOLERANCE = 0.06
"""Tolerance of volumes found from 20000 directions: at most 0.03 off for products of up to 12 coordinates."""


class SpaceContract:
    """Tests of a space: its cube, its metric and its interpolation, batch = loop, and errors for bad input.

    Examples
    --------
    >>> from evenroad.spaces import BoxSpace
    >>> from evenroad.testing import SpaceContract
    >>> class TestMySpace(SpaceContract):
    ...     space = BoxSpace((0, 0), (1, 2))
    """

    space: Space
    """Set it in the subclass."""
    measure_is_the_metrics = True
    """Whether balls of one small radius have one measure everywhere, as they have in boxes, tori and rotation groups.
    Where it is False, what `from_cube` does to volumes is not tested."""

    def configurations(self, n: int, seed: int = 7) -> Floats:
        """Return random configurations of the space.

        Parameters
        ----------
        n, seed : int
            Number of configurations, and their seed.

        Returns
        -------
        ndarray, shape (n, dim)

        Examples
        --------
        >>> from evenroad.spaces import Circle
        >>> from evenroad.testing import SpaceContract
        >>> class TestMySpace(SpaceContract):
        ...     space = Circle()
        >>> TestMySpace().configurations(5).shape
        (5, 1)
        """
        return self.space.from_cube(np.random.default_rng(seed).random((n, self.space.cube_dim)))

    def pairs(self) -> tuple[Floats, Floats, float]:
        """Return the endpoints of 30 random motions, two (30, dim) arrays, and a tolerance for their lengths."""
        a, b = np.split(self.configurations(60), 2)
        return a, b, _TOLERANCE * float(self.space.distance(a, b).max())

    def test_from_cube_gives_one_finite_configuration_of_the_space_a_point(self) -> None:
        q = self.configurations(60)
        assert q.shape == (60, self.space.dim)
        assert q.dtype == np.float64
        assert np.isfinite(q).all()
        assert self.space.contains(q).all()

    def test_from_cube_takes_the_corners_of_the_cube(self) -> None:
        corners = itertools.islice(itertools.product((0.0, 1.0), repeat=self.space.cube_dim), 64)
        assert self.space.contains(self.space.from_cube(np.array(list(corners)))).all()

    def test_from_cube_of_a_batch_is_that_of_its_rows(self) -> None:
        u = np.random.default_rng(1).random((23, self.space.cube_dim))
        rows = np.concatenate([self.space.from_cube(row[np.newaxis]) for row in u])
        np.testing.assert_array_equal(self.space.from_cube(u), rows)

    def test_equal_volumes_of_the_cube_get_equal_measure(self) -> None:
        """At random points, compare the volumes of cube steps of the same small length."""
        if not self.measure_is_the_metrics:
            pytest.skip("measure_is_the_metrics is False")
        rng, dim = np.random.default_rng(3), self.space.cube_dim
        directions = rng.normal(size=(20_000, dim))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        centres = 0.1 + 0.8 * rng.random((8, dim))
        # A step as long as every axis' own counts about the same: else a few directions would decide the mean.
        directions /= self._lengths(centres[0], np.eye(dim))
        # The volume of {step : its length <= 1}, up to a factor, in polar coordinates.
        volumes = [np.mean(self._lengths(centre, directions) ** -dim) for centre in centres]
        np.testing.assert_allclose(volumes / np.mean(volumes), 1.0, atol=_VOLUME_TOLERANCE)

    def _lengths(self, centre: Floats, steps: Floats) -> Floats:
        """Return how far the space goes for `steps` of the cube, (n, cube_dim), in the limit of small ones."""
        shrink = 1e-4 / np.abs(steps).max(axis=1)
        here = self.space.from_cube(np.tile(centre, (len(steps), 1)))
        there = self.space.from_cube(centre + shrink[:, np.newaxis] * steps)
        metric: Floats = self.space.distance(here, there) / shrink
        return metric

    def test_distance_is_zero_to_itself_and_positive_to_others(self) -> None:
        q = self.configurations(60)
        _, _, tolerance = self.pairs()
        np.testing.assert_allclose(self.space.distance(q, q), 0.0, atol=tolerance)
        assert (self.space.distance(q, np.roll(q, 1, axis=0)) > 0.0).all()

    def test_distance_is_symmetric(self) -> None:
        a, b, _ = self.pairs()
        np.testing.assert_array_equal(self.space.distance(a, b), self.space.distance(b, a))

    def test_distance_satisfies_the_triangle_inequality(self) -> None:
        a, b, c = np.split(self.configurations(600), 3)
        through = self.space.distance(a, b) + self.space.distance(b, c)
        assert (self.space.distance(a, c) <= through * (1.0 + 1e-12)).all()

    def test_a_flat_metric_is_the_distance(self) -> None:
        if self.space.flat is None:
            pytest.skip("the metric is not flat")
        a, b, tolerance = self.pairs()
        assert self.space.flat.dim == self.space.dim
        np.testing.assert_allclose(self.space.flat.distance(a, b), self.space.distance(a, b), atol=tolerance)

    def test_interpolation_starts_and_stops_at_its_endpoints(self) -> None:
        a, b, tolerance = self.pairs()
        start, end = self.space.interpolate(a, b, 0.0), self.space.interpolate(a, b, 1.0)
        np.testing.assert_allclose(self.space.distance(start, a), 0.0, atol=tolerance)
        np.testing.assert_allclose(self.space.distance(end, b), 0.0, atol=tolerance)

    def test_interpolation_covers_the_distance_evenly(self) -> None:
        a, b, tolerance = self.pairs()
        t = np.linspace(0.0, 1.0, len(a))
        middle, whole = self.space.interpolate(a, b, t), self.space.distance(a, b)
        np.testing.assert_allclose(self.space.distance(a, middle), t * whole, atol=tolerance)
        np.testing.assert_allclose(self.space.distance(middle, b), (1.0 - t) * whole, atol=tolerance)

    def test_interpolation_back_is_the_same_path(self) -> None:
        a, b, tolerance = self.pairs()
        there, back = self.space.interpolate(a, b, 0.25), self.space.interpolate(b, a, 0.75)
        np.testing.assert_allclose(self.space.distance(there, back), 0.0, atol=tolerance)

    def test_interpolation_stays_in_the_space(self) -> None:
        a, b, _ = self.pairs()
        for t in np.linspace(0.0, 1.0, 17):
            assert self.space.contains(self.space.interpolate(a, b, t)).all()
            assert self.space.contains(self.space.interpolate(a, a, t)).all()

    def test_a_scalar_fraction_is_the_same_for_all_rows(self) -> None:
        a, b, _ = self.pairs()
        each = np.full(len(a), 0.3)
        np.testing.assert_array_equal(self.space.interpolate(a, b, 0.3), self.space.interpolate(a, b, each))

    def test_batches_give_what_their_rows_give(self) -> None:
        a, b, _ = self.pairs()
        t, rows = np.linspace(0.0, 1.0, len(a)), [slice(i, i + 1) for i in range(len(a))]
        space = self.space
        for batch, loop in (
            (space.distance(a, b), [space.distance(a[i], b[i])[0] for i in rows]),
            (space.interpolate(a, b, t), [space.interpolate(a[i], b[i], t[i])[0] for i in rows]),
            (space.contains(a), [space.contains(a[i])[0] for i in rows]),
        ):
            np.testing.assert_array_equal(batch, loop)

    def test_an_empty_batch_gives_an_empty_answer(self) -> None:
        empty = np.empty((0, self.space.dim))
        assert self.space.from_cube(np.empty((0, self.space.cube_dim))).shape == (0, self.space.dim)
        assert self.space.distance(empty, empty).shape == (0,)
        assert self.space.interpolate(empty, empty, 0.5).shape == (0, self.space.dim)
        assert self.space.contains(empty).shape == (0,)

    def test_arguments_are_left_alone_and_may_be_read_only_or_strided(self) -> None:
        a, b, _ = self.pairs()
        u, a, b = arguments = [np.random.default_rng(2).random((5, self.space.cube_dim)), a.copy(), b.copy()]
        before = [argument.copy() for argument in arguments]
        for argument in arguments:
            argument.setflags(write=False)
        space, turned = self.space, np.asfortranarray
        for other, same in (
            (space.from_cube(turned(u)), space.from_cube(u)),
            (space.distance(turned(a), b), space.distance(a, b)),
            (space.distance(a[::2], b[::2]), space.distance(a, b)[::2]),
            (space.interpolate(turned(a), b, 0.25), space.interpolate(a, b, 0.25)),
            (space.contains(turned(a)), space.contains(a)),
            *zip(arguments, before, strict=True),
        ):
            np.testing.assert_array_equal(other, same)

    def test_a_wrong_shape_is_refused(self) -> None:
        q, dim, cube_dim = self.configurations(4), self.space.dim, self.space.cube_dim
        for wrong in (np.array(0.5), q[0], np.zeros((4, dim + 1)), q[np.newaxis]):
            _refused(self.space.distance, wrong, wrong)
            _refused(self.space.interpolate, wrong, wrong, 0.5)
            _refused(self.space.contains, wrong)
        for wrong in (np.array(0.5), np.zeros(cube_dim), np.zeros((4, cube_dim + 1))):
            _refused(self.space.from_cube, wrong)
        _refused(self.space.distance, q[:3], q[:4])

    @pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
    def test_an_entry_that_is_not_finite_is_refused(self, bad: float) -> None:
        q = self.configurations(4)
        wrong, wrong_u = q.copy(), np.full((4, self.space.cube_dim), 0.5)
        wrong[3, -1] = wrong_u[3, -1] = bad
        _refused(self.space.from_cube, wrong_u)
        _refused(self.space.distance, wrong, q)
        _refused(self.space.interpolate, q, wrong, 0.5)

    def test_a_point_outside_the_cube_is_refused(self) -> None:
        for wrong in (-1e-9, 1.0 + 1e-9):
            _refused(self.space.from_cube, np.full((2, self.space.cube_dim), wrong))

    def test_a_fraction_outside_zero_to_one_is_refused(self) -> None:
        q = self.configurations(4)
        for wrong in (-0.1, 1.1, np.nan, np.zeros(len(q) + 1)):
            _refused(self.space.interpolate, q, q, wrong)


def _refused(method: Callable[..., object], *arguments: object) -> None:
    with pytest.raises(InvalidValue):
        method(*arguments)
