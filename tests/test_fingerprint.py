from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
import pytest

from evenroad._fingerprint import Fingerprinted, fingerprint_of
from evenroad.collision.certified import CertifiedWorld
from evenroad.errors import NotAvailable
from evenroad.robot import ArmWorld, load_robot, load_scene
from evenroad.space import SE2, SE3, BoxSpace, Circle, JointSpace, Rectangle
from evenroad.world import FunctionWorld, GridMap
from tests.counting import Counting
from tests.refused import refused


class Colour(Enum):
    RED = 1
    BLUE = 2


@dataclass(frozen=True)
class Pair:
    a: object
    b: object = None


@dataclass(frozen=True)
class Other:
    a: object
    b: object = None


DIFFERENT = [
    1, 1.0, "1", b"1", True, None, 0.0, -0.0, Colour.RED, Colour.BLUE, (), (1,), ((1,),), (1, 2), (2, 1), {1, 2},
    {1: 2}, {2: 1}, Pair(1), Pair(1, 2), Pair(2, 1), Other(1), Pair("a", "b"), Pair("ab", ""),
    np.zeros(2), np.zeros((1, 2)), np.ones(2), np.zeros(2, dtype=np.float32),
    BoxSpace((0,), (1,)), BoxSpace((0,), (2,)), BoxSpace((0,), (1,), weights=(2,)), Circle(),
    SE2((0, 0), (1, 1)), SE2((0, 0), (1, 2)), SE2((0, 0), (1, 1), combine="sum"), SE3((0, 0, 0), (1, 1, 1)),
    JointSpace((0,), (1,)), JointSpace((0,), (1,), wrapping=True), Rectangle((0, 0), (1, 0), (0, 1)),
]  # fmt: skip


def test_equal_values_have_one_fingerprint_and_different_ones_differ():
    assert len({fingerprint_of(value) for value in DIFFERENT}) == len(DIFFERENT)
    assert fingerprint_of(SE2((0, 0), (1, 1))) == fingerprint_of(SE2([0.0, 0.0], [1.0, 1.0]))
    assert fingerprint_of({1: 2, 3: 4}, {5, 6}) == fingerprint_of({3: 4, 1: 2}, {6, 5})
    assert fingerprint_of([1, 2], np.float64(3)) == fingerprint_of((1, 2), 3.0)
    assert fingerprint_of(1, 2) != fingerprint_of((1, 2))


def test_a_fingerprint_is_the_same_in_any_process():
    assert fingerprint_of("a", 1, 2.5, (None, True), {"b", "c"}).startswith("7c9d3d65751e")


@pytest.mark.parametrize("value", [len, object(), Pair(lambda: 0), np.array([object()])])
def test_what_cannot_be_known_again_has_none(value):
    refused(NotAvailable, "no fingerprint", fingerprint_of, value)


def _free(q):
    return np.ones(len(q), dtype=bool)


def test_a_function_has_a_fingerprint_by_the_name_that_its_user_gives():
    space = SE2((0, 0), (1, 1))
    one = FunctionWorld(space, _free, 0.1, name="cell 7")
    assert one.fingerprint() == FunctionWorld(SE2((0, 0), (1, 1)), lambda q: _free(q), 0.1, name="cell 7").fingerprint()
    others = [
        FunctionWorld(space, _free, 0.1, name="cell 8"),
        FunctionWorld(space, _free, 0.2, name="cell 7"),
        FunctionWorld(SE2((0, 0), (1, 2)), _free, 0.1, name="cell 7"),
    ]
    singly = FunctionWorld(space, lambda q: True, 0.1, vectorised=False, name="cell 7")
    assert singly.fingerprint() == one.fingerprint()
    assert len({world.fingerprint() for world in (one, *others)}) == 4
    refused(NotAvailable, "only with a name", lambda: FunctionWorld(space, _free, 0.1).fingerprint())


def test_an_arm_whose_motions_are_proved_is_another_world_than_the_arm():
    arm = ArmWorld(load_robot("ur5"), load_scene("box-reach"))
    worlds = [arm, CertifiedWorld(arm), CertifiedWorld(arm, 1e-3), CertifiedWorld(replace(arm, resolution=0.1))]
    assert len({world.fingerprint() for world in worlds}) == 4
    assert CertifiedWorld(replace(arm)).fingerprint() == worlds[1].fingerprint()


def test_a_counting_world_has_the_fingerprint_of_its_own_world_or_none():
    disk = GridMap(np.zeros((3, 3), dtype=bool)).world(0.5)
    assert Counting(disk).fingerprint() == disk.fingerprint()
    assert isinstance(Counting(disk), Fingerprinted)
    silent = type("Silent", (), {"space": disk.space})()
    assert not isinstance(Counting(silent), Fingerprinted)
