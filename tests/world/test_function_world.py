"""FunctionWorld: the states it asks for, their order, how many calls, and answers that are none."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evenroad.errors import InvalidValue
from evenroad.space import SE2, SE3, BoxSpace, Circle, JointSpace, Product
from evenroad.testing import WorldContract
from evenroad.world import Explains, FunctionWorld
from evenroad.world.bisection import between_endpoints
from evenroad.world.protocol import ValidatesPaths
from tests.refused import refused

SQUARE = BoxSpace([0.0, 0.0], [1.0, 1.0])


def outside_a_disk(q):
    return np.hypot(q[:, 0] - 0.5, q[:, 1] - 0.5) > 0.3


class TestVectorisedFunction(WorldContract):
    world = FunctionWorld(SQUARE, outside_a_disk, 0.01)
    free_between = False


class TestFunctionOfOneConfiguration(WorldContract):
    world = FunctionWorld(SQUARE, lambda q: math.dist(q, (0.5, 0.5)) > 0.3, 0.01, vectorised=False)
    free_between = False


class TestFunctionOfPosesInThePlane(WorldContract):
    world = FunctionWorld(SE2([0, 0], [1, 1]), lambda q: np.cos(q[:, 2]) + q[:, 0] > 0.2, 0.03)
    free_between = False


class TestFunctionOfPosesInSpace(WorldContract):
    """Two resolutions, as the SE(3) puzzles have."""

    world = FunctionWorld(
        SE3([0, 0, 0], [1, 1, 1]), lambda q: np.abs(q[:, 3]) + q[:, 0] > 0.4, (0.02, 0.01 * math.pi / 2)
    )
    free_between = False


class Asked:
    """A function that calls everything free but what it is told, and remembers what it was asked."""

    def __init__(self, is_free=lambda q: np.ones(len(q), dtype=bool)):
        self.is_free, self.batches = is_free, []

    def __call__(self, q):
        self.batches.append(q.copy())
        return self.is_free(q)

    @property
    def states(self):
        return np.concatenate(self.batches)


def levels(n):
    return [state.tolist() for _, state in between_endpoints(np.array([n]), np.array([True]))]


@given(n=st.integers(1, 3000))
def test_each_state_between_the_ends_comes_once_and_every_level_halves_the_gaps(n):
    seen = [0, n]
    for level, states in enumerate(levels(n), start=1):
        seen += states
        assert np.diff(np.sort(seen)).max() <= math.ceil(n / 2**level)
    assert sorted(seen) == list(range(n + 1))
    assert levels(8) == [[4], [2, 6], [1, 3, 5, 7]]
    assert levels(5) == [[2], [1, 3], [4]]
    assert levels(1) == levels(0) == []


def test_a_motion_too_long_for_one_batch_is_handed_out_in_parts():
    batches = list(between_endpoints(np.array([300_000, 300_000]), np.array([True, True])))
    for motion in (0, 1):
        states = np.concatenate([state[owner == motion] for owner, state in batches])
        np.testing.assert_array_equal(np.sort(states), np.arange(1, 300_000))
    assert max(len(state) for _, state in batches) <= 65536


@pytest.mark.parametrize("length", [0.0, 0.05, 0.1, 0.101, 0.75])
def test_states_are_those_of_the_protocol(length):
    asked = Asked()
    world = FunctionWorld(BoxSpace([0.0], [1.0]), asked, 0.1, vectorised=True)
    assert world.motion_valid([[0.0]], [[length]])[0]
    n = max(1, math.ceil(length / 0.1))
    np.testing.assert_allclose(np.sort(asked.states[:, 0]), np.linspace(0.0, length, n + 1), atol=1e-15)


def test_neighbouring_states_are_at_most_the_resolution_apart_in_the_metric_of_the_space():
    space = JointSpace([-math.pi, 0.0], [math.pi, 5.0], wrapping=[True, False], weights=[1.0, 3.0])
    asked = Asked()
    a, b = np.array([[3.0, 1.0]]), np.array([[-2.0, 2.0]])
    FunctionWorld(space, asked, 0.07, vectorised=True).motion_valid(a, b)
    along = asked.states[np.argsort(asked.states[:, 1])]
    steps = space.distance(along[:-1], along[1:])
    assert len(steps) == math.ceil(space.distance(a, b)[0] / 0.07)
    np.testing.assert_allclose(steps, space.distance(a, b)[0] / len(steps))


def test_with_a_resolution_a_part_the_finer_division_counts():
    asked = Asked()
    space = Product([BoxSpace([0.0], [10.0]), Circle()])
    world = FunctionWorld(space, asked, [0.5, 0.1], vectorised=True)
    for b, n in (([4.0, 0.0], 8), ([4.0, 1.05], 11), ([0.0, 0.35], 4)):
        asked.batches.clear()
        world.motion_valid([[0.0, 0.0]], [b])
        assert len(asked.states) == n + 1


@pytest.mark.parametrize(("is_free", "b", "asked_for"), [
    (lambda q: np.abs(q[:, 0] - 0.5) > 0.01, (1.0, 0.0), 3),  # the middle, after both ends
    (lambda q: q[:, 0] > 0.5, (1.0, 0.0), 1),
    (lambda q: q[:, 0] < 0.5, (1.0, 0.0), 2),
])  # fmt: skip
def test_a_blocked_end_is_found_before_any_state_between_and_a_blocked_middle_next(is_free, b, asked_for):
    asked = Asked(is_free)
    assert not FunctionWorld(SQUARE, asked, 0.001, vectorised=True).motion_valid([[0.0, 0.0]], [b])[0]
    assert len(asked.states) == asked_for


def test_one_configuration_at_a_time_nothing_is_asked_after_the_first_blocked_state():
    asked = []

    def free(q):
        asked.append(q[0])
        return not 0.2 < q[0] < 0.3

    world = FunctionWorld(SQUARE, free, 1 / 64, vectorised=False)
    assert not world.motion_valid([[0.0, 0.0]], [[1.0, 0.0]])[0]
    assert asked == [0.0, 1.0, 0.5, 0.25]


def test_motions_of_a_batch_share_the_calls():
    rng = np.random.default_rng(0)
    asked = Asked(outside_a_disk)
    a, b = rng.random((500, 2)), rng.random((500, 2))
    FunctionWorld(SQUARE, asked, 0.01, vectorised=True).motion_valid(a, b)
    assert len(asked.batches) <= 2 + math.ceil(math.log2(math.sqrt(2) / 0.01))


def test_outside_the_space_nothing_is_free_and_the_function_is_not_asked():
    asked = Asked()
    world = FunctionWorld(SQUARE, asked, 0.1, vectorised=True)
    assert world.valid([[0.5, 0.5], [1.5, 0.5], [0.5, -1e9]]).tolist() == [True, False, False]
    assert asked.states.tolist() == [[0.5, 0.5]]
    assert not world.motion_valid([[0.5, 0.5]], [[0.5, 2.0]])[0]


def test_a_function_cannot_write_into_the_callers_configurations():
    def careless(q):
        q += 1.0
        return np.ones(len(q), dtype=bool)

    refused(ValueError, "read-only", lambda: FunctionWorld(SQUARE, careless, 0.1).valid(np.zeros((2, 2))))


@pytest.mark.parametrize(("answer", "vectorised"), [
    (lambda q: np.ones(len(q)), True),
    (lambda q: np.ones(len(q), dtype=int), True),
    (lambda q: np.ones((len(q), 1), dtype=bool), True),
    (lambda q: np.ones(len(q) + 1, dtype=bool), True),
    (lambda q: None, True),
    *((lambda q, answer=answer: answer, False) for answer in (1, None, np.array([True]), "free")),
])  # fmt: skip
def test_an_answer_that_is_none_is_refused_and_the_function_named(answer, vectorised):
    def my_checker(q):
        return answer(q)

    wanted = r"a bool array of shape \(2,\)" if vectorised else "a bool for one"
    with pytest.raises(InvalidValue, match=f"my_checker must return {wanted}"):
        FunctionWorld(SQUARE, my_checker, 0.1, vectorised=None if vectorised else False).valid([[0.1, 0.2], [0.3, 0.4]])


def test_errors_of_the_function_itself_come_through():
    def broken(q):
        raise ZeroDivisionError

    refused(ZeroDivisionError, "", lambda: FunctionWorld(SQUARE, broken, 0.1).valid([[0.1, 0.2]]))


def test_why_a_configuration_is_not_free_is_said():
    world = FunctionWorld(SQUARE, outside_a_disk, 0.1)
    assert isinstance(world, Explains)
    assert "bounds" in world.explain(np.array([2.0, 0.0]))
    assert "outside_a_disk" in world.explain(np.array([0.5, 0.5]))


@pytest.mark.parametrize(("space", "extent"), [
    (BoxSpace((-1, -2), (2, 2)), 5.0), (Circle(), np.pi), (SE2((-5, -5), (5, 5)), math.sqrt(200 + np.pi**2)),
    (SE3((0, 0, 0), (1, 1, 1)), math.sqrt(3) + np.pi / 2),
])  # fmt: skip
def test_without_a_resolution_a_hundredth_of_the_extent_is_taken(space, extent):
    resolution = FunctionWorld(space, lambda q: np.ones(len(q), dtype=bool)).resolution
    assert 0.9 * extent <= 100 * resolution <= extent


PLANE = SE2([0, 0], [1, 1])


@pytest.mark.parametrize(("space", "function", "resolution", "text"), [
    *(
        (SQUARE, outside_a_disk, resolution, "resolution")
        for resolution in (0.0, -1.0, math.nan, math.inf, "fine", [0.1], (0.1, 0.1))
    ),
    *(
        (PLANE, outside_a_disk, resolution, "resolution")
        for resolution in (np.array(0.1), [0.1], [0.1, 0.0], [0.1, 0.1, 0.1], ["a", "b"])
    ),
    (SQUARE, np.ones(3), 0.1, "is_valid"),
    *((space, np.isfinite, 0.1, ".") for space in ("abc", 3, [(0, 1, 2)], None, [(1, 0)])),
])  # fmt: skip
def test_what_is_no_space_no_function_or_no_resolution_is_refused(space, function, resolution, text):
    refused(InvalidValue, text, FunctionWorld, space, function, resolution)


def test_a_resolution_far_too_small_is_an_error_and_no_endless_wait():
    world = FunctionWorld(SQUARE, outside_a_disk, 1e-12)
    refused(InvalidValue, "resolution must be larger", world.motion_valid, [[0.0, 0.0]], [[0.0, 1.0]])


def test_the_strict_check_of_a_path_asks_for_states_twenty_times_as_dense():
    asked = Asked()
    world = FunctionWorld(BoxSpace([0.0], [10.0]), asked, 1.0, vectorised=True)
    path = np.array([[0.0], [3.0], [3.0], [5.0]])
    assert world.motion_valid(path[:-1], path[1:]).all()
    asked.batches.clear()
    assert world.validate(path).all()
    states = np.unique(np.round(np.concatenate(asked.batches), 9))
    np.testing.assert_allclose(np.diff(states), 0.05)
    assert (states[0], states[-1]) == (0.0, 5.0)


def test_a_wall_between_two_states_is_found_by_the_strict_check_alone():
    world = FunctionWorld(SQUARE, lambda q: np.abs(q[:, 0] - 0.55) > 0.02, 0.1)
    path = np.array([[0.0, 0.5], [1.0, 0.5], [1.0, 0.1], [1.5, 0.1]])
    assert world.motion_valid(path[:-1], path[1:]).tolist() == [True, True, False]
    assert world.validate(path).tolist() == [False, True, False]
    assert world.validate(path[:1]).shape == (0,)
    assert (world.proof, isinstance(world, ValidatesPaths)) == ("resolution", True)


ONE_AT_A_TIME = {
    "unpacks": lambda q: bool(sum(x * x for x in q) > 0.25),
    "a scalar of all": lambda q: np.linalg.norm(q) > 0.5,
    "compares coordinates": lambda q: q[0] > q[1],
    "plain comparison": lambda q: (q > 0.25).all(),
    "a chain of words": lambda q: q[0] > 0.5 or q[1] < 0.0,
}


@pytest.mark.parametrize("name", ONE_AT_A_TIME)
@pytest.mark.parametrize("d", [2, 3])
def test_a_function_of_one_configuration_needs_no_flag(name, d):
    function, space = ONE_AT_A_TIME[name], BoxSpace([-1.0] * d, [1.0] * d)
    told = FunctionWorld(space, lambda q: bool(function(q)), 0.05, vectorised=False)
    for n in (1, d, d + 1, 40):
        q = np.random.default_rng(n).uniform(-1, 1, (n, d))
        world = FunctionWorld(space, function, 0.05)
        expected = [bool(function(row)) for row in q]
        assert world.valid(q).tolist() == told.valid(q).tolist() == expected
        assert np.array_equal(world.motion_valid(q, q[::-1]), told.motion_valid(q, q[::-1]))
        assert [world.valid(row) for row in q] == expected
    assert "one configuration at a time" in repr(world)
    assert "once per batch" in world.explain(np.full(d, -0.01))


def test_a_function_that_takes_both_is_asked_about_many():
    calls = []

    def free(q):
        calls.append(np.shape(q))
        return np.hypot(q[..., 0], q[..., 1]) > 0.5

    world = FunctionWorld([(-1, 1), (-1, 1)], free, 0.05)
    assert world.valid(np.eye(2)).all()
    assert calls == [(3, 2), (2, 2)]
    assert "one configuration" not in repr(world)
    assert world.valid((1, 0)) is True
    assert world.motion_valid((-1, 0), (1, 0)) is False
