"""Trained families: sets that ship, and what is said where there is none."""

import numpy as np

from evenroad.errors import NotAvailable, UnknownName
from evenroad.points import draw
from evenroad.points.bank import Trained
from evenroad.points.measures import MEASURES
from tests.points.samplers.sampler_contract import SamplerContract
from tests.refused import refused


class TestHickernell(SamplerContract):
    sampler = Trained("hickernell")
    shapes = ((16, 2), (64, 2), (1024, 2), (24, 3))


def test_where_none_ships_a_set_is_annealed_as_good_as_its_neighbours():
    n, d = 20, 2
    points = draw("hickernell", n, d, rng=3)
    assert points == draw("hickernell", n, d, rng=3)
    assert (points.origin.method, points.origin.steps, points.origin.seed) == ("annealed", 5000, 3)
    value = MEASURES["hickernell"].rooted
    # Between those of the bank with 16 and with 32 points.
    assert value(draw("hickernell", 32, d)) < value(points) < value(draw("hickernell", 16, d))


def test_what_would_take_long_and_an_unknown_family_are_refused_with_what_there_is():
    refused(NotAvailable, r"evenroad train -n 9000 -d 2 --objective hickernell", draw, "hickernell", 9000, 2)
    refused(
        NotAvailable, r"no set of n=11 in d=2; it has .*evenroad train -n 11 -d 2 --method mpmc", draw, "mpmc", 11, 2
    )
    refused(UnknownName, "known: hickernell, mpmc", Trained, "odd")


def test_stored_values_are_float32():
    points = draw("hickernell", 64, 2).points
    np.testing.assert_array_equal(points, points.astype(np.float32))
