"""Trained families: sets that ship, and what is said where there is none."""

import numpy as np
import pytest

from evenroad.errors import NotAvailable, UnknownName
from evenroad.points import draw
from evenroad.points.bank import Trained
from tests.points.samplers.sampler_contract import SamplerContract
from tests.refused import refused


class TestHickernell(SamplerContract):
    sampler = Trained("hickernell")
    shapes = ((16, 2), (64, 2), (1024, 2))


def test_a_set_that_does_not_ship_and_an_unknown_family_are_refused_with_what_there_is():
    with pytest.raises(
        NotAvailable, match=r"hickernell has no set of n=11 in d=2; it has n = 16, .*evenroad train -n 11 -d 2"
    ):
        draw("hickernell", 11, 2)
    refused((NotAvailable, UnknownName), "mpmc", draw, "mpmc", 11, 2)
    refused(UnknownName, "known: hickernell, mpmc", Trained, "odd")


def test_stored_values_are_float32():
    points = draw("hickernell", 64, 2).points
    np.testing.assert_array_equal(points, points.astype(np.float32))
