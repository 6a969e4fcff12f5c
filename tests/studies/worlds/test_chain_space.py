"""ChainSpace: the contract, and the distance joint by joint."""

import math

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.testing import SpaceContract
from evenroad_studies.worlds.chain import ChainSpace


def joints_of(q):
    """The places of the far ends of all links, one after the other."""
    heading, x, y, places = 0.0, 0.0, 0.0, []
    for angle in q:
        heading += angle
        x, y = x + math.cos(heading) / len(q), y + math.sin(heading) / len(q)
        places.append((x, y))
    return places


class TestChainOfTen(SpaceContract):
    space = ChainSpace(10)
    measure_is_the_metrics = False

    def test_interpolation_covers_the_distance_evenly(self):
        pytest.skip("angles turn evenly, joints in the plane do not")


@pytest.mark.parametrize("links", [1, 2, 3, 10])
def test_the_distance_is_how_far_all_joints_are_apart(links):
    space = ChainSpace(links)
    a, b = space.from_cube(np.random.default_rng(links).random((100, links))).reshape(2, 50, links)
    apart = [
        sum(math.dist(p, r) for p, r in zip(joints_of(x), joints_of(y), strict=True)) for x, y in zip(a, b, strict=True)
    ]
    np.testing.assert_allclose(space.distance(a, b), apart, rtol=1e-12)


def test_every_joint_turns_the_short_way_and_the_distance_knows_no_full_turns():
    space = ChainSpace(4)
    a, b = space.from_cube(np.random.default_rng(0).random((40, 4))).reshape(2, 20, 4)
    np.testing.assert_allclose(space.distance(a + 2 * math.pi, b), space.distance(a, b), rtol=1e-9)
    space = ChainSpace(2)
    middle = space.interpolate([[3.0, 1.0]], [[-3.0, 0.0]], 0.5)
    np.testing.assert_allclose(space.distance(middle, [[math.pi, 0.5]]), 0.0, atol=1e-12)
    assert space.wrapped([[4.0, -4.0]])[0] == pytest.approx([4.0 - 2 * math.pi, 2 * math.pi - 4.0])


def test_the_first_joint_counts_more_than_the_last():
    space, turn = ChainSpace(10), np.eye(10) * 0.3
    away = space.distance(np.zeros((10, 10)), turn)
    assert (np.diff(away) < 0).all()
    # The last joint moves the end alone, along a chord of a circle of radius 1 / 10.
    assert away[-1] == pytest.approx(0.1 * 2 * math.sin(0.15))


def test_a_chain_without_links_is_refused():
    for wrong in (0, -1, 2.0, True):
        with pytest.raises(InvalidValue, match="joints"):
            ChainSpace(wrong)
