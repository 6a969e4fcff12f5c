"""Paths that are planned again and again: from where the arm is, free in the scene as it is now, and no older one."""

import math
from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue, UnknownName
from evenroad.robot import link_poses
from evenroad.space.path import configuration_at, subdivide
from tests.robots.kernel_arms import ur5
from tests.robots.oracle import clearance
from tests.threads import together

ROBOT = ur5(limits=math.pi, joints=5)
COUNT = 12
START, GOAL = np.array([-1.2, -1.4, 1.0, 0.3, 0.2]), np.array([1.3, -0.9, 1.2, -0.4, 0.0])
FAR = er.Pose((5.0, 5.0, 5.0))


def world_of(*boxes):
    far = [er.Box((0.12, 0.12, 0.12), pose=FAR, name=f"box {i}") for i in range(COUNT)]
    return er.ArmWorld(ROBOT, er.Scene([*far, *boxes], allowed=frozenset()))


def least_clearance(world, path):
    """The oracle's least distance from contact over dense states of a path."""
    lengths = world.space.distance(path[:-1], path[1:])
    states, _ = subdivide(path, world.space, np.maximum(np.ceil(lengths / 0.01), 1).astype(int))
    return clearance(world.robot, world.scene, states).min()


def tips(world, q):
    """Where the last link is at configurations, (n, 3)."""
    return link_poses(world.robot, np.atleast_2d(q))[:, -1, :3, 3]


def driven(world, path, length):
    """Where an arm is that has driven so far along a path."""
    whole = world.space.distance(path[:-1], path[1:]).sum()
    return configuration_at(path, world.space, min(1.0, length / whole) if whole else 1.0)[0]


@pytest.mark.parametrize("seed", range(6))
def test_an_adversary_puts_boxes_into_the_path_and_no_path_is_handed_out_that_touches_them(seed):
    rng = np.random.default_rng(seed)
    live, q = er.Replanner(world_of(), GOAL), START
    result = live.update(q)
    planners = []
    for k in range(40):
        moved = {}
        for name in rng.choice(COUNT, 3, replace=False):
            # Where the tip is somewhere along the path, or near it.
            there = START if live.path is None else configuration_at(live.path, live.world.space, rng.uniform(0.2, 0.9))
            moved[f"box {name}"] = er.Pose(tuple((tips(live.world, there)[0] + rng.normal(0, 0.05, 3)).tolist()))
        if k % 5 == 4:
            moved = {f"box {i}": FAR for i in range(COUNT)}
        result = live.update(q, moved=moved)
        planners.append(result.planner)
        assert all(live.world.scene.obstacles[int(name[4:])].body.pose == pose for name, pose in moved.items())
        if result.path is None:
            assert live.path is None
            assert result.status in ("budget_spent", "start_invalid", "goal_invalid")
            continue
        assert result.proof == "certified"
        np.testing.assert_array_equal(result.path[[0, -1]], [q, GOAL])
        assert least_clearance(live.world, result.path) > 0.0
        q = driven(live.world, result.path, 0.05)
        if np.allclose(q, GOAL):
            q = START
    assert {"kept", "trees"} <= set(planners)


def test_a_path_is_kept_while_it_is_free_and_gets_no_longer():
    wall = er.Box((0.05, 0.4, 0.9), xyz=(0.6, 0.0, 0.5), name="wall")
    live = er.Replanner(world_of(wall), GOAL)
    costs, q = [live.update(START).cost], START
    assert live.path.shape[0] > 2
    for _ in range(20):
        before = live.path
        q = driven(live.world, before, 0.02)
        result = live.update(q, moved={"box 0": FAR})
        assert result.planner == "kept"
        costs.append(result.cost)
        assert least_clearance(live.world, result.path) > 0.0
    assert (np.diff(costs) < -0.01).all()
    beside = q + 0.01
    assert live.update(beside).planner == "kept"
    assert live.path[0].tolist() == beside.tolist()


def test_where_nothing_is_in_the_way_any_more_the_path_becomes_short():
    wall = er.Box((0.05, 0.4, 0.9), xyz=(0.6, 0.0, 0.5), name="wall")
    live = er.Replanner(world_of(wall), GOAL)
    assert live.update(START).cost > 1.02 * np.linalg.norm(GOAL - START)
    live.update(START, removed="wall")
    for _ in range(20):
        result = live.update(START)
    assert result.cost < 1.02 * np.linalg.norm(GOAL - START)


def test_what_blocks_the_arm_or_its_goal_has_its_status_and_when_it_leaves_there_is_a_path():
    live = er.Replanner(world_of(), GOAL)
    for where, status in ((GOAL, "goal_invalid"), (START, "start_invalid")):
        at = er.Pose(tuple(tips(live.world, where)[0].tolist()))
        result = live.update(START, moved={"box 3": at})
        assert (result.status, result.path, live.path) == (status, None, None)
        assert "'box 3'" in result.message
        assert live.update(START, moved={"box 3": FAR}).solved


def test_an_update_that_finds_no_path_says_so_and_the_next_ones_go_on():
    wall = er.Box((0.05, 0.4, 0.9), xyz=(0.6, 0.0, 0.5), name="wall")
    live = er.Replanner(world_of(wall), GOAL, motions=12)
    results = [live.update(START) for _ in range(60)]
    assert results[0].status == "budget_spent"
    assert "other trees" in results[0].message
    assert any(result.solved for result in results)


def test_obstacles_come_and_go_and_a_whole_scene_can_be_given():
    live = er.Replanner(world_of(), GOAL)
    live.update(START, added=[er.Sphere(0.05, xyz=(0.0, 0.0, 1.5), name="ball")], moved={"ball": er.Pose((0, 0, 2))})
    assert live.world.scene.obstacles[-1].xyz == (0.0, 0.0, 2.0)
    live.update(START, removed=["ball", "box 1"])
    assert live.world.scene.names == tuple(f"box {i}" for i in range(COUNT) if i != 1)
    live.update(START, er.Scene([er.Sphere(0.05, xyz=(0.0, 0.0, 2.0), name="ball")]))
    assert live.world.scene.names == ("ball",)


def test_a_pose_is_reached_in_a_posture_that_is_free_now():
    robot = er.load_robot("ur5")
    world = er.ArmWorld(robot, er.Scene([er.Box((0.1, 0.1, 0.1), xyz=(5, 0, 0), name="box 0")]))
    pose = er.PoseGoal(er.Pose((0.4, 0.3, 0.4)), position_only=True)
    live, start = er.Replanner(world, pose), robot.configuration("home")
    first = live.update(start)
    assert first.solved
    assert len(first.goals) > 1
    # A box into the arm in that posture, but neither where it starts nor in all others.
    for position in np.random.default_rng(0).uniform(-0.1, 0.1, (200, 3)) + tips(world, first.path[-1]):
        moved = {"box 0": er.Pose(tuple(position.tolist()))}
        free = world.moved(moved).valid(np.stack([start, first.path[-1], *first.goals]))
        if free[0] and not free[1] and free[2:].any():
            break
    second = live.update(start, moved=moved)
    for _ in range(20):
        second = second if second.solved else live.update(start)
    assert second.solved
    assert second.goal_index != first.goal_index
    assert live.world.valid(second.path[-1])


def test_the_same_updates_give_the_same_paths_and_another_seed_others():
    def paths(rng):
        live, rows = er.Replanner(world_of(), GOAL, rng=rng), []
        for k in range(8):
            at = er.Pose((0.5 + 0.02 * k, 0.05 * k - 0.2, 0.5))
            result = live.update(START, moved={f"box {k}": at})
            rows.append(None if result.path is None else result.path.tolist())
        return rows

    assert paths(0) == paths(0)
    assert paths(0) != paths(3)


def test_threads_update_one_after_the_other_and_each_gets_a_path_from_where_it_is():
    wall = er.Box((0.05, 0.4, 0.9), xyz=(0.6, 0.0, 0.5), name="wall")
    live = er.Replanner(world_of(wall), GOAL)
    starts = [START + 0.05 * i for i in range(8)]
    for results in together(*(lambda q=q: live.update(q) for q in starts)):
        for q, result in zip(starts, results, strict=True):
            assert result.path[0].tolist() == q.tolist()
            assert least_clearance(result.world, result.path) > 0.0


@pytest.mark.parametrize(
    ("given", "error", "words"),
    [
        ({"moved": {"box 99": FAR}}, UnknownName, "box 99"),
        ({"moved": {"box 1": (0, 0, 1)}}, InvalidValue, "the pose of obstacle 'box 1' must be a Pose"),
        ({"moved": [FAR]}, InvalidValue, "poses must be a mapping"),
        ({"removed": "table"}, UnknownName, "table"),
        ({"added": [er.Sphere(0.1, name="box 2")]}, InvalidValue, "box 2"),
        ({"scene": er.Scene(), "moved": {"box 1": FAR}}, UnknownName, "box 1"),
        ({"moves": {}}, UnknownName, "moves"),
    ],
)
def test_an_update_with_the_wrong_thing_says_what_it_may_be_and_nothing_has_changed(given, error, words):
    live = er.Replanner(world_of(), GOAL)
    before, path = live.update(START).path.tolist(), live.world
    with pytest.raises(error, match=words):
        live.update(START, **given)
    with pytest.raises(InvalidValue, match="q must be 5 finite numbers"):
        live.update(START[:4], moved={"box 1": er.Pose()})
    assert live.world is path
    assert live.path.tolist() == before


def test_only_an_arm_is_planned_for_and_its_goal_is_read_at_once():
    with pytest.raises(InvalidValue, match="world must be an ArmWorld"):
        er.Replanner(er.GridMap(np.zeros((9, 9), dtype=bool)), (1, 1))
    with pytest.raises(UnknownName, match="nowhere"):
        er.Replanner(world_of(), "nowhere")
    with pytest.raises(InvalidValue, match="motions"):
        er.Replanner(world_of(), GOAL, motions=0)


def test_a_scene_whose_obstacles_were_moved_is_the_one_that_is_made_anew():
    scene = er.Scene.of_boxes(np.full((9, 3), 0.1), np.arange(27.0).reshape(9, 3))
    poses = {f"box {i}": er.Pose((i, 0.5, 1.0), rpy=(0.1 * i, 0.2, 0.3)) for i in (1, 4, 7)}
    moved = scene.moved({name: er.Pose() for name in poses}).moved(poses)
    expected = replace(
        scene, obstacles=tuple(each.at(poses.get(each.name, each.body.pose)) for each in scene.obstacles)
    )
    np.testing.assert_array_equal(moved.rows, expected.rows)
    assert moved == expected
    assert moved.fingerprint() == expected.fingerprint() != scene.fingerprint()
    assert moved.without("box 4").names == tuple(name for name in scene.names if name != "box 4")
    assert er.Scene([er.Box((1, 1, 1), name="a"), er.PointCloud([(0, 0, 1)], 0.1, name="b")]).moved(
        {"b": er.Pose((1, 2, 3))}
    ).obstacles[1].xyz == (1, 2, 3)
