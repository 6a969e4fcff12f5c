"""The robot's own shapes as the judge: what is inside of a mesh is not free."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from evenroad.geometry import Pose, TriangleMesh
from evenroad.geometry.shapes import Capsule, Mesh, PointCloud
from evenroad.robot import ArmWorld, Robot, Scene
from evenroad.robot.joint import Joint
from evenroad.robot.reference.validate import FINER
from evenroad.robot.scene import Obstacle
from evenroad.robot_roadmap.own_shapes import OwnShapesWorld, is_inside
from evenroad.space.path import resample
from tests.robot.kernel_arms import STRAIGHT, Z


def block(half, away=0.0, sound=True):
    """A surface around a block."""
    corners = half * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    hull = ConvexHull(corners)
    if not sound:
        # Triangles that are seen from this side and that.
        return TriangleMesh(corners + np.array([away, 0.0, 0.0]), hull.simplices, "block")
    turned = np.cross(*(corners[hull.simplices[:, i]] - corners[hull.simplices[:, 0]] for i in (1, 2)))
    inwards = (turned * hull.equations[:, :3]).sum(axis=1) < 0.0
    triangles = np.where(inwards[:, np.newaxis], hull.simplices[:, ::-1], hull.simplices)
    return TriangleMesh(corners + np.array([away, 0.0, 0.0]), triangles, "block")


def world_with(*obstacles, pairs=()):
    """A block on a turning arm, half a metre out, in a capsule that is larger."""
    pytest.importorskip("coal")
    joint = Joint("joint", "revolute", "base", "link", (0, 0, 0), STRAIGHT, Z, -3.0, 3.0)
    capsule = Capsule((0.4, 0.0, 0.0), (0.6, 0.0, 0.0), 0.18, link="link")
    fixed = Capsule((0.3, 0.0, 0.0), (0.3, 0.0, 0.1), 0.05, link="base")
    capsules = (fixed, capsule) if pairs else (capsule,)
    robot = Robot("arm", ("base", "link"), (joint,), capsules, pairs, ("joint",))
    shapes = [Mesh(block(0.1, 0.5), link="link")]
    if pairs:
        shapes.append(Mesh(block(0.02, 0.3), link="base"))
    return OwnShapesWorld(ArmWorld(robot, Scene(obstacles, name="scene")), shapes)


@pytest.mark.parametrize("obstacle", [
    Obstacle.of("ball", "sphere", (0.03,), (0.5, 0.0, 0.0)),
    Obstacle.of("ball", "box", (0.03, 0.03, 0.03), (0.55, -0.05, 0.05)),
    Obstacle("ball", Mesh(block(0.02), pose=Pose((0.45, 0.0, 0.0)))),
    Obstacle("ball", Mesh(block(0.3), pose=Pose((0.5, 0.0, 0.0)))),
])  # fmt: skip
def test_what_is_inside_of_a_mesh_is_not_free(obstacle):
    world = world_with(obstacle)
    inside, outside = np.zeros((1, 1)), np.full((1, 1), 1.5)
    assert not world.valid(inside)[0]
    assert not world.motion_valid(inside, inside + 0.001)[0]
    assert "touches 'ball'" in world.explain(inside[0])
    assert world.valid(outside)[0]


@pytest.mark.parametrize("first", [0, 1])
def test_a_piece_of_a_mesh_that_is_inside_of_another_touches_it_wherever_the_rest_is(first):
    away, inside = block(0.02, 2.0), block(0.02, 0.45)
    one, other = (away, inside)[first], (away, inside)[1 - first]
    corners = np.concatenate([one.vertices, other.vertices])
    both = TriangleMesh(corners, np.concatenate([one.triangles, other.triangles + len(one.vertices)]), "both")
    world = world_with(Obstacle("both", Mesh(both)))
    assert not world.valid(np.zeros((1, 1)))[0]
    assert world.valid(np.full((1, 1), 1.5))[0]


def test_what_is_free_touches_nothing_and_the_other_way_round():
    rng, near = np.random.default_rng(1), 0
    for away, radius in rng.uniform([0.3, 0.005], [0.75, 0.06], (40, 2)):
        height = rng.uniform(-0.2, 0.2)
        world = world_with(Obstacle.of("ball", "sphere", (radius,), (away, 0.0, height)))
        q = rng.uniform(-0.8, 0.8, (60, 1))
        # Where the ball is, seen from the block, which is turned about the origin.
        place = np.column_stack([away * np.cos(q), -away * np.sin(q), np.full(len(q), height)])
        beyond = np.maximum(np.abs(place - [0.5, 0.0, 0.0]) - 0.1, 0.0)
        apart = np.linalg.norm(beyond, axis=1) - radius
        sure = np.abs(apart) > 1e-6
        near += np.count_nonzero(np.abs(apart) < 0.01)
        np.testing.assert_array_equal(world.valid(q)[sure], apart[sure] > 0.0)
        free = world.motion_valid(q[:-1], q[1:])
        assert not (free & ~((apart[:-1] > 0.0) & (apart[1:] > 0.0)))[sure[:-1] & sure[1:]].any()
    assert near > 100


def test_coal_is_asked_only_where_the_capsules_touch(monkeypatch):
    # Beside an edge of the block, so that not even the boxes around the two tell them apart.
    world = world_with(Obstacle.of("ball", "sphere", (0.03,), (0.622, 0.122, 0.0)))
    coal, asked = pytest.importorskip("coal"), []
    collide = coal.collide
    monkeypatch.setattr(coal, "collide", lambda *given: asked.append(given) or collide(*given))
    way = np.array([[-1.5], [0.0]])
    assert world.motion_valid(way[:1], way[1:])[0]
    states = resample(way, world.space, world.capsules.resolution / FINER)[0]
    assert 0 < len(asked) <= np.count_nonzero(~world.capsules.valid(states))
    asked.clear()
    assert world.motion_proved(np.array([[-1.5]]), np.array([[-1.0]]))[0]
    assert world.motion_valid(np.array([[-1.5]]), np.array([[-1.0]]))[0]
    assert not asked


def test_clouds_are_asked_about_what_the_shapes_say_of_the_robot_itself():
    """A cloud in the scene does not bring back that the capsules of two links touch."""
    cloud = Obstacle("dust", PointCloud(np.array([[0.0, 0.0, 3.0]]), radius=0.01))
    world = world_with(cloud, pairs=(("base", "link"),))
    q = np.zeros((1, 1))
    assert not world.capsules.valid(q)[0]
    assert world.valid(q)[0]
    assert world.motion_valid(q, q + 0.1)[0]
    near = world_with(Obstacle("dust", PointCloud(np.array([[0.5, 0.0, 0.0]]), radius=0.01)))
    assert not near.valid(q)[0]
    assert "dust" in near.explain(q[0])


def test_what_only_the_capsule_touches_is_free():
    beside = Obstacle.of("ball", "sphere", (0.03,), (0.5, 0.14, 0.0))
    within_the_box_of_a_turned_block = Obstacle.of("far", "sphere", (0.03,), (0.5, 0.0, 0.16))
    world = world_with(beside, within_the_box_of_a_turned_block)
    q = np.zeros((1, 1))
    assert not world.capsules.valid(q)[0]
    assert world.valid(q)[0]
    assert world.explain(q[0]) == "it is free"


@pytest.mark.parametrize("sound", [True, False])
def test_inside_of_a_block_is_inside_of_its_surface(sound):
    mesh = block(0.1, 0.5, sound)
    corners = mesh.vertices[mesh.triangles]
    places = np.random.default_rng(0).uniform([0.3, -0.2, -0.2], [0.7, 0.2, 0.2], (400, 3))
    inside = (np.abs(places - [0.5, 0.0, 0.0]) < 0.1).all(axis=1)
    assert 20 < inside.sum() < 380
    found = np.array([is_inside(corners, place) for place in places])
    assert found[inside].all()
    # Triangles that are seen from the wrong side may make more of it, not less.
    assert found[~inside].sum() <= (0 if sound else 0.2 * len(places))


def test_one_of_two_surfaces_that_overlap_does_not_undo_the_other():
    mesh = block(0.1)
    corners = mesh.vertices[mesh.triangles]
    assert is_inside(np.concatenate([corners, corners + 0.01]), np.zeros(3))
