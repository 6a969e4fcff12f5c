"""What a robot's roadmap is made of, what it is refused for, and its file."""

from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue
from evenroad.geometry import Mesh, PointCloud, Pose, TriangleMesh
from evenroad.geometry.shapes import Box, Capsule
from evenroad.roadmap import Budget, KNearest, Radius, Status
from evenroad.robot import ArmWorld, Joint, Mimic, Obstacle, Scene, link_poses, with_group, with_limits
from evenroad.robot_roadmap import free_probability
from evenroad.robot_roadmap.build import arm_roadmap, build_roadmap
from evenroad.robot_roadmap.recipe import Recipe, displacement_weights, spread_order
from evenroad.robot_roadmap.static_scene import joined_scenes
from evenroad.robot_roadmap.turns import whole_turns
from tests.refused import refused
from tests.robot.kernel_arms import STRAIGHT, TABLE, Z, box_scene, ur5
from tests.robot.surface_oracle import all_clearance
from tests.robot_roadmap.worlds import within


@pytest.fixture(scope="module")
def roadmap():
    return arm_roadmap(ArmWorld(ur5(joints=3), TABLE), 40, 4, recipe=Recipe(0.0, 100))


def test_milestones_and_motions_are_free_of_robot_and_cell(roadmap):
    world = ArmWorld(ur5(joints=3), TABLE)
    assert len(roadmap.milestones) == 40
    assert world.valid(roadmap.milestones).all()
    a, b = roadmap.milestones[roadmap.edges[:, 0]], roadmap.milestones[roadmap.edges[:, 1]]
    b = b + 2.0 * np.pi * roadmap.turns
    # Where the second end is past a limit, the first may be turned back.
    back = np.where(b > world.space.high, -1, np.where(b < world.space.low, 1, 0)) * 2.0 * np.pi
    assert world.motion_certified(a + back, b + back, 1e-6).all()
    assert np.bincount(roadmap.edges.ravel(), minlength=40).min() >= 4


def test_clouds_and_meshes_of_a_cell_are_kept_in_its_file(tmp_path):
    """What its file says is free of them is so in double precision, and the day's scene has them."""
    corners = [(0, 0, 0), (0.3, 0, 0), (0, 0.3, 0), (0, 0, 0.5)]
    wedge = TriangleMesh(corners, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)], "wedge")
    points = np.random.default_rng(0).uniform((-0.5, 0.4, 0.2), (0.1, 0.6, 0.6), (60, 3))
    cell = TABLE.with_(
        Obstacle("wedge", Mesh(wedge, pose=Pose.from_rpy((0.35, -0.3, 0.05), (0.2, 0.1, 0.4))), cell=True),
        Obstacle("scan", PointCloud(points, 0.02, pose=Pose((0.0, 0.05, 0.0)))),
    )
    robot = ur5(joints=3)
    made = arm_roadmap(ArmWorld(robot, cell), 40, 4, recipe=Recipe(4.0, 20))
    assert all_clearance(robot, cell, made.milestones).min() > 0.0
    plain = arm_roadmap(ArmWorld(robot, TABLE), 40, 4, recipe=Recipe(4.0, 20))
    assert not ArmWorld(robot, cell).valid(plain.milestones).all(), "they are in the way of something"
    made.save(tmp_path / "a.roadmap")
    again = er.load_roadmap(tmp_path / "a.roadmap")
    assert again.scene == cell
    np.testing.assert_array_equal(again.edges, made.edges)
    known = within(again, Scene((Obstacle.of("ball", "sphere", (0.05,), (0.5, 0.3, 0.4)),), name="today"))
    assert [each.name for each in known.world.scene.obstacles] == ["table", "wedge", "scan", "ball"]
    solved = 0
    for start, goal in zip(made.milestones[:8], made.milestones[8:16], strict=True):
        result = known.plan(start, goal)
        if result.solved:
            solved += 1
            assert known.world.validate(result.path).all()
    assert solved >= 4
    moved = cell.without("wedge").with_(Obstacle("wedge", Mesh(wedge), cell=True))
    refused(InvalidValue, "'wedge' of scene 'cell' is a mesh", again.within, ArmWorld(robot, moved))


def test_the_same_arguments_give_the_same_roadmap(roadmap):
    again = arm_roadmap(ArmWorld(ur5(joints=3), TABLE), 40, 4, recipe=Recipe(0.0, 100))
    np.testing.assert_array_equal(again.milestones, roadmap.milestones)
    np.testing.assert_array_equal(again.edges, roadmap.edges)
    other = arm_roadmap(ArmWorld(ur5(joints=3), TABLE), 40, 4, recipe=Recipe(0.0, 100), rng=1)
    assert not np.array_equal(other.milestones, roadmap.milestones)


def test_each_milestone_is_the_farthest_from_those_before():
    points = np.random.default_rng(0).random((300, 2))
    order = spread_order(points, np.array([np.inf, 1.0]), np.ones(300), 40)
    apart = np.abs(points[:, np.newaxis] - points[order])
    apart[..., 1] = np.minimum(apart[..., 1], 1.0 - apart[..., 1])
    distances = np.linalg.norm(apart, axis=2)
    for i in range(1, 40):
        assert distances[:, :i].min(axis=1).argmax() == order[i]


def test_random_scenes_leave_more_room_to_an_arm_that_is_folded(monkeypatch):
    monkeypatch.setattr(free_probability, "SEEN", 100)
    straight, folded = [0.0, -0.3, 0.0], [0.0, -1.57, 2.6]
    q = np.concatenate([np.random.default_rng(0).uniform(-3, 3, (98, 3)), [straight, folded]])
    shares = free_probability.free_probability(ur5(joints=3), q, 200, np.random.default_rng(1))
    assert 0.3 < shares[-2] < shares[-1] <= 1.0


def test_one_milestone_and_ones_that_cannot_be_made():
    one = arm_roadmap(ArmWorld(ur5(joints=3), TABLE), 1, recipe=Recipe(0.0, 100))
    assert one.edges.shape == (0, 2)
    assert within(one, Scene(name="today")).plan([0.0, -1.5, 0.0], [1.0, -1.5, 0.0]).solved
    for n in (0, -3, 1.5, 1 << 16):
        refused(InvalidValue, "n must be", arm_roadmap, ArmWorld(ur5(), TABLE), n)
    refused(InvalidValue, "k must be", arm_roadmap, ArmWorld(ur5(), TABLE), 8, k=0)


def test_a_robot_that_is_never_free_is_refused_with_what_blocks():
    with pytest.raises(InvalidValue, match="never free: 'base' always touches 'table'"):
        arm_roadmap(ArmWorld(ur5(), replace(TABLE, allowed=frozenset())), 8)
    wall = Obstacle.of("room", "box", (4.0, 4.0, 4.0))
    links = ("base", "shoulder", "upperarm")
    full = Scene((wall,), name="full", allowed=frozenset((link, "room") for link in links))
    with pytest.raises(InvalidValue, match=r"never free: of \d+ .* in .* of the last 100 .* touches 'room'"):
        arm_roadmap(ArmWorld(ur5(joints=3), full), 8)


def test_a_turn_of_a_joint_that_others_follow_is_not_nothing():
    robot = ur5()
    mimic = Mimic("wrist_3_joint", 0.5)
    follower = Joint("finger", "revolute", "wrist3", "f", (0, 0, 0.1), STRAIGHT, Z, -9, 9, mimic=mimic)
    robot = replace(robot, links=(*robot.links, "f"), joints=(*robot.joints, follower))
    assert whole_turns(robot).tolist() == [True] * 5 + [False]


def test_a_slider_that_goes_straight_up_has_a_roadmap(monkeypatch):
    monkeypatch.setattr("evenroad.robot_roadmap.recipe.SCENES", 20)
    joint = Joint("lift", "prismatic", "base", "sled", (0, 0, 0), STRAIGHT, Z, 0.0, 1.0)
    body = Capsule((0, 0, 0), (0, 0, 0.1), 0.05, link="sled")
    robot = er.Robot("lift", ("base", "sled"), (joint,), (body,), (), ("lift",))
    roadmap = arm_roadmap(ArmWorld(robot), 16, recipe=Recipe(4.0, 100))
    assert displacement_weights(robot, roadmap.milestones).tolist() == [1.0]
    lid = Scene((Obstacle.of("lid", "box", (1, 1, 0.1), (0, 0, 0.8)),), name="lid")
    assert within(roadmap, lid).plan([0.0], [0.5]).solved
    assert within(roadmap, lid).plan([0.0], [0.9]).status == "goal_invalid"


def test_several_goals_and_none_that_is_free(roadmap):
    inside, free, far = [0.0, 0.6, 0.0], [1.0, -1.5, 0.0], [3.0, -1.5, 0.0]
    result = within(roadmap, box_scene()).plan([0.0, -1.5, 0.0], [inside, far, free])
    assert result.solved
    assert result.goal_index == 2
    assert result.proof == "certified"
    assert within(roadmap, box_scene()).plan([0.0, -1.5, 0.0], [inside, inside]).status == "goal_invalid"
    assert within(roadmap, box_scene()).plan(inside, free).status == "start_invalid"


def test_the_cell_is_there_even_where_the_scene_does_not_name_it(roadmap):
    blocked = within(roadmap, Scene(name="today")).plan([0.0, -1.5, 0.0], [0.0, 0.6, 0.0])
    assert blocked.status == "goal_invalid"
    named = within(roadmap, TABLE).plan([0.0, -1.5, 0.0], [1.0, -1.5, 0.0])
    unnamed = within(roadmap, Scene(name="today")).plan([0.0, -1.5, 0.0], [1.0, -1.5, 0.0])
    np.testing.assert_array_equal(named.path, unnamed.path)


def test_a_scene_that_contradicts_the_cell_is_refused_and_ranges_of_both_hold(roadmap):
    higher = TABLE.obstacles[0].at(replace(TABLE.obstacles[0].body.pose, xyz=(0.25, 0.0, 0.1)))
    with pytest.raises(InvalidValue, match=r"'table' of scene 'cell' is a box of 1, 1.2, 0.05 at \(0.25, 0, 0.1\)"):
        roadmap.within(ArmWorld(roadmap.robot, replace(TABLE, obstacles=(higher,))))
    with pytest.raises(InvalidValue, match="does not allow 'base' to touch it"):
        roadmap.within(ArmWorld(roadmap.robot, replace(TABLE, allowed=frozenset({("shoulder", "table")}))))
    cell, scene = (
        Scene(name="cell", limits={"a": (-1.0, 1.0), "b": (0.0, 1.0)}),
        Scene(name="today", limits={"a": (0.0, 3.0)}),
    )
    assert joined_scenes(cell, scene).limits == {"a": (0.0, 1.0), "b": (0.0, 1.0)}


def with_last(row, **changes):
    return *row[:-1], replace(row[-1], **changes)


@pytest.mark.parametrize(("change", "said"), [
    (lambda r: with_group(r, r.group[:2]),
        "for another group of .* without elbow_joint among its joints of the group"),
    (lambda r: r.with_tool([Capsule((0, 0, 0), (0, 0, 0.1), 0.02)], "wrist3"), "with tool among its links"),
    (lambda r: replace(r, pairs=r.pairs[1:]), "among its tested pairs"),
    (lambda r: replace(r, held={"wrist_1_joint": 1.0}), "'wrist_1_joint' was held at 0, now at 1"),
    (lambda r: replace(r, capsules=r.capsules[:-1]), r"'wrist3' differ: it had 1, .*; this one has none"),
    (lambda r: replace(r, capsules=with_last(r.capsules, radius=0.2)), "one has 1, a capsule of radius 0.2 from"),
    (lambda r: replace(r, joints=with_last(r.joints, xyz=(0, 0, 0.1))), r"'wrist_3_joint' had xyz \(.*\), now \("),
])  # fmt: skip
def test_another_robot_is_refused_with_what_differs(roadmap, change, said):
    refused(InvalidValue, said, within, roadmap, TABLE, change(ur5(joints=3)))


def test_a_joint_that_turns_on_may_have_limits_in_the_cell_but_none_of_a_day(roadmap, tmp_path):
    joint = Joint("turn", "continuous", "base", "arm", (0, 0, 0), STRAIGHT, Z, -np.inf, np.inf)
    body = Capsule((0.2, 0, 0.1), (0.6, 0, 0.1), 0.05, link="arm")
    robot = er.Robot("turner", ("base", "arm"), (joint,), (body,), (), ("turn",))
    limited = Scene(name="limited", limits={"turn": (-1.0, 2.0)})
    recipe = Recipe(4.0, 20)
    endless = arm_roadmap(ArmWorld(robot), 8, recipe=recipe)
    kept = arm_roadmap(ArmWorld(robot, limited), 8, recipe=recipe)
    kept.save(tmp_path / "a.roadmap")
    assert er.load_roadmap(tmp_path / "a.roadmap").milestones.min() >= -1.0
    assert within(kept, Scene(name="today"), robot).world.space.high == (2.0,)
    post = Scene((Obstacle.of("post", "box", (0.1, 0.1, 1.0), (0.5, 0.0, 0.0)),), name="post")
    result = within(endless, post).plan([-0.5], [0.5])
    assert result.solved
    assert within(endless, post).world.validate(result.path).all()
    assert len(result.path) > 2
    refused(InvalidValue, "'turn' had kind continuous, now revolute", within, endless, limited)


def test_other_limits_are_no_other_robot(roadmap):
    narrow = with_limits(ur5(joints=3), {"elbow_joint": (-1.0, 1.0)})
    assert within(roadmap, TABLE, narrow).world.space.high[2] == 1.0


def test_a_file_gives_back_all_of_it(roadmap, tmp_path):
    file = tmp_path / "arm.roadmap"
    roadmap.save(file)
    again = er.load_roadmap(file)
    for name in ("milestones", "edges", "turns", "weights"):
        np.testing.assert_array_equal(getattr(again, name), getattr(roadmap, name))
    assert (again.robot, again.scene, again.clearance, again.resolution) == (roadmap.robot, TABLE, 0.0, 0.05)
    first, second = (within(r, box_scene()).plan([0.0, -1.5, 0.0], [2.0, -1.0, 1.0]) for r in (roadmap, again))
    np.testing.assert_array_equal(first.path, second.path)


def test_a_damaged_file_and_one_of_another_version_are_broken(roadmap, tmp_path, monkeypatch):
    file = tmp_path / "arm.roadmap"
    roadmap.save(file)
    content = file.read_bytes()
    for damaged in (b"", content[:-30], content[:200] + b"\0" + content[201:], b"obstacles: {}"):
        file.write_bytes(damaged)
        refused(er.errors.BrokenFile, "", er.load_roadmap, file)
    refused(er.errors.BrokenFile, "no such file", er.load_roadmap, tmp_path / "other.roadmap")
    monkeypatch.setattr("evenroad.roadmap.npz.__version__", "0.0.1")
    roadmap.save(file)
    monkeypatch.undo()
    refused(er.errors.BrokenFile, "of evenroad 0.0.1, this is", er.load_roadmap, file)
    monkeypatch.setattr("evenroad.roadmap.npz.FORMAT", 2)
    roadmap.save(file)
    monkeypatch.undo()
    refused(er.errors.BrokenFile, r"format 2 .* build the roadmap anew", er.load_roadmap, file)


@pytest.mark.parametrize(("field", "value", "said"), [
    ("edges", lambda a: a + 39, "edges must join milestones"),
    ("turns", lambda a: a + np.int8(2), "by at most one turn"),
    ("milestones", lambda a: a + 4.0, "within the ranges"),
    ("weights", lambda a: -a, "weights must be"),
    ("milestones", lambda a: a[:, :2], "milestones must be float64 of shape"),
    ("milestones", lambda a: a[:0], "edges must join"),
    ("resolution", lambda a: 1e-300, r"arm\.roadmap: resolution must be larger"),
])  # fmt: skip
def test_content_that_no_roadmap_has_is_broken(roadmap, tmp_path, field, value, said):
    file = tmp_path / "arm.roadmap"
    replace(roadmap, **{field: value(getattr(roadmap, field))}).save(file)
    refused(er.errors.BrokenFile, said, er.load_roadmap, file)


def test_a_pose_is_a_goal_as_it_is_elsewhere(roadmap):
    scene, robot = within(roadmap, Scene(name="today")), roadmap.robot
    tip, (start, end) = robot.links[-1], roadmap.milestones[[0, 1]]
    xyz = link_poses(robot, end[np.newaxis])[0, -1, :3, 3]
    pose = er.PoseGoal(er.Pose(tuple(xyz)), tip=tip, position_only=True)
    found = scene.plan(start, pose)
    assert found.solved, found.message
    np.testing.assert_allclose(link_poses(robot, found.path[-1:])[0, -1, :3, 3], xyz, atol=1e-6)
    beside = scene.plan(start, [pose, start])
    assert beside.solved
    assert len(beside.goals) == len(found.goals) + 1
    far = scene.plan(start, er.PoseGoal(er.Pose((9.0, 0.0, 0.0)), tip=tip, position_only=True))
    assert far.status is Status.GOAL_UNREACHABLE
    assert "out of reach" in far.message
    assert far.path is None


CLAMPS = PointCloud([(0.0, 0.0, 0.02)], 0.02), Box((0.02, 0.02, 0.02), xyz=(0.0, 0.0, 0.02))


@pytest.mark.parametrize("body", CLAMPS, ids=["cloud", "box"])
def test_what_touches_the_base_leaves_no_configuration_free(roadmap, body):
    """No joint moves it, so that compiled checks are told nothing of it."""
    known = within(roadmap, Scene((Obstacle("clamp", body),), name="today"))
    assert known.world.fixed_contact is not None
    for trees in (True, False):
        result = known.plan(roadmap.milestones[0], roadmap.milestones[1], trees=trees)
        assert (result.status, result.path) == (Status.START_INVALID, None)
        assert "'clamp'" in result.message
    assert known.connect(roadmap.milestones[0], roadmap.milestones[1:2]).goal == -1


def test_a_spent_budget_is_not_a_roadmap_that_leads_nowhere(roadmap):
    known = within(roadmap, Scene((Obstacle.of("ball", "sphere", (0.05,), (0.4, 0.1, 0.4)),), name="today"))
    statuses = []
    for start, goal in zip(roadmap.milestones[:20], roadmap.milestones[20:], strict=True):
        fresh = within(roadmap, known.world.scene)
        if known.plan(start, goal, trees=False).solved:
            statuses.append(fresh.plan(start, goal, trees=False, budget=Budget(motions=1)).status)
    assert Status.BUDGET_SPENT in statuses
    assert Status.NOT_CONNECTED not in statuses


def test_points_that_are_given_are_the_milestones_where_they_are_free(tmp_path):
    world = ArmWorld(ur5(joints=3), TABLE)
    points = er.draw("even", 64, 3)
    made = build_roadmap(world, points, rule=KNearest(4))
    # Joints of two turns have their milestones within the one in the middle.
    low, high = made.one_turn.low, made.one_turn.high
    q = low + points.points * (high - low)
    np.testing.assert_array_equal(made.milestones, q[world.valid(q)])
    made.save(tmp_path / "given.roadmap")
    known = within(er.load_roadmap(tmp_path / "given.roadmap"), box_scene())
    start, goal = made.milestones[known.world.valid(made.milestones)][:2]
    assert known.world.validate(known.plan(start, goal).path).all()
    refused(InvalidValue, "KNearest", build_roadmap, world, points, rule=Radius(0.5))


def test_a_world_may_keep_as_far_away_as_the_roadmap_does_but_no_farther():
    wide = ArmWorld(ur5(joints=3), TABLE, clearance=0.01)
    made = arm_roadmap(wide, 24, 4, recipe=Recipe(0.0, 0))
    assert wide.valid(made.milestones).all()
    for clearance in (0.0, 0.01):
        assert made.within(ArmWorld(made.robot, TABLE, clearance=clearance)).world.clearance == clearance
    with pytest.raises(InvalidValue, match=r"clearance of 0.03 m, the roadmap was built with 0.01 m"):
        made.within(ArmWorld(made.robot, TABLE, clearance=0.03))
