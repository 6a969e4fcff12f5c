"""Bodies of convex hulls: contact, configurations and motions, by linear programs that know nothing of our search."""

import numpy as np
import pytest
import trimesh
from scipy.optimize import linprog
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from evenroad.geometry import Capsule
from evenroad.geometry.distance import segment_distance
from evenroad.geometry.hulls import Hull
from evenroad.robot import ArmWorld, Robot, Scene, load_model, load_robot
from evenroad.robots.hull_trees import contacts, hull_trees
from evenroad.robots.joint import Joint
from evenroad.robots.kinematics import link_poses
from tests.robots.kernel_arms import STRAIGHT, X, Y, Z, edge, states_along, through_contact
from tests.robots.mesh_arms import rod_touches
from tests.robots.urdf_texts import joint, link, urdf, write

EMPTY = Scene((), name="empty")
WIDTH = 0.05
"""Radius of capsules [m]."""


def gap(first, second):
    """How far two convex sets, (n, 3) corners, can be pushed together along the line of their middles, or -1."""
    towards = first.mean(axis=0) - second.mean(axis=0)
    n, m = len(first), len(second)
    # Least s >= 0 with a point of the first in the second moved by s: 0 where they touch.
    equal = np.vstack(
        [np.c_[first.T, -second.T, -towards], np.r_[np.ones(n), np.zeros(m), 0], np.r_[np.zeros(n), np.ones(m), 0]]
    )
    found = linprog(np.r_[np.zeros(n + m), 1.0], A_eq=equal, b_eq=[0, 0, 0, 1, 1], bounds=(0, None))
    return found.fun * np.linalg.norm(towards) if found.status == 0 else np.inf


def placed(rng, count, spread):
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, :3] = Rotation.random(count, rng=rng).as_matrix()
    poses[:, :3, 3] = rng.normal(size=(count, 3)) * spread
    return poses


def test_hulls_touch_where_a_linear_program_says_so_also_at_the_edge_of_contact():
    rng = np.random.default_rng(0)
    for _ in range(12):
        bodies = []
        for count in (30, 12):
            points = rng.normal(size=(count, 3)) * rng.uniform(0.02, 0.3, 3)
            bodies.append(points[ConvexHull(points).vertices])
        trees = hull_trees({"a": [(bodies[0][np.newaxis], 0.0)], "b": [(bodies[1][np.newaxis], 0.0)]})
        poses, far = placed(rng, 20, 0.1), placed(rng, 20, 0.1)
        near = far.copy()
        far[:, :3, 3] += 2.0
        near[:, :3, 3] = poses[:, :3, 3]
        assert (contacts(trees, "a", "b", poses, near)[:, 0] >= 0).all()
        assert (contacts(trees, "a", "b", poses, far)[:, 0] < 0).all()
        for _ in range(26):
            middle = near.copy()
            middle[:, :3, 3] = 0.5 * (near[:, :3, 3] + far[:, :3, 3])
            touch = (contacts(trees, "a", "b", poses, middle)[:, 0] >= 0)[:, np.newaxis, np.newaxis]
            near, far = np.where(touch, middle, near), np.where(touch, far, middle)
        for pose, apart in zip(poses, far, strict=True):
            here = bodies[0] @ pose[:3, :3].T + pose[:3, 3]
            # Within some 1e-7 m of contact, and on the side of safety.
            assert 0.0 <= gap(here, bodies[1] @ apart[:3, :3].T + apart[:3, 3]) < 1e-6


def test_widened_segments_are_capsules():
    rng = np.random.default_rng(1)
    ends = rng.normal(size=(2, 2, 3)) * 0.2
    trees = hull_trees({"a": [(ends[:1], 0.05)], "b": [(ends[1:], 0.1)]})
    poses, others = placed(rng, 500, 0.2), placed(rng, 500, 0.2)
    segments = [
        np.einsum("nij,ej->nei", p[:, :3, :3], e) + p[:, np.newaxis, :3, 3]
        for p, e in zip((poses, others), ends, strict=True)
    ]
    distance = segment_distance(*segments)
    sure = np.abs(distance - 0.15) > 1e-6
    touch = contacts(trees, "a", "b", poses, others)[:, 0] >= 0
    np.testing.assert_array_equal(touch[sure], distance[sure] < 0.15)


def studded(stems):
    """A body that three slides and three joints move past another: each of capsules, (n, 2, 3) their segments."""
    links = ("a", *(f"link {i}" for i in range(5)), "b")
    moves = [(kind, axis) for kind in ("prismatic", "revolute") for axis in (X, Y, Z)]
    joints = tuple(
        Joint(f"to {links[i + 1]}", kind, links[i], links[i + 1], (0.0, 0.0, 0.0), STRAIGHT, axis, -2.0, 2.0)
        for i, (kind, axis) in enumerate(moves)
    )
    hulls, balls = [], []
    for body, segments in stems.items():
        hulls += [Hull(segment, WIDTH, body) for segment in segments]
        # What is not round lets hulls decide: it lies within a capsule.
        hulls.append(Hull(segments[0, 0] + 0.1 * WIDTH * np.eye(3), 0.0, body))
        balls.append(Capsule((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 2.0, link=body))
    group = tuple(each.name for each in joints)
    return Robot("studded", links, joints, tuple(balls), (("a", "b"),), group, hulls=tuple(hulls))


@pytest.mark.parametrize("counts", [(1, 40), (40, 1), (40, 40)])
def test_of_many_capsules_no_contact_is_left_out(counts):
    """Whichever of two bodies the search divides: their distances are those of segments."""
    rng = np.random.default_rng(7)
    stems = {
        body: rng.normal(size=(count, 1, 3)) * 0.3 + rng.normal(size=(count, 2, 3)) * 0.03
        for body, count in zip("ab", counts, strict=True)
    }
    world = ArmWorld(studded(stems), EMPTY)
    q = rng.normal(size=(400, 6)) * 0.3
    poses = link_poses(world.robot, q)[:, -1]
    moved = np.einsum("nij,sej->nsei", poses[:, :3, :3], stems["b"]) + poses[:, np.newaxis, np.newaxis, :3, 3]
    every = np.broadcast_arrays(stems["a"][:, np.newaxis], moved[:, np.newaxis])
    distance = segment_distance(*(each.reshape(-1, 2, 3) for each in every)).reshape(len(q), -1).min(axis=1)
    sure = np.abs(distance - 2.0 * WIDTH) > 2e-5
    assert 10 < (distance < 2.0 * WIDTH).sum() < 390
    np.testing.assert_array_equal(world.valid(q)[sure], distance[sure] > 2.0 * WIDTH)
    trees = hull_trees({body: [(segments, WIDTH)] for body, segments in stems.items()})
    apart = contacts(trees, "a", "b", np.tile(np.eye(4), (len(q), 1, 1)), poses)[:, 0] < 0
    np.testing.assert_array_equal(apart[sure], distance[sure] > 2.0 * WIDTH)


def test_of_many_hulls_the_tree_finds_those_that_touch():
    rng = np.random.default_rng(2)
    triangles = [rng.normal(size=(100, 3, 3)) * 0.02 + rng.normal(size=(100, 1, 3)) * 0.2 for _ in range(2)]
    trees = hull_trees({name: [(t, 0.01)] for name, t in zip("ab", triangles, strict=True)})
    one_by_one = [hull_trees({"a": [(triangles[0][i : i + 1], 0.01)], "b": [(triangles[1], 0.01)]}) for i in range(100)]
    poses, others = placed(rng, 30, 0.05), placed(rng, 30, 0.5)
    found = contacts(trees, "a", "b", poses, others)
    expected = np.array([contacts(tree, "a", "b", poses, others)[:, 0] >= 0 for tree in one_by_one])
    np.testing.assert_array_equal(found[:, 0] >= 0, expected.any(axis=0))
    assert 0 < expected.any(axis=0).sum() < 30
    for row, (leaf, _) in enumerate(found):
        assert leaf < 0 or expected[leaf, row]


def test_a_rod_in_the_gap_of_a_fork_is_free_and_nowhere_free_where_it_touches(fork_file):
    robot = load_robot(fork_file)
    assert robot.pairs == (("fork", "rod"),)
    world = ArmWorld(robot, EMPTY)
    q = world.space.from_cube(np.random.default_rng(0).random((2000, 2)))
    free, touches = world.valid(q), rod_touches(robot, q)
    assert not (free & touches).any()
    assert (~free & ~touches).mean() < 0.01
    assert 0.1 < free.mean() < 0.9
    assert world.valid(np.zeros((1, 2)))[0], "between the prongs"
    last, first = edge(world, q, 200)
    assert not rod_touches(robot, last).any()
    assert "'fork' touches 'rod'" in world.explain(first[0])


def test_motions_that_are_proved_free_are_free_between_their_states(fork_file):
    world = ArmWorld(load_robot(fork_file), EMPTY)
    rng = np.random.default_rng(3)
    q = world.space.from_cube(rng.random((400, 2)))
    a = q[world.valid(q)][:100]
    b = a + rng.normal(size=a.shape) * 0.3
    proved = world.motion_certified(a, b, 1e-5)
    assert 0.3 < proved.mean() < 1.0
    assert not (proved & ~world.motion_valid(a, b)).any()
    assert not rod_touches(world.robot, states_along(world, a[proved], b[proved], rng)).any()
    a, b = through_contact(world, lambda q: np.where(rod_touches(world.robot, q), -1e-3, 1.0), rng)
    assert len(a) > 100
    for tolerance in (1e-6, 0.01):
        assert not world.motion_certified(a, b, tolerance).any()


@pytest.fixture(scope="module")
def stones(tmp_path_factory):
    """A stone of 60 corners, and another that slides along x and turns about z and y; their corners."""
    folder, rng = tmp_path_factory.mktemp("stones"), np.random.default_rng(6)
    corners = []
    for name in "ab":
        points = rng.normal(size=(60, 3))
        points *= [0.06, 0.2, 0.1] / np.linalg.norm(points, axis=1, keepdims=True)
        trimesh.convex.convex_hull(points.astype(np.float32)).export(folder / f"{name}.stl")
        corners.append(points.astype(np.float32).astype(float))
    wide = "<limit lower='-3' upper='3' velocity='2' effort='1'/>"
    bodies = [f"<collision><geometry><mesh filename='{name}.stl'/></geometry></collision>" for name in "ab"]
    text = urdf(
        link("a", bodies[0]), link("sled", ""), link("table", ""), link("b", bodies[1]),
        joint("slide", "a", "sled", "prismatic", "<limit lower='0' upper='1' velocity='1' effort='1'/>", "0 0.02 0.01",
              "1 0 0"),
        joint("turn", "sled", "table", "revolute", wide, "0 0 0", "0 0 1"),
        joint("tilt", "table", "b", "revolute", wide, "0 0 0", "0 1 0"),
        name="stones",
    )  # fmt: skip
    return load_robot(write(folder, text, "stones.urdf")), corners


def stones_gap(robot, corners, q):
    pose = link_poses(robot, q[np.newaxis])[0, robot.links.index("b")]
    return gap(corners[1] @ pose[:3, :3].T + pose[:3, 3], corners[0])


def at_the_edge(world, count):
    """States that are free, and others that are not, as near to each other as numbers are."""
    a = world.space.from_cube(np.random.default_rng(8).random((count, world.space.dim)))
    b = a.copy()
    a[:, 0], b[:, 0] = 1.0, 0.0
    assert world.valid(a).all()
    assert not world.valid(b).any()
    return edge(world, np.concatenate([a, b]))


def test_stones_are_blocked_where_they_touch_and_hardly_before(stones):
    robot, corners = stones
    assert robot.pairs == (("a", "b"),)
    world = ArmWorld(robot, EMPTY)
    free, _ = at_the_edge(world, 64)
    for q in free:
        apart = stones_gap(robot, corners, q)
        # How far they can be pushed along the line of their middles is more than how far they are apart.
        assert 0.0 < apart < 2e-4


def test_parallel_plates_as_thin_as_paper_pass_each_other(tmp_path):
    plate = "<collision><geometry><box size='0.3 0.2 0.00001'/></geometry></collision>"
    wide = "<limit lower='-1' upper='1' velocity='2' effort='1'/>"
    text = urdf(
        link("a", plate), link("sled", ""), link("b", plate),
        joint("along", "a", "sled", "prismatic", wide, "0.01 0 0", "1 0 0"),
        joint("up", "sled", "b", "prismatic", wide, "0 0 0", "0 0 1"),
        name="plates",
    )  # fmt: skip
    world = ArmWorld(load_robot(write(tmp_path, text, "plates.urdf")), EMPTY)
    q = np.array([[x, z] for x in (-0.25, -0.01, 0.0, 0.15) for z in (-1e-3, -1e-4, -5e-6, 0.0, 5e-6, 1e-4, 1e-3)])
    np.testing.assert_array_equal(world.valid(q), np.abs(q[:, 1]) > 5e-5)
    beside = np.array([[0.35, 0.0], [-0.35, 0.0]])
    assert world.valid(beside).all()


def test_a_verdict_depends_neither_on_the_order_of_states_nor_on_their_neighbours(stones, fork_file):
    rng = np.random.default_rng(9)
    world = ArmWorld(stones[0], EMPTY)
    edge = np.concatenate(at_the_edge(world, 50))
    edge = np.concatenate([edge, edge + rng.normal(size=edge.shape) * 1e-6])
    edge[:, 0] = np.clip(edge[:, 0], 0.0, 1.0)
    other = ArmWorld(load_robot(fork_file), EMPTY)
    for each, q in ((world, edge), (other, other.space.from_cube(rng.random((200, 2))))):
        verdicts = each.valid(q)
        assert 0 < verdicts.sum() < len(q)
        for _ in range(3):
            order = rng.permutation(len(q))
            np.testing.assert_array_equal(each.valid(q[order]), verdicts[order])
        np.testing.assert_array_equal(np.concatenate([each.valid(row[np.newaxis]) for row in q]), verdicts)


def test_a_robot_with_hulls_comes_out_of_the_cache_as_it_was_made(fork_file):
    first, second = load_model(fork_file), load_model(fork_file)
    assert first == second
    assert len(first.robot.hulls) > 2
