import json
from dataclasses import asdict

import numpy as np
import pytest

from evenroad.errors import InvalidValue, UnknownName
from evenroad.research.network import NetworkConfig


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("n", 1),
        ("n", 2.0),
        ("d", 0),
        ("sets", 0),
        ("width", 0),
        ("layers", 0),
        ("k", 0),
        ("radius", 0.0),
        ("radius", float("nan")),
        ("steps", 0),
        ("rate", 0.0),
        ("rate", float("inf")),
        ("weight_decay", -1e-6),
        ("micro_batch", 0),
        ("patience", 0),
        ("seed", -1),
        ("seed", True),
    ],
)
def test_a_value_out_of_range_is_refused_by_name(name, value):
    with pytest.raises(InvalidValue, match=f"{name} must be .*, got"):
        NetworkConfig(**{"n": 16, "d": 2, name: value})


def test_an_objective_that_does_not_parse_is_refused_with_the_place():
    with pytest.raises(UnknownName, match="column 4.*'nonsense'"):
        NetworkConfig(16, 2, objective="2 *nonsense")


def test_two_spellings_of_an_objective_are_the_same_config():
    assert NetworkConfig(16, 2, "hickernell+10*riesz") == NetworkConfig(
        16, 2, "log(hickernell) + 10*log(riesz)"
    )


def test_a_config_survives_json():
    config = NetworkConfig(16, 2, "star", radius=0.35, patience=None)
    assert NetworkConfig(**json.loads(json.dumps(asdict(config)))) == config


def test_numbers_of_numpy_are_kept_as_plain_ones():
    config = NetworkConfig(np.int64(16), np.int32(2), rate=np.float32(0.5), radius=1)
    assert json.loads(json.dumps(asdict(config))) == asdict(NetworkConfig(16, 2, rate=0.5, radius=1.0))


@pytest.mark.parametrize(
    ("n", "sets", "expected"), [(16, 16, 16), (1024, 16, 4), (10_000, 16, 1), (1024, 2, 2)]
)
def test_micro_batches_bound_the_points_in_memory(n, sets, expected):
    assert NetworkConfig(n, 2, sets=sets).sets_at_once == expected


def test_a_micro_batch_that_is_asked_for_is_taken():
    assert NetworkConfig(1024, 2, sets=16, micro_batch=7).sets_at_once == 7
