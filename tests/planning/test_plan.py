import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import InvalidValue
from evenroad.planning import Status
from evenroad.planning.shortcut import shortcut
from evenroad.points import PointSet, draw
from evenroad.roadmap import KNearest, Radius
from evenroad.space import BoxSpace
from evenroad.space.path import path_length
from evenroad.world import FunctionWorld, GridMap
from tests.plan_on import plan_on


def _map(*rows):
    return GridMap(np.array([[cell == "#" for cell in row] for row in rows]))


OPEN = _map(*["." * 20] * 20)
WALL = _map(*(["." * 20] * 9 + ["#" * 20] + ["." * 20] * 10))
GAP = _map(*(["." * 20] * 9 + ["#" * 14 + "." * 6] + ["." * 20] * 10))


def test_an_open_map_is_solved_by_a_straight_line():
    result = plan_on(OPEN.world(1.0), (2, 2), (18, 18), draw("halton", 50, 2))
    assert result.status is Status.SOLVED
    np.testing.assert_array_equal(result.path, [[2, 2], [18, 18]])
    assert result.cost == pytest.approx(16 * np.sqrt(2))


def test_no_way_around_a_wall_is_an_answer_with_its_reason():
    result = plan_on(WALL.world(0.5), (2, 2), (18, 18), draw("halton", 64, 2))
    assert result.status is Status.NOT_CONNECTED
    assert not result.solved
    assert result.path is None
    assert result.counts["start_component"] + result.counts["goal_component"] <= result.counts["valid"]
    assert f"start reaches {result.counts['start_component']}" in result.message
    assert "try n=128 or a larger k" in result.message
    by_radius = plan_on(WALL.world(0.5), (2, 2), (18, 18), draw("halton", 64, 2), rule=Radius(4.0))
    assert "or a larger radius" in by_radius.message


def test_few_neighbours_on_a_lattice_are_named_as_a_cause():
    def message(family, n, d, k, *sides):
        space = BoxSpace([0.0] * d, sides or [1.0] * d)
        end = np.array(sides or [1.0] * d)
        wall = FunctionWorld(space, lambda q: np.abs(q[:, 0] / end[0] - 0.5) > 0.2, resolution=0.02 * end.max())
        points = draw(family, n, d, rng=4)
        return plan_on(wall, 0.1 * end, 0.9 * end, points, rule=KNearest(k)).message

    # The six nearest of this lattice of 128 points lie in a plane, the ten nearest of 96 in five dimensions in three.
    assert "the nearest 6 of this lattice leave directions out, 7 would not" in message("korobov", 128, 3, 6)
    assert "the nearest 10 of this lattice leave directions out, 21 would not" in message("korobov", 96, 5, 10)
    assert "the nearest 4 of this lattice leave directions out" in message("korobov", 128, 7, 4)
    # One of two opposite neighbours is enough.
    assert "directions" in message("even", 64, 2, 2)
    assert "directions" not in message("even", 64, 2, 3)
    # Where one side is long, the nearest lie along the other; where it is so long that they lie outside, who knows.
    assert "directions" not in message("even", 100, 2, 4)
    assert "the nearest 4 of this lattice leave directions out, 9 would not" in message("even", 100, 2, 4, 1, 8)
    assert "directions" not in message("even", 100, 2, 4, 1, 1000)
    # Many stretched axes: the lattice's short vectors are too many to look at.
    assert "directions" not in message("korobov", 128, 5, 4, 1000, 1000, 1, 1, 1)
    assert "directions" not in message("korobov", 64, 5, 4, 5000, 3, 3, 3, 3)
    # Axes in an order that the origin does not tell, and that counts: only a bound is known.
    assert "leave directions out, at least 11 are needed" in message("even", 128, 6, 4, 1, 1, 1, 1, 1, 1.2)
    # Of A_d* all nearest are equally near, and others have no pairs.
    for family in ("halton", "lattice"):
        assert "directions" not in message(family, 64, 3, 3)


@pytest.mark.parametrize(("start", "goal", "status"), [
    ((2, 9.5), (18, 18), Status.START_INVALID), ((2, 2), (18, 9.5), Status.GOAL_INVALID),
    ((0.5, 2), (18, 18), Status.START_INVALID), ((2, 9.5), (18, 9.5), Status.START_INVALID),
])  # fmt: skip
def test_an_end_in_collision_is_an_answer_and_nothing_is_searched(start, goal, status):
    result = plan_on(WALL.world(1.0), start, goal, draw("halton", 64, 2))
    assert result.status is status
    assert result.path is None
    assert result.roadmap is None
    assert str(status).split("_")[0] in result.message


def test_an_end_in_collision_says_with_what_and_by_how_much():
    touching = plan_on(WALL.world(1.0), (2, 8.5), (18, 18), draw("halton", 64, 2))
    assert touching.message == (
        "the start is in collision: the obstacle at (2, 9) is 0.5 away, the disk needs 1; the nearest free position is"
        " (2, 8)"
    )
    inside = plan_on(WALL.world(1.0), (2, 2), (18, 9.5), draw("halton", 64, 2))
    assert inside.message == (
        "the goal is in collision: its centre lies in an obstacle; the nearest free position is (18, 8)"
    )


def test_a_world_that_cannot_explain_itself_is_planned_in_all_the_same():
    class Silent:
        space = WALL.space

        def valid(self, q):
            return q[:, 0] > 5

        def motion_valid(self, a, b):
            return self.valid(a) & self.valid(b)

    assert plan_on(Silent(), (2, 8), (18, 18), draw("halton", 64, 2)).message == "the start is in collision"
    assert plan_on(Silent(), (6, 8), (18, 18), draw("halton", 64, 2)).solved


def test_the_path_begins_at_the_start_and_ends_at_the_goal_and_every_motion_is_free():
    world = GAP.world(1.0)
    result = plan_on(world, (2, 2), (2, 18), draw("halton", 200, 2))
    for path in (result.path, result.milestone_path):
        np.testing.assert_array_equal(path[[0, -1]], [[2, 2], [2, 18]])
        assert world.motion_valid(path[:-1], path[1:]).all()
    assert result.cost <= result.milestone_cost
    assert result.cost == pytest.approx(path_length(result.path, world.space))
    assert result.milestone_cost == pytest.approx(path_length(result.milestone_path, world.space))


def test_without_shortcut_the_path_is_the_milestone_path():
    result = plan_on(GAP.world(1.0), (2, 2), (2, 18), draw("halton", 200, 2), smooth=False)
    np.testing.assert_array_equal(result.path, result.milestone_path)
    assert "shortcut" not in result.timings


def test_no_points_and_an_equal_start_and_goal_are_no_special_cases():
    empty = PointSet(np.empty((0, 2)))
    assert plan_on(OPEN.world(1.0), (2, 2), (18, 18), empty).solved
    assert plan_on(GAP.world(1.0), (2, 2), (2, 18), empty).status is Status.NOT_CONNECTED
    same = plan_on(OPEN.world(1.0), (5, 5), (5, 5), draw("halton", 10, 2), rule=Radius(6.0))
    assert (same.solved, same.cost, same.rule) == (True, 0.0, "radius=6")


@pytest.mark.parametrize("bad", [(1, 2, 3), (np.nan, 1), "ab", 5.0])
def test_a_query_of_the_wrong_kind_is_refused_by_name(bad):
    with pytest.raises(InvalidValue, match="start must be 2 finite numbers"):
        plan_on(OPEN.world(1.0), bad, (1, 1), draw("halton", 10, 2))
    with pytest.raises(InvalidValue, match="d=3"):
        plan_on(OPEN.world(1.0), (2, 2), (3, 3), draw("halton", 10, 3))


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_shortcutting_never_lengthens_and_only_uses_free_motions(seed):
    random = np.random.default_rng(seed)
    world = GridMap(random.random((20, 20)) < 0.12).world(0.4)
    result = plan_on(world, (0.5, 0.5), (19.5, 19.5), draw("uniform", 150, 2, rng=seed), smooth=False)
    if not result.solved:
        return
    path, motions = shortcut(world, result.path)
    assert motions > 0
    assert path_length(path, world.space) <= result.cost * (1 + 1e-12)
    assert world.motion_valid(path[:-1], path[1:]).all()
    np.testing.assert_array_equal(path[[0, -1]], result.path[[0, -1]])
