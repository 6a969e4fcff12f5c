"""The kinematic chain: the contract, crossings in plain sight and by the definition, motions state by state."""

import math

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.testing import WorldContract
from evenroad.world import FunctionWorld
from evenroad_studies.worlds.chain import ChainWorld, horn
from tests.threads import together

TEN = ChainWorld()
TOUCHING = 1.1920929e-07


def segments_of(q):
    """The links, and the piece at the end, as pairs of end points."""
    heading, place, segments = 0.0, (0.0, 0.0), []
    for angle in q:
        heading += angle
        far = (place[0] + math.cos(heading) / len(q), place[1] + math.sin(heading) / len(q))
        segments.append((place, far))
        place = far
    segments.append((place, (place[0] + 0.001 * math.cos(heading), place[1] + 0.001 * math.sin(heading))))
    return segments


def horn_segments(links):
    """The walls again, from the definition."""
    eps, walls = math.log(10) / links, []
    for s in (1, -1):
        place = (1 / links, -s * eps)
        for i in range(1, links):
            length, heading = (1 / links) * (1 + s * math.pi * eps), i * math.pi / links
            far = (place[0] + length * math.cos(heading), place[1] + length * math.sin(heading))
            walls.append((place, far))
            place = far
    return walls


def side(p, q, r):
    """Twice the area of the triangle p q r, > 0 if r lies to the left of the way from p to q."""
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])


def cross(first, second):
    """Whether both ends of each segment lie on different sides of the other, clearly."""
    (a, b), (c, d) = first, second
    sides = side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b)
    if min(map(abs, sides)) < TOUCHING:
        return False
    return (sides[0] > 0) != (sides[1] > 0) and (sides[2] > 0) != (sides[3] > 0)


def is_free(q):
    links, walls = segments_of(q), horn_segments(len(q))
    for i in range(len(links)):
        for j in range(i):
            if cross(links[i], links[j]):
                return False
        for wall in walls:
            if cross(links[i], wall):
                return False
    return True


class TestChainOfTen(WorldContract):
    world = TEN
    free_between = False


@pytest.mark.parametrize("links", [2, 3, 6, 10])
def test_a_chain_is_free_iff_nothing_crosses(links):
    world = ChainWorld(links)
    q = world.space.from_cube(np.random.default_rng(links).random((1500, links)))
    free = world.valid(q)
    np.testing.assert_array_equal(free, [is_free(row) for row in q])
    assert 0 < free.sum() < len(q)


def test_the_free_share_is_the_published_one():
    n = 100_000
    share = TEN.valid(TEN.space.from_cube(np.random.default_rng(0).random((n, 10)))).mean()
    assert abs(share - 0.2144) < 4 * math.sqrt(0.2144 * 0.7856 / n)


def test_start_and_goal_are_free_and_not_joined_by_one_motion():
    ends = np.stack([TEN.start, TEN.goal])
    assert TEN.valid(ends).all()
    assert not TEN.motion_valid(ends[:1], ends[1:]).any()


def test_a_chain_that_touches_itself_is_free_and_one_that_winds_up_crosses_itself():
    stretched, folded = np.zeros((1, 4)), np.array([[math.pi / 2, math.pi, 0.0, 0.0]])
    closed = np.array([[math.pi / 2, math.pi / 2, math.pi / 2, math.pi / 2]])
    world = ChainWorld(4)
    for q in (stretched, folded, closed):
        assert world.valid(q + np.array([math.pi, 0, 0, 0])).all()
    spiral = np.array([math.pi / 2, 2.0, 2.0, 2.0, 2.0])
    assert not ChainWorld(5).valid(spiral[np.newaxis])[0]
    assert "two links" in ChainWorld(5).explain(spiral)


def test_the_explanation_tells_crossed_links_from_crossed_walls():
    q = TEN.space.from_cube(np.random.default_rng(1).random((300, 10)))
    reasons = {TEN.explain(row) for row in q[~TEN.valid(q)]}
    assert reasons == {"two links of the chain cross", "a link crosses the horn"}


def test_the_horn_is_that_of_the_definition():
    x, y, dx, dy = horn(10)
    walls = np.array(horn_segments(10)).reshape(-1, 4)
    np.testing.assert_allclose(np.stack([x, y, x + dx, y + dy], axis=1), walls, atol=1e-15)
    assert walls.shape == (18, 4)


def test_motions_get_the_verdict_of_their_states_one_by_one():
    assert TEN.resolution == pytest.approx(0.1987, abs=5e-5)
    state_by_state = FunctionWorld(TEN.space, TEN.valid, TEN.resolution)
    q = TEN.space.from_cube(np.random.default_rng(2).random((40_000, 10)))
    q = q[TEN.valid(q)]
    a, b = q[:2000], q[2000:4000]
    b = TEN.space.interpolate(a, b, np.random.default_rng(3).random(2000))
    verdicts = TEN.motion_valid(a, b)
    np.testing.assert_array_equal(verdicts, state_by_state.motion_valid(a, b))
    assert 0 < verdicts.sum() < (TEN.valid(a) & TEN.valid(b)).sum()


def test_angles_may_be_given_with_full_turns():
    q = TEN.space.from_cube(np.random.default_rng(4).random((2000, 10)))
    a, b = q[:1000], TEN.space.interpolate(q[:1000], q[1000:], 0.1)
    np.testing.assert_array_equal(TEN.motion_valid(a + 2 * math.pi, b), TEN.motion_valid(a, b))


def test_chains_that_are_none_are_refused():
    for wrong in (0, 1, 10.0, 10**6):
        with pytest.raises(InvalidValue, match="links"):
            ChainWorld(wrong)


def test_threads_give_the_verdicts_of_one():
    q = np.random.default_rng(3).uniform(-math.pi, math.pi, (64, 10))
    asked = [lambda i=i: TEN.motion_valid(q[i : i + 8], q[i + 8 : i + 16]).tolist() for i in range(0, 48, 8)]
    alone = [ask() for ask in asked]
    assert all(each == alone for each in together(*asked))
