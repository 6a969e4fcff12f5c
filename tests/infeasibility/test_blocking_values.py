"""Values of a joint that no path passes, whatever the other joints do: shown by the true shapes of two links."""

import math
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from scipy.optimize import linprog

import evenroad as er
from evenroad.geometry import Box, Capsule, Cylinder, Mesh, Pose, TriangleMesh
from evenroad.geometry.fit import fit_capsules
from evenroad.geometry.hulls import piece_of
from evenroad.geometry.inner import inner_of
from evenroad.geometry.mesh import convex_hull
from evenroad.infeasibility.blocking_values import pieces_between_walls, walls_of
from evenroad.infeasibility.proof import apart
from evenroad.robot import ArmWorld, PoseGoal, Robot, Scene, load_robot, with_limits
from evenroad.robots.joint import Joint, Mimic
from evenroad.robots.kinematics import link_poses
from tests.plan_on import may_connect
from tests.robots.kernel_arms import STRAIGHT, Z, random_tree
from tests.robots.urdf_texts import joint, link, urdf, write

TURNS = "<limit lower='-6.2831853' upper='6.2831853' velocity='2' effort='1'/>"
UP, OVER, ROUND = np.array([0.3, 0.0, 0.4]), np.array([1.0, 3.1, -0.4]), np.array([1.0, -3.1, -0.4])
"""From the first, the second lies behind the foot, through which the arm would have to pass, or go once more round."""


def turret(folder, **files):
    """An arm on a foot that it meets where it hangs: two convex meshes, of which one turns about two joints."""
    for name, mesh in {
        "foot": trimesh.creation.cylinder(radius=0.15, height=0.2, sections=12).apply_translation((0, 0, 0.1)),
        "arm": trimesh.creation.box((0.5, 0.1, 0.08)).apply_translation((0.2, 0.0, 0.0)),
        **files,
    }.items():
        mesh.export(folder / f"{name}.stl")
    bodies = {
        name: f"<collision><geometry><mesh filename='{name}.stl'/></geometry></collision>" for name in ("foot", "arm")
    }
    text = urdf(
        link("foot", bodies["foot"]),
        link("shoulder", ""),
        link("arm", bodies["arm"]),
        link("hand", "<collision><geometry><sphere radius='0.03'/></geometry></collision>"),
        joint("pan", "foot", "shoulder", inside=TURNS, xyz="0 0 0", axis="0 0 1"),
        joint("lift", "shoulder", "arm", inside=TURNS),
        joint("elbow", "arm", "hand", xyz="0.55 0 0"),
    )
    return load_robot(write(folder, text))


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    return turret(tmp_path_factory.mktemp("turret"))


def test_a_band_that_the_foot_blocks_is_proved_in_an_empty_scene(robot):
    result = er.plan(Scene(), UP, OVER, robot=robot, seconds=2.0)
    assert result.status == "not_connected"
    assert result.message == (
        "proved: there is no path: joint lift alone cannot get there, whatever the others do (shown for bodies inside"
        " of the robot's shapes)"
    )
    assert er.plan(Scene(), UP, ROUND, robot=robot, seconds=2.0).status == "solved"
    assert er.plan(Scene(), UP, [OVER, ROUND], robot=robot, seconds=2.0).status == "solved"


def test_walls_are_kept_with_the_robot_and_known_out_of_its_cache(robot, tmp_path):
    world = ArmWorld(robot)
    assert world.apart(UP, OVER[np.newaxis], quickly=True).proved
    assert walls_of(replace(robot)) is walls_of(robot)
    assert walls_of(replace(robot, pairs=())) != walls_of(robot)
    again = turret(tmp_path), turret(tmp_path)
    assert all(walls_of(each) == walls_of(robot) for each in again)
    assert [hull.solid for hull in again[1].hulls] == [hull.solid for hull in robot.hulls]


def test_a_pair_that_is_not_tested_and_what_is_no_solid_block_nothing(robot, tmp_path):
    for pairs in ((), tuple(pair for pair in robot.pairs if pair != ("foot", "arm"))):
        allowed = replace(robot, pairs=pairs)
        assert may_connect(ArmWorld(allowed), UP, OVER)
        assert er.plan(Scene(), UP, OVER, robot=allowed, seconds=2.0).status == "solved"
    """A foot without its lid: nobody knows where its inside is."""
    open_foot = trimesh.creation.cylinder(radius=0.15, height=0.2, sections=12).apply_translation((0, 0, 0.1))
    open_foot.update_faces(np.arange(len(open_foot.faces)) > 0)
    assert may_connect(ArmWorld(turret(tmp_path, foot=open_foot)), UP, OVER)


def test_a_pose_is_out_of_reach_only_where_all_of_its_postures_are(robot):
    """Its second posture is that of the first joint turned by half a turn."""
    behind = PoseGoal(Pose((-0.55, 0.0, 0.3)), "hand", position_only=True)
    either = with_limits(robot, {"lift": (-1.0, 3.2)})
    narrow = with_limits(either, {"pan": (-0.5, 0.5)})
    results = [er.plan(Scene(), np.zeros(3), behind, robot=each, seconds=2.0) for each in (either, narrow)]
    assert [result.status for result in results] == ["solved", "not_connected"]
    assert "joint lift alone" in results[1].message
    # Also where nobody found the posture that can be reached.
    found = np.array([[0.0, math.pi, 0.0]])
    shown = [apart(ArmWorld(each), np.zeros(3), found, [behind]) for each in (either, narrow)]
    assert [each.proved for each in shown] == [False, True]


def test_a_joint_that_turns_on_needs_walls_on_both_sides(robot):
    joints = [
        replace(each, kind="continuous", lower=-math.inf, upper=math.inf) if each.name == "lift" else each
        for each in robot.joints
    ]
    endless = replace(robot, joints=tuple(joints))
    assert may_connect(ArmWorld(endless), UP, OVER)
    lid = Mesh(
        convex_hull(np.array([[x, y, z] for x in (-0.2, 0.2) for y in (-0.2, 0.2) for z in (0.5, 0.7)])), link="foot"
    )
    between = replace(
        endless,
        capsules=(*endless.capsules, *fit_capsules(lid)),
        hulls=(*endless.hulls, piece_of(lid).hull),
        inner=(*endless.inner, *inner_of([lid])),
    )
    world = ArmWorld(between)
    for turn in (-4.0, -2.0, 0.0, 1.0):
        near, far = (np.array([0.3, math.remainder(lift + turn, math.tau), 0.0]) for lift in (0.0, math.pi))
        if world.valid(np.array([near, far])).all():
            assert may_connect(world, near, UP) != may_connect(world, far, UP)
    assert not may_connect(world, UP, OVER)
    for turn in (-math.pi, -1.0, 1.0, math.pi):
        ((k, piece),) = pieces_between_walls(between, UP + np.array([turn, 0.0, 0.0]))
        assert k == 1
        assert piece.holds(UP)
        assert not piece.holds(OVER)


def boxes(*links):
    """Hulls and capsules of boxes, each of a link: its name, size and place."""
    shapes = [Box(size, pose=pose, link=name) for name, size, pose in links]
    hulls = tuple(piece_of(shape).hull for shape in shapes)
    return {"hulls": hulls, "inner": inner_of(shapes), "capsules": tuple(c for s in shapes for c in fit_capsules(s))}


def crossing(other, block, body, place=(0.0, 0.0, 0.0)):
    """A body that slides past a block, on a joint of another kind: both boxes."""
    kind, axis, end = other
    joints = (
        Joint("other", kind, "block", "carriage", (0.0, 0.0, 0.0), STRAIGHT, axis, -end, end),
        Joint("past", "prismatic", "carriage", "body", place, STRAIGHT, Z, -1.0, 1.0),
    )
    links = ("block", "carriage", "body")
    pairs = (("block", "body"),)
    group = ("other", "past")
    bodies = boxes(("block", *block), ("body", *body))
    return Robot("crossing", links, joints, pairs=pairs, group=group, **bodies)


SLIT = 1e-4
"""How far the block ends before the body does, where the other joint is at its limit [m]."""


def sliding():
    """The body is half a metre long; at the limit of the slide it ends as far from the middle as this."""
    block = (10.0, 0.2, 0.2), Pose((0.5 - SLIT - 5.0, 0.0, 0.0))
    return crossing(("prismatic", (1.0, 0.0, 0.0), 1.0), block, ((1.0, 0.1, 0.1), Pose()))


def turning(radius=5.0, end=0.8):
    """The body is flush with the block where the other joint is at its limit."""
    flush = Pose.from_rpy((0.0, 0.0, 0.0), (0.0, 0.0, -end))
    top = radius * math.sin(end) - 0.1 - SLIT
    block = (10.0, 20.0, 0.2), Pose((4.0, top - 10.0, 0.0))
    return crossing(("revolute", Z, end), block, ((0.2, 0.2, 0.2), flush), (radius, 0.0, 0.0))


@pytest.mark.parametrize("make", [sliding, turning])
def test_a_slit_at_the_end_of_the_other_joint_is_seen(make):
    """It is narrower than half of any cell that is looked at."""
    robot = make()
    world = ArmWorld(robot)
    limit = robot.joints[0].upper
    ends = np.array([[limit, -0.7], [limit, 0.7]])
    assert world.motion_valid(*ends[:, np.newaxis])[0]
    assert not world.motion_valid(*(ends - (0.01 * limit, 0.0))[:, np.newaxis])[0]
    assert may_connect(world, *ends)
    narrower = with_limits(robot, {"other": (-limit, 0.98 * limit)})
    assert not may_connect(ArmWorld(narrower), *(ends - (0.1 * limit, 0.0)))


def test_a_plate_in_which_no_point_is_deep_shows_nothing():
    """Its link's origin, beside it, is in the block for all values: what shows a wall must be in the plate, too."""
    block = (10.0, 0.2, 0.2), Pose((0.5 - SLIT - 5.0, 0.0, 0.0))
    plate = (1.0, SLIT, 0.1), Pose((3.0, 0.0, 0.0))
    robot = crossing(("prismatic", (1.0, 0.0, 0.0), 1.0), block, plate, (-3.0, 0.0, 0.0))
    ends = np.array([[1.0, -0.7], [1.0, 0.7]])
    assert ArmWorld(robot).motion_valid(*ends[:, np.newaxis])[0]
    assert walls_of(robot) == ((), ())


@pytest.mark.parametrize(("overlap", "shown"), [(1e-3, True), (2.5e-4, False), (-1e-5, False)])
def test_bodies_that_hardly_overlap_show_nothing(overlap, shown):
    slide = Joint("slide", "prismatic", "block", "body", (0.0, 0.0, 0.0), STRAIGHT, Z, -1.0, 1.0)
    bodies = boxes(("block", (1.0, 1.0, 0.2), Pose()), ("body", (1.0, 1.0, 0.2), Pose((1.0 - overlap, 0.0, 0.0))))
    links = "block", "body"
    robot = Robot("two", links, (slide,), pairs=(links,), group=("slide",), **bodies)
    assert bool(walls_of(robot)[0]) == shown


def test_a_bar_that_is_in_a_plate_for_most_angles_alone_shows_nothing():
    """Each of their points is in the other for a few cells alone, and in the last cells none is."""
    plate = (0.01, 1.5, 0.2), Pose((0.4, -0.25, 0.0))
    robot = crossing(("revolute", Z, 1.0), plate, ((1.0, 0.01, 0.1), Pose((0.5, 0.0, 0.0))))
    ends = np.array([[1.0, -0.7], [1.0, 0.7]])
    assert ArmWorld(robot).motion_valid(*ends[:, np.newaxis])[0]
    assert walls_of(robot) == ((), ())


def test_a_follower_that_turns_farther_than_its_leader_shows_nothing():
    robot = turning()
    leader, past = robot.joints
    leader = replace(leader, name="leader", child="aside", lower=leader.lower / 3.0, upper=leader.upper / 3.0)
    linked = replace(
        robot,
        links=("block", "aside", "carriage", "body"),
        joints=(leader, replace(robot.joints[0], mimic=Mimic("leader", 3.0)), past),
        group=("leader", "past"),
    )
    assert walls_of(linked) == ((), ())


def solid_tree(seed):
    """A tree of joints of every kind, whose links are convex meshes, large enough to meet, each in one ball."""
    rng = np.random.default_rng(seed)
    tree = random_tree(seed)
    hulls, capsules = [], []
    for name in tree.links:
        corners = rng.uniform(-1.0, 1.0, (10, 3)) * rng.uniform(0.05, 0.3, 3)
        hulls.append(piece_of(Mesh(convex_hull(corners), link=name)).hull)
        radius = float(np.linalg.norm(corners, axis=1).max()) + 1e-3
        capsules.append(Capsule((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), radius, link=name))
    pairs = tuple((a, b) for i, a in enumerate(tree.links) for b in tree.links[i + 2 : i + 4])
    return replace(tree, capsules=tuple(capsules), hulls=tuple(hulls), pairs=pairs)


def overlap(robot, pair, poses):
    """Whether some mean of corners of the one link is one of corners of the other: another oracle than planes."""
    for a in (hull for hull in robot.hulls if hull.link == pair[0]):
        for b in (hull for hull in robot.hulls if hull.link == pair[1]):
            placed = [
                hull.points @ poses[robot.links.index(hull.link), :3, :3].T + poses[robot.links.index(hull.link), :3, 3]
                for hull in (a, b)
            ]
            n, m = map(len, placed)
            rows = np.zeros((5, n + m))
            rows[:3] = np.concatenate([placed[0], -placed[1]]).T
            rows[3, :n] = rows[4, n:] = 1.0
            if linprog(np.zeros(n + m), A_eq=rows, b_eq=[0.0, 0.0, 0.0, 1.0, 1.0]).status == 0:
                return True
    return False


def test_at_a_wall_two_links_are_in_each_other_whatever_the_others_do():
    rng, found = np.random.default_rng(1), 0
    for seed in range(3):
        robot = solid_tree(seed)
        space = ArmWorld(replace(robot, pairs=())).space
        for k, walls in enumerate(walls_of(robot)):
            for wall in walls[:2]:
                q = space.from_cube(rng.random((4, space.dim)))
                q[:2] = space.low, space.high
                q[:, k] = wall
                found += 1
                for poses in link_poses(robot, q):
                    assert any(overlap(robot, pair, poses) for pair in robot.pairs)
    assert found > 10


def test_no_free_motion_leads_out_of_what_lies_between_walls():
    walked = 0
    for seed in range(3):
        rng, robot = np.random.default_rng(seed), solid_tree(seed)
        # One pair alone leaves room to walk.
        for pair in robot.pairs:
            one = replace(robot, pairs=(pair,))
            if not any(walls_of(one)):
                continue
            world = ArmWorld(one)
            q = world.space.from_cube(rng.random((400, world.space.dim)))
            free = q[world.valid(q)]
            if not len(free):
                continue
            a, b = free[rng.integers(len(free), size=(2, 300))]
            joined = world.motion_valid(a, b)
            for start, goal in zip(a[joined], b[joined], strict=True):
                for _, piece in pieces_between_walls(one, start):
                    walked += 1
                    assert piece.holds(goal)
    assert walked > 100


def test_a_hull_is_solid_where_the_mesh_fills_it():
    drum = trimesh.creation.cylinder(radius=0.1, height=0.3, sections=30)
    needle = drum.vertices.copy(), np.array(drum.faces)
    assert piece_of(Mesh(TriangleMesh(*needle))).hull.solid
    assert piece_of(Box((0.1, 0.2, 0.3))).hull.solid
    # A prism around it is more than it is.
    assert not piece_of(Cylinder(0.1, 0.3)).hull.solid
    # A corner of the lid's middle pushed in: hardly any volume, but as deep as a finger.
    thin = trimesh.creation.box((1.0, 1.0, 1.0)).subdivide().subdivide().subdivide().subdivide()
    inmost = int(np.argmin(np.linalg.norm(thin.vertices - (0.03, 0.03, 0.5), axis=1)))
    vertices = thin.vertices.copy()
    vertices[inmost, 2] -= 0.01
    dented = piece_of(Mesh(TriangleMesh(vertices, np.array(thin.faces))))
    assert len(dented.parts) == 1
    assert not dented.hull.solid
    assert piece_of(Mesh(TriangleMesh(thin.vertices, np.array(thin.faces)))).hull.solid
    open_mesh = TriangleMesh(thin.vertices, np.array(thin.faces)[1:])
    assert not piece_of(Mesh(open_mesh)).hull.solid
