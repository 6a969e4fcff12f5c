"""Clouds and meshes in the kernel against every point and triangle in double precision, and against solid angles."""

from dataclasses import replace

import numpy as np
import pytest

from evenroad.collision.arm_world import ArmWorld
from evenroad.collision.native_surfaces import FRAME, surface_of
from evenroad.geometry import Mesh, PointCloud, Pose, Sphere, TriangleMesh
from evenroad.geometry.mesh import merged
from evenroad.scenes.scene import Obstacle, Scene
from evenroad.world import FunctionWorld
from tests.robots.kernel_arms import (
    as_balls,
    box_scene,
    edge,
    random_tree,
    seven_joint_arm,
    states_along,
    through_contact,
    ur5,
)
from tests.robots.surface_oracle import all_clearance
from tests.robots.surface_scenes import (
    BALLS,
    BOXES,
    TURNED,
    all_sorts,
    ball,
    box,
    cloud_scene,
    half_open,
    half_turned,
    scene_of,
    soup,
    thin,
)

BAND = 1e-5
"""Nearer to contact than this [m] either verdict is right; but single precision must then say blocked."""

UR5, THIN = ur5(np.pi), thin(ur5(np.pi))
TREE, WRAPPING = random_tree(8), random_tree(13)
FIRST, SECOND = (replace(cloud_scene(seed, 400).obstacles[0], name=f"cloud{seed}") for seed in (6, 7))
MANY = scene_of(*BALLS, *BOXES, half_open(ball(-0.1, 0.6, 0.6, 0.2)), soup(2, 200)).with_(FIRST)
"""So many that there is a grid around all of them."""


def cloud_of(points, radius):
    return Scene((Obstacle("cloud", PointCloud(points, radius)),), name="cloud")


CLOUDS = {
    "one point": (UR5, cloud_of([[0.4, 0.2, 0.4]], 0.15)),
    "16 points": (UR5, cloud_scene(1, 16, 0.06)),
    "17 points": (UR5, cloud_scene(2, 17, 0.06)),
    "257 points": (UR5, cloud_scene(3, 257, 0.03)),
    "3000 points in a pose": (UR5, cloud_scene(4, 3000, 0.005, pose=TURNED)),
    "boxes and points": (ur5(np.pi, joints=5), box_scene().with_(*cloud_scene(5, 300).obstacles)),
    "two clouds, of which one may be touched": (UR5,
        Scene((FIRST, SECOND), allowed=frozenset({("forearm", "cloud6"), ("wrist1", "cloud7")}))),
    "points and seven joints": (seven_joint_arm(), cloud_scene(8, 500)),
    "points and bodies of balls": (as_balls(UR5), cloud_scene(9, 500)),
    "points and a tree": (TREE, cloud_scene(10, 200, 0.05, 0.7, 0.45)),
    "points and a tree with a joint that wraps": (WRAPPING, cloud_scene(11, 200, 0.05, 0.7, 0.45)),
}  # fmt: skip
MESHES = {
    "closed balls": (UR5, scene_of(*BALLS), True),
    "thin arm, closed balls": (THIN, scene_of(*BALLS), True),
    "thin arm, boxes in one mesh that overlap": (THIN, scene_of(merged(BOXES)), True),
    "thin arm, open balls": (THIN, scene_of(*map(half_open, BALLS)), False),
    "thin arm, triangles turned to either side": (THIN, scene_of(*map(half_turned, BALLS)), None),
    "thin arm, a large ball in a pose": (THIN, scene_of(ball(0.7, 0, 0, 0.5, 3), pose=TURNED), True),
    "soup": (UR5, scene_of(soup(1, 40)), False),
    "thin arm, triangles of all sorts": (THIN, scene_of(all_sorts(6)), False),
    "one triangle": (UR5, scene_of(soup(3, 9, 0.5)), False),
    "a floor of a kilometre": (UR5, scene_of(box((1000, 1000, 1), 0, 0, -0.9, 0.0)), True),
    "soup and bodies of balls": (as_balls(seven_joint_arm()), scene_of(soup(4, 60)), False),
    "balls and a tree": (TREE, scene_of(*(ball(*place, 0.3) for place in np.eye(3) * 0.75)), True),
    "many closed ones": (THIN, scene_of(*BALLS, *BOXES, ball(-0.1, 0.6, 0.6, 0.2), ball(0, 0, 1, 0.2)), True),
    "many of which some may be touched": (UR5,
        replace(MANY, allowed=frozenset({("forearm", "mesh0"), ("wrist1", "mesh1"), ("upperarm", "cloud6")})), False),
}  # fmt: skip
WORLDS = {name: (*world, True) for name, world in CLOUDS.items()} | MESHES


def apart_from(world, solid, q):
    """The oracle; of triangles that are turned to either side, inside is what the same in order wind around."""
    return all_clearance(world.robot, scene_of(*BALLS) if solid is None else world.scene, q, solid is not False)


@pytest.fixture(scope="module", params=WORLDS)
def arm(request):
    """A world with surfaces, random configurations, and by how much the first of them are clear of contact."""
    robot, scene, solid = WORLDS[request.param]
    world = ArmWorld(robot, scene)
    q = world.space.from_cube(np.random.default_rng(1).random((3000, world.space.dim)))
    return world, q, solid, apart_from(world, solid, q[:150])


def test_verdicts_are_those_of_every_point_and_triangle(arm):
    world, q, _, apart = arm
    free = world.valid(q[:150])
    clear = np.abs(apart) > BAND
    assert 0.02 < free.mean() < 0.98
    np.testing.assert_array_equal(free[clear], apart[clear] > 0.0)


def test_at_contact_no_verdict_is_freer_than_the_surfaces_and_hardly_less_free(arm):
    world, q, solid, _ = arm
    free, blocked = edge(world, q, most=100)
    apart = apart_from(world, solid, free)
    assert (apart > 0.0).all()
    assert np.median(apart) < BAND
    assert apart_from(world, solid, blocked[:20]).max() < 2.0 * BAND


def motions_of(world, q, count):
    """Motions between free configurations, of any length, two (n, dim)."""
    free = q[world.valid(q)][: 2 * count]
    a, b = free[0 : len(free) // 2 * 2 : 2], free[1::2]
    return a, world.space.interpolate(a, b, np.linspace(0.05, 1.0, len(b)) ** 2)


def test_motions_are_free_where_their_states_are(arm):
    world, q, _, _ = arm
    a, b = motions_of(world, q, 100)
    verdicts = world.motion_valid(a, b)
    assert verdicts.any()
    expected = FunctionWorld(world.space, world.valid, world.resolution).motion_valid(a, b)
    np.testing.assert_array_equal(verdicts, expected)


def test_what_is_proved_is_free_everywhere_and_nothing_that_touches_is(arm):
    world, q, solid, _ = arm
    rng = np.random.default_rng(2)
    a, b = motions_of(world, q, 30)
    proved = world.motion_certified(a, b, 1e-4)
    assert proved.any()
    states = states_along(world, a[proved], b[proved], rng, 6)
    assert apart_from(world, solid, states).min() > 0.0
    a, b = through_contact(world, lambda x: apart_from(world, solid, x), rng, 60, 100)
    assert len(a) > 10
    assert not world.motion_certified(a, b, 0.01).any()


@pytest.mark.parametrize("name", ["many closed ones", "many of which some may be touched"])
def test_a_scene_is_free_where_each_obstacle_alone_leaves_it_free(name):
    robot, scene, _ = MESHES[name]
    world, alone = ArmWorld(robot, scene), []
    for each in scene.obstacles:
        others = {other.name for other in scene.obstacles} - {each.name}
        alone.append(ArmWorld(robot, scene.without(*others)))
    q = world.space.from_cube(np.random.default_rng(3).random((3000, world.space.dim)))
    q = np.concatenate([q, *edge(world, q, most=200)])
    verdicts = world.valid(q)
    np.testing.assert_array_equal(verdicts, np.logical_and.reduce([each.valid(q) for each in alone]))
    a, b = motions_of(world, q, 100)
    proved = world.motion_certified(a, b, 1e-3)
    assert proved.any()
    assert (proved <= np.logical_and.reduce([each.motion_certified(a, b, 1e-4) for each in alone])).all()


def test_a_cloud_of_100_000_points_is_never_called_farther_than_it_is():
    scene = cloud_scene(12, 100_000, 0.005)
    world = ArmWorld(UR5, scene)
    q = world.space.from_cube(np.random.default_rng(2).random((400, 6)))
    apart = all_clearance(UR5, scene, edge(world, q, most=60)[0])
    assert (apart > 0.0).all()
    assert np.median(apart) < BAND


def test_points_are_as_spheres_of_their_radius_but_tighter_against_long_capsules():
    """Spheres meet the spheres that cover a capsule, points the capsule itself."""
    scene = cloud_scene(13, 60, 0.04)
    points, radius = scene.obstacles[0].body.points, scene.obstacles[0].body.radius
    spheres = Scene([Sphere(radius, pose=Pose(point)) for point in points])
    balls = as_balls(UR5)
    q = ArmWorld(balls, scene).space.from_cube(np.random.default_rng(3).random((5_000, 6)))
    np.testing.assert_array_equal(ArmWorld(balls, scene).valid(q), ArmWorld(balls, spheres).valid(q))
    with_points, with_spheres = ArmWorld(UR5, scene).valid(q), ArmWorld(UR5, spheres).valid(q)
    assert (with_points >= with_spheres).all()
    assert with_points.sum() > with_spheres.sum()


def test_surfaces_beyond_reach_change_nothing():
    points = cloud_scene(14, 100).obstacles[0].body.points
    far = [[50.0, 0.0, 0.0], [0.0, 1e6, 0.0]]
    near, more = ArmWorld(UR5, cloud_of(points, 0.02)), ArmWorld(UR5, cloud_of([*points, *far], 0.02))
    q = near.space.from_cube(np.random.default_rng(4).random((2000, 6)))
    np.testing.assert_array_equal(near.valid(q), more.valid(q))
    nothing = ArmWorld(UR5, Scene()).valid(q)
    for scene in (cloud_of(far, 0.1), scene_of(ball(50, 0, 0))):
        np.testing.assert_array_equal(ArmWorld(UR5, scene).valid(q), nothing)


def test_it_is_told_which_link_touches_which_cloud():
    scene = box_scene().with_(Obstacle("wall", PointCloud([[0.3, 0.0, 0.8]], 0.1)))
    world = ArmWorld(UR5, scene)
    q = world.space.from_cube(np.random.default_rng(5).random((4000, 6)))
    said = {world.explain(row) for row in q[~world.valid(q)]}
    assert any(text.endswith("touches 'wall'") for text in said)
    assert any(text.endswith("touches 'table'") for text in said)
    assert "it is free" not in said


@pytest.mark.parametrize(("robot", "body"), [
    (ur5(), PointCloud([[0.0, 0.0, 0.0]], 0.1)), (thin(ur5()), Mesh(ball(0, 0, 0, 1.0))),
], ids=["a cloud", "inside of a mesh"])  # fmt: skip
def test_what_does_not_move_is_looked_at_once(robot, body):
    scene = Scene((Obstacle("wall", body),), name="one")
    world = ArmWorld(robot, scene)
    assert world.fixed_contact == ("base", "wall")
    assert not world.valid(np.zeros((2, 6))).any()
    said = "'base' touches 'wall' wherever the joints are; if it stands there, allow it: in the scene, allowed:"
    assert world.explain(np.zeros(6)) == f"{said} {{wall: [base]}}"
    allowed = ArmWorld(robot, replace(scene, allowed=frozenset({("base", "wall")})))
    assert allowed.fixed_contact is None


NAMED_APART = BALLS[0].vertices[BALLS[0].triangles].reshape(-1, 3), np.arange(240).reshape(-1, 3)


@pytest.mark.parametrize(("mesh", "closed", "turned"), [
    (BALLS[0], 1.0, True), (merged(BOXES), 1.0, True), (half_open(BALLS[0]), 0.0, True),
    (half_turned(BALLS[0]), 1.0, True),
    (merged((BALLS[0], half_open(BALLS[2]))), 80 / 240, True),
    (soup(5, 20), 0.0, True),
    # Corners that are named apart but lie in one place.
    (TriangleMesh(*NAMED_APART), 1.0, True),
])  # fmt: skip
def test_closed_parts_are_found(mesh, closed, turned):
    parts = mesh.closed_parts
    assert (parts.closed.mean(), parts.oriented) == (pytest.approx(closed), turned)


def test_a_few_frames_of_a_camera_are_kept_and_not_every_one():
    frames = [PointCloud(np.full((FRAME + 1, 3), 0.3 + 0.01 * i), 0.01) for i in range(6)]
    first = surface_of(frames[0], 1.0)
    assert surface_of(frames[0], 1.0) is first
    for frame in frames[1:]:
        surface_of(frame, 1.0)
    assert surface_of(frames[0], 1.0) is not first
