"""Parts of a scan that may be touched, or are cut out: near the ends of a path, in a region, where one holds."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

import evenroad as er
from evenroad.geometry import Box, Capsule, Cylinder, PointCloud, Pose, Sphere
from evenroad.geometry.distance import point_distance
from evenroad.robot import (
    ArmWorld,
    Cut,
    HeldObject,
    Obstacle,
    Scene,
    Seen,
    allowed_near_ends,
    allowed_within,
    in_scene,
    link_poses,
    load_robot,
    load_scene,
    scene_seen_by,
    without_shapes,
)
from evenroad.space.path import resample

RADIUS, NEAR = 0.006, 0.03
UR5 = load_robot("ur5")
BLOCK = HeldObject("block", Box((0.06, 0.06, 0.1), pose=Pose((0, 0, 0.05))), "tool0", ("wrist_3_link",))
DOWN = (np.pi, 0.0, 0.0)
START = [0.5, -1.9, 1.8, -1.5, -1.57, 0.0]


def placed(xyz):
    """A configuration with the tool there, pointing down."""
    result = er.plan(Scene(name="air"), START, Pose.from_rpy(xyz, DOWN), robot=UR5, tip="tool0")
    assert result.solved
    return result.path[-1]


@pytest.fixture(scope="module")
def ends():
    return np.stack([placed((0.5, 0.15, 0.2)), placed((0.5, -0.2, 0.2))])


def scanned(seed=0):
    """A table that the block stands on, and a wall across the way, (n, 3)."""
    rng = np.random.default_rng(seed)
    table = np.c_[rng.uniform((0.35, -0.35), (0.65, 0.3), (4000, 2)), rng.normal(0.099, 3e-4, 4000)]
    wall = np.c_[rng.uniform(0.35, 0.65, 1500), np.full(1500, -0.03), rng.uniform(0.1, 0.25, 1500)]
    return np.concatenate([table, wall])


def scene(**more):
    return Scene((Obstacle("scan", PointCloud(scanned(), RADIUS)),), name="desk", attached=(BLOCK,), **more)


NEAR_ENDS = scene(near_ends=frozenset({("block", "scan", NEAR)}))


def poses_along(path):
    """Poses of the block at states close together, (s, 4, 4)."""
    robot = in_scene(UR5, Scene(name="air", attached=(BLOCK,)))
    world = ArmWorld(robot, Scene(name="air"))
    return link_poses(robot, resample(path, world.space, 0.01)[0])[:, robot.links.index("block")]


def away(pose, points):
    """How far points are from the block, (n,), by nothing of evenroad's."""
    own = (points - pose[:3, 3]) @ pose[:3, :3]
    return np.linalg.norm(np.maximum(np.abs(own) - [0.03, 0.03, 0.05], 0.0), axis=1)


def deepest(path, points):
    """By how much the block enters the ball of each point along a path, (n,)."""
    return np.max([RADIUS - away(pose, points) for pose in poses_along(path)], axis=0)


def test_what_may_touch_near_the_ends_touches_nothing_else(ends):
    points = scanned()
    assert er.plan(scene(), ends[0], ends[1], robot=UR5).status == "start_invalid"
    result = er.plan(NEAR_ENDS, ends[0], ends[1], robot=UR5)
    assert result.solved, result.message
    assert "not tested" not in result.message
    first, last = poses_along(result.path)[[0, -1]]
    open_ = np.minimum(away(first, points), away(last, points)) <= NEAR
    assert 100 < open_.sum() < 2000
    assert deepest(result.path, points[~open_]).max() < 0.0
    # Contact at the ends is what it is for.
    assert deepest(result.path, points[open_]).max() > 0.0


def test_an_allowance_with_a_whole_cloud_lets_a_block_pass_through_and_is_said(ends):
    allowed = frozenset({("block", "scan"), ("base_link", "scan")})
    result = er.plan(scene(allowed=allowed), ends[0], ends[1], robot=UR5)
    assert result.solved
    assert deepest(result.path, scanned()).max() == pytest.approx(RADIUS)
    assert "not tested, as the scene allows: 'block' against the whole cloud 'scan'" in result.message
    assert "base_link" not in result.message


def test_a_goal_that_is_a_pose_has_its_ends_where_it_is_reached(ends):
    goal = Pose.from_rpy((0.5, -0.2, 0.2), DOWN)
    result = er.plan(NEAR_ENDS, ends[0], goal, robot=UR5, tip="tool0")
    assert result.solved, result.message
    points = scanned()
    goals = link_poses(in_scene(UR5, scene()), result.goals)[:, UR5.links.index("tool0")]
    places = [poses_along(result.path)[0], *(pose @ BLOCK.body.pose.matrix for pose in goals)]
    open_ = np.min([away(pose, points) for pose in places], axis=0) <= NEAR
    assert deepest(result.path, points[~open_]).max() < 0.0


def test_in_a_region_a_link_may_touch_and_others_may_not(ends):
    robot = in_scene(UR5, scene())
    low = Box((0.4, 0.8, 0.02), pose=Pose((0.5, 0.0, 0.1)))
    divided = allowed_within(scene(), "block", "scan", low)
    parts = {each.name: each.body.points for each in divided.obstacles}
    assert parts.keys() == {"scan", "scan, open to block"}
    joined = np.concatenate([*parts.values()])
    assert sorted(map(tuple, joined)) == sorted(map(tuple, scanned()))
    for name, part in parts.items():
        within = (np.abs(part - [0.5, 0, 0.1]) <= [0.2, 0.4, 0.01]).all(axis=1)
        assert len(part)
        assert (within == (name != "scan")).all()
    world = ArmWorld(robot, divided)
    assert world.valid(ends).all()
    result = er.plan(divided, ends[0], ends[1], robot=UR5)
    assert result.solved, result.message
    assert deepest(result.path, parts["scan"]).max() < 0.0
    # The same place is closed to the other links.
    closed = ArmWorld(robot, replace(divided, allowed=frozenset()))
    assert closed.explain(ends[0]).startswith("'block' touches")


def test_two_links_may_have_parts_that_overlap():
    one, two = (Sphere(0.1, pose=Pose((0.5, y, 0.1))) for y in (0.0, 0.1))
    both = allowed_within(allowed_within(scene(), "block", "scan", one), "wrist_3_link", "scan", two)
    robot = in_scene(UR5, both)
    ArmWorld(robot, both)
    for link, region in (("block", one), ("wrist_3_link", two)):
        mine = [each.body.points for each in both.obstacles if (link, each.name) in both.allowed]
        theirs = [each.body.points for each in both.obstacles if (link, each.name) not in both.allowed]
        assert (point_distance(region, np.concatenate(mine)) == 0.0).all()
        assert (point_distance(region, np.concatenate(theirs)) > 0.0).all()
    assert sum(len(each.body.points) for each in both.obstacles) == len(scanned())


def test_what_is_allowed_with_a_cloud_stays_allowed_with_its_parts():
    whole = replace(scene(), allowed=frozenset({("base_link", "scan")}))
    for grow, count in ((0.0, 2), (9.0, 1)):
        parts = allowed_within(whole, "block", "scan", Sphere(0.1, pose=Pose((0.5, 0, 0.1))), grow)
        assert len(parts.obstacles) == count
        names = {each.name for each in parts.obstacles}
        assert {name for link, name in parts.allowed if link == "base_link"} == names
        assert {name for _, name in parts.allowed} == names


def test_a_part_of_anything_else_is_refused():
    table = Scene((Obstacle.of("table", "box", (1, 1, 0.1)),), name="desk", attached=(BLOCK,))
    with pytest.raises(er.errors.InvalidValue, match="'table' cannot be allowed, since it is a box and no cloud"):
        allowed_within(table, "block", "table", Sphere(0.1))
    with pytest.raises(er.errors.UnknownName, match="obstacle of scene 'desk': 'desk'"):
        allowed_within(table, "block", "desk", Sphere(0.1))


def test_a_world_that_does_not_know_the_ends_says_so(ends):
    robot = in_scene(UR5, NEAR_ENDS)
    with pytest.raises(er.errors.InvalidValue, match="contacts near start and goals, which a world does not know"):
        ArmWorld(robot, NEAR_ENDS)
    divided = allowed_near_ends(robot, NEAR_ENDS, ends)
    assert ArmWorld(robot, divided).valid(ends).all()
    places = link_poses(robot, ends)[:, robot.links.index("block")]
    distances = np.min([away(place, scanned()) for place in places], axis=0)
    strict, open_ = (each.body.points for each in divided.obstacles)
    assert sorted(map(tuple, open_)) == sorted(map(tuple, scanned()[distances <= NEAR]))
    assert len(strict) + len(open_) == len(scanned())
    assert NEAR_ENDS.fingerprint() != scene().fingerprint()


def test_what_is_held_is_cut_out_of_the_scan_where_it_is_grasped(ends):
    robot, rng = in_scene(UR5, scene()), np.random.default_rng(2)
    pose = link_poses(robot, ends[:1])[0, robot.links.index("block")]
    seen = pose[:3, 3] + rng.uniform(-1, 1, (500, 3)) * [0.03, 0.03, 0.05] @ pose[:3, :3].T
    text = ",".join(map(repr, ends[0].tolist()))
    cloud = PointCloud(np.concatenate([scanned(), seen]), RADIUS)
    grown = Obstacle("scan", cloud, cuts=(Cut("block", text, 0.025),))
    left = scene_seen_by(robot, Scene((grown,), name="desk", attached=(BLOCK,)))
    assert left.obstacles[0].cuts == ()
    points = left.obstacles[0].body.points
    assert away(pose, points).min() > 0.025
    assert len(points) == (away(pose, cloud.points) > 0.025).sum()
    assert ArmWorld(robot, left).valid(ends[:1])[0]
    cup = replace(grown, cuts=(Cut("cup", text),))
    with pytest.raises(er.errors.UnknownName, match="attached, to be cut out of 'scan': 'cup'"):
        scene_seen_by(robot, Scene((cup,), name="desk", attached=(BLOCK,)))


def test_a_start_inside_of_the_scan_is_said_to_be_one():
    q = np.array(START)
    poses = link_poses(UR5, q[np.newaxis])[0]
    cloud = PointCloud(np.concatenate([scanned(), poses[[UR5.links.index("forearm_link")], :3, 3]]), RADIUS)
    scan = Obstacle("scan", cloud)
    away = [0.0, -1.57, 0, -1.57, 0, 0]
    result = er.plan(Scene((scan,), name="desk"), q, away, robot=UR5)
    assert result.status == "start_invalid"
    assert "the robot stands in its scan, " in result.message
    assert "touches 'scan': seen_at" in result.message
    seen = replace(scan, seen=Seen(",".join(map(str, START))))
    assert er.plan(Scene((seen,), name="desk"), q, away, robot=UR5).status != "start_invalid"


CUT = {"shape": "box", "size": [0.1, 0.1, 0.1], "xyz": [0.4, 0.25, 0.1], "grow": 0.01}
LOW = {"shape": "box", "size": [0.4, 0.8, 0.02], "xyz": [0.5, 0, 0.1]}
SCAN = {"shape": "cloud", "file": "scan.npy", "radius": RADIUS, "cut": [CUT, {"attached": "block", "at": "grasp"}]}
HELD = {"shape": "box", "size": [0.06, 0.06, 0.1], "link": "tool0", "xyz": [0, 0, 0.05]}
ALLOWED = ["base_link", {"link": "block", "near_ends": 0.02}, {"link": "block", "within": LOW, "grow": 0.001}]


@pytest.fixture
def desk(tmp_path):
    """Write a scene that has all of this, with changes, and return its file."""
    np.save(tmp_path / "scan.npy", scanned())
    document = {"obstacles": {"scan": SCAN}, "allowed": {"scan": ALLOWED}, "attach": {"block": HELD}}

    def written(**changes):
        (tmp_path / "desk.yaml").write_text(yaml.safe_dump(document | changes))
        return tmp_path / "desk.yaml"

    return written


def test_scene_files_say_all_of_this(desk):
    loaded = load_scene(desk())
    assert loaded.near_ends == {("block", "scan", 0.02)}
    assert {each.name for each in loaded.obstacles} == {"scan", "scan, open to block"}
    assert all(each.cuts == (Cut("block", "grasp"),) for each in loaded.obstacles)
    points = np.concatenate([each.body.points for each in loaded.obstacles])
    box = Box((0.1, 0.1, 0.1), pose=Pose((0.4, 0.25, 0.1)))
    assert len(points) == (point_distance(box, scanned()) > 0.01).sum() < len(scanned())


@pytest.mark.parametrize(("change", "error", "says"), [
    ({"allowed": {"scan": [{"link": "block"}]}}, er.errors.InvalidValue, "one of near_ends and within"),
    ({"allowed": {"scan": [{"near_ends": 1}]}}, er.errors.BrokenFile, "link"),
    ({"allowed": {"scan": [{"link": "block", "near_ends": -1}]}}, er.errors.InvalidValue, "near_ends .* got -1"),
    ({"allowed": {"scan": [{"link": "block", "within": {"shape": "mesh"}}]}}, er.errors.UnknownName, "within of"),
    ({"obstacles": {"scan": SCAN | {"cut": [CUT | {"grow": 9}]}}}, er.errors.InvalidValue, "leaves nothing"),
    ({"obstacles": {"scan": SCAN | {"cut": "block"}}}, er.errors.InvalidValue, "must be a list"),
    ({"obstacles": {"scan": {"shape": "sphere", "radius": 1}}}, er.errors.InvalidValue, "of a cloud alone"),
])  # fmt: skip
def test_what_a_scene_file_says_wrongly_of_them_is_refused(desk, change, error, says):
    with pytest.raises(error, match=says):
        load_scene(desk(**change))


def segment_to_points(points, a, b):
    """Distances of points (n, 3) from many places of a segment."""
    places = np.linspace(a, b, 200)
    return np.min([np.linalg.norm(points - place, axis=1) for place in places], axis=0)


@pytest.mark.parametrize("shape", [
    Box((0.2, 0.4, 0.1)), Sphere(0.2), Cylinder(0.1, 0.4), Capsule((0, 0.1, 0), (0.2, 0, 0.1), 0.1),
], ids=lambda shape: shape.kind)  # fmt: skip
def test_distances_from_shapes_are_those_from_all_that_is_in_them(shape):
    rng = np.random.default_rng(5)
    shape = replace(shape, pose=Pose.from_rpy((0.1, -0.2, 0.3), (0.4, 0.5, 0.6)))
    filled = rng.uniform(-0.4, 0.4, (30_000, 3))
    body = replace(shape, pose=Pose())
    inside = {
        "box": lambda p: (np.abs(p) <= [0.1, 0.2, 0.05]).all(axis=1),
        "sphere": lambda p: np.linalg.norm(p, axis=1) <= 0.2,
        "cylinder": lambda p: (np.hypot(p[:, 0], p[:, 1]) <= 0.1) & (np.abs(p[:, 2]) <= 0.2),
        "capsule": lambda p: segment_to_points(p, (0, 0.1, 0), (0.2, 0, 0.1)) <= 0.1,
    }[shape.kind](filled)
    assert (point_distance(body, filled[inside]) == 0.0).all()
    points = rng.uniform(-0.6, 0.6, (200, 3))
    within = shape.pose.apply(filled[inside])
    nearest = np.min(np.linalg.norm(points[:, np.newaxis] - within, axis=2), axis=1)
    found = point_distance(shape, points)
    assert (found <= nearest + 1e-12).all()
    assert (found >= nearest - 0.05).all()


def test_nothing_is_left_where_all_is_cut():
    assert without_shapes(PointCloud([[0, 0, 0]], 0.1), [Sphere(0.1)]) is None
    with pytest.raises(er.errors.InvalidValue, match="a region must be one of box"):
        without_shapes(PointCloud([[0, 0, 0]], 0.1), [PointCloud([[0, 0, 0]])])
