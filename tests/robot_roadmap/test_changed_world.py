"""A roadmap that goes on in a changed scene answers as one made anew there, and checks less."""

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue

COUNT = 150


def places(rng, count, low=0.6):
    away = rng.normal(size=(count, 3))
    return away * rng.uniform(low, 0.9, (count, 1)) / np.linalg.norm(away, axis=1, keepdims=True)


def pose(rng):
    return er.Pose(tuple(places(rng, 1)[0].tolist()), rpy=tuple(rng.uniform(-3, 3, 3).tolist()))


@pytest.fixture(scope="module")
def roadmap():
    return er.build_roadmap(er.ArmWorld("ur5"), er.draw("even", 48, 6))


@pytest.fixture(scope="module")
def world(roadmap):
    rng = np.random.default_rng(0)
    scene = er.Scene.of_boxes(rng.uniform(0.01, 0.03, (COUNT, 3)), places(rng, COUNT, 0.6))
    return er.ArmWorld(roadmap.robot, scene)


@pytest.fixture(scope="module")
def queries(roadmap, world):
    """Starts and goals that the roadmap joins, by way of its milestones."""
    q = world.robot.random(np.random.default_rng(1), 2000)
    free, kept = q[world.valid(q)], roadmap.within(world)
    pairs = zip(free[0:120:2], free[1:120:2, np.newaxis], strict=True)
    joined = [pair for pair in pairs if len(kept.connect(*pair, greed=1.0).path) > 2]
    assert len(joined) >= 6
    return joined[:6]


def change(world, rng, number):
    """One change of a world: some obstacles moved, added or removed."""
    names = [str(name) for name in rng.permutation(np.array(world.scene.names))[:2]]
    match rng.integers(4):
        case 0:
            return world.without(*names)
        case 1:
            return world.with_(er.Sphere(0.02, pose=pose(rng), name=f"ball {number}"))
        case 2:
            return world.with_(er.Box((0.05, 0.02, 0.05), pose=pose(rng), name=f"plate {number}")).without(names[0])
    return world.moved({name: pose(rng) for name in names})


def length(path):
    return np.linalg.norm(np.diff(path, axis=0), axis=1).sum()


@pytest.mark.parametrize("seed", range(3))
def test_after_each_of_many_changes_shortest_paths_are_those_of_a_roadmap_made_anew(roadmap, world, queries, seed):
    rng = np.random.default_rng(seed)
    kept = roadmap.within(world)
    found = checked = checked_anew = 0
    for number in range(15):
        world = change(world, rng, number)
        kept, anew = kept.within(world), roadmap.within(world)
        for start, goal in queries:
            one, other = kept.connect(start, goal, greed=1.0), anew.connect(start, goal, greed=1.0)
            assert one.goal == other.goal
            checked, checked_anew = checked + one.motions, checked_anew + other.motions
            if one.goal >= 0:
                assert length(one.path) == length(other.path)
                assert world.motion_certified(one.path[:-1], one.path[1:], 1e-6).all()
                found += 1
    assert found > 10
    assert checked < 0.8 * checked_anew


def test_what_trees_found_stays_where_nothing_has_come_near(roadmap, world, queries):
    kept = roadmap.within(world)
    for start, goal in queries:
        kept.plan(start, goal[0])
    size = kept._graph.size
    assert size > len(roadmap.milestones)
    far = er.Box((0.01, 0.01, 0.01), xyz=(0.0, 0.0, -0.9), name="far")
    later = kept.within(world.with_(far))
    assert later._graph.size == size
    for start, goal in queries:
        before, after = kept.connect(start, goal), later.connect(start, goal)
        assert (before.goal, before.motions) == (after.goal, after.motions)
        np.testing.assert_array_equal(before.path, after.path)


def test_paths_in_a_changed_world_are_free_where_boxes_come_onto_the_last_ones(roadmap, world, queries):
    rng = np.random.default_rng(5)
    kept = roadmap.within(world)
    moved = 0
    for number in range(20):
        start, goal = queries[number % len(queries)]
        result = kept.plan(start, goal[0])
        if result.path is None:
            continue
        assert world.motion_certified(result.path[:-1], result.path[1:], 1e-6).all()
        # A ball at the tip, half way.
        middle = result.path[len(result.path) // 2] if len(result.path) > 2 else 0.5 * (result.path[0] + goal[0])
        at = world.robot.fk(middle).xyz
        name = f"ball {rng.integers(4)}"
        known = name in world.scene.names
        there = er.Pose(at)
        world = world.moved({name: there}) if known else world.with_(er.Sphere(0.03, pose=there, name=name))
        kept, moved = kept.within(world), moved + 1
    assert moved > 10


def test_a_world_that_differs_in_more_is_looked_at_anew(roadmap, world, queries):
    kept = roadmap.within(world)
    start, goal = queries[0]
    kept.connect(start, goal)
    for other in (
        er.ArmWorld(world.robot, world.scene, clearance=0.0, resolution=0.02),
        world.with_(er.PointCloud([(0.4, 0.3, 0.3)], 0.02, name="cloud")),
    ):
        one, two = kept.within(other).connect(start, goal), roadmap.within(other).connect(start, goal)
        assert (one.goal, one.motions) == (two.goal, two.motions)
    with pytest.raises(InvalidValue, match="clearance"):
        kept.within(er.ArmWorld(world.robot, world.scene, clearance=0.1))


def test_what_stands_in_the_static_scene_may_not_move():
    table = er.Box((0.3, 0.3, 0.02), xyz=(0.5, 0, 0.05), name="table")
    static = er.ArmWorld("ur5", er.Scene([table]))
    kept = er.build_roadmap(static, er.draw("even", 16, 6)).within(static)
    assert kept.within(static.with_(er.Sphere(0.02, xyz=(0.4, 0.4, 0.4)))) is not kept
    with pytest.raises(InvalidValue, match="'table'"):
        kept.within(static.moved({"table": er.Pose((0.5, 0, 0.3))}))
