"""The search where evaluations are expensive: it finds what it finds where they are cheap, with fewer of them."""

from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from evenroad.roadmap import Budget
from evenroad.robot import ArmWorld
from evenroad.robot_roadmap.build import arm_roadmap
from evenroad.robot_roadmap.recipe import Recipe
from tests.robot.kernel_arms import box_scene, ur5

CLEARANCE = 0.01

MOTIONS = []
"""What the worlds of a test evaluated; the only list, since the roadmap makes another world of the dynamic scene."""


@dataclass(frozen=True, eq=False)
class Counted:
    """An arm's world that is no arm's world, whose capsules are too thick, and that counts what is evaluated."""

    capsules: ArmWorld
    judge: ArmWorld = field(init=False)
    backend, proof = "other", "resolution"

    def __post_init__(self):
        world = self.capsules
        object.__setattr__(self, "judge", ArmWorld(world.robot, world.scene, resolution=world.resolution))

    @property
    def space(self):
        return self.capsules.space

    def valid(self, q):
        return self.judge.valid(q)

    def motion_valid(self, a, b):
        return self.motion_certified(a, b, 1e-6)

    def explain(self, q):
        return self.judge.explain(q)

    def motion_certified(self, a, b, tolerance):
        MOTIONS.extend(zip(map(tuple, a.tolist()), map(tuple, b.tolist()), strict=True))
        return self.judge.motion_certified(a, b, tolerance)


@pytest.fixture(autouse=True)
def no_motions():
    MOTIONS.clear()


@pytest.fixture(scope="module")
def roadmap():
    """Three joints of two turns each, on a table."""
    cell = box_scene()
    on_table = frozenset(pair for pair in cell.allowed if pair[1] == "table")
    cell = replace(cell, obstacles=cell.obstacles[:1], allowed=on_table)
    return arm_roadmap(ArmWorld(ur5(joints=3), cell, clearance=CLEARANCE), 48, 5, recipe=Recipe(2.0, 300))


def cheap(roadmap):
    return roadmap.within(ArmWorld(roadmap.robot, box_scene()))


def expensive(roadmap):
    """A planner in a world whose capsules keep a clearance that its judge does not need."""
    return roadmap.within(Counted(ArmWorld(roadmap.robot, box_scene(), clearance=CLEARANCE)))


def queries(known, count):
    world = cheap(known.roadmap).world
    q = world.space.from_cube(np.random.default_rng(5).random((4000, 3)))
    q = q[world.valid(q) & (q[:, 1] > -np.pi) & (q[:, 1] < 0.0)]
    q = q[np.argsort(q[:, 0])]
    far = np.stack([q[: len(q) // 2], q[::-1][: len(q) // 2]], axis=1)
    return far[~world.motion_valid(far[:, 0], far[:, 1])][:count]


def test_it_finds_a_path_where_the_cheap_search_does_and_each_motion_is_proved(roadmap):
    found, lazy, known = 0, cheap(roadmap), expensive(roadmap)
    for start, goal in queries(known, 25):
        few = known.connect(start, goal[np.newaxis])
        assert few.goal == lazy.connect(start, goal[np.newaxis]).goal
        if few.goal == 0:
            found += len(few.path) > 2
            np.testing.assert_array_equal(few.path[[0, -1]], [start, goal])
            assert lazy.world.validate(few.path).all()
    assert found > 5


def test_no_motion_is_evaluated_twice_in_a_query_and_known_ones_never_again(roadmap):
    known = expensive(roadmap)
    for start, goal in queries(known, 10):
        MOTIONS.clear()
        known.connect(start, goal[np.newaxis])
        motions = [frozenset(motion) for motion in MOTIONS]
        assert len(set(motions)) == len(motions)
        of_edges = [motion for motion in motions if not motion & {tuple(start), tuple(goal)}]
        MOTIONS.clear()
        known.connect(start, goal[np.newaxis])
        assert not set(of_edges) & set(map(frozenset, MOTIONS))


def test_fewer_motions_are_evaluated_where_earlier_queries_are_kept(roadmap):
    known, counts = expensive(roadmap), {}
    for start, goal in queries(known, 20):
        for planner in (expensive(roadmap), known):
            MOTIONS.clear()
            if planner.plan(start, goal, trees=False, shorten=False).solved:
                kept = planner is known
                counts[kept] = counts.get(kept, 0) + len(MOTIONS)
    assert 0 < counts[True] < 0.6 * counts[False]


def test_several_goals_and_a_budget_of_one_motion(roadmap):
    known = expensive(roadmap)
    (start, goal), (other, _) = queries(known, 2)
    both = known.connect(start, np.array([goal, other]))
    assert both.goal in (0, 1)
    np.testing.assert_array_equal(both.path[-1], (goal, other)[both.goal])
    MOTIONS.clear()
    assert expensive(roadmap).connect(start, goal[np.newaxis], most_motions=1).motions <= 1
    assert len(MOTIONS) <= 1


def test_a_proof_is_said_of_what_the_capsules_prove_alone(roadmap):
    known, proofs = expensive(roadmap), set()
    for start, goal in queries(known, 20):
        result = known.plan(start, goal, budget=Budget(seconds=5.0))
        if result.solved:
            proofs.add(result.proof)
            assert result.proof == ("certified" if known.capsules.validate(result.path).all() else "resolution")
            assert known.world.judge.validate(result.path).all()
    assert "certified" in proofs


def test_starts_and_goals_are_kept_and_the_same_path_is_found_again(roadmap):
    first, second = expensive(roadmap), expensive(roadmap)
    some = queries(first, 8)
    for start, goal in some:
        one, other = (known.plan(start, goal, trees=False) for known in (first, second))
        assert one.solved == other.solved
        if one.solved:
            np.testing.assert_array_equal(one.path, other.path)
    for start, goal in some:
        MOTIONS.clear()
        if first.plan(start, goal, trees=False).solved:
            # The straight motion is evaluated anew, and a link to what is a milestone but for its last bits.
            assert len(MOTIONS) <= 2
