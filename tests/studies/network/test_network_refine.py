import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.points import Origin, PointSet
from evenroad_studies.network import refine
from evenroad_studies.training.objective import parse_objective

TRAINED = [
    PointSet(
        np.random.default_rng(index).random((12, 2)),
        Origin(family="mpmc", method="network", objective="star", seed=3, replica=index),
    )
    for index in (0, 1)
]


def test_refining_makes_every_set_better_and_says_so_in_the_origin():
    star = parse_objective("star")
    for before, after in zip(TRAINED, refine(TRAINED, steps=200), strict=True):
        assert star.value(after.points) < star.value(before.points)
        origin = after.origin
        assert (origin.family, origin.method, origin.objective) == ("mpmc", "network+annealed", "star")
        assert (origin.seed, origin.replica) == (3, before.origin.replica)


def test_a_set_that_cannot_get_better_stays_as_it_is_and_one_without_an_objective_needs_one():
    best = PointSet(np.array([[1 / 2]]), TRAINED[0].origin)
    (after,) = refine([best], steps=3)
    assert after.points.tolist() == [[1 / 2]]
    with pytest.raises(InvalidValue, match="not made for an objective"):
        refine([PointSet(np.random.default_rng(0).random((4, 2)))])


def test_refining_is_the_same_again_and_whichever_other_sets_are_there():
    seen = []
    both = refine(TRAINED, steps=20, callback=lambda step, steps, best: seen.append((step, steps)))
    assert both[1] == refine(TRAINED[1:], steps=20)[0]
    assert seen == [(step, 40) for step in range(1, 41)]


def test_another_objective_can_be_asked_for():
    (after,) = refine(TRAINED[:1], "hickernell", steps=200)
    assert after.origin.objective == "hickernell"
    assert parse_objective("hickernell").value(after.points) < parse_objective("hickernell").value(TRAINED[0].points)
