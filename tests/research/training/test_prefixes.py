"""The objective over all prefixes beside a loop over them."""

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.points import draw
from evenroad.points.measures import MEASURES
from evenroad.research.network import NetworkConfig, train
from evenroad.research.training.objective import parse_objective
from evenroad.research.training.prefixes import PREFIXED, SHORTEST


def mean_log(name, points):
    lengths = range(min(SHORTEST, len(points)), len(points) + 1)
    logs = [np.log(MEASURES[name].rooted(points[:n])) for n in lengths]
    return np.average(logs, weights=[1 / n for n in lengths])


@pytest.mark.parametrize("name", PREFIXED)
@pytest.mark.parametrize(("n", "d"), [(1, 2), (5, 1), (8, 3), (40, 2), (33, 5)])
def test_it_is_the_mean_over_all_prefixes(name, n, d):
    points = np.random.default_rng(n).random((n, d))
    objective = parse_objective(f"prefixes({name})")
    assert objective.value(points) == pytest.approx(mean_log(name, points), rel=1e-9)


@pytest.mark.parametrize("name", PREFIXED)
def test_the_gradient_is_that_of_finite_differences(name):
    points = np.random.default_rng(3).random((21, 3))
    objective = parse_objective(f"prefixes({name})")
    gradient, step = objective.with_gradient(points)[1], 1e-6
    for place in np.ndindex(points.shape):
        moved = points.copy()
        moved[place] += step
        above = mean_log(name, moved)
        moved[place] -= 2 * step
        difference = (above - mean_log(name, moved)) / (2 * step)
        assert gradient[place] == pytest.approx(difference, rel=1e-4, abs=1e-7)


def test_its_text_parses_to_itself_and_other_measures_are_refused():
    objective = parse_objective("2 * prefixes( hickernell ) + log(star)")
    assert str(objective) == "2*prefixes(hickernell) + log(star)"
    assert parse_objective(str(objective)) == objective
    with pytest.raises(InvalidValue, match="hickernell or star"):
        parse_objective("prefixes(riesz)")


def test_a_network_makes_the_prefixes_of_sobol_points_better():
    made = train(NetworkConfig(64, 2, "prefixes(hickernell)", steps=400), rng=1)
    sobol = [mean_log("hickernell", draw("sobol", 64, 2, rng=seed).points) for seed in range(8)]
    assert made.value < np.mean(sobol) - 0.02
