"""The bank of least star discrepancies."""

from itertools import product

import numpy as np
import pytest

from evenroad.errors import BrokenFile, NotAvailable
from evenroad.points import draw
from evenroad.points.bank import star
from evenroad.points.bank.star import LARGEST, Star, records
from evenroad.points.measures import star_discrepancy
from tests.points.samplers.sampler_contract import SamplerContract
from tests.refused import refused


class TestStar(SamplerContract):
    sampler = Star()
    shapes = ((1, 2), (7, 3), (100, 2), (LARGEST, 3))
    draws_depend_on_rng = False


def corners_deviation(points):
    """Return the star discrepancy, box after box: upper sides through points or 1, with and without what is there."""
    sides = [[*axis, 1.0] for axis in points.T]
    worst = 0.0
    for box in product(*sides):
        volume = np.prod(box)
        open_share, closed_share = (np.mean(inside.all(axis=1)) for inside in (points < box, points <= box))
        worst = max(worst, volume - open_share, closed_share - volume)
    return worst


@pytest.mark.parametrize(("n", "d"), [(1, 2), (9, 2), (30, 2), (1, 3), (8, 3), (15, 3)])
def test_a_kept_value_is_that_of_all_boxes(n, d):
    assert corners_deviation(draw("star", n, d).points) == pytest.approx(records(d)[n].value, abs=1e-12)


@pytest.mark.parametrize("d", [2, 3])
def test_there_is_a_set_of_every_number_with_its_exact_value(d):
    assert list(records(d)) == list(range(1, LARGEST + 1))
    for n in (64, 200):
        assert star_discrepancy(draw("star", n, d)) == records(d)[n].value


@pytest.mark.parametrize(("n", "published"), [(60, 0.02336), (100, 0.01504), (140, 0.01151), (260, 0.00831)])
def test_in_the_plane_sets_are_below_the_best_public_ones(n, published):
    assert records(2)[n].value < published


def test_what_there_is_not_and_what_was_changed_is_refused(monkeypatch, tmp_path):
    refused(NotAvailable, r"n = 1 .. 512 points in d = 2 and 3, not of n=513 in d=2", draw, "star", 513, 2)
    refused(NotAvailable, "not of n=8 in d=4", draw, "star", 8, 4)
    sets = np.load(star.large_file("star", "d02.npy"))
    np.save(tmp_path / "d02.npy", 0.5 * sets)
    (tmp_path / "d02.csv").write_bytes(star.large_file("star", "d02.csv").read_bytes())
    star._sets.cache_clear()
    monkeypatch.setattr(star, "large_file", lambda family, name: tmp_path / name)
    refused(BrokenFile, "does not match its hash", draw, "star", 8, 2)
    star._sets.cache_clear()
