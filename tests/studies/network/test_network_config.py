import json
from dataclasses import asdict

import numpy as np
import pytest

from evenroad.errors import InvalidValue, UnknownName
from evenroad_studies.network import NetworkConfig
from tests.refused import refused


@pytest.mark.parametrize(("name", "value"), [
    ("n", 1), ("n", 2.0), ("d", 0), ("width", 0), ("layers", 0), ("k", True), ("steps", 0), ("rate", 0.0),
    ("rate", float("inf")), ("noise", -1e-6), ("noise", float("nan")),
])  # fmt: skip
def test_a_value_out_of_range_is_refused_by_name(name, value):
    refused(InvalidValue, f"{name} must be .*, got", NetworkConfig, **{"n": 16, "d": 2, name: value})


def test_names_that_nobody_knows_and_a_judge_out_of_the_plane_are_refused():
    refused(UnknownName, "column 4.*'nonsense'", NetworkConfig, 16, 2, objective="2 *nonsense")
    refused(UnknownName, "start.*'grid'.*sobol", NetworkConfig, 16, 2, start="grid")
    refused(UnknownName, "judge.*'me'.*star", NetworkConfig, 16, 2, judge="me")
    refused(InvalidValue, "in d = 2 alone, not in d = 3", NetworkConfig, 16, 3, judge="star")


def test_the_start_is_kronecker_in_the_plane_but_for_prefixes_unless_it_is_asked_for():
    assert {NetworkConfig(16, 2).start, NetworkConfig(16, 2, "star").start} == {"kronecker"}
    assert NetworkConfig(16, 2, "star", start="sobol").start == "sobol"
    assert NetworkConfig(16, 2, "prefixes(hickernell)").start == "sobol"
    assert {NetworkConfig(16, 3, "star").start, NetworkConfig(16, 1).start} == {"sobol"}


def test_a_config_survives_json_and_another_spelling_of_its_objective():
    assert NetworkConfig(16, 2, "hickernell+10*riesz") == NetworkConfig(16, 2, "log(hickernell) + 10*log(riesz)")
    config = NetworkConfig(np.int64(16), np.int32(2), "star", rate=np.float32(0.5), noise=1)
    assert NetworkConfig(**json.loads(json.dumps(asdict(config)))) == config


def test_noise_is_taken_as_asked_or_chosen_by_the_dimension():
    assert NetworkConfig(16, 10, noise=0.2).drift == 0.2
    assert NetworkConfig(16, 2).drift == 0.0 < NetworkConfig(16, 10).drift
