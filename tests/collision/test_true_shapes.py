"""Where capsules touch an obstacle the links' true shapes decide: against solids in double precision, near contact."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from evenroad.collision.arm_world import ArmWorld
from evenroad.geometry import Box, Capsule, Cylinder, Mesh, PointCloud, Sphere, TriangleMesh
from evenroad.planning import plan
from evenroad.robot import load_robot
from evenroad.scenes.scene import Obstacle, Scene
from tests.robots.kernel_arms import edge, proof_edge, states_along
from tests.robots.mesh_arms import fork, write_fork_arm
from tests.robots.shape_oracle import shape_clearance
from tests.robots.solid_scenes import as_meshes, solids
from tests.robots.surface_scenes import from_trimesh
from tests.robots.urdf_texts import joint, link, urdf

BAND = 1e-5
"""Nearer to contact than this [m] either verdict is right: single precision costs some micrometres."""
WIDE = "<limit lower='-3' upper='3' velocity='2' effort='1'/>"


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    """An arm of a box, a cylinder, a capsule and a fork, with no link tested against another, and its shapes."""
    folder = tmp_path_factory.mktemp("arm")
    robot = load_robot(write_fork_arm(folder))
    from evenroad.loading.urdf import read_urdf

    return replace(robot, pairs=()), read_urdf(folder / "arm.urdf").shapes


def points(seed, count=60):
    rng = np.random.default_rng(seed)
    angle, away = rng.uniform(0.0, 2.0 * np.pi, count), rng.uniform(0.25, 0.7, count)
    places = np.stack([away * np.cos(angle), away * np.sin(angle), rng.uniform(0.2, 1.0, count)], axis=1)
    return Scene((Obstacle("cloud", PointCloud(places, 0.012)),), name="points")


def triangles(seed, count=90):
    """Triangles around the arm, large and small; a third are needles, some are segments or points; and each alone."""
    rng = np.random.default_rng(seed)
    angle, away = rng.uniform(0.0, 2.0 * np.pi, count), rng.uniform(0.3, 0.7, count)
    places = np.stack([away * np.cos(angle), away * np.sin(angle), rng.uniform(0.2, 1.0, count)], axis=1)
    first, second = rng.normal(0.0, 1.0, (2, count, 3)) * np.linspace(0.002, 0.2, count)[:, np.newaxis]
    second[::3] = first[::3] * 0.6 + rng.normal(0.0, 1e-7, second[::3].shape)
    second[::9], first[::18] = first[::9], 0.0
    corners = places[:, np.newaxis] + np.stack([np.zeros_like(first), first, second], axis=1)
    mesh = Mesh(TriangleMesh(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)))
    return Scene((Obstacle("triangles", mesh),)), SimpleNamespace(obstacles=[SimpleNamespace(body=corners)])


BOXES = as_meshes(solids(3, 80))
SCENES = {
    "solids": (solids(1), solids(1)),
    "others": (solids(2), solids(2)),
    "points": (points(4),) * 2,
    "meshes": BOXES,
    "triangles": triangles(10),
}


@pytest.mark.parametrize("name", SCENES)
def test_verdicts_next_to_contact_are_those_of_the_solids(arm, name):
    (robot, shapes), (scene, solid) = arm, SCENES[name]
    world = ArmWorld(robot, scene)
    q = world.space.from_cube(np.random.default_rng(5).random((1200, world.space.dim)))
    free, blocked = edge(world, q, 60)
    slack = BAND + 2e-4 * 0.15
    assert shape_clearance(robot, shapes, solid, free).min() > -slack
    assert shape_clearance(robot, shapes, solid, blocked).max() < slack
    some = q[:80]
    apart = shape_clearance(robot, shapes, solid, some)
    clear = np.abs(apart) > slack
    assert np.array_equal(world.valid(some)[clear], apart[clear] > 0.0)


@pytest.mark.parametrize("name", ["solids", "others"])
def test_no_verdict_next_to_contact_depends_on_what_was_asked_before(arm, name):
    world, rng = ArmWorld(arm[0], SCENES[name][0]), np.random.default_rng(9)
    q = np.concatenate(edge(world, world.space.from_cube(rng.random((1500, world.space.dim))), 80))
    q = np.concatenate([q, q + rng.normal(0.0, 1e-4, q.shape), q + rng.normal(0.0, 1e-2, q.shape)])
    valid = world.valid(q)
    for _ in range(4):
        order = rng.permutation(len(q))
        assert np.array_equal(ArmWorld(arm[0], SCENES[name][0]).valid(q[order]), valid[order])


def test_capsules_call_more_blocked_and_never_less(arm):
    robot, _ = arm
    q = ArmWorld(robot).space.from_cube(np.random.default_rng(6).random((3000, 3)))
    shaped = ArmWorld(robot, solids(1)).valid(q)
    capsules = ArmWorld(replace(robot, shapes=()), solids(1)).valid(q)
    assert not (capsules & ~shaped).any()
    assert (shaped & ~capsules).mean() > 0.005


@pytest.mark.parametrize("name", SCENES)
def test_no_state_of_a_proved_motion_touches(arm, name):
    (robot, shapes), (scene, solid) = arm, SCENES[name]
    world, rng = ArmWorld(robot, scene), np.random.default_rng(7)
    q = world.space.from_cube(rng.random((3000, world.space.dim)))
    free, blocked = (q[world.valid(q) == is_free][:40] for is_free in (True, False))
    a = free[: len(blocked)]
    end = proof_edge(world, a, blocked[: len(a)])
    states = states_along(world, a, end, rng, 8)
    assert shape_clearance(robot, shapes, solid, end).min() < 1e-4
    assert shape_clearance(robot, shapes, solid, states).min() > -2e-4 * 0.15 - BAND


def test_a_clearance_is_kept_by_the_shapes(arm):
    robot, shapes = arm
    world = ArmWorld(robot, solids(1), clearance=0.02)
    q = world.space.from_cube(np.random.default_rng(8).random((1500, 3)))
    free, blocked = edge(world, q, 50)
    assert np.abs(shape_clearance(robot, shapes, solids(1), free) - 0.02).max() < BAND + 3e-5
    assert np.abs(shape_clearance(robot, shapes, solids(1), blocked) - 0.02).max() < BAND + 3e-5


def hollow_arm(folder):
    """An arm of one joint that swings a large closed mesh which is not convex, 0.4 m long, about z."""
    bar = trimesh.creation.box((0.4, 0.12, 0.12)).apply_translation((0.4, 0, 0))
    foot = trimesh.creation.box((0.1, 0.12, 0.3)).apply_translation((0.55, 0, 0.1))
    trimesh.util.concatenate([bar, foot]).export(folder / "bar.stl")
    text = urdf(
        link("base", ""),
        link("bar", "<collision><geometry><mesh filename='bar.stl'/></geometry></collision>"),
        joint("turn", "base", "bar", "revolute", WIDE, "0 0 0", "0 0 1"),
        name="hollow",
    )
    (folder / "hollow.urdf").write_text(text)
    return load_robot(folder / "hollow.urdf")


def test_what_is_inside_of_a_link_or_has_it_inside_is_not_free(tmp_path):
    robot = hollow_arm(tmp_path)
    small = trimesh.creation.icosphere(1, 0.01).apply_translation((0.4, 0, 0))
    inside = {
        "ball": Obstacle("ball", Sphere(0.01, xyz=(0.4, 0, 0))),
        "points": Obstacle("points", PointCloud(np.array([[0.4, 0.0, 0.0]]), 0.005)),
        "mesh": Obstacle("mesh", Mesh(from_trimesh(small))),
    }
    for obstacle in inside.values():
        world = ArmWorld(robot, Scene((obstacle,)))
        assert not world.valid(np.array([0.0]))
        assert world.valid(np.array([0.5]))
        assert world.explain(np.array([0.0])) == f"'bar' touches {obstacle.name!r}"
    around = Obstacle("around", Mesh(from_trimesh(trimesh.creation.box((1.3, 1.3, 1.3)))))
    assert not ArmWorld(robot, Scene((around,))).valid(np.array([[0.0], [2.0]])).any()


def test_of_a_mesh_in_many_parts_the_one_inside_of_a_link_is_found(tmp_path):
    robot = hollow_arm(tmp_path)
    places = [(0.0, 0.0, z) for z in np.linspace(0.5, 0.9, 20)]
    balls = [trimesh.creation.icosphere(1, 0.01).apply_translation(place) for place in (*places, (0.4, 0.0, 0.0))]
    for order in (balls, balls[::-1]):
        whole = trimesh.util.concatenate(order)
        sheet = trimesh.Trimesh(whole.vertices, whole.faces[whole.triangles_center[:, 0] < 0.4])
        for mesh in (whole, sheet):
            world = ArmWorld(robot, Scene((Obstacle("balls", Mesh(from_trimesh(mesh))),)))
            assert list(world.valid(np.array([[0.0], [0.5]]))) == [False, True]


@pytest.mark.parametrize(("high", "is_free"), [(0.0, True), (1e-6, True), (1e-4, False)])
def test_a_base_may_stand_on_a_table_but_not_in_it(tmp_path, high, is_free):
    text = urdf(
        link("base", "<collision><origin xyz='0 0 .05'/><geometry><box size='.3 .2 .1'/></geometry></collision>"),
        link("arm", "<collision><origin xyz='0 0 .4'/><geometry><box size='.05 .05 .4'/></geometry></collision>"),
        joint("turn", "base", "arm", "revolute", WIDE, "0 0 0", "0 1 0"),
        name="standing",
    )
    (tmp_path / "standing.urdf").write_text(text)
    top = Obstacle("table", Box((1.0, 1.0, 0.5), xyz=(0, 0, high - 0.25)))
    leg = Obstacle("leg", Cylinder(0.1, 0.5, xyz=(0, 0, high - 0.25)))
    for table in (top, leg):
        world = ArmWorld(load_robot(tmp_path / "standing.urdf"), Scene((table,)))
        assert world.valid(np.array([0.0])) == is_free
        said = "it is free" if is_free else f"'base' touches {table.name!r} wherever the joints are"
        assert world.explain(np.array([0.0])).startswith(said)
    # What it stands on is no nearer to a base that keeps away from all else.
    padded = load_robot(tmp_path / "standing.urdf").with_padding({"base": 0.01})
    assert ArmWorld(padded, Scene((top,)), clearance=0.01).valid(np.array([0.0])) == is_free


def test_a_closed_mesh_around_all_that_the_robot_can_reach_is_an_obstacle(tmp_path):
    robot = hollow_arm(tmp_path)
    for away, is_free in ((0.0, False), (90.0, True)):
        mesh = trimesh.creation.box((40.0, 40.0, 40.0)).apply_translation((away, 0, 0))
        world = ArmWorld(robot, Scene((Obstacle("around", Mesh(from_trimesh(mesh))),)))
        assert world.valid(np.array([0.3])) == is_free


def test_shapes_decide_unless_capsules_are_asked_for(tmp_path):
    file = write_fork_arm(tmp_path)
    shaped, again, capsules = load_robot(file), load_robot(file, bodies="shapes"), load_robot(file, bodies="capsules")
    assert shaped.shapes == again.shapes
    assert {each.of for each in shaped.shapes} == {"box", "cylinder", "mesh"}
    assert capsules == replace(shaped, shapes=())
    assert shaped.fingerprint() != capsules.fingerprint()
    held = Box((0.1, 0.1, 0.1), xyz=(0, 0, 0.1))
    for robot in (shaped, capsules, load_robot("ur5")):
        assert [each.of for each in robot.holding(held, robot.links[-1]).shapes if each.link == "held"] == ["box"]


def test_a_flat_link_passes_a_slot_with_12_mm_on_both_sides(tmp_path):
    text = urdf(
        link("base", ""),
        link("rail", ""),
        link("plate", "<collision><geometry><box size='0.2 0.3 0.02'/></geometry></collision>"),
        joint("along", "base", "rail", "prismatic", WIDE, "0 0 0.5", "1 0 0"),
        joint("up", "rail", "plate", "prismatic", WIDE, "0 0 0", "0 0 1"),
        name="plate",
    )  # fmt: skip
    (tmp_path / "plate.urdf").write_text(text)
    slot = Scene(
        tuple(
            Obstacle(name, Box((0.2, 2, 1), xyz=(0, 0, 0.5 + side * 0.522)))
            for name, side in (("under", -1), ("over", 1))
        )
    )
    start, goal = np.array([-0.8, 0.1]), np.array([0.8, -0.2])
    assert plan(ArmWorld(load_robot(tmp_path / "plate.urdf"), slot), start, goal).solved
    capsules = load_robot(tmp_path / "plate.urdf", bodies="capsules")
    assert not ArmWorld(capsules, slot).valid(np.array([0.0, 0.0]))


def test_a_convex_mesh_is_one_hull_and_another_one_its_triangles(tmp_path):
    ball = Mesh(from_trimesh(trimesh.creation.icosphere(3, 0.1)), link="ball")
    from evenroad.geometry.parts import parts_of

    (hull,) = parts_of([ball])
    assert (hull.of, len(hull.corners)) == ("hull", 1)
    assert hull.radius < 2e-4
    forked = from_trimesh(fork())
    (mesh,) = parts_of([Mesh(TriangleMesh(forked.vertices, forked.triangles), link="fork")])
    assert (mesh.of, mesh.corners.shape, mesh.closed) == ("mesh", (36, 3, 3), True)
    assert parts_of([Sphere(0.1, link="a"), Capsule((0, 0, 0), (0, 0, 1), 0.1, link="a")]) == ()
    (tube,) = parts_of([Cylinder(0.05, 0.2, link="a")])
    assert np.linalg.norm(tube.disc) == pytest.approx(0.05)
