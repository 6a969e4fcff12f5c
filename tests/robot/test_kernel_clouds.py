"""Clouds in the kernel against a ball around every point, in double precision, one by one."""

import copy
import pickle
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from evenroad.geometry.pose import Pose
from evenroad.geometry.rotation import rotation_from_rpy
from evenroad.geometry.shapes import PointCloud, Sphere
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.certified import CertifiedWorld
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel import surface_tree
from evenroad.robot.kernel.surface_grid import grid_of_points
from evenroad.robot.scene import Obstacle, Scene
from tests.robot.kernel_arms import as_balls, box_scene, edge, random_tree, seven_joint_arm, ur5
from tests.robot.surface_oracle import all_clearance

BAND = 1e-5
"""Nearer to contact than this [m] either verdict is right; but single precision must then say blocked."""
TURNED = Pose((0.1, -0.2, 0.05), rotation_from_rpy(0.3, -0.5, 1.1))


def states_between(world, start, end, count):
    ends = (np.broadcast_to(each, (count, len(start))) for each in (start, end))
    return world.space.interpolate(*ends, np.linspace(0.0, 1.0, count))


def cloud_scene(seed, n, radius=0.02, spread=0.9, clear=0.35, pose=Pose()):
    """Points of a few walls and blobs, none near the origin."""
    rng = np.random.default_rng(seed)
    points = np.zeros((0, 3))
    while len(points) < n:
        place, turn = (
            rng.uniform(-spread, spread, 3),
            np.reshape(rotation_from_rpy(*rng.uniform(-3, 3, 3)), (3, 3)),
        )
        some = place + rng.uniform(-0.5, 0.5, (max(n // 8, 4), 3)) * rng.uniform(0.0, 0.4, 3) @ turn
        points = np.concatenate([points, some[np.linalg.norm(some, axis=1) > clear]])
    turn, shift = np.reshape(pose.rotation, (3, 3)), np.array(pose.xyz)
    cloud = PointCloud((points[:n] - shift) @ turn, radius, pose=pose)
    return Scene((Obstacle("cloud", cloud),), name=f"cloud{seed}")


WORLDS = {
    "ur5, one point": (
        ur5(np.pi),
        Scene((Obstacle("cloud", PointCloud([[0.4, 0.2, 0.4]], 0.15)),), name="one"),
        3000,
    ),
    "ur5, sixteen points": (ur5(np.pi), cloud_scene(1, 16, 0.06), 3000),
    "ur5, seventeen points": (ur5(np.pi), cloud_scene(2, 17, 0.06), 3000),
    "ur5, 257 points": (ur5(np.pi), cloud_scene(3, 257, 0.03), 2000),
    "ur5, 3000 points in a pose": (ur5(np.pi), cloud_scene(4, 3000, 0.005, pose=TURNED), 600),
    "ur5 among boxes and points": (
        ur5(np.pi, joints=5),
        replace(box_scene().with_(*cloud_scene(5, 300).obstacles), name="both"),
        1500,
    ),
    "two clouds, of which one may be touched": (
        ur5(np.pi),
        Scene(
            (
                replace(cloud_scene(6, 400).obstacles[0], name="first"),
                replace(cloud_scene(7, 400).obstacles[0], name="second"),
            ),
            name="two",
            allowed=frozenset({("forearm", "first"), ("wrist1", "second")}),
        ),
        1500,
    ),
    "seven joints": (seven_joint_arm(), cloud_scene(8, 500), 1500),
    "ur5 of balls": (as_balls(ur5(np.pi)), cloud_scene(9, 500), 600),
    "tree": (random_tree(8), cloud_scene(10, 200, 0.05, 0.7, 0.45), 2000),
    "tree with a joint that wraps": (random_tree(13), cloud_scene(11, 200, 0.05, 0.7, 0.45), 2000),
}


@pytest.fixture(scope="module", params=WORLDS)
def arm(request):
    """A world with clouds, random configurations, and by how much they are clear of contact."""
    robot, scene, count = WORLDS[request.param]
    world = ArmWorld(robot, scene)
    q = world.space.from_cube(np.random.default_rng(1).random((count, world.space.dim)))
    return world, q, all_clearance(robot, scene, q)


@pytest.mark.parametrize("backend", ["lanes", "scalar"])
def test_verdicts_are_those_of_a_ball_around_every_point(arm, backend):
    world, q, apart = arm
    free = ArmWorld(world.robot, world.scene, backend=backend).valid(q)
    clear = np.abs(apart) > BAND
    assert 0.02 < free.mean() < 0.98
    np.testing.assert_array_equal(free[clear], apart[clear] > 0.0)


def test_at_contact_no_verdict_is_freer_than_the_balls(arm):
    world, q, _ = arm
    free, blocked = edge(world, np.concatenate([q, q[::-1]]), most=300)
    apart = all_clearance(world.robot, world.scene, free)
    assert (apart > 0.0).all()
    assert np.median(apart) < BAND
    # And hardly less free: by what single precision may lose.
    assert all_clearance(world.robot, world.scene, blocked).max() < 2.0 * BAND


def test_motions_are_free_where_their_states_are(arm):
    world, q, _ = arm
    free = q[world.valid(q)]
    a, b = free[0::2][:300], free[1::2][:300]
    a = a[: len(b)]
    b = world.space.interpolate(a, b, np.linspace(0.05, 1.0, len(b)) ** 2)
    verdicts = world.motion_valid(a, b)
    assert verdicts.any()
    exact = ArmWorld(world.robot, world.scene, backend="scalar").motion_valid(a, b)
    assert not (verdicts & ~exact).any()
    for start, end in zip(a[exact & ~verdicts], b[exact & ~verdicts], strict=True):
        count = 1 + int(np.ceil(world.space.distance(start[None], end[None])[0] / world.resolution))
        assert all_clearance(world.robot, world.scene, states_between(world, start, end, count)).min() < BAND


@pytest.mark.parametrize("backend", ["lanes", "scalar"])
def test_what_is_proved_is_free_everywhere(arm, backend):
    world, q, _ = arm
    free = q[world.valid(q)]
    a, b = free[0::2][:60], free[1::2][:60]
    a = a[: len(b)]
    b = world.space.interpolate(a, b, np.linspace(0.05, 1.0, len(b)) ** 2)
    proving = ArmWorld(world.robot, world.scene, backend=backend)
    proved = proving.motion_certified(a, b, 1e-4)
    assert proved.any()
    # What is free with room to spare is proved, too.
    np.testing.assert_array_equal(proved[::7], CertifiedWorld(proving).motion_valid(a[::7], b[::7]))
    for start, end in list(zip(a[proved], b[proved], strict=True))[-2:]:
        count = 1 + 10 * int(np.ceil(world.space.distance(start[None], end[None])[0] / world.resolution))
        assert all_clearance(world.robot, world.scene, states_between(world, start, end, count)).min() > 0.0


def test_a_cloud_of_100_000_points_is_never_called_farther_than_it_is():
    scene = cloud_scene(12, 100_000, 0.005)
    world = ArmWorld(ur5(np.pi), scene)
    q = world.space.from_cube(np.random.default_rng(2).random((400, 6)))
    free, _ = edge(world, q, most=60)
    apart = all_clearance(world.robot, scene, free)
    assert (apart > 0.0).all()
    assert np.median(apart) < BAND


def test_points_are_as_spheres_of_their_radius_but_tighter_against_long_capsules():
    """Spheres meet the spheres that cover a capsule, points the capsule itself."""
    scene = cloud_scene(13, 60, 0.04)
    points, radius = scene.obstacles[0].body.points, scene.obstacles[0].body.radius
    spheres = Scene(
        tuple(Obstacle(str(i), Sphere(radius, pose=Pose(point))) for i, point in enumerate(points)),
        name="spheres",
    )
    balls, capsules = as_balls(ur5(np.pi)), ur5(np.pi)
    q = ArmWorld(balls, scene).space.from_cube(np.random.default_rng(3).random((5_000, 6)))
    np.testing.assert_array_equal(ArmWorld(balls, scene).valid(q), ArmWorld(balls, spheres).valid(q))
    with_points, with_spheres = ArmWorld(capsules, scene).valid(q), ArmWorld(capsules, spheres).valid(q)
    assert (with_points >= with_spheres).all()
    assert with_points.sum() > with_spheres.sum()


def test_points_beyond_reach_change_nothing():
    near = cloud_scene(14, 100)
    cloud = near.obstacles[0].body
    far = replace(cloud, points=np.concatenate([cloud.points, [[50.0, 0.0, 0.0], [0.0, 1e6, 0.0]]]))
    worlds = [ArmWorld(ur5(np.pi), Scene((Obstacle("cloud", body),), name="s")) for body in (cloud, far)]
    np.testing.assert_array_equal(worlds[0].lanes.surfaces.arrays[0], worlds[1].lanes.surfaces.arrays[0])
    only_far = Scene((Obstacle("cloud", PointCloud([[50.0, 0.0, 0.0]], 0.1)),), name="s")
    assert ArmWorld(ur5(np.pi), only_far).lanes.surfaces is None


def test_it_is_told_which_link_touches_which_cloud():
    scene = Scene(
        (Obstacle("wall", PointCloud([[0.3, 0.0, 0.8]], 0.1)), *box_scene().obstacles),
        name="one",
        allowed=box_scene().allowed,
    )
    world = ArmWorld(ur5(np.pi), scene, backend="lanes")
    q = world.space.from_cube(np.random.default_rng(5).random((4000, 6)))
    said = {world.explain(row) for row in q[~world.valid(q)]}
    assert any(text.endswith("touches 'wall'") for text in said)
    assert any(text.endswith("touches 'table'") for text in said)
    assert "it is free" not in said


def test_what_does_not_move_is_looked_at_once():
    cloud = Obstacle("wall", PointCloud([[0.0, 0.0, 0.0]], 0.1))
    world = ArmWorld(ur5(), Scene((cloud,), name="one"))
    assert world.fixed_contact == ("base", "wall")
    assert not world.valid(np.zeros((2, 6))).any()
    assert "'base' touches 'wall'" in world.explain(np.zeros(6))
    assert (
        ArmWorld(ur5(), Scene((cloud,), name="one", allowed=frozenset({("base", "wall")}))).fixed_contact
        is None
    )


def test_copies_of_a_world_find_its_clouds_again():
    world = ArmWorld(ur5(np.pi), cloud_scene(15, 300))
    q = world.space.from_cube(np.random.default_rng(6).random((500, 6)))
    expected = world.valid(q)
    for sent in (pickle.loads(pickle.dumps(world)), copy.deepcopy(world)):
        np.testing.assert_array_equal(sent.valid(q), expected)
        assert sent.lanes.surfaces.arrays[0] is not world.lanes.surfaces.arrays[0]
        assert sent.tables.lanes[at.SURFACES] == sent.tables.ints[at.SURFACES] == 0


def test_a_scene_of_the_same_cloud_is_made_of_the_same_array():
    first = ArmWorld(ur5(), cloud_scene(16, 300))
    second = ArmWorld(ur5(), cloud_scene(16, 300).with_(*box_scene().obstacles))
    assert first.lanes.surfaces.arrays[0] is second.lanes.surfaces.arrays[0]


def test_scenes_without_clouds_compile_nothing_for_them():
    code = (
        "import sys; from tests.robot.kernel_arms import *; from evenroad.robot.arm_world import ArmWorld\n"
        "ArmWorld(ur5(), box_scene()).valid([[0.0] * 6]); print('evenroad.robot.kernel.surface_contact' in sys.modules)"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "False"


@pytest.mark.parametrize("n", [1, 15, 16, 17, 256, 257, 4096, 4097, 30_000])
def test_the_tree_has_every_point_once_and_its_nodes_hold_what_is_below(n):
    rng = np.random.default_rng(n)
    # Some of them twice, and many in one plane.
    points = rng.integers(-20, 20, (n, 3)) / 32.0 * (1.0, 1.0, 0.1)
    array = surface_tree.surface_array(points[:, None], 0.01, grid_of_points(points))
    table = array.view(np.float32)[2 * surface_tree.HEADER :]
    levels, starts = int(array[surface_tree.LEVELS]), array[surface_tree.FIRST_NODES :]
    leaves = (int(starts[0]) - surface_tree.LEAVES) // surface_tree.POINT_ROW
    rows = table[surface_tree.LEAVES : int(starts[0])].reshape(leaves, 3, 16).transpose(0, 2, 1)
    held = rows.reshape(-1, 3)
    held = held[held[:, 0] < 1e8]
    order = np.lexsort(held.T), np.lexsort(points.T)
    np.testing.assert_array_equal(held[order[0]], points[order[1]].astype(np.float32))
    below = [row[row[:, 0] < 1e8] for row in rows]
    for level in range(levels):
        count = -(-len(below) // 16)
        first = int(starts[level])
        nodes = table[first : first + surface_tree.NODE_ROW * count].reshape(count, 7, 16)
        for i, inside in enumerate(below):
            if len(inside):
                box = nodes[i // 16, :, i % 16]
                assert (np.abs(inside - box[:3]) <= box[3:6]).all()
                assert (np.linalg.norm(inside - box[:3], axis=1) <= box[6]).all()
        below = [np.concatenate(below[16 * i : 16 * i + 16]) for i in range(count)]
    assert len(below) == 1
    assert len(below[0]) == n


def test_the_grid_says_no_more_than_is_true_and_no_less_than_it_should():
    rng = np.random.default_rng(3)
    points = np.concatenate([rng.uniform(-0.5, 0.5, (3000, 3)) * (1, 1, 0), rng.normal(0.2, 0.05, (2000, 3))])
    array = surface_tree.surface_array(points[:, None], 0.0, grid_of_points(points))
    table = array.view(np.float32)[2 * surface_tree.HEADER :].astype(np.float64)
    low, size = table[:3], table[surface_tree.SIZE : surface_tree.SIZE + 3]
    x = rng.uniform(low, low + size, (3000, 3))
    cells = ((x - low) * table[surface_tree.ONE_BY_CELL]).astype(int)
    number = (cells[:, 0] * array[surface_tree.CELLS_Y] + cells[:, 1]) * array[surface_tree.CELLS_Z] + cells[
        :, 2
    ]
    told = array.view(np.uint8)[array[surface_tree.GRID] + number] * table[surface_tree.STEP]
    apart = np.array([np.sqrt(((points - row) ** 2).sum(axis=1).min()) for row in x])
    assert (told <= apart).all()
    assert (apart <= told + table[surface_tree.EXCESS]).all()
    assert (points > low).all()
    assert (points < low + size).all()
