"""Scenes of a mapping that holds primitives alone, which compiled code reads, beside the same as a list."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import evenroad as er
from evenroad.errors import EvenroadError

LENGTHS = st.one_of(st.integers(1, 3), st.floats(1e-3, 2.0))
NUMBERS = st.one_of(st.integers(-3, 3), st.floats(-4.0, 4.0))
ROWS = st.lists(NUMBERS, min_size=3, max_size=3).flatmap(lambda row: st.sampled_from([row, tuple(row)]))
TURNS = st.lists(NUMBERS, min_size=4, max_size=4).filter(any)


@st.composite
def entries(draw):
    shape = draw(st.sampled_from(["box", "sphere", "cylinder", "capsule"]))
    entry = {"shape": shape}
    if shape == "box":
        entry["size"] = draw(st.lists(LENGTHS, min_size=3, max_size=3))
    else:
        entry["radius"] = draw(LENGTHS)
    if shape in ("cylinder", "capsule"):
        entry["length"] = draw(LENGTHS)
    if draw(st.booleans()):
        entry["xyz"] = draw(ROWS)
    turned = draw(st.sampled_from(["", "rpy", "xyzw"]))
    if turned:
        entry[turned] = draw(ROWS if turned == "rpy" else TURNS)
    return entry


def as_list(mapping):
    """The same obstacles one by one, which Python reads."""
    return [{"name": name, **entry} for name, entry in mapping.items()]


@settings(max_examples=60, deadline=None)
@given(st.lists(entries(), max_size=4))
def test_a_mapping_and_a_list_of_the_same_obstacles_are_the_same_scene_to_the_last_bit(listed):
    mapping = {f"o{i}": entry for i, entry in enumerate(listed)}
    quick, slow = er.Scene({"obstacles": mapping}), er.Scene({"obstacles": as_list(mapping)})
    assert quick.names == slow.names
    assert quick.rows.tobytes() == slow.rows.tobytes()
    assert quick == slow
    assert quick.fingerprint() == slow.fingerprint()


WRONG = [
    {"shape": "box", "size": [0.1, 0.1]},
    {"shape": "box", "size": [0.1, 0.1, 0.0]},
    {"shape": "box", "size": [0.1, 0.1, True]},
    {"shape": "box", "size": [0.1, 0.1, 1e10]},
    {"shape": "sphere", "radius": -1},
    {"shape": "sphere", "radius": 10**400},
    {"shape": "sphere", "radius": math.nan},
    {"shape": "sphere", "radius": "0.1"},
    {"shape": "sphere", "radius": 0.1, "colour": "red"},
    {"shape": "sphere", "radius": 0.1, "xyz": [0, 0, math.inf]},
    {"shape": "sphere", "radius": 0.1, "xyz": [0, 0, 2e9]},
    {"shape": "cylinder", "radius": 0.1},
    {"shape": "cylinder", "radius": 0.1, "length": 1, "rpy": [0, 0, 1], "xyzw": [0, 0, 0, 1]},
    {"shape": "cylinder", "radius": 0.1, "length": 1, "xyzw": [0, 0, 0, 0]},
    {"shape": "cone", "radius": 0.1},
    {"radius": 0.1},
    "sphere",
]


@pytest.mark.parametrize("entry", WRONG, ids=str)
def test_what_is_no_primitive_is_refused_by_its_name(entry):
    with pytest.raises(EvenroadError, match=r"bad|1e\+09"):
        er.Scene({"obstacles": {"good": {"shape": "sphere", "radius": 1}, "bad": entry}})


def test_what_compiled_code_does_not_know_is_read_by_python():
    mapping = {
        "table": {"shape": "box", "size": [1, 1, 0.1], "cell": True, "clearance": 0.01},
        "ball": {"sphere": 0.1, "xyz": np.array([0.0, 0.0, 1.0])},
    }
    scene = er.Scene({"obstacles": mapping, "allowed": {"table": ["base_link"]}})
    assert scene.obstacles[0].cell
    assert scene.obstacles[0].clearance == 0.01
    assert scene.obstacles[1].xyz == (0.0, 0.0, 1.0)
    assert scene.allowed == {("base_link", "table")}
