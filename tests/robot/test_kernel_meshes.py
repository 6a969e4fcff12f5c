"""Meshes in the kernel against every triangle in double precision, and against solid angles for what is inside."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from evenroad.geometry import Mesh, Pose, TriangleMesh, rotation_from_rpy
from evenroad.geometry.mesh import closed_parts, merged
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.kernel.surface_grid import STEPS, grid_of_triangles
from evenroad.robot.scene import Obstacle, Scene
from tests.robot.kernel_arms import as_balls, edge, random_tree, seven_joint_arm, ur5
from tests.robot.surface_oracle import mesh_clearance, point_triangle

BAND = 1e-5
"""Nearer to contact than this [m] either verdict is right; but single precision must then say blocked."""


def from_trimesh(mesh, *move):
    return TriangleMesh(np.asarray(mesh.vertices) + (move or (0.0, 0.0, 0.0)), np.asarray(mesh.faces))


def ball(x, y, z, radius=0.25, finer=1):
    return from_trimesh(trimesh.creation.icosphere(finer, radius), x, y, z)


def box(size, x, y, z, turn=0.0):
    mesh = trimesh.creation.box(size, trimesh.transformations.rotation_matrix(turn, (1, 2, 3)))
    return from_trimesh(mesh, x, y, z)


def half_open(mesh):
    return TriangleMesh(mesh.vertices, mesh.triangles[::2])


def half_turned(mesh):
    triangles = mesh.triangles.copy()
    triangles[::3] = triangles[::3, ::-1]
    return TriangleMesh(mesh.vertices, triangles)


def soup(seed, n, size=0.3):
    """Triangles of all forms, slivers and such without an area among them."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-0.8, 0.8, (n, 1, 3)) + rng.uniform(-size, size, (n, 3, 3))
    corners[: n // 8, 2] = corners[: n // 8, 1] + rng.normal(0.0, 1e-4, (n // 8, 3))
    corners[n // 8 : n // 6, 2] = corners[n // 8 : n // 6, 1]
    corners = corners[np.linalg.norm(corners, axis=2).min(axis=1) > 0.35]
    return TriangleMesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


def thin(robot, radius=0.004):
    """The robot with bodies that fit into others."""
    return replace(robot, capsules=tuple(replace(c, radius=radius) for c in robot.capsules), pairs=())


def scene_of(*meshes, pose=Pose()):
    return Scene(
        tuple(Obstacle(f"mesh{i}", Mesh(mesh, pose=pose)) for i, mesh in enumerate(meshes)), name="meshes"
    )


TURNED = Pose((0.1, -0.2, 0.05), rotation_from_rpy(0.3, -0.5, 1.1))
BALLS = (ball(0.6, 0.2, 0.4), ball(-0.4, 0.5, 0.3, 0.3, 0), ball(0.1, -0.6, 0.7, 0.2, 2))
BOXES = (
    box((0.5, 0.4, 0.3), 0.6, 0.1, 0.4, 0.4),
    box((0.3, 0.7, 0.2), 0.5, 0.2, 0.5, 1.0),
    box((0.2, 0.2, 1.5), -0.5, 0, 0),
)
WORLDS = {
    "closed balls": (ur5(np.pi), scene_of(*BALLS), True),
    "thin arm, closed balls": (thin(ur5(np.pi)), scene_of(*BALLS), True),
    "thin arm, boxes in one mesh that overlap": (thin(ur5(np.pi)), scene_of(merged(BOXES)), True),
    "thin arm, open balls": (thin(ur5(np.pi)), scene_of(*map(half_open, BALLS)), False),
    "thin arm, triangles turned to either side": (thin(ur5(np.pi)), scene_of(*map(half_turned, BALLS)), None),
    "thin arm, a large ball in a pose": (
        thin(ur5(np.pi)),
        scene_of(ball(0.7, 0, 0, 0.5, 3), pose=TURNED),
        True,
    ),
    "soup": (ur5(np.pi), scene_of(soup(1, 40)), False),
    "thin arm, soup": (thin(ur5(np.pi)), scene_of(soup(2, 300)), False),
    "one triangle": (ur5(np.pi), scene_of(soup(3, 9, 0.5)), False),
    "a floor of a kilometre": (ur5(np.pi), scene_of(box((1000, 1000, 1), 0, 0, -0.9, 0.0)), True),
    "balls of bodies": (as_balls(seven_joint_arm()), scene_of(soup(4, 60)), False),
    "tree": (random_tree(8), scene_of(*(ball(*place, 0.3) for place in np.eye(3) * 0.75)), True),
}


def apart_from(robot, scene, solid, q):
    """The oracle; of triangles that are turned to either side, inside is what the same in order wind around."""
    if solid is None:
        in_order = scene_of(*BALLS)
        return mesh_clearance(robot, in_order, q, True)
    return mesh_clearance(robot, scene, q, solid)


@pytest.fixture(scope="module", params=WORLDS)
def arm(request):
    """A world with meshes, random configurations, and by how much they are clear of contact."""
    robot, scene, solid = WORLDS[request.param]
    world = ArmWorld(robot, scene)
    q = world.space.from_cube(np.random.default_rng(1).random((3000, world.space.dim)))
    return world, q, solid, apart_from(robot, scene, solid, q[:120])


@pytest.mark.parametrize("backend", ["lanes", "scalar"])
def test_verdicts_are_those_of_every_triangle(arm, backend):
    world, q, _, apart = arm
    free = ArmWorld(world.robot, world.scene, backend=backend).valid(q[:120])
    clear = np.abs(apart) > BAND
    assert 0.02 < free.mean() < 0.98
    np.testing.assert_array_equal(free[clear], apart[clear] > 0.0)


def test_at_contact_no_verdict_is_freer_than_the_triangles(arm):
    world, q, solid, _ = arm
    free, blocked = edge(world, q, most=60)
    apart = apart_from(world.robot, world.scene, solid, free)
    assert (apart > 0.0).all()
    assert np.median(apart) < BAND
    assert apart_from(world.robot, world.scene, solid, blocked[:10]).max() < 2.0 * BAND


@pytest.mark.parametrize("backend", ["lanes", "scalar"])
def test_what_is_proved_is_free_everywhere(arm, backend):
    world, q, solid, _ = arm
    free = q[world.valid(q)]
    a, b = free[0::2][:60], free[1::2][:60]
    a = a[: len(b)]
    b = world.space.interpolate(a, b, np.linspace(0.05, 1.0, len(b)) ** 2)
    proved = ArmWorld(world.robot, world.scene, backend=backend).motion_certified(a, b, 1e-4)
    assert proved.any()
    start, end = a[proved][-1], b[proved][-1]
    count = 1 + 10 * int(np.ceil(world.space.distance(start[None], end[None])[0] / world.resolution))
    ends = (np.broadcast_to(each, (count, len(start))) for each in (start, end))
    states = world.space.interpolate(*ends, np.linspace(0.0, 1.0, count))
    assert apart_from(world.robot, world.scene, solid, states[:: 1 + len(states) // 60]).min() > 0.0


@pytest.mark.parametrize(
    ("mesh", "closed", "turned"),
    [
        (BALLS[0], 1.0, True),
        (merged(BOXES), 1.0, True),
        (half_open(BALLS[0]), 0.0, True),
        (half_turned(BALLS[0]), 1.0, False),
        (merged((BALLS[0], half_open(BALLS[2]))), 80 / 240, True),
        (soup(5, 20), 0.0, True),
        # Corners that are named apart but lie in one place.
        (
            TriangleMesh(BALLS[0].vertices[BALLS[0].triangles].reshape(-1, 3), np.arange(240).reshape(-1, 3)),
            1.0,
            True,
        ),
    ],
)
def test_closed_parts_are_found(mesh, closed, turned):
    parts, sides = closed_parts(mesh)
    assert (parts.mean(), sides) == (pytest.approx(closed), turned)


def test_a_mesh_of_no_reach_changes_nothing():
    assert ArmWorld(ur5(), scene_of(ball(50, 0, 0))).lanes.surfaces is None


def test_a_robot_that_stands_inside_is_never_free():
    world = ArmWorld(thin(ur5()), scene_of(ball(0, 0, 0, 1.0)))
    assert world.fixed_contact == ("base", "mesh0")
    assert not world.valid(np.zeros((1, 6)))[0]


def all_sorts(rng):
    """Triangles large and small, slivers, such without an area, along planes between cells and out of the grid."""
    sizes = np.repeat([1.0, 0.1, 0.003], [20, 100, 400])[:, None, None]
    corners = rng.uniform(-0.4, 0.4, (520, 1, 3)) + sizes * rng.uniform(-1, 1, (520, 3, 3))
    corners[:40, 2] = corners[:40, 1] + rng.normal(0.0, 1e-12, (40, 3))
    corners[40:80, 2] = 0.5 * (corners[40:80, 0] + corners[40:80, 1])
    corners[80:120, :, 1] = 0.25
    corners[120:130] = corners[120:130, :1]
    corners[130:160] = np.round(corners[130:160], 1)
    return corners


def test_the_grid_of_triangles_says_no_more_than_is_true_and_no_less_than_it_should():
    rng = np.random.default_rng(6)
    corners = all_sorts(rng)
    grid = grid_of_triangles(corners, corners[:0], False, 0.6)
    weights = rng.dirichlet(np.full(3, 0.5), (len(corners), 2000))
    weights[:, :3] = np.eye(3)
    on = (weights @ corners).reshape(-1, 3)
    cells = np.floor((on - grid.low) / grid.cell).astype(int)
    cells = cells[((cells >= 0) & (cells < grid.taken.shape)).all(axis=1)]
    assert len(cells) > 500_000
    assert grid.taken[tuple(cells.T)].all()
    x = rng.uniform(-0.6, 0.6, (2000, 3))
    told = grid.distances[tuple(((x - grid.low) / grid.cell).astype(int).T)] * (grid.cell / STEPS)
    rows = corners.transpose(1, 0, 2)
    apart = np.array([point_triangle(np.broadcast_to(row, (len(corners), 3)), *rows).min() for row in x])
    # What lies beyond the grid is not in it.
    near = apart < 0.6 - np.abs(x).max(axis=1)
    assert near.sum() > 1000
    assert (told <= apart)[near].all()
    assert (apart <= told + grid.excess)[near].all()
