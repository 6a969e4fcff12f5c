import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad._time_limit import BudgetSpent
from evenroad.errors import InvalidValue, UnknownName
from evenroad.planning import Status
from evenroad.points.samplers import Halton, Sobol
from evenroad.points.samplers.lattice import Lattice
from evenroad.roadmap import Budget, KNearest, Radius
from evenroad.world.gridmap.load import load_maze
from tests.plan_on import plan_growing, plan_on
from tests.planning.worlds import ChanceWorld
from tests.refused import refused

START, GOAL = (0.0, 0.0), (1.0, 1.0)


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    free=st.floats(0.1, 0.9),
    rule=st.sampled_from([KNearest(6), Radius(0.3)]),
    sampler=st.sampled_from([Sobol(), Halton()]),
)
def test_each_stage_finds_what_a_fresh_plan_with_its_points_finds(seed, free, rule, sampler):
    world = ChanceWorld(seed, 0.8, free)
    grown = plan_growing(
        world, START, GOAL, sampler, first=8, until="budget", budget=Budget(samples=50), rng=seed, rule=rule,
        smooth=False,
    )  # fmt: skip
    assert [stage.points for stage in grown.stages] == [8, 16, 32, 50]
    fresh = [
        plan_on(ChanceWorld(seed, 0.8, free), START, GOAL, sampler.draw(n, 2, rng=seed), rule=rule, smooth=False)
        for n in (8, 16, 32, 50)
    ]
    for stage, result in zip(grown.stages, fresh, strict=True):
        assert stage.valid == result.counts["valid"]
        assert stage.cost == pytest.approx(result.cost)
    best = min((result.cost for result in fresh if result.solved), default=None)
    assert grown.cost == pytest.approx(best)
    assert grown.status is (Status.BUDGET_SPENT if best is None else Status.SOLVED)
    assert grown.counts["edges_checked"] == world.asked_motions
    assert grown.counts["configurations_checked"] == world.asked_configurations == 52


def test_no_motion_is_checked_twice_over_all_stages():
    asked = set()

    class Once(ChanceWorld):
        def motion_valid(self, a, b):
            for x, y in zip(a.tolist(), b.tolist(), strict=True):
                key = frozenset((tuple(x), tuple(y)))
                assert key not in asked
                asked.add(key)
            return super().motion_valid(a, b)

    result = plan_growing(Once(3, 0.8, 0.5), START, GOAL, until="budget", budget=Budget(samples=256), smooth=False)
    assert len(asked) == result.counts["edges_checked"]


def test_it_stops_with_the_first_path():
    result = plan_growing(ChanceWorld(5, 0.8, 0.2), START, GOAL, first=4)
    assert result.solved
    assert [stage.cost is None for stage in result.stages] == [True] * (len(result.stages) - 1) + [False]
    assert len(result.stages) > 1
    assert result.planner == "prm anytime"
    assert result.counts["points"] == result.stages[-1].points == 4 * 2 ** (len(result.stages) - 1)


def test_it_stops_when_the_path_has_settled():
    maze = load_maze(2)
    result = plan_growing(maze.world(), maze.start, maze.goal, until="settled", smooth=False)
    costs = [stage.cost for stage in result.stages if stage.cost is not None]
    assert result.cost == pytest.approx(min(costs))
    assert min(costs) >= 0.99 * min(costs[:-1])
    assert len(costs) > 2
    for i in range(2, len(costs)):
        assert min(costs[:i]) < 0.99 * min(costs[: i - 1])


@pytest.mark.parametrize(("budget", "points", "asked"), [
    (Budget(motions=1), None, 1), (Budget(motions=25), None, 25), (Budget(samples=40), 40, None),
    (Budget(seconds=1e-9), None, 0),
])  # fmt: skip
def test_a_budget_is_kept_to_and_named(budget, points, asked):
    world = ChanceWorld(4, 1.0, 0.0)
    result = plan_growing(world, START, GOAL, first=16, budget=budget)
    assert result.status is Status.BUDGET_SPENT
    assert not result.solved
    if points is not None:
        assert (result.counts["points"], result.counts["start_component"]) == (points, 0)
    assert world.asked_motions == result.counts["edges_checked"]
    if asked is not None:
        assert world.asked_motions == asked
        motions = f", {asked} motions" if asked else ""
        spent = f"no path within 65536 samples{motions}, {budget.seconds:g} s; start reaches"
        assert spent in result.message


def test_a_path_that_was_found_before_the_budget_was_spent_is_the_answer():
    world = ChanceWorld(2, 0.8, 0.6)
    early = plan_growing(world, START, GOAL, first=16, smooth=False)
    checks = early.counts["edges_checked"] + 1
    late = plan_growing(world, START, GOAL, first=16, until="budget", budget=Budget(motions=checks), smooth=False)
    assert late.solved
    assert late.cost <= early.cost
    assert late.counts["edges_checked"] <= checks


def test_the_best_path_stays_where_the_time_ends_between_two_stages():
    class Endless(Halton):
        def draw(self, n, d, *, rng=0):
            if n > 64:
                raise BudgetSpent
            return super().draw(n, d, rng=rng)

    class Longer(KNearest):
        def edges(self, q, space=None, *, terminals=0):
            if len(q) > 66:
                raise BudgetSpent
            return super().edges(q, space, terminals=terminals)

    for cut in ({"sampler": Endless()}, {"sampler": Halton(), "rule": Longer(10)}):
        result = plan_growing(ChanceWorld(3, 1.0, 0.7), START, GOAL, first=16, until="budget", **cut)
        assert result.solved
        assert [stage.points for stage in result.stages][:3] == [16, 32, 64]
        assert result.counts["points"] == result.stages[-1].points <= 128


def test_the_same_seed_gives_the_same_bits_and_sets_must_extend_one_another():
    one, other = (plan_growing(ChanceWorld(2, 0.8, 0.5), START, GOAL, rng=7, until="settled") for _ in range(2))
    assert one.path.tobytes() == other.path.tobytes()
    assert one.counts == other.counts
    assert one.stages == other.stages
    blocked = ChanceWorld(4, 1.0, 0.0)
    refused(InvalidValue, "do not begin with", plan_growing, blocked, START, GOAL, Lattice())
    refused(InvalidValue, "not a Generator", plan_growing, blocked, START, GOAL, rng=np.random.default_rng(0))


def test_ends_in_collision_and_bad_arguments():
    world = ChanceWorld(0, 0.0, 1.0)
    assert plan_growing(world, (0.3, 0.3), GOAL).status is Status.START_INVALID
    refused(UnknownName, "budget, settled, solved", plan_growing, world, START, GOAL, until="bored")
    refused(InvalidValue, "first", plan_growing, world, START, GOAL, first=0)
    for bad in (dict(samples=0), dict(motions=0), dict(seconds=np.nan), dict(seconds=0), dict(seconds=-1.0)):
        refused(InvalidValue, next(iter(bad)), Budget, **bad)
