"""What keeps an arm from its goals is true of the question: of all postures of a pose, of the robot's true shapes."""

import numpy as np
import pytest

import evenroad as er
from evenroad.geometry import Pose
from evenroad.geometry.rotation import rotation_from_z
from evenroad.infeasibility.prefix_cells import Cells, Piece
from evenroad.infeasibility.proof import apart, is_beyond
from evenroad.planning.arm_trees import connect
from evenroad.poses.chain import chain_of, default_tip
from evenroad.poses.inverse_kinematics import task_of
from evenroad.robot import ArmWorld, CartesianLine, HeldObject, Obstacle, PoseGoal, Scene, load_robot
from evenroad.robots.joint import Joint
from evenroad.robots.kinematics import link_poses
from tests.plan_on import may_connect
from tests.robots.kernel_arms import STRAIGHT, Z, random_tree

X = (1.0, 0.0, 0.0)

START = np.array([0.0, 0.6, 0.0, -0.8, 0.0, 0.5, 0.0])
WITNESSES = (
    [0.1966, 0.6373, 1.5409, -2.2475, -1.7129, 0.395, 0.4594],
    [-0.1966, 0.5981, -0.813, -0.0652, 2.6717, -1.4241, 0.2934],
    [0.0983, 0.5785, 0.9222, -2.0549, 0.4767, 0.4956, 0.5205],
    [0.1180, 0.5981, 2.0909, -1.7349, 1.7909, -1.2291, -0.4421],
)
"""Configurations that the start is joined to; for the places of their tips none is found that it could be."""


@pytest.fixture(scope="module")
def arm7():
    return load_robot("arm7")


@pytest.fixture(scope="module")
def barred(arm7):
    """Four thin bars around the upper arm of the shipped arm of seven joints, as it stands at the start."""
    tilted = link_poses(arm7, START[np.newaxis])[0, arm7.links.index("shoulder_tilt_link")]
    middle, axis = tilted[:3, 3] + 0.1 * tilted[:3, 2], tilted[:3, 2]
    side = np.array([0.0, 1.0, 0.0])
    other = np.cross(axis, side)
    bars = [
        Obstacle.of(
            f"bar{k}", "cylinder", (0.008, 0.3), tuple(middle + 0.1 * away), tuple(rotation_from_z(along).ravel())
        )
        for k, (away, along) in enumerate([(side, other), (-side, other), (other, side), (-other, side)])
    ]
    return ArmWorld(arm7, Scene(tuple(bars), name="bars"))


def place_of(robot, q):
    return Pose(tuple(chain_of(robot, default_tip(robot)).tip_poses(np.array([q]))[0, 9:]))


@pytest.mark.parametrize("witness", WITNESSES)
def test_a_place_is_not_out_of_reach_because_the_postures_found_are(barred, witness):
    goal = PoseGoal(place_of(barred.robot, witness), position_only=True)
    assert connect(barred, START, np.array([witness])).goal == 0
    result = er.plan(barred.scene, START, goal, robot=barred.robot, seconds=3.0)
    assert result.status in ("solved", "budget_spent")
    if not result.solved:
        assert "be reached: joints shoulder_pan, shoulder_tilt alone" in result.message
        assert "others may be" in result.message
        assert "proved" not in result.message


def test_the_place_of_the_issue_is_not_called_impossible(barred):
    goal = PoseGoal(Pose((0.403498, -0.222401, 0.870594)), position_only=True)
    result = er.plan(barred.scene, START, goal, robot=barred.robot, seconds=3.0)
    # In a scene that is like the issue's.
    assert result.status != "not_connected"
    assert "proved" not in result.message


def test_a_place_beyond_what_the_bars_leave_is_proved_for_all_postures(barred):
    """Behind the arm: the elbow cannot turn to where the forearm would be long enough."""
    goal = PoseGoal(Pose((-0.75, 0.0, 0.5)), position_only=True)
    result = er.plan(barred.scene, START, goal, robot=barred.robot, seconds=3.0)
    assert result.status == "not_connected"
    assert result.message.startswith("proved: there is no path: joints shoulder_pan, shoulder_tilt alone")
    # One more goal that can be reached, or may be, and nothing is proved.
    for more in (PoseGoal(place_of(barred.robot, WITNESSES[0]), position_only=True), WITNESSES[1]):
        result = er.plan(barred.scene, START, [goal, more], robot=barred.robot, seconds=3.0)
        assert result.status in ("solved", "budget_spent")


def test_straight_ways_are_planned_to_some_postures_alone(barred):
    goal = PoseGoal(Pose((-0.75, 0.0, 0.5)), position_only=True)
    result = er.plan(barred.scene, START, goal, robot=barred.robot, seconds=3.0, constraints=CartesianLine(0.02))
    assert not result.solved
    assert "proved" not in result.message


@pytest.mark.parametrize("seed", range(30))
def test_no_pose_is_beyond_a_piece_that_holds_a_posture_of_it(seed):
    """Of every kind of joint, for poses with and without rotation, by cells of any size."""
    rng = np.random.default_rng(seed)
    robot = random_tree(seed)
    world = ArmWorld(robot, Scene(name="empty"))
    for link in robot.links[::-1][:3]:
        try:
            chain = chain_of(robot, link)
        except er.errors.InvalidValue:
            continue
        for q in world.space.from_cube(rng.random((20, world.space.dim))):
            place = chain.tip_poses(q[np.newaxis])[0]
            pose = Pose(tuple(place[9:]), tuple(place[:9]))
            known = int(rng.integers(1, min(world.space.dim, 3) + 1))
            half = rng.uniform(1e-4, 0.3)
            low = q[:known] - half * rng.uniform(0.0, 2.0, known)
            period = world.space.flat.period[:known]
            cells = Cells(low, low + 2.0 * half, np.ones(known, dtype=int), period)
            piece = Piece(cells, np.ones((1,) * known, dtype=bool))
            for more in ({}, {"position_only": True}, {"free_axis": "z"}, {"angle_tolerance": 0.1}):
                assert not is_beyond(piece, *task_of(robot, PoseGoal(pose, link, **more)))


def test_a_pose_that_may_be_turned_is_reached_with_the_tip_turned(arm7):
    """Its last joint is then elsewhere than the pose itself says."""
    q = np.array([0.3, 0.9, 0.0, -0.02, 0.0, 0.01, 0.0])
    place, away = chain_of(arm7, default_tip(arm7)).tip_poses(q[np.newaxis])[0], 0.3
    cells = Cells(q[:2] - 1e-4, q[:2] + 1e-4, np.ones(2, dtype=int), np.full(2, np.inf))
    piece, rotation = Piece(cells, np.ones((1, 1), dtype=bool)), place[:9].reshape(3, 3)
    for axis in np.eye(3):
        x, y, z = axis
        across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        for angle in (-away, away):
            turn = np.eye(3) + np.sin(angle) * across + (1.0 - np.cos(angle)) * across @ across
            pose = Pose(tuple(place[9:]), tuple((rotation @ turn).ravel()))
            assert not is_beyond(piece, *task_of(arm7, PoseGoal(pose, angle_tolerance=away + 1e-6)))


def test_a_pose_is_beyond_a_piece_from_where_the_links_are_too_short_or_cannot_fold(arm7):
    cells = Cells(np.zeros(2), np.full(2, 0.01), np.ones(2, dtype=int), np.full(2, np.inf))
    piece = Piece(cells, np.ones((1, 1), dtype=bool))
    # The next joint is .2 m above the shoulder at .34 m; from there the flange reaches .79 m.
    for height, beyond in ((1.3, False), (1.36, True), (-0.24, False), (-0.3, True)):
        goal = PoseGoal(Pose((0.0, 0.0, height)), position_only=True)
        assert is_beyond(piece, *task_of(arm7, goal)) == beyond
    near = PoseGoal(Pose((0.0, 0.0, 1.36)), position_only=True, position_tolerance=0.1)
    assert not is_beyond(piece, *task_of(arm7, near))
    # Upright, the last joint is .1 m below the flange: nearer than that.
    upright = PoseGoal(Pose((0.0, 0.0, -0.2)))
    assert is_beyond(piece, *task_of(arm7, upright))


FLAT = """<robot name="flat"><link name="rail"/><link name="plate"><collision>{origin}
<geometry>{shape}</geometry></collision></link>
<joint name="slide" type="prismatic"><parent link="rail"/><child link="plate"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""


def flat_link(folder, shape='<box size=".5 .4 .02"/>', origin="", bodies="capsules"):
    file = folder / "flat.urdf"
    file.write_text(FLAT.format(shape=shape, origin=origin))
    return load_robot(file, bodies=bodies)


def slot(gap, half=0.05):
    plates = [
        Obstacle.of(f"plate{sign}", "box", (2 * half, 1.0, 0.2), (0.0, 0.0, sign * (0.5 * gap + 0.1)))
        for sign in (-1, 1)
    ]
    return Scene(tuple(plates), name="slot")


A, B = np.array([-0.6]), np.array([0.6])


@pytest.mark.parametrize("gap", [0.034, 0.05, 0.08])
def test_a_flat_link_passes_a_slot_that_its_capsules_do_not(tmp_path, gap):
    robot = flat_link(tmp_path)
    # The true link, .02 m thick, slides straight through: its witness is the joint's whole range.
    assert 0.02 < gap < 2 * min(capsule.radius for capsule in robot.capsules)
    world = ArmWorld(robot, slot(gap))
    assert world.valid(np.array([A, B])).all()
    assert not world.valid(np.zeros((1, 1)))[0]
    assert may_connect(world, A, B)
    result = er.plan(world.scene, A, B, robot=robot, seconds=2.0)
    assert result.status == "budget_spent"
    assert "for the capsules that stand for the robot's shapes" in result.message
    assert "proved: " not in result.message


SHAPES = {
    "boxes": '<box size=".5 .4 .02"/>',
    "cylinders": '<cylinder radius=".2" length=".02"/>',
    "hulls": '<mesh filename="plate.stl"/>',
    "meshes": '<mesh filename="cross.stl"/>',
}
"""A link 20 mm thick as files have it, by what its answers speak of."""


def shaped_link(folder, of):
    trimesh = pytest.importorskip("trimesh")
    bars = [trimesh.creation.box(size) for size in ((0.5, 0.1, 0.02), (0.1, 0.4, 0.02))]
    trimesh.util.concatenate(bars).export(folder / "cross.stl")
    trimesh.creation.box((0.5, 0.4, 0.02)).export(folder / "plate.stl")
    return flat_link(folder, SHAPES[of], bodies="shapes")


@pytest.mark.parametrize("of", SHAPES)
def test_the_flat_link_passes_a_slot_of_44_mm_with_12_mm_to_spare_on_both_sides(tmp_path, of):
    result = er.plan(slot(0.044), A, B, robot=shaped_link(tmp_path, of), seconds=2.0)
    assert result.solved
    assert result.proof == "certified"
    assert result.bodies == of
    assert result.nearest[0] == "plate"
    assert 0.0119 < result.clearance <= 0.012


@pytest.mark.parametrize("gap", [0.021, 0.02005])
def test_the_flat_link_passes_a_slot_with_hardly_anything_to_spare(tmp_path, gap):
    result = er.plan(slot(gap), A, B, robot=shaped_link(tmp_path, "boxes"), seconds=2.0)
    assert result.solved
    assert result.proof == "certified"


@pytest.mark.parametrize("of", SHAPES)
def test_no_way_through_a_slot_too_narrow_for_the_flat_link_is_proved_of_the_robot(tmp_path, of):
    """What proves it lies inside of the link: nothing thinner is closed off."""
    robot = shaped_link(tmp_path, of)
    result = er.plan(slot(0.018), A, B, robot=robot, seconds=0.3)
    assert result.status == "not_connected"
    assert result.bodies == of
    assert result.message.startswith("proved: there is no path: joint slide alone cannot get there")
    assert result.message.endswith("(shown for bodies inside of the robot's shapes)")
    assert may_connect(ArmWorld(robot, slot(0.0201)), A, B)


def test_a_slot_narrower_than_the_link_itself_is_proved(tmp_path):
    robot = flat_link(tmp_path)
    result = er.plan(slot(0.01), A, B, robot=robot, seconds=2.0)
    assert result.status == "not_connected"
    assert "(shown for bodies inside of the robot's shapes)" in result.message


def test_a_goal_that_only_capsules_keep_out_of_is_not_left_out_of_a_proof(tmp_path):
    """Of two goals the one is behind a wall, the other in a slot where the true link fits."""
    robot = flat_link(tmp_path)
    wall = Obstacle.of("wall", "box", (0.02, 1.0, 1.0), (0.35, 0.0, 0.0))
    scene = slot(0.05).with_(wall)
    behind, within = np.array([0.8]), np.array([0.0])
    world = ArmWorld(robot, scene)
    assert world.valid(np.array([A, behind, within])).tolist() == [True, True, False]
    assert er.plan(scene, A, behind, robot=robot, seconds=2.0).status == "not_connected"
    result = er.plan(scene, A, [behind, within], robot=robot, seconds=2.0)
    assert result.status == "budget_spent"


def test_a_robot_made_of_capsules_is_what_they_are(tmp_path):
    robot = flat_link(tmp_path, '<capsule radius=".05" length=".3"/>')
    assert robot.inner is None
    result = er.plan(slot(0.05), A, B, robot=robot, seconds=2.0)
    assert result.status == "not_connected"
    assert "(shown for the robot's capsules)" in result.message


def test_what_is_held_counts_by_what_is_inside_of_it(tmp_path):
    robot = flat_link(tmp_path, '<sphere radius=".005"/>')
    plate = er.geometry.Box((0.5, 0.4, 0.02))
    held = robot.holding(HeldObject("plate_held", plate, "plate"))
    assert robot.inner is None
    assert {each.link for each in held.inner} == {"plate", "plate_held"}
    assert held.empty_handed() == robot
    assert may_connect(ArmWorld(held, slot(0.05)), A, B)
    assert not may_connect(ArmWorld(held, slot(0.018)), A, B)
    tooled = robot.with_tool([plate], "plate", prefix="a_")
    assert {each.link for each in tooled.inner} == {"plate", "a_tool"}
    assert may_connect(ArmWorld(tooled, slot(0.05)), A, B)
    assert not may_connect(ArmWorld(tooled, slot(0.018)), A, B)


def test_what_is_inside_decides_no_verdict_and_is_kept_with_the_robot(tmp_path):
    robot = flat_link(tmp_path)
    assert robot.inner
    assert flat_link(tmp_path).inner == robot.inner
    other = er.Robot(**{**robot.__dict__, "inner": None})
    assert other.fingerprint() == robot.fingerprint()


def test_nothing_is_inside_of_an_open_mesh_and_its_hull_proves_nothing(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box((0.5, 0.4, 0.02))
    box.update_faces(np.arange(len(box.faces)) > 0)
    box.export(tmp_path / "open.stl")
    robot = flat_link(tmp_path, '<mesh filename="open.stl"/>')
    assert robot.inner == ()
    result = er.plan(slot(0.01), A, B, robot=robot, seconds=2.0)
    assert result.status == "budget_spent"
    assert "for the capsules that stand for the robot's shapes" in result.message


def test_a_clouds_balls_and_a_closed_mesh_block_as_they_are(tmp_path):
    robot = flat_link(tmp_path, '<sphere radius=".05"/>')
    cloud = er.geometry.PointCloud(np.array([[0.0, 0.0, z] for z in (-0.12, 0.12)]), 0.06)
    wider = er.geometry.PointCloud(cloud.points, 0.08)
    assert may_connect(ArmWorld(robot, Scene((Obstacle("cloud", cloud),), name="cloud")), A, B)
    assert not may_connect(ArmWorld(robot, Scene((Obstacle("cloud", wider),), name="cloud")), A, B)
    found = apart(ArmWorld(robot, Scene((Obstacle("cloud", wider),), name="cloud")), A, B[np.newaxis], quickly=True)
    assert found.proved


@pytest.mark.parametrize("seed", range(8))
def test_what_a_joint_slides_by_is_a_lever_of_the_joints_before_it(seed):
    """An arm that turns, slides and turns: its first joint moves the third by as much as the second has slid."""
    rng = np.random.default_rng(seed)
    far = rng.uniform(0.02, 0.1, 3)
    links = ("base", "arm", "slider", "hand", "tip")
    kinds = (("revolute", 0.0, Z, -3, 3), ("prismatic", far[0], X, 0, 1), ("revolute", far[1], Z, -3, 3))
    kinds += (("fixed", far[2], Z, 0, 0),)
    joints = tuple(
        Joint(f"joint{i}", kind, links[i], links[i + 1], (x, 0.0, 0.0), STRAIGHT, axis, *limits)
        for i, (kind, x, axis, *limits) in enumerate(kinds)
    )
    ball = er.geometry.Capsule((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.01, link="arm")
    robot = er.Robot("slider", links, joints, (ball,), (), ("joint0", "joint1", "joint2"))
    chain, half = chain_of(robot, "tip"), rng.uniform(0.2, 0.4)
    for q in rng.uniform([-half, 0.9, -3.0], [half, 1.0, 3.0], (40, 3)):
        place = chain.tip_poses(q[np.newaxis])[0]
        # The cell holds the posture at its rim.
        cells = Cells(
            np.array([q[0] - 2.0 * half, q[1]]), np.array([q[0], q[1] + 1e-3]), np.ones(2, int), np.full(2, np.inf)
        )
        piece = Piece(cells, np.ones((1, 1), dtype=bool))
        for more in ({}, {"position_only": True}):
            pose = Pose(tuple(place[9:]), tuple(place[:9]))
            assert not is_beyond(piece, *task_of(robot, PoseGoal(pose, "tip", **more)))
