"""Trained families: sets that ship, and what is said where there is none."""

import numpy as np

from evenroad.errors import NotAvailable, UnknownName
from evenroad.points import draw
from evenroad.points.bank import Trained, bank
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


def test_where_none_ships_the_network_of_the_studies_makes_one_as_good_as_an_annealed_one(monkeypatch):
    monkeypatch.setattr("evenroad_studies.network.on_demand.STEPS", 300)
    n, d = 96, 2
    points = draw("mpmc", n, d, rng=3)
    assert points == draw("mpmc", n, d, rng=3)
    assert (points.origin.family, points.origin.method, points.origin.seed) == ("mpmc", "network", 3)
    value = MEASURES["hickernell"].rooted
    assert value(points) < 1.02 * value(draw("hickernell", n, d))
    assert value(draw("mpmc", 128, d)) < value(points) < value(draw("mpmc", 64, d))


def test_without_the_studies_the_error_says_what_makes_a_set(monkeypatch):
    monkeypatch.setattr(bank, "_maker", lambda family: None)
    bank._made.cache_clear()
    refused(NotAvailable, r"no set of n=97 in d=2; .* pip install evenroad-studies", draw, "mpmc", 97, 2)
    assert not Trained("mpmc").any_n


def test_what_would_take_long_and_an_unknown_family_are_refused_with_what_there_is():
    refused(NotAvailable, r"evenroad train -n 9000 -d 2 --objective hickernell", draw, "hickernell", 9000, 2)
    refused(
        NotAvailable, r"no set of n=9000 in d=2; .*evenroad train -n 9000 -d 2 --method mpmc", draw, "mpmc", 9000, 2
    )
    refused(UnknownName, "known: hickernell, mpmc", Trained, "odd")


def test_stored_values_are_float32():
    points = draw("hickernell", 64, 2).points
    np.testing.assert_array_equal(points, points.astype(np.float32))
