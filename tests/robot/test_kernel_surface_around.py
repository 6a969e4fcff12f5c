"""The grid around all surfaces of a scene: it changes no verdict, and its bytes are bounds."""

from dataclasses import replace

import numpy as np
import pytest

from evenroad.geometry import Mesh
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.kernel import scene_surfaces
from evenroad.robot.kernel import surface_tree as tree
from evenroad.robot.kernel.scene_surfaces import surface_of
from evenroad.robot.kernel.surface_around import surface_around
from evenroad.robot.scene import Obstacle, Scene
from tests.robot.kernel_arms import edge, ur5
from tests.robot.surface_oracle import mesh_clearance, point_triangle, windings
from tests.robot.test_kernel_clouds import cloud_scene
from tests.robot.test_kernel_meshes import BALLS, BOXES, TURNED, ball, half_open, scene_of, soup, thin

BAND = 1e-5
"""Nearer to contact than this [m] either verdict is right; but single precision must then say blocked."""

INSIDE_OUT = replace(BALLS[0], triangles=BALLS[0].triangles[:, ::-1])
CLOUD = cloud_scene(6, 400).obstacles[0]
SCENES = {
    "closed ones that overlap": scene_of(*BALLS, *BOXES),
    "one turned inside out in another": scene_of(BALLS[0], INSIDE_OUT, ball(0.6, 0.2, 0.4, 0.1), pose=TURNED),
    "open ones, a soup and a cloud": Scene(
        (*scene_of(half_open(BALLS[1]), soup(2, 200)).obstacles, Obstacle("cloud", CLOUD.body)), name="all"
    ),
    "some that may be touched": replace(
        scene_of(*BALLS),
        allowed=frozenset({("forearm", "mesh0"), ("wrist1", "mesh1"), ("upperarm", "mesh2")}),
    ),
}


@pytest.fixture(autouse=True)
def around_few(monkeypatch):
    """Have a grid around two surfaces."""
    monkeypatch.setattr(scene_surfaces, "MANY", 2)
    scene_surfaces._surfaces.cache_clear()
    yield
    scene_surfaces._surfaces.cache_clear()


@pytest.fixture(scope="module", params=SCENES)
def scene(request):
    return SCENES[request.param]


@pytest.mark.parametrize("robot", [ur5(np.pi), thin(ur5(np.pi))], ids=["arm", "thin arm"])
def test_a_scene_is_free_where_each_obstacle_alone_leaves_it_free(scene, robot):
    world = ArmWorld(robot, scene)
    assert world.lanes.surfaces.around is not None
    alone = []
    for number in range(len(scene.obstacles)):
        one = replace(scene, obstacles=scene.obstacles[number : number + 1], allowed=frozenset())
        touched = {pair for pair in scene.allowed if pair[1] == one.obstacles[0].name}
        alone.append(ArmWorld(robot, replace(one, allowed=frozenset(touched))))
        assert alone[-1].lanes.surfaces.around is None
    q = world.space.from_cube(np.random.default_rng(3).random((6000, world.space.dim)))
    free, blocked = edge(world, q, most=200)
    q = np.concatenate([q, free, blocked])
    verdicts = world.valid(q)
    assert 0.02 < verdicts.mean() < 0.98
    np.testing.assert_array_equal(verdicts, np.logical_and.reduce([each.valid(q) for each in alone]))
    # Proofs are made with enlarged bodies.
    a, b = q[verdicts][:400:2], q[verdicts][1:400:2]
    b = world.space.interpolate(a, b, np.linspace(0.05, 0.6, len(b)))
    proved = world.motion_certified(a, b, 1e-3)
    assert proved.any()
    np.testing.assert_array_equal(
        proved <= np.logical_and.reduce([each.motion_certified(a, b, 1e-4) for each in alone]), True
    )


@pytest.mark.parametrize("robot", [ur5(np.pi), thin(ur5(np.pi))], ids=["arm", "thin arm"])
@pytest.mark.parametrize("title", ["closed ones that overlap", "some that may be touched"])
def test_at_contact_with_many_no_verdict_is_freer_than_the_triangles(title, robot):
    world = ArmWorld(robot, SCENES[title])
    q = world.space.from_cube(np.random.default_rng(4).random((4000, world.space.dim)))
    free, blocked = edge(world, q, most=80)
    apart = mesh_clearance(robot, world.scene, free, True)
    assert (apart > 0.0).all()
    assert np.median(apart) < BAND
    assert mesh_clearance(robot, world.scene, blocked[:20], True).max() < 2.0 * BAND


def test_bytes_are_no_more_than_the_distances():
    scene = SCENES["closed ones that overlap"]
    meshes = [obstacle.body for obstacle in scene.obstacles]
    grid = surface_around([surface_of(Mesh(each.triangles), 1.2) for each in meshes])
    table, first = grid.view(np.float32)[2 * tree.HEADER :], int(grid[tree.GRID])
    counts = grid[[tree.CELLS_X, tree.CELLS_Y, tree.CELLS_Z]]
    away = grid.view(np.uint8)[first : first + counts.prod()].reshape(counts) * table[tree.STEP]
    rng = np.random.default_rng(5)
    cells = rng.integers(counts, size=(2000, 3))
    places = table[:3] + (cells + rng.random((2000, 3))) / table[tree.ONE_BY_CELL]
    corners = np.concatenate([each.triangles.vertices[each.triangles.triangles] for each in meshes])
    slack = []
    for place, bound in zip(places, away[tuple(cells.T)], strict=True):
        inside = max(
            abs(windings(place, each.triangles.vertices[each.triangles.triangles])) for each in meshes
        )
        distance = point_triangle(
            np.broadcast_to(place, (len(corners), 3)), *corners.transpose(1, 0, 2)
        ).min()
        slack.append((0.0 if inside > 0.5 else distance) - bound)
    assert min(slack) >= 0.0
    # Good for something: some two cells are lost.
    assert np.median(slack) < 3.0 / table[tree.ONE_BY_CELL]


def test_only_many_surfaces_have_a_grid_around_them(monkeypatch):
    for many, expected in ((6, True), (7, False)):
        monkeypatch.setattr(scene_surfaces, "MANY", many)
        scene_surfaces._surfaces.cache_clear()
        world = ArmWorld(ur5(np.pi), SCENES["closed ones that overlap"])
        assert (world.lanes.surfaces.around is not None) == expected
