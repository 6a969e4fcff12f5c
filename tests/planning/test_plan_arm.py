"""Planning for an arm in one call."""

import json

import numpy as np
import pytest

import evenroad as er
from evenroad.cli import main
from evenroad.collision.validate import MeshCheck
from evenroad.errors import InvalidValue
from evenroad.planning.read_problem import arm_problem
from evenroad.planning.reading import Reading
from evenroad.roadmap import Budget
from evenroad.robot import Obstacle, link_poses
from tests.refused import refused
from tests.robots.mesh_arms import write_fork_arm


def test_names_files_and_values_give_the_path_that_the_command_gives(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    line = ["plan", "box-reach.yaml", "--robot", "ur5", "--start", "home", "--goal", "inside", "--no-picture"]
    assert main([*line, "--out", "a"]) == 0
    expected = json.loads((tmp_path / "a.json").read_text())["path"]
    scene, robot = er.load_scene("box-reach"), er.load_robot("ur5")
    goal = [scene.states["inside"][joint] for joint in robot.group]
    for asked in (
        ("box-reach", "ur5", "home", "inside"),
        (scene, robot, "home", goal),
        (scene, "ur5", np.array([scene.states["home"][joint] for joint in robot.group]), "inside"),
    ):
        result = er.plan(asked[0], *asked[2:], robot=asked[1])
        assert result.solved
        assert result.path.tolist() == expected


def test_with_points_the_path_is_that_of_the_command_with_so_many(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    line = ["plan", "box-reach.yaml", "--robot", "ur5", "--start", "home", "--goal", "inside", "--no-picture"]
    assert main([*line, "-n", "1024", "--out", "a"]) == 0
    expected = json.loads((tmp_path / "a.json").read_text())["path"]
    for points in (1024, er.draw("even", 1024, 6)):
        result = er.plan("box-reach", "home", "inside", er.PRM(points), robot="ur5")
        assert result.planner == "prm lazy"
        assert result.path.tolist() == expected


def test_ends_and_options_that_do_not_fit_are_refused():
    with pytest.raises(er.errors.InvalidValue, match="with the file of a robot"):
        er.plan("box-reach", "home", "inside", robot=er.load_robot("ur5"), group="a")
    with pytest.raises(er.errors.InvalidValue, match="start must be 6 finite numbers"):
        er.plan("box-reach", [0.0, 0.0], "inside", robot="ur5")
    with pytest.raises(er.errors.UnknownName, match="unknown state 'outside'"):
        er.plan("box-reach", "home", "outside", robot="ur5")


def test_meshes_have_the_last_word(tmp_path, monkeypatch):
    write_fork_arm(tmp_path)
    (tmp_path / "desk.yaml").write_text(
        "obstacles: {}\nstates:\n  home: {turn: 0, bend: 0, slide: 0}\n  away: {turn: 0.5, bend: 0.2, slide: 0.1}\n"
    )
    monkeypatch.setattr("evenroad.planning.finish.validate", lambda *_: MeshCheck("in collision", 7, "at (0, 0, 0)"))
    result = er.plan(tmp_path / "desk.yaml", "home", "away", er.PRM(64), robot=tmp_path / "arm.urdf")
    assert result.status == "mesh_collision"
    assert not result.solved
    assert result.meshes == MeshCheck("in collision", 7, "at (0, 0, 0)")
    assert "not for the shapes that they stand for: in collision at (0, 0, 0)" in result.message


def test_a_planner_refuses_constraints_which_only_plan_can_keep():
    wanted = {"constraints": er.CartesianLine(0.05)}
    problem = arm_problem("ur5", "box-reach", "home", "inside", Reading(), wanted)
    refused(InvalidValue, "a planner knows no constraints", er.RRTConnect().solve, problem)


def test_without_points_trees_plan_and_the_path_is_proved():
    query = arm_problem("ur5", "box-reach", "home", "inside")
    result = er.plan("box-reach", "home", "inside", robot="ur5", certified=True)
    assert result.solved
    assert result.planner == "trees"
    assert result.proof == "certified"
    assert query.world.validate(result.path).all()
    assert result.counts["nodes"] > 2


def test_of_several_goals_one_is_reached_and_named():
    scene = er.load_scene("box-reach")
    q = [scene.states["home"][joint] for joint in er.load_robot("ur5").group]
    near = np.array(q) + 0.1
    result = er.plan(scene, "home", ["inside", near], er.RRTConnect(improve=True), robot="ur5", seconds=0.2)
    assert result.goal_index == 1
    assert np.array_equal(result.path[-1], near)
    assert result.message.endswith("to goal 1")
    result = er.plan(scene, "home", [near, "inside", near], er.PRM(64), robot="ur5")
    assert result.goals.shape == (3, 6)
    other_way = er.plan(scene, near, ["inside", "home"], robot="ur5")
    assert "to goal 1 (home)" in other_way.message
    assert er.plan(scene, "home", np.stack([near, near]), robot="ur5").goals.shape == (2, 6)


def test_more_rounds_never_give_a_longer_path_and_the_same_rounds_the_same():
    def after(rounds):
        budget = Budget(seconds=None, rounds=rounds)
        return er.plan("box-reach", "home", "inside", er.RRTConnect(improve=True), robot="ur5", limits=budget)

    first = er.plan("box-reach", "home", "inside", robot="ur5")
    results = [after(rounds) for rounds in (1, 10, 60, 60)]
    costs = [first.cost, *(result.cost for result in results)]
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] < 0.97 * first.cost
    assert np.array_equal(results[2].path, results[3].path)
    world = arm_problem("ur5", "box-reach", "home", "inside").world
    assert world.validate(results[3].path).all()


def test_a_motion_that_cannot_be_proved_is_named(monkeypatch):
    doubt = np.array([True, False, True, True, True])
    monkeypatch.setattr(er.ArmWorld, "validate", lambda self, path: doubt[: len(path) - 1])
    result = er.plan("box-reach", "home", "inside", robot="ur5", certified=True)
    assert result.status == "not_certified"
    assert "motion 2 of 8 is not proved free, from (" in result.message
    assert not result.solved
    assert result.proof == "resolution"


def test_joint_values_within_five_decimals_of_a_limit_stay_what_they_are():
    robot = er.load_robot("ur5")
    low, high = arm_problem("ur5", "box-reach", "home", "inside").world.bounds[:2]
    home = [er.load_scene("box-reach").states["home"][joint] for joint in robot.group]
    for limit, off in ((high[0], 9e-6), (low[0], -9e-6)):
        beyond = [limit + off, *home[1:]]
        for place in (beyond, ",".join(map(repr, map(float, beyond)))):
            query = arm_problem("ur5", "box-reach", place, place)
            assert query.start.tolist() == query.goals[0].tolist() == beyond
    query = arm_problem("ur5", "box-reach", [high[0] + 2e-5, *home[1:]], "home")
    assert query.start[0] == high[0] + 2e-5
    assert er.plan("box-reach", query.start, "home", robot="ur5").status == "start_outside_limits"
    with pytest.raises(er.errors.InvalidValue, match="outside the limits of scene 'box-reach'"):
        arm_problem("ur5", "box-reach", f"{float(high[0]) + 2e-5},0,0,0,0,0", "home")


def test_what_is_of_no_world_is_named():
    with pytest.raises(er.errors.InvalidValue, match="resolutoin: .* did you mean 'resolution'?"):
        er.plan("box-reach", "home", "inside", robot="ur5", resolutoin=0.1)
    with pytest.raises(er.errors.InvalidValue, match="needs radius=, of a disk on this map, or robot="):
        er.plan("box-reach", "home", "inside")


def test_a_goal_that_an_arm_cannot_leave_is_explained():
    robot, scene = er.load_robot("ur5"), er.load_scene("box-reach")
    home = [scene.states["home"][joint] for joint in robot.group]
    goal = [1.0, *home[1:]]
    # Balls around the forearm, which stands upright; they leave it a centimetre.
    posts = [
        Obstacle.of(f"ball{i}", "sphere", (0.05,), (-0.014 + 0.102 * x, 0.009 + 0.102 * y, 0.7))
        for i, (x, y) in enumerate(
            zip(np.cos(np.arange(8) * np.pi / 4), np.sin(np.arange(8) * np.pi / 4), strict=False)
        )
    ]
    start = [0.0, -1.0, *home[2:]]
    for planner in (None, er.PRM(64)):
        limits = {"motions": 3000}
        result = er.plan(er.Scene(tuple(posts), name="balls"), start, goal, planner, robot="ur5", limits=limits)
        assert not result.solved
        assert "The goal is nearly enclosed: " in result.message
        assert "'forearm_link' touches 'ball" in result.message
        assert "The start is" not in result.message


def tip_of(robot, q, tip):
    return link_poses(robot, np.atleast_2d(q))[0, robot.links.index(tip)]


def test_a_pose_is_a_goal_and_the_path_ends_there():
    pose = er.Pose.from_rpy((0.65, 0.0, 0.2), (0.0, np.pi / 2, 0.0))
    result = er.plan("box-reach", "home", pose, robot="ur5")
    assert result.solved
    assert "(tool0 at (0.65, 0, 0.2))" in result.message
    assert np.abs(tip_of(er.load_robot("ur5"), result.path[-1], "tool0") - pose.matrix).max() < 1e-6
    assert "goals" in result.timings


def test_the_matrix_of_a_pose_is_the_pose_alone_and_among_others():
    world = er.ArmWorld("ur5", "box-reach")
    poses = [er.Pose.from_rpy((0.65, y, 0.2), (0.0, np.pi / 2, 0.0)) for y in (0.05, -0.05)]
    by_pose, matrices = er.plan(world, "home", poses), np.array([pose.matrix for pose in poses])
    for goals in (matrices, list(matrices)):
        np.testing.assert_array_equal(er.plan(world, "home", goals).goals, by_pose.goals)
    one, of_pose = er.plan(world, "home", matrices[0]), er.plan(world, "home", poses[0])
    np.testing.assert_array_equal(one.path, of_pose.path)
    refused(er.errors.InvalidValue, "matrix", er.plan, world, "home", 2.0 * matrices[0])


def test_of_poses_and_configurations_the_path_ends_at_one_and_the_cheapest_where_that_is_asked_for():
    poses = [er.Pose.from_rpy((0.65, y, 0.2), (0.0, np.pi / 2, 0.0)) for y in (0.05, -0.05)]
    first = er.plan("box-reach", "home", [*poses, "inside"], robot="ur5")
    best = er.plan(
        "box-reach", "home", [*poses, "inside"], er.RRTConnect(improve=True), robot="ur5", limits={"rounds": 30}
    )
    assert first.solved
    assert best.cost <= first.cost
    assert len(first.goals) > 3


def test_a_pose_that_cannot_be_reached_is_an_answer_and_does_not_stop_the_others():
    far = er.plan("box-reach", "home", er.Pose((2.0, 0.0, 0.0)), robot="ur5")
    assert far.status is er.Status.GOAL_UNREACHABLE
    assert "out of reach" in far.message
    assert far.path is None
    inside_wall = er.plan("box-reach", "home", er.PoseGoal(er.Pose((0.9, 0.0, 0.2)), position_only=True), robot="ur5")
    assert inside_wall.status is er.Status.GOAL_INVALID
    assert "touches 'box back'" in inside_wall.message
    result = er.plan("box-reach", "home", [er.Pose((2.0, 0.0, 0.0)), "inside"], robot="ur5")
    assert result.solved
