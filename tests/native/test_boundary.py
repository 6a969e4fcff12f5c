"""What the native kernel takes from Python, and what it refuses."""

import threading

import numpy as np
import pytest

from evenroad._native import points
from evenroad.errors import InvalidValue

COLUMNS, ONES = np.random.default_rng(0).random((3, 40)), np.ones(3)


@pytest.mark.parametrize(
    ("columns", "got"),
    [
        ([[0.5], [0.5], [0.5]], "got list"),
        (None, "got NoneType"),
        (np.zeros((3, 4), dtype=np.int64), r"got an array of int64, shape \(3, 4\)"),
        (np.zeros((3, 4), dtype=np.float32), r"got an array of float32, shape \(3, 4\)"),
        (np.zeros((3, 8))[:, ::2], r"got an array of float64, shape \(3, 4\)"),
        (np.zeros((4, 3)).T, r"got an array of float64, shape \(3, 4\)"),
        (np.zeros(3), r"got an array of float64, shape \(3,\)"),
        (np.zeros((3, 4, 1)), r"got an array of float64, shape \(3, 4, 1\)"),
    ],
)
def test_arrays_of_another_kind_are_refused_and_named(columns, got):
    with pytest.raises(InvalidValue, match=f"columns must be a C-contiguous array of float64 with 2 axes, {got}"):
        points.maximum_pair_sums(columns, ONES, ONES, True)


def test_arrays_that_do_not_fit_each_other_are_refused():
    with pytest.raises(InvalidValue, match=r"slope must have shape \(3,\), got \(4,\)"):
        points.maximum_pair_sums(COLUMNS, ONES, np.ones(4), True)
    flat = np.zeros((3, 39))
    with pytest.raises(InvalidValue, match=r"own must have shape \(3, 40\), got \(3, 39\)"):
        points.distance_pair_sums(COLUMNS, ONES, ONES, ONES, flat, flat, True)


def test_arrays_that_cannot_be_written_to_are_read():
    frozen = COLUMNS.copy()
    frozen.setflags(write=False)
    np.testing.assert_array_equal(
        points.maximum_pair_sums(frozen, ONES, ONES, True).sums,
        points.maximum_pair_sums(COLUMNS, ONES, ONES, True).sums,
    )


def test_results_outlive_the_call_and_own_their_memory():
    found = points.maximum_pair_sums(COLUMNS, ONES, ONES, True)
    sums, gradient = found.sums, found.gradient
    del found
    kept = sums.copy(), gradient.copy()
    for _ in range(50):
        points.maximum_pair_sums(COLUMNS, 2 * ONES, ONES, True)
    np.testing.assert_array_equal(sums, kept[0])
    np.testing.assert_array_equal(gradient, kept[1])
    assert gradient.shape == COLUMNS.shape
    assert gradient.flags.writeable


def test_no_points_and_no_coordinates_are_sums_of_nothing():
    assert points.maximum_pair_sums(np.zeros((3, 0)), ONES, ONES, True).sums.shape == (0,)
    np.testing.assert_array_equal(
        points.maximum_pair_sums(np.zeros((0, 5)), ONES[:0], ONES[:0], True).sums, np.full(5, 5.0)
    )


def test_eight_threads_get_what_one_gets():
    sets = [np.random.default_rng(seed).random((4, 200)) for seed in range(8)]
    ones = np.ones(4)
    alone = [points.maximum_pair_sums(each, 2 * ones, ones, True).gradient for each in sets]
    found = [[] for _ in sets]

    def work(i):
        for _ in range(20):
            found[i].append(points.maximum_pair_sums(sets[i], 2 * ones, ones, True).gradient)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for one, several in zip(alone, found, strict=True):
        assert len(several) == 20
        for each in several:
            np.testing.assert_array_equal(each, one)
