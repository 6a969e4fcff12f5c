"""What is said about a batch that cannot be read."""

from __future__ import annotations

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.space.batch import as_batch, as_batch_pair, as_cube_batch, as_fractions


def test_a_batch_is_read_only_and_of_float64():
    batch = as_batch("q", [[1, 2]], 2)
    assert batch.dtype == np.float64
    assert not batch.flags.writeable


@pytest.mark.parametrize("wrong", [[1.0, 2.0], [[1.0]], [[[1.0, 2.0]]], 3.0])
def test_a_wrong_shape_is_named(wrong):
    with pytest.raises(InvalidValue, match=r"q must have shape \(n, 2\), got \("):
        as_batch("q", wrong, 2)


def test_who_gives_one_configuration_is_told_how_to_write_it():
    with pytest.raises(
        InvalidValue, match=r"shape \(n, 2\), got \(2,\); one configuration .*: \[\[1.0, 2.0\]\]"
    ):
        as_batch("q", [1.0, 2.0], 2)


@pytest.mark.parametrize("wrong", [[["a", "b"]], [[1.0, 2.0], [3.0]]])
def test_what_is_no_array_of_numbers_is_refused(wrong):
    with pytest.raises(InvalidValue, match="numbers"):
        as_batch("q", wrong, 2)


def test_the_first_entry_that_is_not_finite_is_named():
    with pytest.raises(InvalidValue, match=r"q must be finite: entry \[1, 0\] is nan"):
        as_batch("q", [[1.0, 2.0], [np.nan, np.inf]], 2)


def test_two_ends_of_different_length_are_refused():
    with pytest.raises(InvalidValue, match="same length, got 1 and 2"):
        as_batch_pair([[1.0]], [[1.0], [2.0]], 1)


def test_the_first_entry_outside_the_cube_is_named():
    with pytest.raises(InvalidValue, match=r"u must lie in \[0, 1\]: entry \[0, 1\] is 1.5"):
        as_cube_batch([[0.5, 1.5]], 2)


def test_fractions_become_a_column():
    np.testing.assert_array_equal(as_fractions(0.25, 2), [[0.25], [0.25]])
    np.testing.assert_array_equal(as_fractions([0.0, 1.0], 2), [[0.0], [1.0]])


@pytest.mark.parametrize(
    ("t", "text"), [("half", "numbers"), ([0.1], "shape"), (1.5, r"\[0, 1\]"), (np.nan, r"\[0, 1\]")]
)
def test_fractions_that_are_none_are_refused(t, text):
    with pytest.raises(InvalidValue, match=text):
        as_fractions(t, 2)
