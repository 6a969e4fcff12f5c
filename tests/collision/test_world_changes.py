"""Worlds whose scenes were changed give the verdicts of worlds made anew, whatever happened before."""

import math
from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.collision.scene_changes import FEW, MOST
from evenroad.errors import InvalidValue, UnknownName
from tests.robots.kernel_arms import ur5
from tests.threads import together

ROBOT = ur5(limits=math.pi)
COUNT = 200


def positions(rng, count):
    away = rng.normal(size=(count, 3))
    return away * rng.uniform(0.4, 1.2, (count, 1)) / np.linalg.norm(away, axis=1, keepdims=True)


def some_shape(rng, name):
    pose = er.Pose(tuple(positions(rng, 1)[0].tolist()), rpy=tuple(rng.uniform(-3, 3, 3).tolist()))
    size = rng.uniform(0.01, 0.04, 3).tolist()
    kinds = (
        lambda: er.Box(size, pose=pose, name=name),
        lambda: er.Sphere(size[0], pose=pose, name=name),
        lambda: er.Cylinder(size[0], size[1], pose=pose, name=name),
        lambda: er.Capsule((0, 0, -0.05), (0, 0, 0.05), size[0], pose=pose, name=name),
    )
    return kinds[rng.integers(len(kinds))]()


@pytest.fixture(scope="module")
def base():
    rng = np.random.default_rng(0)
    allowed = frozenset({("forearm", "shape 3"), ("wrist1", "shape 4")})
    return er.ArmWorld(ROBOT, er.Scene([some_shape(rng, f"shape {i}") for i in range(COUNT)], allowed=allowed))


def change(world, rng, number):
    """One change of a world: some obstacles moved, added or removed."""
    names = list(rng.permutation(np.array(world.scene.names))[:3])
    match rng.integers(4):
        case 0:
            return world.without(*names)
        case 1:
            return world.with_(some_shape(rng, f"new {number}"), some_shape(rng, f"newer {number}"))
        case 2:
            return world.with_(er.Sphere(0.03, xyz=tuple(positions(rng, 1)[0].tolist()))).without(names[0])
    return world.moved({name: er.Pose(tuple(positions(rng, 1)[0].tolist())) for name in names})


def assert_like_made_anew(world, rng, count=1500):
    anew = er.ArmWorld(world.robot, replace(world.scene), clearance=world.clearance)
    assert anew.native_scene.changes == 0
    q = world.robot.random(rng, count)
    free = anew.valid(q)
    np.testing.assert_array_equal(world.valid(q), free)
    assert 0 < free.sum() < len(q)
    a, b = q[free][:-1], q[free][:-1] + 0.3 * (q[free][1:] - q[free][:-1])
    np.testing.assert_array_equal(world.motion_valid(a, b), anew.motion_valid(a, b))
    np.testing.assert_array_equal(world.motion_certified(a, b, 1e-6), anew.motion_certified(a, b, 1e-6))
    for each in q[~free][: 0 if world.clearance else 20]:
        # More than one obstacle may touch: which is named depends on their order.
        link, name = world.explain(each).replace("'", "").split(" touches ")
        assert name in (*world.scene.names, *world.robot.links)
        if name in world.scene.names:
            only = world.scene.without(*(other for other in world.scene.names if other != name))
            assert not er.ArmWorld(world.robot, only).valid(each), f"{link} does not touch {name}"


@pytest.mark.parametrize("seed", range(4))
def test_after_many_changes_the_verdicts_are_those_of_a_world_made_anew(base, seed):
    rng = np.random.default_rng(seed)
    world, most = base, 0
    for number in range(60):
        world = change(world, rng, number)
        most = max(most, world.native_scene.changes)
        if number % 20 == 19:
            assert_like_made_anew(world, rng)
    assert 0 < most <= MOST


def test_a_changed_world_shares_what_stays_and_its_base_is_what_it_was(base):
    q = ROBOT.random(np.random.default_rng(1), 2000)
    before = base.valid(q)
    moved = base.moved({name: er.Pose((5.0, 5.0, 5.0)) for name in base.scene.names[:100]})
    assert moved.native_scene.changes == 0, "what is out of reach is no obstacle"
    assert moved.valid(q).sum() > before.sum()
    np.testing.assert_array_equal(base.valid(q), before)
    back = moved.moved({each.name: each.body.pose for each in base.scene.obstacles[:100]})
    assert back.native_scene.changes == 100
    np.testing.assert_array_equal(back.valid(q), before)


def test_a_world_with_more_room_is_changed_with_it(base):
    rng = np.random.default_rng(2)
    world = (
        base.moved({"shape 0": er.Pose((0.4, 0.4, 0.4))}).with_(some_shape(rng, "new")).without("shape 1", "shape 2")
    )
    roomier = world.roomier
    assert roomier.clearance == base.roomier.clearance
    assert roomier.native_scene.changes > 0
    assert roomier.scene == world.scene
    assert_like_made_anew(roomier, rng)


def test_allowed_contacts_stay_allowed_where_their_obstacle_moves(base):
    rng = np.random.default_rng(3)
    q = ROBOT.random(rng, 1)[0]
    on_wrist = {"shape 4": er.Pose(tuple(er.Pose.from_matrix(np.eye(4)).xyz))}
    world = base.moved(on_wrist).moved({"shape 3": er.Pose((0.3, 0.3, 0.3)), "shape 4": er.Pose((0.3, 0.2, 0.5))})
    assert_like_made_anew(world, rng)
    assert world.scene.allowed == base.scene.allowed
    assert isinstance(world.valid(q), bool | np.bool_)


def test_what_stands_in_the_base_is_found_and_when_it_leaves_the_arm_is_free_again(base):
    blocked = base.with_(er.Sphere(0.3, name="in the base"))
    assert blocked.native_scene.changes == 1
    assert blocked.fixed_contact == ("base", "in the base")
    assert not blocked.valid(ROBOT.random(np.random.default_rng(0), 500)).any()
    assert blocked.without("in the base").fixed_contact is None
    assert_like_made_anew(blocked.without("in the base"), np.random.default_rng(0))


def test_distances_of_a_changed_world_name_what_is_there_now(base):
    rng = np.random.default_rng(5)
    world = base.without("shape 0", "shape 7").with_(er.Sphere(0.1, xyz=(0.0, 0.0, 1.0), name="lamp"))
    anew = er.ArmWorld(world.robot, replace(world.scene))
    q = ROBOT.random(rng, 200)
    mine, theirs = world.distance(q), anew.distance(q)
    np.testing.assert_array_equal(mine.metres, theirs.metres)
    assert mine.pair == theirs.pair
    free = q[world.valid(q)]
    result = er.plan(world, free[0], free[1])
    assert result.path is None or result.nearest[1] in world.scene.names


def test_a_copy_of_a_changed_world_and_one_in_threads_give_its_verdicts(base):
    import pickle

    world = base.moved({"shape 5": er.Pose((0.4, 0.1, 0.5))}).without("shape 9")
    q = ROBOT.random(np.random.default_rng(6), 1000)
    expected = world.valid(q).tolist()
    assert pickle.loads(pickle.dumps(world)).valid(q).tolist() == expected
    asks = [lambda: base.moved({"shape 5": er.Pose((0.4, 0.1, 0.5))}).without("shape 9").valid(q).tolist()]
    for answers in together(*asks):
        assert answers == [expected]


def test_small_scenes_and_clouds_are_made_anew():
    few = er.ArmWorld(ROBOT, er.Scene([some_shape(np.random.default_rng(i), f"shape {i}") for i in range(FEW - 1)]))
    assert few.moved({"shape 0": er.Pose((0.4, 0.2, 0.3))}).native_scene.changes == 0
    cloud = er.PointCloud([(0.4, 0.0, 0.6)], 0.05, name="cloud")
    world = few.with_(cloud).moved({"cloud": er.Pose((0.0, 0.1, 0.0))})
    assert_like_made_anew(world, np.random.default_rng(8))


def test_what_is_not_there_or_too_far_is_refused(base):
    with pytest.raises(UnknownName, match="shape 999"):
        base.moved({"shape 999": er.Pose()})
    with pytest.raises(UnknownName, match="shape 0"):
        base.without("shape 0").without("shape 0")
    with pytest.raises(InvalidValue, match="'shape 2' must be within"):
        base.moved({"shape 2": er.Pose((2e6, 0, 0), rpy=(0.1, 0.2, 0.3))})
    with pytest.raises(InvalidValue, match="names of their own"):
        base.with_(er.Sphere(0.1, name="shape 2"))
