"""What is said about a batch that cannot be read."""

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.space.batch import as_batch, as_batch_pair, as_cube_batch, as_fractions


def test_a_batch_is_read_only_and_of_float64_and_fractions_become_a_column():
    batch = as_batch("q", [[1, 2]], 2)
    assert batch.dtype == np.float64
    assert not batch.flags.writeable
    np.testing.assert_array_equal(as_fractions(0.25, 2), [[0.25], [0.25]])
    np.testing.assert_array_equal(as_fractions([0.0, 1.0], 2), [[0.0], [1.0]])


@pytest.mark.parametrize(("read", "text"), [
    *((lambda bad=bad: as_batch("q", bad, 2), r"q must have shape \(n, 2\), got \(")
      for bad in ([1.0, 2.0], [[1.0]], [[[1.0, 2.0]]], 3.0)),
    (lambda: as_batch("q", [1.0, 2.0], 2), r"got \(2,\); one configuration .*: \[\[1.0, 2.0\]\]"),
    *((lambda bad=bad: as_batch("q", bad, 2), "numbers") for bad in ([["a", "b"]], [[1.0, 2.0], [3.0]])),
    (lambda: as_batch("q", [[1.0, 2.0], [np.nan, np.inf]], 2), r"q must be finite: entry \[1, 0\] is nan"),
    (lambda: as_batch_pair([[1.0]], [[1.0], [2.0]], 1), "same length, got 1 and 2"),
    (lambda: as_cube_batch([[0.5, 1.5]], 2), r"u must lie in \[0, 1\]: entry \[0, 1\] is 1.5"),
    (lambda: as_fractions("half", 2), "numbers"),
    (lambda: as_fractions([0.1], 2), "shape"),
    *((lambda bad=bad: as_fractions(bad, 2), r"\[0, 1\]") for bad in (1.5, np.nan)),
])  # fmt: skip
def test_what_is_no_batch_is_refused_with_the_reason(read, text):
    with pytest.raises(InvalidValue, match=text):
        read()
