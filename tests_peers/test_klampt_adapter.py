"""Klamp't's robots for our planners, our worlds and points for Klamp't's, and motions both ways."""

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import Exhausted, InvalidValue, UnknownName
from evenroad.robot import Scene, link_poses, load_robot
from evenroad.space import SE2
from evenroad.testing import WorldContract
from evenroad.trajectory import Limits, make_trajectory
from evenroad.world import FunctionWorld
from evenroad.world.gridmap.load import load_maze
from tests_peers.engines.urdf_text import as_urdf

klampt = pytest.importorskip("klampt")
cspace = pytest.importorskip("klampt.plan.cspace")
from evenroad.adapters.klampt import (  # noqa: E402
    KlamptWorld,
    cspace_of,
    klampt_motion,
    motion_of,
    plan_on_points,
)

BODY = '<collision><origin xyz=".5 0 0"/><geometry><box size=".9 .1 .1"/></geometry></collision>'
ARM = f"""<robot name="two"><klampt use_vis_geom="0"/><link name="world"/><link name="base"/>
<link name="upper">{BODY}</link><link name="fore">{BODY}</link><link name="finger"/>
<joint name="f" type="fixed"><parent link="world"/><child link="base"/></joint>
<joint name="turn" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint>
<joint name="bend" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="1 0 0"/>
<axis xyz="0 0 1"/><limit lower="-2.8" upper="2.8" velocity="1" effort="1"/></joint>
<joint name="slide" type="prismatic"><parent link="fore"/><child link="finger"/><axis xyz="0 0 1"/>
<limit lower="0" upper=".5" velocity="1" effort="1"/>MIMIC</joint></robot>"""
POSTS = np.array([(1.3, 0.0), (-1.2, 1.0), (0.4, -1.3)])
HALF = 0.1


def _world(folder, mimic=""):
    """An arm of two boxes in the plane among three square posts."""
    (folder / "arm.urdf").write_text(ARM.replace("MIMIC", mimic))
    world = klampt.WorldModel()
    assert world.readFile(str(folder / "arm.urdf"))
    for i, (x, y) in enumerate(POSTS.tolist()):
        box = klampt.GeometricPrimitive()
        box.setAABB([x - HALF, y - HALF, -1.0], [x + HALF, y + HALF, 1.0])
        shape = klampt.Geometry3D()
        shape.setGeometricPrimitive(box)
        (world.makeTerrain if i else world.makeRigidObject)(f"post {i}").geometry().set(shape.convert("TriangleMesh"))
    return world


def _corners(q):
    """The corners of both boxes in the plane, (n, 2, 4, 2)."""
    at = np.zeros((len(q), 2))
    boxes = []
    for angle in (q[:, 0], q[:, 0] + q[:, 1]):
        along = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        across = np.stack([-along[:, 1], along[:, 0]], axis=1)
        middle = at + 0.5 * along
        boxes.append(
            np.stack([middle + s * 0.45 * along + t * 0.05 * across for s in (-1, 1) for t in (-1, 1)], axis=1)
        )
        at = at + along
    return np.stack(boxes, axis=1)


def _gap(a, b):
    """By how much two convex quadrilaterals, (n, 4, 2) each, are apart along the best normal of a side: (n,)."""
    best = np.full(len(a), -np.inf)
    for shape in (a, b):
        for side in (shape[:, 1] - shape[:, 0], shape[:, 2] - shape[:, 0]):
            normal = side / np.linalg.norm(side, axis=1)[:, None]
            one, other = np.einsum("nkj,nj->nk", a, normal), np.einsum("nkj,nj->nk", b, normal)
            apart = np.maximum(one.min(1) - other.max(1), other.min(1) - one.max(1))
            best = np.maximum(best, apart)
    return best


def _apart(q):
    """How far the arm is from the posts, up to the sign; links in a row are not tested against each other."""
    boxes = _corners(q)
    square = np.array([(s, t) for s in (-HALF, HALF) for t in (-HALF, HALF)])
    gaps = [_gap(boxes[:, i], np.tile(post + square, (len(q), 1, 1))) for post in POSTS for i in (0, 1)]
    return np.min(gaps, axis=0)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return KlamptWorld(_world(tmp_path_factory.mktemp("arm")), links=("upper", "fore"))


class TestTheirWorld(WorldContract):
    free_between = False

    @pytest.fixture(autouse=True)
    def _given(self, arm):
        self.world = arm


def test_verdicts_are_those_of_boxes_in_the_plane(arm):
    q = arm.space.from_cube(np.random.default_rng(3).random((5000, 2)))
    apart = _apart(q)
    clear = np.abs(apart) > 1e-6
    np.testing.assert_array_equal(arm.valid(q)[clear], (apart > 0.0)[clear])
    assert 100 < (apart < 0.0).sum() < 2500


def test_our_planner_on_their_robot(arm):
    result = er.plan(arm, (0.9, 0.0), (-0.9, 0.3))
    assert result.solved
    assert result.proof == "resolution"
    fine = np.linspace(0.0, 1.0, 400)
    for a, b in zip(result.path[:-1], result.path[1:], strict=True):
        states = arm.space.interpolate(np.tile(a, (400, 1)), np.tile(b, (400, 1)), fine)
        assert (_apart(states) > -1e-9).all()
    blocked = er.plan(arm, (0.0, 0.0), (-0.9, 0.3))
    assert "does not call it free" in blocked.message


def test_asking_leaves_their_robot_where_it_was(arm):
    robot = arm.model.robot(0)
    robot.setConfig([0.0, 0.3, 0.2, 0.1])
    before = robot.getConfig()
    arm.valid([[1.0, 1.0]])
    assert robot.getConfig() == before


def test_all_joints_with_a_driver_are_planned_for(tmp_path):
    world = KlamptWorld(_world(tmp_path))
    assert world.links == ("upper", "fore", "finger")
    assert world.space.wrapping == (True, False, False)
    assert world.space.high[1:] == (2.8, 0.5)
    assert world.whole([[0.1, 0.2, 0.3]]).shape == (1, world.model.robot(0).numLinks())


def test_what_is_not_there_is_named(tmp_path):
    model = _world(tmp_path, '<mimic joint="bend" multiplier="0.1"/>')
    with pytest.raises(InvalidValue, match="several joints"):
        KlamptWorld(model)
    with pytest.raises(UnknownName, match="'thumb'"):
        KlamptWorld(model, links=("thumb",))
    with pytest.raises(UnknownName, match="robot of Klamp't's world '3'; known: 0, arm"):
        KlamptWorld(model, 3)
    with pytest.raises(InvalidValue, match="low < high"):
        KlamptWorld(model, links=("base",))


@pytest.mark.parametrize("n", [16, 64, 128])
def test_their_prm_on_our_map_and_points(n):
    maze = load_maze(1)
    world = maze.world()
    for seed in range(3):
        points = er.draw("even", n, 2, rng=seed)
        path = plan_on_points(world, maze.start, maze.goal, points)
        if path is not None:
            assert world.motion_valid(path[:-1], path[1:]).all()
            given = {tuple(row) for row in world.space.from_cube(points.points).tolist()}
            assert {tuple(row) for row in path[1:-1].tolist()} <= given
        if n == 128:
            assert path is not None


def test_their_prm_finds_nothing_where_there_is_nothing():
    wall = FunctionWorld(SE2((0, 0), (1, 1)), lambda q: abs(q[:, 0] - 0.5) > 0.1, 0.02)
    points = er.draw("even", 64, 3)
    assert plan_on_points(wall, (0.1, 0.1, 0.0), (0.9, 0.9, 0.0), points) is None
    assert plan_on_points(wall, (0.1, 0.1, 0.0), (0.5, 0.9, 0.0), points) is None
    assert plan_on_points(wall, (0.1, 0.1, 3.0), (0.1, 0.9, -3.0), points) is not None


def test_their_planners_take_our_arm_and_end_with_the_points():
    world = er.ArmWorld(load_robot("ur5"), Scene((), name="nothing"))
    start, goal = [0.0, -1.9, 1.6, -1.3, -1.57, 0.0], [1.0, -1.5, 1.2, -1.3, -1.57, 0.5]
    path = plan_on_points(world, start, goal, er.draw("even", 32, 6))
    assert world.validate(path).all()
    space = cspace_of(world, er.draw("even", 4, 6))
    plan = cspace.MotionPlan(space, "prm*", knn=5)
    plan.setEndpoints(start, goal)
    with pytest.raises(Exhausted, match="more points"):
        plan.planMore(100)
    plan.close()
    space.close()


def test_paths_come_back(arm):
    path = arm.space.from_cube(np.random.default_rng(1).random((7, 2)))
    motion = klampt_motion(arm.model.robot(0), path, arm.links)
    times, back = motion_of(motion, arm.links)
    np.testing.assert_array_equal(times, range(7))
    np.testing.assert_array_equal(back, path)


def test_a_trajectory_moves_their_robot_as_it_does_ours(tmp_path):
    robot = load_robot("ur5")
    (tmp_path / "ur5.urdf").write_text(as_urdf(robot))
    world = klampt.WorldModel()
    assert world.readFile(str(tmp_path / "ur5.urdf"))
    theirs = world.robot(0)
    path = np.random.default_rng(2).uniform(-1.0, 1.0, (3, 6))
    trajectory = make_trajectory(path, Limits((1.0,) * 6, (2.0,) * 6), names=robot.group)
    motion = klampt_motion(theirs, trajectory, robot)
    times, back = motion_of(motion, robot)
    np.testing.assert_array_equal(times, trajectory.times)
    np.testing.assert_array_equal(back, trajectory.positions)
    poses = link_poses(robot, trajectory.positions)
    for i in (0, len(times) // 2, -1):
        theirs.setConfig(motion.milestones[i])
        rotation, place = theirs.link("tool0").getTransform()
        np.testing.assert_allclose(place, poses[i, robot.links.index("tool0"), :3, 3], atol=1e-9)
        turned = np.reshape(rotation, (3, 3)).T
        np.testing.assert_allclose(turned, poses[i, robot.links.index("tool0"), :3, :3], atol=1e-9)
