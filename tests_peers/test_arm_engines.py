"""Klamp't, coal and pinocchio behind one protocol agree with our capsules, and with meshes of our own making."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.robots.kernel_arms import box_scene, random_scene, random_tree, ur5
from tests.robots.mesh_arms import FORK, LONG, write_fork_arm
from tests.robots.oracle import clearance, obstacle_distance

from evenroad.collision.arm_world import ArmWorld
from evenroad.collision.coal_world import CoalWorld, original_shapes
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.geometry import Mesh, Pose, TriangleMesh
from evenroad.robot import link_poses, load_robot
from evenroad.scenes.scene import Obstacle, Scene
from evenroad.testing import WorldContract
from tests_peers.engines.klampt_world import KlamptWorld
from tests_peers.engines.pinocchio_world import PinocchioWorld
from tests_peers.second_judge import free_for_both

for extra in ("klampt", "coal", "pinocchio"):
    pytest.importorskip(extra)

ENGINES = {KlamptWorld: 2e-3, CoalWorld: 2e-4, PinocchioWorld: 2e-4}
"""Engine -> clearance within which its verdict may be another [m]: Klamp't has triangles within round bodies, and
the oracle takes a capsule for many balls.
"""
CASES = {
    "ur5": (ur5(math.pi, joints=5), box_scene(0.30)),
    "tree": (random_tree(8), random_scene(108, spread=0.7, clear=0.45)),
}
engines = pytest.mark.parametrize("engine", ENGINES)


class TestKlampt(WorldContract):
    world = KlamptWorld(*CASES["ur5"])
    free_between = False


class TestCoal(WorldContract):
    world = CoalWorld(*CASES["tree"])
    free_between = False


class TestPinocchio(WorldContract):
    world = PinocchioWorld(*CASES["tree"])
    free_between = False


@engines
@pytest.mark.parametrize(("robot", "scene"), CASES.values(), ids=CASES)
def test_verdicts_are_those_of_the_capsules(engine, robot, scene):
    world = engine(robot, scene)
    q = world.space.from_cube(np.random.default_rng(1).random((1_000, world.space.dim)))
    apart = clearance(robot, scene, q, samples=80)
    clear = np.abs(apart) > ENGINES[engine]
    assert clear.mean() > 0.95
    np.testing.assert_array_equal(world.valid(q)[clear], apart[clear] > 0.0)


@engines
@pytest.mark.parametrize(("robot", "scene"), CASES.values(), ids=CASES)
def test_what_we_call_free_they_call_free(engine, robot, scene):
    world = ArmWorld(robot, scene)
    q = world.space.from_cube(np.random.default_rng(2).random((2_000, world.space.dim)))
    judge = engine(robot, scene)
    free = q[world.valid(q)]
    assert (free_for_both(judge, free) if engine is CoalWorld else judge.valid(free)).all()


@pytest.mark.parametrize(("robot", "scene"), CASES.values(), ids=CASES)
def test_pinocchio_and_coal_say_the_same_of_every_configuration(robot, scene):
    world, other = PinocchioWorld(robot, scene), CoalWorld(robot, scene)
    q = world.space.from_cube(np.random.default_rng(3).random((3_000, world.space.dim)))
    verdicts = world.valid(q)
    assert 0.05 < verdicts.mean() < 0.95
    np.testing.assert_array_equal(verdicts, free_for_both(other, q))


@engines
def test_no_shapes_are_no_free_pass(engine):
    robot, scene = CASES["ur5"]
    with pytest.raises(InvalidValue, match="one or more"):
        engine(robot, scene, shapes=())


def test_coal_names_what_touches():
    robot, scene = CASES["ur5"]
    assert CoalWorld(robot, scene).explain(np.array([0.0, 0.6, 0.0, 0.0, 0.0])).endswith("touches 'table'")


@pytest.mark.parametrize(("robot", "scene"), CASES.values(), ids=CASES)
def test_no_contact_of_coal_is_missed_by_the_boxes_around_bodies(robot, scene, monkeypatch):
    turned = Pose((0.3, 0.2, 0.2), (0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6))
    mesh = replace(tetrahedron(0.15), pose=turned)
    scene = replace(scene, obstacles=(*scene.obstacles, Obstacle("surface", mesh)))
    world = CoalWorld(robot, scene)
    q = world.space.from_cube(np.random.default_rng(2).random((150, world.space.dim)))
    found = [world.contacts(each) for each in q]
    assert sum(map(len, found)) > 50
    assert any("surface" in pair for contacts in found for pair in contacts)
    skipped = 1.0 - world._near(world._poses(q)).mean()
    assert skipped > 0.5
    monkeypatch.setattr(CoalWorld, "_near", lambda self, poses: np.full((len(self._tests), poses.shape[1]), True))
    assert [world.contacts(each) for each in q] == found


def tetrahedron(half):
    """A tetrahedron."""
    corners = half * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    return Mesh(TriangleMesh(corners, np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]), "four"))


@pytest.fixture
def fork_arm(tmp_path):
    """An arm that ends in a mesh, with its own shapes."""
    path = write_fork_arm(tmp_path)
    robot = load_robot(path)
    return robot, original_shapes(path, robot)


def balls(count=8, radius=0.06):
    """Balls around the arm, larger than a prong is thick: none is wholly inside of a surface."""
    rng = np.random.default_rng(5)
    directions = rng.normal(size=(count, 3))
    places = directions / np.linalg.norm(directions, axis=1, keepdims=True) * rng.uniform(0.25, 0.6, (count, 1))
    places[:, 2] += 0.4
    return Scene(
        tuple(Obstacle.of(f"ball {i}", "sphere", (radius,), tuple(p)) for i, p in enumerate(places)),
        name="balls",
    )


def clearance_of_shapes(robot, shapes, scene, q):
    """How far the balls stay from the shapes, (n,), the fork being the boxes that it was made of."""
    poses = link_poses(robot, q)
    least = np.full(len(q), np.inf)
    for shape in shapes:
        if not isinstance(shape, Mesh):
            solids = [Obstacle.of("", shape.kind, shape.size)]
        else:
            solids = [Obstacle.of("", "box", size, centre) for size, centre in FORK]
        frames = np.linalg.inv(poses[:, robot.links.index(shape.link)] @ shape.pose.matrix)
        for ball in scene.obstacles:
            centres = frames[:, :3, :3] @ np.array(ball.xyz) + frames[:, :3, 3]
            for solid in solids:
                least = np.minimum(least, obstacle_distance(centres, solid) - ball.size[0])
    return least


@engines
def test_verdicts_are_those_of_the_original_shapes_and_mesh(engine, fork_arm):
    robot, shapes = fork_arm
    robot, scene = replace(robot, pairs=()), balls()
    world = engine(robot, scene, shapes)
    q = world.space.from_cube(np.random.default_rng(6).random((2_000, world.space.dim)))
    apart = clearance_of_shapes(robot, shapes, scene, q)
    clear = np.abs(apart) > (1e-5 if engine is not KlamptWorld else ENGINES[engine])
    free = apart > 0.0
    assert 0.1 < free.mean() < 0.9
    np.testing.assert_array_equal(world.valid(q)[clear], free[clear])


@engines
def test_what_is_free_for_the_fitted_capsules_is_free_for_the_meshes(engine, fork_arm):
    robot, shapes = fork_arm
    world, exact = ArmWorld(robot, balls()), engine(robot, balls(), shapes)
    q = world.space.from_cube(np.random.default_rng(7).random((4_000, world.space.dim)))
    ours, theirs = world.valid(q), exact.valid(q)
    assert theirs[ours].all()
    assert ours.sum() > 0.98 * theirs.sum() > 100, "hulls decide where capsules touch: little is lost"


@engines
def test_a_mesh_is_not_made_convex_and_no_prong_is_lost(engine, fork_arm):
    """A ball in the gap of the fork is free; where a prong is, it is not."""
    robot, shapes = fork_arm
    q = np.array([[0.4, 0.3, 0.1]])
    mesh = next(shape for shape in shapes if isinstance(shape, Mesh))
    frame = link_poses(robot, q)[0, robot.links.index("fork")] @ mesh.pose.matrix

    def verdict(y):
        place = frame[:3, :3] @ (0.0, y, 0.6 * LONG) + frame[:3, 3]
        scene = Scene((Obstacle.of("ball", "sphere", (0.05,), tuple(place)),), name="ball")
        return engine(replace(robot, pairs=()), scene, shapes).valid(q)[0]

    assert verdict(0.0)
    assert not verdict(0.06)
    assert not verdict(-0.06)
    assert verdict(0.16)


@pytest.mark.parametrize("engine", [CoalWorld, PinocchioWorld])
def test_a_capsule_that_lies_in_the_end_of_a_cylinder_touches_it(engine, fork_arm):
    """Coal misses it, 3 cm deep, when it is not asked for contacts."""
    robot, shapes = fork_arm
    q = np.array([[turn, -0.5 * math.pi + off, 0.1] for turn in np.linspace(-3, 3, 50) for off in (-2e-3, 0.0, 2e-3)])
    assert ("arm", "nose") in robot.pairs
    assert not engine(replace(robot, pairs=(("arm", "nose"),)), Scene((), name="nothing"), shapes).valid(q).any()


def test_self_collisions_of_meshes_are_found_by_all(fork_arm):
    robot, shapes = fork_arm
    assert ("base", "fork") in robot.pairs
    worlds = [engine(robot, Scene((), name="nothing"), shapes) for engine in (CoalWorld, PinocchioWorld, KlamptWorld)]
    q = worlds[0].space.from_cube(np.random.default_rng(8).random((3_000, 3)))
    coal, (pinocchio, klampt) = free_for_both(worlds[0], q), (world.valid(q) for world in worlds[1:])
    assert 0.5 < coal.mean() < 0.99
    np.testing.assert_array_equal(coal, pinocchio)
    assert (coal != klampt).mean() < 0.01


@engines
@pytest.mark.parametrize("content", [b"", b"solid fork\nendsolid fork\n"])
def test_a_mesh_that_has_become_empty_is_an_error(engine, fork_arm, content):
    robot, shapes = fork_arm
    next(shape for shape in shapes if isinstance(shape, Mesh)).source.write_bytes(content)
    with pytest.raises(BrokenFile, match=r"fork\.stl"):
        engine(robot, balls(), shapes)


@engines
def test_a_mesh_that_is_gone_is_an_error(engine, fork_arm, tmp_path):
    robot, shapes = fork_arm
    gone = [replace(shape, source=tmp_path / "gone.stl") if isinstance(shape, Mesh) else shape for shape in shapes]
    with pytest.raises(BrokenFile, match=r"gone\.stl is missing"):
        engine(robot, balls(), gone)
