"""A path that was found among capsules is checked again with the meshes, state by state."""

import json
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from tests.robots.mesh_arms import write_fork_arm, write_plate_arm

from evenroad.cli import main
from evenroad.collision.coal_world import CoalWorld, original_shapes
from evenroad.collision.validate import has_meshes, unseen_pairs, validate
from evenroad.errors import BrokenFile
from evenroad.loading.load import load_model
from evenroad.robot import ArmWorld, Obstacle, Scene, link_poses, load_robot
from evenroad.space.path import resample
from tests_peers.second_judge import free_for_both

pytest.importorskip("coal")

NOTHING = Scene((), name="nothing")


@pytest.fixture
def arm(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return write_fork_arm(tmp_path)


def test_states_are_those_at_which_a_motion_is_checked(arm):
    """Both ends of every motion and what divides it, no further apart than asked, the shorter way round."""
    space = ArmWorld(load_robot(arm), NOTHING).space
    path = np.array([[3.0, 0.0, 0.1], [-3.0, 0.4, 0.1], [-3.0, 0.4, 0.1], [-2.0, 0.4, 0.0]])
    states, motions = resample(path, space, 0.05)
    steps = space.distance(states[:-1], states[1:])
    assert steps.max() <= 0.05 + 1e-12
    lengths = space.distance(path[:-1], path[1:])
    assert lengths[0] < 0.6, "the first joint turns on through pi"
    counts = [1 + int(np.ceil(lengths[0] / 0.05)), 1, int(np.ceil(lengths[2] / 0.05))]
    assert np.bincount(motions).tolist() == counts
    np.testing.assert_allclose(space.distance(states[-1:], path[-1:]), 0.0, atol=1e-12)


def test_one_waypoint_is_one_state(arm):
    space = ArmWorld(load_robot(arm), NOTHING).space
    states, motions = resample(np.zeros((1, 3)), space, 0.05)
    assert (states.tolist(), motions.tolist()) == ([[0.0, 0.0, 0.0]], [0])


def test_only_a_robot_whose_urdf_names_a_mesh_has_meshes(arm):
    assert has_meshes(load_model(arm))
    assert has_meshes(load_model(arm)), "out of the cache, too"
    assert not has_meshes(load_model("ur5"))


def test_a_path_that_is_free_for_the_capsules_is_free_for_the_meshes(arm):
    robot = load_robot(arm)
    path = np.array([[0.0, 0.0, 0.0], [0.5, 0.5, 0.2], [1.0, 0.0, 0.0]])
    check = validate(arm, robot, NOTHING, path)
    assert check.verdict == "free"
    assert str(check) == f"free ({check.states} states)"
    world = CoalWorld(robot, NOTHING, original_shapes(arm, robot))
    assert free_for_both(world, resample(path, world.space, 0.005)[0]).all()


def test_a_contact_is_named_with_its_motion_and_its_state(arm):
    robot = load_robot(arm)
    scene = Scene((Obstacle.of("wall", "box", (1.0, 0.02, 1.0), (0.3, 0.15, 0.6)),), name="wall")
    path = np.array([[-0.4, 0.0, 0.0], [-0.2, 0.0, 0.0], [1.5, 0.0, 0.0]])
    check = validate(arm, robot, scene, path)
    assert check.verdict == "in collision"
    assert "in motion 1 of the path: 'fork' touches 'wall'" in check.message
    assert str(check).startswith("in collision at (")
    assert -0.2 < check.configuration[0] < 1.5
    before = np.array([[-0.4, 0.0, 0.0], [check.configuration[0] - 0.05, 0.0, 0.0]])
    assert validate(arm, robot, scene, before).verdict == "free", "it is the first"


def test_a_mesh_that_is_gone_by_then_is_an_error(arm, tmp_path):
    robot = load_robot(arm)
    (tmp_path / "meshes" / "fork.stl").unlink()
    with pytest.raises(BrokenFile, match=r"fork\.stl"):
        validate(arm, robot, NOTHING, np.zeros((2, 3)))


# ---- pairs that the planner does not test

PLATE_WAY = np.array([[0.0, -1.0, 0.0], [0.5, 0.5, 0.1], [1.0, 1.6, 0.0]])
"""The tip of the plate arm comes from above and ends in the plate."""


def test_a_pair_that_the_planner_does_not_test_is_tested_with_its_shapes(arm, tmp_path):
    file = write_plate_arm(tmp_path)
    model = load_model(file)
    assert not ArmWorld(model.robot, NOTHING).validate(PLATE_WAY).all(), "it sees the tip in the plate"
    pair = ("plate", "tip")
    robot = replace(model.robot, pairs=tuple(other for other in model.robot.pairs if other != pair))
    unseen = (*unseen_pairs(model), pair)
    assert not has_meshes(model), "it is not for meshes alone"
    assert ArmWorld(robot, NOTHING).validate(PLATE_WAY).all(), "nobody else sees it"
    check = validate(file, robot, NOTHING, PLATE_WAY, unseen=unseen)
    assert check.verdict == "in collision"
    assert "in motion 1 of the path: 'plate' touches 'tip'" in check.message
    assert validate(file, robot, NOTHING, PLATE_WAY[:2], unseen=unseen).verdict == "free"


def test_a_pair_whose_shapes_always_touch_is_left_out_and_named(arm, tmp_path):
    file = write_plate_arm(tmp_path)
    model = load_model(file)
    check = validate(file, model.robot, NOTHING, PLATE_WAY[:2], unseen=unseen_pairs(model))
    assert ("plate", "collar") in check.always_touching
    assert ("plate", "tip") not in check.always_touching
    assert "left out, for they always touch: " in str(check)
    assert "'plate' with 'collar'" in str(check)


def test_a_graze_between_the_states_of_the_planner_is_found(arm):
    """A thin post beside the way of the fork: a tenth of the resolution sees what the resolution itself passes over."""
    robot = load_robot(arm)
    path = np.array([[-0.4, 0.0, 0.0], [1.5, 0.0, 0.0]])
    coarse = resample(path, ArmWorld(robot, NOTHING).space, 0.951)[0]
    between = 0.5 * (coarse[0] + coarse[1])
    corner = link_poses(robot, between[np.newaxis])[0, robot.links.index("fork")]
    place = corner[:3, :3] @ (0.05, 0.0, 0.02) + corner[:3, 3]
    scene = Scene((Obstacle.of("needle", "sphere", (1e-3,), tuple(place)),), name="needle")
    assert CoalWorld(robot, scene, original_shapes(arm, robot)).valid(coarse).all()
    check = validate(arm, robot, scene, path, resolution=0.951)
    assert check.verdict == "in collision"
    assert "'fork' touches 'needle'" in check.message


def test_a_plan_into_what_only_the_shapes_see_is_not_handed_out(arm, tmp_path, capsys):
    write_plate_arm(tmp_path)
    (tmp_path / "empty.yaml").write_text("obstacles: {}\n")
    (tmp_path / "bodies.yaml").write_text("tip: [{centre: [0.02, 0, 0], radius: 0.001}]\n")
    robot = ["--robot", "plate.urdf", "--bodies", "bodies.yaml"]
    words = ["plan", "empty.yaml", *robot, "-n", "64", "--out", "b"]
    assert main([*words, "--start", "0", "-1", "0", "--goal", "1", "0.2", "0"]) == 0
    assert json.loads((tmp_path / "b.json").read_text())["meshes"]["verdict"] == "free"
    assert main([*words, "--start", "0", "-1", "0", "--goal", "1", "1.6", "0"]) == 1
    record = json.loads((tmp_path / "b.json").read_text())
    assert record["status"] == "mesh_collision"
    assert "'plate' touches 'tip'" in record["message"]
    assert not (tmp_path / "b.csv").exists()
    assert "left out" in " ".join(capsys.readouterr().out.split())


SCENE = """
obstacles:
  post: {shape: cylinder, radius: 0.03, length: 0.6, xyz: [0.2, 0.2, 0.8]}
states:
  home: {turn: 0.0, bend: 0.0, slide: 0.1}
  away: {turn: 1.6, bend: 0.0, slide: 0.1}
"""
ENDS = ["--start", "home", "--goal", "away"]
PLAN = ["plan", "desk.yaml", "--robot", "arm.urdf", *ENDS, "-n", "256", "--out", "a"]


def planned(capsys, tmp_path, *more):
    (tmp_path / "desk.yaml").write_text(SCENE)
    code = main([*PLAN, *more])
    captured = capsys.readouterr()
    assert captured.err == ""
    return code, " ".join(captured.out.split()), json.loads((tmp_path / "a.json").read_text())


@pytest.mark.parametrize("file", ["meshes/fork.stl", "package://lab/meshes/fork.stl"])
def test_a_plan_says_that_its_path_is_free_for_the_meshes(arm, tmp_path, capsys, file):
    write_fork_arm(tmp_path, file=file)
    (tmp_path / "lab").symlink_to(tmp_path)
    code, out, record = planned(capsys, tmp_path)
    assert code == 0
    assert record["status"] == "solved"
    assert record["meshes"]["verdict"] == "free"
    assert record["meshes"]["states"] > 30
    assert f"second check free ({record['meshes']['states']} states)" in out


def test_bodies_that_leave_a_mesh_out_are_found_out_and_no_path_is_written(arm, tmp_path, capsys):
    """The user's own ball for the fork is far smaller than it: the planner goes through the post."""
    (tmp_path / "small.yaml").write_text("fork: [{centre: [0, 0, 0], radius: 0.01}]\n")
    (tmp_path / "a.csv").write_text("old")
    code, out, record = planned(capsys, tmp_path, "--bodies", "small.yaml")
    assert code == 1
    assert record["status"] == "mesh_collision"
    assert record["meshes"]["verdict"] == "in collision"
    assert "'fork' touches 'post'" in record["message"]
    assert "second check in collision at (" in out
    assert "mesh_collision" in out
    assert len(record["path"]) >= 2, "what was found, to look at"
    assert not (tmp_path / "a.csv").exists(), "a table of numbers cannot say that it is not to be driven"
    assert (tmp_path / "a.png").exists()


def test_a_mesh_between_whose_triangles_there_is_room_is_not_filled(arm, tmp_path):
    """A fork stands with one prong on each side of a post: free, which its convex hull would not be."""
    robot = load_robot(arm)
    hull = trimesh.load_mesh(tmp_path / "meshes" / "fork.stl").convex_hull
    q = np.array([[0.0, 0.0, 0.1]])
    frame = link_poses(robot, q)[0, robot.links.index("fork")]
    middle = frame[:3, :3] @ (0.05, 0.0, 0.12) + frame[:3, 3]
    scene = Scene((Obstacle.of("ball", "sphere", (0.04,), tuple(middle)),), name="ball")
    assert validate(arm, robot, scene, q).verdict == "free"
    hull.export(tmp_path / "meshes" / "fork.stl")
    assert validate(arm, robot, scene, q).verdict == "in collision"
