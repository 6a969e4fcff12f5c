"""Paths drawn tight: shorter than shortcuts make them, proved free by double precision, and the same each time."""

import ctypes
import itertools
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from evenroad._native import planning
from evenroad.errors import InvalidValue
from evenroad.planning.arm_trees import checks_of, connect, shorten, smooth
from evenroad.robot import Obstacle, Scene, load_robot
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.certified import CertifiedWorld
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import address
from evenroad.robot.kernel.lane_world import check_addresses
from evenroad.robot.tree_sequences import ball_points, share_pairs, sphere_points
from tests.robot.kernel_arms import box_scene, edge, random_scene, random_tree, ur5
from tests.robot.oracle import clearance, link_poses
from tests.robot.surface_oracle import all_clearance, mesh_clearance
from tests.robot.test_kernel_clouds import cloud_scene
from tests.robot.test_kernel_hulls import EMPTY, fork_file, rod_gap  # noqa: F401
from tests.robot.test_kernel_meshes import ball, box, scene_of
from tests.robot.test_shorten import length, paths, queries  # noqa: F401
from tests.robot.test_trees import GOAL, START, box_world, dense_states

CLEARANCE = planning.CLEARANCES[0]
BATCHES = 400
BAND = 1e-5
"""Nearer to the edge of a verdict than this [m] either one is right."""


def proved(world, path):
    """Whether double precision proves every motion of a path."""
    proofs = CertifiedWorld(replace(world, backend="scalar"), 1e-6)
    return proofs.motion_valid(path[:-1], path[1:]).all()


def searched(world, count, least, **how):
    """Paths of three waypoints or more that trees find, at least so many."""
    limits = {"most_motions": 5_000, "seconds": 30} | how
    found = [connect(world, a, [b], **limits).path for a, b in queries(world, count)]
    found = [path for path in found if len(path) > 2]
    assert len(found) >= least
    return found


def lengths(world, found):
    """How long paths are all together: straight, drawn tight, and as shortcuts leave them."""
    straight = sum(length(world, path[[0, -1]]) for path in found)
    tight = sum(length(world, smooth(world, path, batches=BATCHES)[0]) for path in found)
    return straight, tight, sum(length(world, shorten(world, path)[0]) for path in found)


def test_no_tightened_path_touches_anything(paths):  # noqa: F811
    world, found = paths
    for path in found:
        tight, _ = smooth(world, path, batches=BATCHES)
        assert clearance(world.robot, world.scene, dense_states(world, tight)).min() > 0.0


def test_every_motion_of_a_tightened_path_is_proved(paths):  # noqa: F811
    world, found = paths
    for path in found:
        tight, motions = smooth(world, path, batches=BATCHES)
        assert proved(world, tight)
        assert motions > 0


def test_tightened_paths_keep_their_ends_and_are_never_longer(paths):  # noqa: F811
    world, found = paths
    for path in found:
        for batches in (0, 30, BATCHES):
            tight, _ = smooth(world, path, batches=batches)
            np.testing.assert_array_equal(tight[[0, -1]], path[[0, -1]])
            assert length(world, tight) <= length(world, path) * (1 + 1e-12)
            assert world.space.contains(tight).all()


def test_tightened_paths_are_shorter_than_shortcuts_leave_them(paths):  # noqa: F811
    world, found = paths
    straight, tight, short = lengths(world, found)
    # Among so little that most ways are straight there is hardly anything to gain.
    assert tight <= (0.985 if short > 1.05 * straight else 1.001) * short


def test_few_batches_give_a_free_path_and_more_a_shorter_one(paths):  # noqa: F811
    world, found = paths
    sums = []
    for batches in (0, 100, 4 * BATCHES):
        tight = [smooth(world, path, batches=batches)[0] for path in found]
        sums.append(sum(length(world, path) for path in tight))
        assert all(proved(world, path) for path in tight)
    assert sums[0] > sums[1] > sums[2]


def test_paths_beside_prismatic_joints_slide_within_their_limits():
    robot = random_tree(8)
    sliding = [joint for joint in robot.joints if joint.kind == "prismatic" and joint.name in robot.group]
    assert sliding
    world = ArmWorld(robot, random_scene(108, spread=0.7, clear=0.45))
    columns = [robot.group.index(joint.name) for joint in sliding]
    q = world.space.from_cube(np.random.default_rng(2).random((4000, world.space.dim)))
    # From limit to limit.
    low, high = (np.array(each)[columns] for each in (world.space.low, world.space.high))
    q[0::2, columns], q[1::2, columns] = low, high
    starts, goals = (q[side::2][world.valid(q[side::2])] for side in (0, 1))
    tightened = 0
    for start, goal in zip(starts[:60], goals[:60], strict=True):
        path = connect(world, start, [goal], most_motions=5_000, seconds=30).path
        if len(path) > 2:
            tight, _ = smooth(world, path, batches=BATCHES)
            assert np.all(tight >= np.array(world.space.low))
            assert np.all(tight <= np.array(world.space.high))
            assert proved(world, tight)
            tightened += 1
    assert tightened >= 5


@pytest.fixture(scope="module")
def detour():
    """A way into a box, out and in again."""
    world = box_world()
    path = connect(world, START, [GOAL], seconds=60).path
    return world, np.concatenate([path, path[::-1], path])


def test_the_same_path_is_tightened_to_the_same_bits(paths):  # noqa: F811
    world, found = paths
    fresh = ArmWorld(world.robot, world.scene)
    for path in found[:5]:
        first, motions = smooth(world, path, batches=BATCHES)
        # What other calls leave behind in memory changes nothing.
        smooth(world, found[-1], batches=BATCHES)
        again, motions_again = smooth(fresh, path.copy(), batches=BATCHES)
        np.testing.assert_array_equal(first, again)
        assert motions == motions_again


def test_threads_do_not_disturb_each_others_tightening(detour):
    world, path = detour
    alone, _ = smooth(world, path, batches=BATCHES)
    # Of a world that nobody has asked for larger bodies.
    fresh = box_world()
    with ThreadPoolExecutor(4) as threads:
        for tight in threads.map(lambda _: smooth(fresh, path, batches=BATCHES)[0], range(40)):
            np.testing.assert_array_equal(tight, alone)


def test_another_process_tightens_to_the_same_bits(detour):
    world, path = detour
    tight, motions = smooth(world, path, batches=BATCHES)
    code = (
        "import sys\nimport numpy as np\n"
        "from evenroad.planning.arm_trees import smooth\nfrom tests.robot.test_trees import box_world\n"
        "path = np.frombuffer(bytes.fromhex(sys.stdin.read())).reshape(-1, 5)\n"
        f"tight, motions = smooth(box_world(), path, batches={BATCHES})\nprint(motions, tight.tobytes().hex())"
    )
    answer = subprocess.run(
        [sys.executable, "-c", code], input=path.tobytes().hex(), capture_output=True, text=True, check=True
    )
    assert answer.stdout.split() == [str(motions), tight.tobytes().hex()]


@pytest.mark.parametrize("backend", ["lanes", "scalar"])
def test_a_path_of_two_waypoints_stays_as_it_is(backend):
    world = box_world(backend)
    for path in (np.stack([START, START + 0.1]), np.stack([START, START])):
        np.testing.assert_array_equal(smooth(world, path, batches=BATCHES)[0], path)


def test_without_lanes_paths_are_shortened(detour):
    _, path = detour
    slow = box_world("scalar")
    tight, motions = smooth(slow, path, batches=BATCHES)
    short, expected = shorten(slow, path)
    np.testing.assert_array_equal(tight, short)
    assert motions == expected


def test_a_path_that_cannot_be_proved_is_shortened(detour):
    world, _ = detour
    # Through the wall: no path at all, but what is said of it is told apart from a good one.
    through = np.stack([START, 0.5 * (START + GOAL), GOAL])
    assert not world.motion_certified(through[:-1], through[1:], 1e-6).all()
    tight, _ = smooth(world, through, batches=BATCHES)
    np.testing.assert_array_equal(tight, shorten(world, through, pairs=20, shortcuts=16)[0])


def test_where_a_given_motion_cannot_be_proved_no_other_is_put_in_unproved(detour):
    world, _ = detour
    # To and fro beside the box, then through its wall.
    seen = world.space.from_cube(np.random.default_rng(3).random((200, 5)))
    seen = seen[world.motion_certified(np.broadcast_to(START, seen.shape).copy(), seen, 1e-6)]
    assert len(seen) > 10
    for place in seen[:10]:
        given = np.stack([START, place, 0.95 * START + 0.05 * place, GOAL])
        tight, _ = smooth(world, given, batches=BATCHES)
        np.testing.assert_array_equal(tight[[0, -1]], given[[0, -1]])
        assert length(world, tight) < length(world, given)
        unproved = [motion for motion in pairwise(tight) if not proved(world, np.stack(motion))]
        assert unproved
        for a, b in unproved:
            assert any(on_motion(a, *motion) and on_motion(b, *motion) for motion in pairwise(given))


def test_of_a_path_that_nobody_proved_nothing_is_returned_that_is_not_proved():
    # States so far apart that many a motion is free at them, and cannot be proved.
    world = replace(box_world(), resolution=1.0)
    q = world.space.from_cube(np.random.default_rng(5).random((4000, world.space.dim)))
    q = q[world.valid(q)]
    a, b = q[0::2][: len(q) // 2], q[1::2]
    q = np.stack([a, b], axis=1)[world.motion_valid(a, b)]
    sure = world.motion_certified(q[:, 0], q[:, 1], 1e-6)
    doubtful, certain = q[~sure], q[sure]
    empty = left = 0
    for first, then in zip(doubtful[:60], certain, strict=False):
        for joined in itertools.permutations([*first, then[1]]):
            given = np.stack(joined)
            free = world.motion_valid(given[:-1], given[1:])
            if not free.all() or proved(world, given):
                continue
            tight, motions = smooth(world, given, batches=BATCHES, proved=False)
            assert motions > 0
            if not len(tight):
                assert tight.shape == (0, world.space.dim)
                empty += 1
                continue
            left += 1
            assert proved(world, tight)
            np.testing.assert_array_equal(tight[[0, -1]], given[[0, -1]])
    assert min(empty, left) >= 5


def test_a_proved_path_is_drawn_as_tight_where_nobody_says_that_it_is(paths):  # noqa: F811
    world, found = paths
    for path in found[:8]:
        expected, _ = smooth(world, path, batches=BATCHES)
        np.testing.assert_array_equal(smooth(world, path, batches=BATCHES, proved=False)[0], expected)


def test_work_heeds_the_limit_of_batches():
    world = ArmWorld(ur5(np.pi), random_scene(5))
    found, most = searched(world, 30, 8), {}
    for batches in (0, 100, 2000):
        used = []
        for path in found:
            checks = checks_of(world, planning.CLEARANCES)
            planning.smooth(checks, path, (share_pairs(), sphere_points(world.space.dim)), batches, True)
            used.append(checks.counts[2])
        most[batches] = max(used)
    # Cuts and the proof come on top, and what was begun is ended.
    assert most[0] < most[100] <= 200
    assert most[2000] > 400


def on_motion(q, a, b):
    """Whether a configuration lies on a motion."""
    share = np.clip((q - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
    return np.linalg.norm(a + share * (b - a) - q) < 1e-9


@pytest.mark.parametrize(
    "path",
    [
        np.full((3, 5), np.nan),
        np.stack([START, START + np.inf, START]),
        np.zeros((3, 4)),
        np.zeros((3, 6)),
        np.zeros(5),
        [START],
        [START, START + np.nan],
        [START, GOAL, ["x"] * 5],
    ],
)
def test_what_is_no_path_is_not_tightened_but_refused(path):
    with pytest.raises(InvalidValue):
        smooth(box_world(), path, batches=BATCHES)


def test_a_list_of_waypoints_is_a_path_too(detour):
    world, path = detour
    tight, _ = smooth(world, path.tolist(), batches=BATCHES)
    np.testing.assert_array_equal(tight, smooth(world, path, batches=BATCHES)[0])


def with_ball_beside(world, q, away, place):
    """The world with a ball more, so far from the robot at q [m], beside the tip."""
    robot = world.robot
    capsule = robot.capsules[-1]
    rotation, origin = (each[0] for each in link_poses(robot, q[np.newaxis])[capsule.link])
    tip = origin + rotation @ np.array(capsule.b)
    towards = place / np.linalg.norm(place)
    near, far = 0.0, 0.4
    for _ in range(60):
        middle = 0.5 * (near + far)
        ball = Obstacle.of("ball", "sphere", (0.05,), tuple(tip + towards * middle))
        apart = clearance(robot, Scene((ball,), name="ball"), q[np.newaxis])[0]
        near, far = (middle, far) if apart < away else (near, middle)
    ball = Obstacle.of("ball", "sphere", (0.05,), tuple(tip + towards * far))
    return replace(world, scene=world.scene.with_(ball), robot=robot)


@pytest.mark.parametrize("both", [False, True])
def test_ends_that_nearly_touch_are_kept_and_their_paths_tightened(both):
    free, rng = ArmWorld(ur5(np.pi), random_scene(5)), np.random.default_rng(4)
    tight_length = short_length = 0.0
    touching = 0
    for start, goal in queries(free, 20, seed=1):
        world = with_ball_beside(free, start, 4e-4, rng.normal(size=3))
        ends = np.stack([start, goal])
        if both:
            second = with_ball_beside(free, goal, 4e-4, rng.normal(size=3)).scene.obstacles[-1]
            scene = world.scene.with_(replace(second, name="other ball"))
            world = replace(world, scene=scene)
        apart = clearance(world.robot, world.scene, ends)
        if not np.all((apart > 3e-4) & ((apart < 6e-4) | [False, not both])):
            continue
        path = connect(world, start, [goal], most_motions=5_000, seconds=30).path
        if len(path) < 3:
            continue
        touching += 1
        for way in (path, path[::-1].copy()):
            tight, _ = smooth(world, way, batches=BATCHES)
            np.testing.assert_array_equal(tight[[0, -1]], way[[0, -1]])
            assert proved(world, tight)
            assert clearance(world.robot, world.scene, dense_states(world, tight, 2)).min() > 0.0
            assert length(world, tight) <= length(world, way) * (1 + 1e-12)
            tight_length += length(world, tight)
            short_length += length(world, shorten(world, way)[0])
    assert touching >= 5
    assert tight_length <= 0.99 * short_length


def test_where_all_that_leads_away_from_an_end_nearly_touches_the_path_is_tightened_nearer_to_it():
    free, rng = ArmWorld(ur5(np.pi), random_scene(5)), np.random.default_rng(4)
    tight_length = short_length = 0.0
    touching = 0
    for start, goal in queries(free, 20, seed=1):
        world = with_ball_beside(free, start, 4e-4, rng.normal(size=3))
        path = connect(world, start, [goal], most_motions=5_000, seconds=30).path
        if len(path) < 3:
            continue
        # All of the first motion, a thousandth of what it was, is as near as its end.
        way = np.insert(path, 1, path[0] + 1e-3 * (path[1] - path[0]), axis=0)
        near = clearance(world.robot, world.scene, np.linspace(way[0], way[1], 9))
        if not np.all((near > 2e-4) & (near < CLEARANCE)):
            continue
        touching += 1
        tight, _ = smooth(world, way, batches=BATCHES)
        np.testing.assert_array_equal(tight[[0, -1]], way[[0, -1]])
        assert proved(world, tight)
        assert clearance(world.robot, world.scene, dense_states(world, tight, 2)).min() > 0.0
        tight_length += length(world, tight)
        short_length += length(world, shorten(world, way)[0])
    assert touching >= 5
    assert tight_length <= 0.99 * short_length


def test_robots_with_hulls_are_told_apart_by_them_on_tight_paths(fork_file):  # noqa: F811
    robot = load_robot(fork_file)
    world = ArmWorld(robot, EMPTY)
    found = searched(world, 12, 4)
    for path in found:
        tight, _ = smooth(world, path, batches=BATCHES)
        assert proved(world, tight)
        np.testing.assert_array_equal(tight[[0, -1]], path[[0, -1]])
        assert min(rod_gap(robot, q) for q in dense_states(world, tight, 1)) > 0.0
    straight, tight, short = lengths(world, found)
    # The rods are thin: shortcuts leave hardly anything to gain.
    assert straight < tight < 1.001 * short


SURFACES = {
    "cloud": (cloud_scene(4, 2000, 0.02), all_clearance),
    "meshes": (
        scene_of(ball(0.5, 0.3, 0.3), ball(-0.4, 0.4, 0.5), box((0.3, 0.5, 0.2), 0.3, -0.6, 0.4, 0.7)),
        lambda robot, scene, q: mesh_clearance(robot, scene, q, True),
    ),
}


@pytest.mark.parametrize("kind", SURFACES)
def test_tight_paths_touch_no_cloud_and_no_mesh(kind):
    scene, apart = SURFACES[kind]
    world = ArmWorld(ur5(np.pi), scene)
    assert world.lanes.surfaces is not None
    found = searched(world, 20, 4)
    for path in found:
        tight, _ = smooth(world, path, batches=BATCHES)
        assert proved(world, tight)
        assert apart(world.robot, scene, dense_states(world, tight, 1)).min() > 0.0
    _, tight, short = lengths(world, found)
    assert tight <= 0.99 * short


def lane_verdicts(world, q, table):
    """Which configurations touch nothing, by sixteen lanes that read the lengths at an address."""
    lanes = world.lanes
    check = ctypes.CFUNCTYPE(ctypes.c_int64, *[ctypes.c_int64] * 5)(int(check_addresses(False)[1]))
    _, tables, _, _ = lanes.addresses
    header = lanes.tables[: at.HEADER]
    room = np.zeros(header[at.SCRATCH] + 64, dtype=np.float32)
    states = np.empty(world.space.dim * at.LANES + 8)
    scratch, place = ((address(each) + 63) // 64 * 64 for each in (room, states))
    first = (place - address(states)) // 8
    check(scratch, 0, tables, tables + 8 * int(header[at.INTEGERS]), 0)
    masks = []
    for some in q.reshape(-1, at.LANES, world.space.dim):
        states[first : first + some.size] = some.T.ravel()
        masks.append(check(scratch, place, tables, table, at.LANES))
    return ~(np.array(masks)[:, np.newaxis] >> np.arange(at.LANES) & 1).astype(bool).ravel()


WIDER = {
    "ur5 in a box": (ur5(np.pi), box_scene()),
    "ur5 among everything": (ur5(np.pi), random_scene(5)),
    "tree with a joint that wraps": (random_tree(13), random_scene(113, spread=0.7, clear=0.45)),
}


@pytest.mark.parametrize("kind", WIDER)
@pytest.mark.parametrize("margin", [CLEARANCE, 0.03])
def test_larger_bodies_keep_so_far_from_obstacles_and_as_near_to_each_other(kind, margin):
    robot, scene = WIDER[kind]
    world = ArmWorld(robot, scene)
    q = world.space.from_cube(np.random.default_rng(6).random((6000, world.space.dim)))
    # Most of them near contact, where a margin decides.
    near, others = edge(world, q, 400)
    shift = np.random.default_rng(7).normal(size=near.shape) * margin
    near = np.clip(near + shift, world.space.low, world.space.high)
    some = np.concatenate([near, others, q[:800]])
    some = some[: len(some) // 16 * 16]
    plain = world.lanes.addresses[1] + 8 * int(world.lanes.tables[at.INTEGERS])
    obstacles = clearance(replace(robot, pairs=()), scene, some)
    itself = clearance(robot, Scene(name="nothing"), some)
    for grown, table in ((0.0, plain), (margin, world.lanes.wider(margin))):
        free, apart = lane_verdicts(world, some, table), np.minimum(obstacles - grown, itself)
        sure = np.abs(apart) > BAND
        np.testing.assert_array_equal(free[sure], apart[sure] > 0.0)
        # Nearer than that single precision has to say blocked.
        assert not free[apart < 0.0].any()
    decided = (obstacles > BAND) & (obstacles < margin - BAND) & (itself > BAND)
    assert decided.sum() > 20
    kept = (itself > BAND) & (itself < margin - BAND) & (obstacles > margin + BAND)
    assert kept.sum() > 0 or (kind, margin) != ("ur5 among everything", 0.03)
    # Nothing but a copy was changed.
    assert world.lanes.wider(margin) == table != plain
    assert (lane_verdicts(world, some, plain) == world.valid(some)).all()


def test_directions_have_length_one_and_are_spread_evenly():
    for dim in (1, 2, 6, 14):
        points = sphere_points(dim)
        assert points.shape == ball_points(dim).shape
        np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1.0, rtol=1e-12)
        np.testing.assert_allclose(points.mean(axis=0), 0.0, atol=0.03)
        np.testing.assert_allclose((points**2).mean(axis=0), 1.0 / dim, rtol=0.1)
