"""WorldContract: what every world must do, as tests."""

# ruff: noqa: D102 -- the name of a test says what it tests

from __future__ import annotations

import numpy as np
import pytest

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue
from evenroad.space.protocol import is_directed
from evenroad.world import World


class WorldContract:
    """Tests of a world: batch = loop, symmetry, free motions have free endpoints, and errors for bad batches.

    Examples
    --------
    >>> import numpy as np
    >>> import evenroad as er
    >>> from evenroad.testing import WorldContract
    >>> cells = np.zeros((20, 30), dtype=bool)
    >>> class TestMyWorld(WorldContract):
    ...     world = er.GridMap(cells).world(radius=2)
    """

    world: World
    """Set it in the subclass.  Of 400 random configurations and motions some must be free and some blocked."""
    free_between = True
    """Whether all states of a free motion are free, as in a world that checks motions exactly.  Set it to False for one
    that checks states at a resolution."""

    def configurations(self) -> Floats:
        """Return 400 random configurations, (400, dim)."""
        return self.world.space.from_cube(np.random.default_rng(11).random((400, self.world.space.cube_dim)))

    def motions(self) -> tuple[Floats, Floats]:
        """Return the endpoints of 400 motions, short ones and long ones."""
        q = self.configurations()
        reach = np.random.default_rng(12).random(len(q)) ** 3
        return q, self.world.space.interpolate(q, np.roll(q, 1, axis=0), reach)

    def test_answers_are_booleans_one_a_row(self) -> None:
        q = self.configurations()
        for answer in (self.world.valid(q), self.world.motion_valid(*self.motions())):
            assert answer.shape == (len(q),)
            assert answer.dtype == np.bool_
            assert 0 < int(answer.sum()) < len(q), "the contract needs both results to mean anything"

    def test_a_batch_gives_what_its_rows_give(self) -> None:
        q, (a, b) = self.configurations(), self.motions()
        rows, world = [slice(i, i + 1) for i in range(len(q))], self.world
        np.testing.assert_array_equal(world.valid(q), [world.valid(q[i])[0] for i in rows])
        np.testing.assert_array_equal(world.motion_valid(a, b), [world.motion_valid(a[i], b[i])[0] for i in rows])

    def test_a_motion_and_its_reverse_get_one_result(self) -> None:
        if is_directed(self.world.space):
            pytest.skip("the space is directed")
        a, b = self.motions()
        np.testing.assert_array_equal(self.world.motion_valid(a, b), self.world.motion_valid(b, a))

    def test_a_free_motion_has_free_endpoints(self) -> None:
        a, b = self.motions()
        free = self.world.motion_valid(a, b)
        assert self.world.valid(a[free]).all()
        assert self.world.valid(b[free]).all()

    def test_a_free_motion_is_free_along_its_length(self) -> None:
        if not self.free_between:
            pytest.skip("free_between is False")
        a, b = self.motions()
        free = self.world.motion_valid(a, b)
        for t in np.linspace(0.0, 1.0, 21):
            assert self.world.valid(self.world.space.interpolate(a[free], b[free], t)).all()

    def test_a_motion_of_no_length_is_free_where_its_start_is(self) -> None:
        q = self.configurations()
        np.testing.assert_array_equal(self.world.motion_valid(q, q), self.world.valid(q))

    def test_an_empty_batch_gives_an_empty_answer(self) -> None:
        empty = np.empty((0, self.world.space.dim))
        assert self.world.valid(empty).shape == (0,)
        assert self.world.motion_valid(empty, empty).shape == (0,)

    def test_arguments_are_left_alone_and_may_be_read_only_or_strided(self) -> None:
        a, b = self.motions()
        expected, before = self.world.motion_valid(a, b), (a.copy(), b.copy())
        a.setflags(write=False)
        b.setflags(write=False)
        for other, same in (
            (self.world.motion_valid(a, b), expected),
            (self.world.motion_valid(np.asfortranarray(a), b), expected),
            (self.world.motion_valid(a[::2], b[::2]), expected[::2]),
            (self.world.valid(np.repeat(a, 2, axis=0)[::2]), self.world.valid(a)),
            *zip((a, b), before, strict=True),
        ):
            np.testing.assert_array_equal(other, same)

    def test_a_wrong_shape_is_refused(self) -> None:
        q = self.configurations()
        for wrong in (np.hstack([q, q[:, :1]]), q[np.newaxis], np.append(q[0], 0.0)):
            with pytest.raises(InvalidValue):
                self.world.valid(wrong)
            with pytest.raises(InvalidValue):
                self.world.motion_valid(q, wrong)
        with pytest.raises(InvalidValue):
            self.world.motion_valid(q[:3], q[:4])

    @pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
    def test_an_entry_that_is_not_finite_is_refused(self, bad: float) -> None:
        q = self.configurations()
        wrong = q.copy()
        wrong[5, 0] = bad
        with pytest.raises(InvalidValue):
            self.world.valid(wrong)
        with pytest.raises(InvalidValue):
            self.world.motion_valid(q, wrong)
