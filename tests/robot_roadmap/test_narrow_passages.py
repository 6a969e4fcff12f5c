"""Ends in pockets at random, and milestones that are chosen for what such ends see."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import starmap

import numpy as np
import pytest

from evenroad._native.robot_roadmap import rows_joined, scenes_free
from evenroad.robot import ArmWorld, Obstacle, Scene, load_robot, with_group, with_limits
from evenroad.robot.obstacle import box_rows, boxes_of
from evenroad.robot_roadmap import narrow_passages
from evenroad.robot_roadmap.build import arm_roadmap
from evenroad.robot_roadmap.free_probability import Surroundings, among, free_probability, random_boxes
from evenroad.robot_roadmap.narrow_passages import hard_queries
from evenroad.robot_roadmap.recipe import Recipe, spread_order
from tests.robot.kernel_arms import ur5

NOTHING = Scene(name="nothing")
TABLE = Scene(
    (Obstacle.of("table", "box", (1.6, 1.6, 0.05), (0.3, 0.0, -0.03)),),
    name="cell",
    allowed=frozenset({("base_link", "table"), ("shoulder_link", "table")}),
)


@pytest.fixture(scope="module")
def arm():
    return ur5(joints=4)


@pytest.fixture(scope="module")
def pool(arm):
    world = ArmWorld(arm, NOTHING)
    q = world.space.from_cube(np.random.default_rng(3).random((600, 4)))
    return q[world.valid(q)]


def walls_of(rows):
    return boxes_of(rows, [f"wall {i}" for i in range(len(rows))])


def test_a_pocket_holds_the_tip_between_five_walls_and_is_open_to_the_side_of_the_robot_or_above(arm, pool):
    around, rng = Surroundings.of(arm, pool), np.random.default_rng(0)
    tips = narrow_passages.tips_of(arm, pool)
    open_above, drawn = 0, narrow_passages.passages_around(tips[:100, 0], around, rng)
    for i, tip in enumerate(tips[:100, 0]):
        walls, centre, turn, half = walls_of(drawn.walls(i)), drawn.centre[i], drawn.turn[i], drawn.half[i]
        assert len(walls) == 5
        assert drawn.holds(i, tip[np.newaxis])[0]
        assert np.all(np.abs((tip - centre) @ turn) <= 0.5 * half + 1e-12)
        np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(turn) > 0.0
        way_out = -turn[:, 0]
        if way_out[2] > 0.5:
            open_above += 1
        else:
            outwards = (tip - around.base)[:2]
            assert way_out[:2] @ outwards < 0.0
        # No wall is where the way out is.
        assert not any(np.dot(np.array(wall.xyz) - centre, way_out) > 0.5 * half[0] for wall in walls)
    assert 15 <= open_above <= 45


def test_what_is_passed_over_before_a_world_is_made_touches_a_wall(arm, pool):
    around, rng = Surroundings.of(arm, pool), np.random.default_rng(4)
    tips, (body, radii) = narrow_passages.tips_of(arm, pool), narrow_passages.body_of(arm, pool)
    drawn = narrow_passages.passages_around(tips[:300, 0], around, rng)
    passed = drawn.touched_by(body[:300], radii)
    free = np.array([ArmWorld(arm, Scene(walls_of(drawn.walls(i)))).valid(pool[i]) for i in range(300)])
    assert not (passed & free).any()
    touching, passed = np.sum(~free), np.sum(passed)
    assert 0.8 * touching <= passed < 300


def test_ends_see_what_straight_motions_reach_at_their_states_and_never_themselves(arm, pool, monkeypatch):
    cell = Scene((Obstacle.of("post", "box", (0.1, 0.1, 1.0), (0.5, 0.3, 0.5)),), name="post")
    pool = pool[ArmWorld(arm, cell).valid(pool)]
    made, asked = {}, []

    def noting_walls(robot, rows):
        made[checker := among(robot, rows)] = rows
        return checker

    def noting_ends(walls, inside, pool, ends, rows, early):
        asked.extend((walls_of(made[each]), end) for each, end in zip(walls, ends, strict=True))
        return rows_joined(walls, inside, pool, ends, rows, early)

    monkeypatch.setattr(narrow_passages, "among", noting_walls)
    monkeypatch.setattr(narrow_passages, "rows_joined", noting_ends)
    monkeypatch.setattr(narrow_passages, "in_order", starmap)
    # Not all of the pool: some are hardly ever chosen.
    candidates = np.flatnonzero(np.arange(len(pool)) % 5 != 2)
    seen = hard_queries(arm, cell, pool, candidates, 30, np.random.default_rng(1))
    assert len(seen.first) == 31
    assert seen.first[-1] == len(seen.which) > 0
    for number, (walls, end) in enumerate(asked):
        world, bare = ArmWorld(arm, Scene((*cell.obstacles, *walls))), ArmWorld(replace(arm, pairs=()), Scene(walls))
        assert world.valid(pool[end])
        reached = np.full(len(pool), True)
        for share in narrow_passages.EARLY:
            reached &= bare.valid(pool[end] + share * (pool - pool[end]))
        for share in np.arange(1, 17) / 16:
            reached &= world.valid(pool[end] + share * (pool - pool[end]))
        found = seen.which[seen.first[number] : seen.first[number + 1]]
        assert found.tolist() == [row for row in candidates if reached[row] and row != end]


def test_scenes_in_which_a_configuration_is_free_are_counted_among_obstacles_alone(arm, pool):
    around, rng = Surroundings.of(arm, pool), np.random.default_rng(6)
    rows = [box_rows(*random_boxes(around, rng), None) for _ in range(20)]
    q = np.concatenate([pool, np.full((1, 4), 9.0)])  # the last one is outside of the limits
    bare = replace(arm, pairs=())
    free = sum(ArmWorld(bare, Scene(walls_of(each))).valid(q).astype(int) for each in rows)
    assert scenes_free([among(arm, each) for each in rows], q).tolist() == free.tolist()
    assert 0 < free[:-1].min() < free[:-1].max() == 20
    assert free[-1] == 0


def test_the_number_of_processors_changes_nothing(arm, pool, monkeypatch):
    def by_threads(function, tasks):
        with ThreadPoolExecutor(3) as pool:
            yield from pool.map(lambda task: function(*task), tasks)

    seen, chances = [], []
    for in_order in (starmap, by_threads):
        for module in ("narrow_passages", "free_probability"):
            monkeypatch.setattr(f"evenroad.robot_roadmap.{module}.in_order", in_order)
        seen.append(hard_queries(arm, NOTHING, pool, np.arange(len(pool)), 40, np.random.default_rng(2)))
        chances.append(free_probability(arm, pool, 40, np.random.default_rng(2)))
    assert len(seen[0].own) == 40
    for one, several in zip(*seen, strict=True):
        assert one.tolist() == several.tolist()
    assert chances[0].tolist() == chances[1].tolist()


def test_an_arm_whose_tip_stays_where_it_is_has_no_pockets(arm, pool):
    still = replace(arm, group=arm.group[:1])
    spun = np.zeros((50, 1))
    seen = hard_queries(still, NOTHING, spun, np.arange(50), 10, np.random.default_rng(0))
    assert seen.first.tolist() == [0]


def test_what_ends_see_comes_first_and_each_end_counts_less_once_it_is_served():
    points = np.random.default_rng(0).random((200, 2))
    # Two ends: one sees the first ten points, the other the next ten.
    first, which = np.array([0, 10, 20]), np.arange(20)
    order = spread_order(points, np.full(2, np.inf), np.ones(200), 30, first, which)
    assert set(order[:10].tolist()) <= set(range(20))
    assert order[0] // 10 != order[1] // 10
    # Served, they leave the rest to spreading.
    assert set(order[20:].tolist()) - set(range(20))


def test_more_ends_see_a_roadmap_that_learned_from_others():
    arm = load_robot("ur5")
    arm = with_limits(with_group(arm, arm.group[:5]), dict.fromkeys(arm.group[:5], (-3.14, 3.14)))
    world = ArmWorld(arm, TABLE)
    learned, plain = (arm_roadmap(ArmWorld(arm, TABLE), 24, recipe=Recipe(0.0, ends)).milestones for ends in (600, 0))
    q = world.space.from_cube(np.random.default_rng(99).random((2400, 5)))
    q = q[world.valid(q)][:700]
    everything = np.concatenate([q, learned, plain])
    rows = np.arange(len(everything))
    seen = hard_queries(arm, TABLE, everything, rows, 300, np.random.default_rng(5))
    of_end = [each for own, each in zip(seen.own, np.split(seen.which, seen.first[1:-1]), strict=True) if own < len(q)]
    share = [
        np.mean([np.any(which // 24 == kind) for which in (each[each >= len(q)] - len(q) for each in of_end)])
        for kind in (0, 1)
    ]
    assert share[0] > share[1] + 0.03
