"""Annealing: the recipe's promises, on small sets."""

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.points import PointSet
from evenroad.points import anneal as module
from evenroad.points.anneal import first_rate, learning_rate, noise_over_rate
from evenroad.points.measures import MEASURES, separation
from evenroad_studies.training.objective import parse_objective
from tests.refused import refused


def anneal(n, d, objective="hickernell", **options):
    return module.anneal(n, d, parse_objective(objective), **options)


def test_the_same_seed_gives_the_same_bits():
    once, again = anneal(20, 3, steps=50, rng=7), anneal(20, 3, steps=50, rng=7)
    assert once.points.tobytes() == again.points.tobytes()
    assert once.value == again.value
    assert once.points.tobytes() != anneal(20, 3, steps=50, rng=8).points.tobytes()


def test_the_value_is_the_objective_at_the_points():
    for text in ("hickernell", "star+10*riesz", "riesz"):
        annealed = anneal(15, 2, text, steps=40)
        assert annealed.value == parse_objective(text).value(annealed.points)


def test_points_are_read_only_and_stay_below_one_as_float32():
    points = anneal(3, 1, "star", steps=100).points
    assert points.shape == (3, 1)
    assert not points.flags.writeable
    assert points.astype(np.float32).max() < 1
    assert points.min() > 0


@pytest.mark.parametrize("name", MEASURES)
def test_every_measure_falls_well_below_random_points(name):
    random = np.median([MEASURES[name].rooted(np.random.default_rng(i).random((32, 2))) for i in range(9)])
    assert anneal(32, 2, name, steps=300).value < 0.5 * random


def test_one_dimension_finds_the_midpoints():
    annealed = anneal(8, 1, "star", steps=2000)
    np.testing.assert_allclose(np.sort(annealed.points[:, 0]), (np.arange(8) + 0.5) / 8, atol=1e-3)


def test_an_energy_settles_even_for_many_points_on_a_line():
    points = anneal(100, 1, "average_squared+10*riesz", steps=2000).points
    assert separation(points, periodic=True) * 100 > 0.95
    assert MEASURES["star"].rooted(points) < 1.05 / (100 * 12**0.5)  # that of the midpoints is the best


def test_discrepancy_in_ten_dimensions_is_near_the_record_already_after_few_steps():
    # 0.197 after 20000 steps; Owen-scrambled Sobol points have 0.2455, random ones 0.54.
    assert anneal(128, 10, steps=1500).value < 0.21


def test_an_energy_beside_a_measure_gives_low_discrepancy_and_large_separation():
    # Spacing-relative separation: about .2 without the energy; .9 is hardly exceeded by any set.
    alone, both = anneal(64, 2, "hickernell", steps=2000), anneal(64, 2, "hickernell+10*riesz", steps=2000)
    assert MEASURES["hickernell"].rooted(both.points) < 1.15 * alone.value
    assert separation(both.points, periodic=True) * 64 ** (1 / 2) > 0.7
    assert separation(both.points, periodic=True) > 1.5 * separation(alone.points, periodic=True)


def test_a_start_is_taken_and_never_made_worse():
    start = anneal(30, 4, steps=300).points
    again = anneal(30, 4, steps=5, start=PointSet(start))
    assert again.value <= MEASURES["hickernell"].rooted(start)
    np.testing.assert_allclose(again.points, start, atol=0.2)
    refused(InvalidValue, r"start must have shape \(31, 4\), got \(30, 4\)", anneal, 31, 4, steps=5, start=start)


def test_a_start_at_the_faces_is_moved_off_them():
    # One step, from a start that is better than anything a step away: the start itself is returned.
    start = np.array([[0.0, 0.5], [0.5, np.nextafter(1.0, 0.0)]])
    points = anneal(2, 2, "riesz", steps=1, start=start).points
    assert points.min() > 0
    assert points.astype(np.float32).max() < 1
    np.testing.assert_allclose(points, start, atol=1e-7)


def test_points_that_coincide_come_apart():
    annealed = anneal(6, 2, "riesz", steps=1500, start=np.full((6, 2), 0.5))
    assert separation(annealed.points, periodic=True) > 0.2


def test_the_callback_sees_every_step_and_may_stop():
    seen = []
    anneal(5, 2, steps=4, callback=lambda step, steps, best: seen.append((step, steps, best)))
    assert [(step, steps) for step, steps, _ in seen] == [(1, 4), (2, 4), (3, 4), (4, 4)]
    bests = [best for _, _, best in seen]
    assert bests == sorted(bests, reverse=True)

    def stop(step, steps, best):
        raise KeyboardInterrupt

    refused(KeyboardInterrupt, "", anneal, 5, 2, steps=4, callback=stop)


def test_the_rate_falls_along_a_half_cosine_and_is_never_long_beside_the_spacing():
    rates = [learning_rate(step, 101, 0.02) for step in range(1, 102)]
    assert rates[0] == 0.02
    assert rates[50] == pytest.approx(0.010005)
    assert rates[100] == pytest.approx(1e-5)
    assert rates == sorted(rates, reverse=True)
    assert learning_rate(1, 1, 0.02) == 0.02
    assert first_rate(128, 10) == 0.02
    assert first_rate(1024, 2) == pytest.approx(1 / 32 / 5)


@pytest.mark.parametrize(("text", "n", "d", "noise"), [
    ("hickernell", 16, 3, 0.3), ("hickernell", 128, 10, 0.2), ("hickernell", 512, 10, 0.1),
    ("star", 128, 2, 0.1), ("star", 2048, 2, 0.05), ("riesz", 1024, 2, 0.1), ("star+riesz", 128, 10, 0.3),
])  # fmt: skip
def test_the_noise_follows_its_rule(text, n, d, noise):
    assert noise_over_rate(parse_objective(text), n, d) == pytest.approx(noise)


@pytest.mark.parametrize(("changes", "text"), [
    ({"n": 0}, "n must be an integer >= 1"), ({"d": 0}, "d must be an integer >= 1"),
    ({"n": 2.0}, "n must be an integer >= 1"), ({"steps": 0}, "steps must be an integer >= 1"),
    ({"rng": None}, "rng must be an int"),
    ({"n": 1, "objective": "riesz"}, "needs at least 2 points"),
])  # fmt: skip
def test_arguments_out_of_range_are_refused(changes, text):
    arguments = {"n": 4, "d": 2, "steps": 3, **changes}
    refused(InvalidValue, text, anneal, **arguments)
