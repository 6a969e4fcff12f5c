"""The objective over all prefixes: relative to Sobol's points, and what it makes of them."""

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.points import draw
from evenroad_studies.network import NetworkConfig, train
from evenroad_studies.prefixes import rooted_prefixes
from evenroad_studies.training.objective import parse_objective


def test_it_is_near_nothing_for_sobol_points_and_grows_with_the_worst_prefix():
    objective = parse_objective("prefixes(hickernell)")
    sobol = [objective.value(draw("sobol", 64, 2, rng=seed).points) for seed in range(8)]
    assert 0.0 < np.mean(sobol) < 0.15
    bad = draw("sobol", 64, 2, rng=0).points.copy()
    bad[:16] *= 0.5
    assert objective.value(bad) > max(sobol) + 0.2


def test_its_text_parses_to_itself_and_other_measures_are_refused():
    objective = parse_objective("2 * prefixes( hickernell ) + log(star)")
    assert str(objective) == "2*prefixes(hickernell) + log(star)"
    assert parse_objective(str(objective)) == objective
    with pytest.raises(InvalidValue, match="hickernell or star"):
        parse_objective("prefixes(riesz)")


def test_a_network_makes_the_prefixes_of_sobol_points_better():
    made = train(NetworkConfig(64, 2, "prefixes(hickernell)", steps=400), rng=1)
    sobol = np.mean([np.log(rooted_prefixes(draw("sobol", 64, 2, rng=seed))) for seed in range(8)], axis=0)
    assert np.mean((np.log(rooted_prefixes(made.points)) - sobol)[15:]) < -0.02
