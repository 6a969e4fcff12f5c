"""Paths drawn tight: shorter than shortcuts make them, proved free by an oracle, and the same each time."""

import itertools
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import evenroad as er
from evenroad._native.planning import CLEARANCES
from evenroad.collision.arm_world import ArmWorld
from evenroad.planning.arm_trees import connect, shorten, smooth, smooth_with_clearance
from evenroad.robot import Obstacle, Scene, load_robot
from tests.refused import refused
from tests.robots.kernel_arms import random_scene, random_tree, ur5
from tests.robots.mesh_arms import rod_touches
from tests.robots.oracle import clearance, link_poses
from tests.robots.paths import GOAL, START, box_world, dense_states, length, proved, queries, searched
from tests.robots.surface_oracle import all_clearance
from tests.robots.surface_scenes import ball, box, cloud_scene, scene_of

BATCHES = 400


def tightened(world, path):
    """A path drawn tight, which keeps what all do, and how long it is that way and shortened."""
    tight, motions = smooth(world, path, batches=BATCHES)
    assert motions > 0
    assert world.validate(tight).all()
    np.testing.assert_array_equal(tight[[0, -1]], path[[0, -1]])
    assert world.space.contains(tight).all()
    assert length(world, tight) <= length(world, path) * (1 + 1e-12)
    return tight, np.array([length(world, tight), length(world, shorten(world, path)[0])])


def test_tightened_paths_are_free_proved_shorter_than_shortcuts_and_keep_their_ends(paths):
    world, found = paths
    straight, lengths, every = 0.0, np.zeros(2), []
    for path in found:
        tight, both = tightened(world, path)
        every.append(tight)
        assert clearance(world.robot, world.scene, dense_states(world, tight, 5)).min() > 0.0
        straight, lengths = straight + length(world, path[[0, -1]]), lengths + both
    assert proved(world, *every)
    # Among so little that most ways are straight there is hardly anything to gain.
    assert lengths[0] <= (0.985 if lengths[1] > 1.05 * straight else 1.001) * lengths[1]


def test_a_plan_is_drawn_tight_unless_quick_shortcuts_or_no_smoothing_are_wanted(paths):
    world, found = paths
    path = max(found, key=len)
    plans = {how: er.plan(world, path[0], path[-1], smooth=how) for how in (True, "quick", False)}
    raw = plans[False].path
    np.testing.assert_array_equal(plans["quick"].path, shorten(world, raw)[0])
    # Joints that wrap are brought into their range and back, which rounds.
    np.testing.assert_allclose(plans[True].path, smooth_with_clearance(world, raw, batches=500)[0], rtol=0, atol=1e-14)
    assert max(plans[True].cost, plans["quick"].cost) < plans[False].cost
    # To keep 5 mm off may cost 2 % of the length.
    assert plans[True].cost < 1.02 * plans["quick"].cost
    assert all(proved(world, each.path) for each in plans.values())
    said = "smooth must be True, False or \"quick\", got 'fast'"
    refused(er.errors.InvalidValue, said, er.plan, world, path[0], path[-1], smooth="fast")


def test_a_plan_keeps_five_millimetres_off_where_that_costs_two_percent_at_most(paths):
    world, found = paths
    kept, lengths = 0, np.zeros(2)
    for path in found:
        plan, _ = smooth_with_clearance(world, path, batches=500)
        tight, _ = smooth(world, path, batches=500)
        assert proved(world, plan)
        np.testing.assert_array_equal(plan[[0, -1]], path[[0, -1]])
        lengths += length(world, plan), length(world, tight)
        if not world.roomier.validate(plan).all():
            continue
        kept += 1
        # Distances from obstacles: the bodies of one robot may come as near to each other as they touch.
        alone = replace(world.robot, pairs=())
        assert clearance(alone, world.scene, dense_states(world, plan, 5)).min() > 0.005
        assert er.ArmWorld(world.robot, world.scene).path_clearance(plan) >= 0.005
    assert kept > 0
    # One path may be longer: it is compared with the path that it leads to, not with the one from the same beginning.
    assert lengths[0] <= 1.02 * lengths[1]


def test_where_the_start_sees_the_goal_a_plan_is_one_motion(paths):
    world, found = paths
    long = [path for path in found if world.validate(path[[0, -1]]).all()]
    for path in long[:5]:
        result = er.plan(world, path[0], path[-1])
        assert len(result.milestone_path) == 2
        assert result.cost <= 1.02 * length(world, path[[0, -1]])
    assert long


def test_who_improves_wants_the_shortest_path(paths):
    world, found = paths
    path = max(found, key=len)
    one_round = er.plan(world, path[0], path[-1], er.RRTConnect(improve=True), limits={"rounds": 1})
    assert one_round.cost <= er.plan(world, path[0], path[-1], smooth=True).cost * (1 + 1e-12)


def test_few_batches_give_a_free_path_and_more_a_shorter_one(paths):
    world, found = paths
    sums = []
    for batches in (0, 100, 4 * BATCHES):
        tight = [smooth(world, path, batches=batches) for path in found]
        sums.append((-sum(length(world, path) for path, _ in tight), sum(motions for _, motions in tight)))
        assert all(world.validate(path).all() for path, _ in tight)
    assert (np.diff(sums, axis=0) > 0).all()


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
    tight = []
    for start, goal in zip(starts[:60], goals[:60], strict=True):
        path = connect(world, start, [goal], most_motions=5_000, seconds=30).path
        if len(path) > 2:
            tight.append(tightened(world, path)[0])
    assert len(tight) >= 5
    assert proved(world, *tight)


@pytest.fixture(scope="module")
def detour():
    """A way into a box, out and in again."""
    world = box_world()
    path = connect(world, START, [GOAL], seconds=60).path
    return world, np.concatenate([path, path[::-1], path])


def test_the_same_path_is_tightened_to_the_same_bits(paths):
    world, found = paths
    fresh = ArmWorld(world.robot, world.scene)
    for path in found[:5]:
        first, motions = smooth(world, path, batches=BATCHES)
        # What other calls leave behind in memory changes nothing, nor does it that nobody says that it is proved.
        smooth(world, found[-1], batches=BATCHES)
        again, motions_again = smooth(fresh, path.tolist(), batches=BATCHES)
        np.testing.assert_array_equal(first, again)
        assert motions == motions_again
        np.testing.assert_array_equal(first, smooth(world, path, batches=BATCHES, proved=False)[0])


def test_another_process_tightens_to_the_same_bits(detour):
    world, path = detour
    tight, motions = smooth(world, path, batches=BATCHES)
    code = (
        "import sys\nimport numpy as np\n"
        "from evenroad.planning.arm_trees import smooth\nfrom tests.robots.paths import box_world\n"
        "path = np.frombuffer(bytes.fromhex(sys.stdin.read())).reshape(-1, 5)\n"
        f"tight, motions = smooth(box_world(), path, batches={BATCHES})\nprint(motions, tight.tobytes().hex())"
    )
    answer = subprocess.run(
        [sys.executable, "-c", code], input=path.tobytes().hex(), capture_output=True, text=True, check=True
    )
    assert answer.stdout.split() == [str(motions), tight.tobytes().hex()]


def test_a_path_that_cannot_be_proved_is_shortened(detour):
    world, _ = detour
    # Through the wall: no path at all, but what is said of it is told apart from a good one.
    through = np.stack([START, 0.5 * (START + GOAL), GOAL])
    assert not world.motion_certified(through[:-1], through[1:], 1e-6).all()
    tight, _ = smooth(world, through, batches=BATCHES)
    np.testing.assert_array_equal(tight, shorten(world, through, pairs=20, shortcuts=16)[0])


def on_motion(q, a, b):
    """Whether a configuration lies on a motion."""
    share = np.clip((q - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
    return np.linalg.norm(a + share * (b - a) - q) < 1e-9


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
        unproved = [motion for motion, free in zip(pairwise(tight), world.validate(tight), strict=True) if not free]
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
            if not free.all() or world.validate(given).all():
                continue
            tight, motions = smooth(world, given, batches=BATCHES, proved=False)
            assert motions > 0
            if not len(tight):
                assert tight.shape == (0, world.space.dim)
                empty += 1
                continue
            left += 1
            assert world.validate(tight).all()
            np.testing.assert_array_equal(tight[[0, -1]], given[[0, -1]])
    assert min(empty, left) >= 5


def ball_beside(robot, q, away, towards, name):
    """A ball so far from the robot at q [m], beside its tip."""
    rotation, origin = (each[0] for each in link_poses(robot, q[np.newaxis])[robot.capsules[-1].link])
    tip = origin + rotation @ np.array(robot.capsules[-1].b)
    alone, near, far = replace(robot, pairs=()), 0.0, 0.4
    for _ in range(16):
        middle = 0.5 * (near + far)
        place = tip + towards / np.linalg.norm(towards) * middle
        found = Obstacle.of(name, "sphere", (0.05,), tuple(place))
        apart = clearance(alone, Scene((found,)), q[np.newaxis])[0]
        near, far = (middle, far) if apart < away else (near, middle)
    return found


@pytest.mark.parametrize("case", ["at the start", "at both ends", "all along the first motion"])
def test_ends_that_nearly_touch_are_kept_and_their_paths_tightened(case):
    free, rng = ArmWorld(ur5(np.pi), random_scene(5)), np.random.default_rng(4)
    lengths, touching, both = np.zeros(2), 0, case == "at both ends"
    for start, goal in queries(free, 20, seed=1):
        balls = [ball_beside(free.robot, start, 4e-4, rng.normal(size=3), "ball")]
        if both:
            balls.append(ball_beside(free.robot, goal, 4e-4, rng.normal(size=3), "other ball"))
        world = replace(free, scene=free.scene.with_(*balls))
        path = connect(world, start, [goal], most_motions=5_000, seconds=30).path
        if len(path) < 3:
            continue
        if case == "all along the first motion":
            # All of it, a thousandth of what it was, is as near as its end.
            path = np.insert(path, 1, path[0] + 1e-3 * (path[1] - path[0]), axis=0)
            near = np.linspace(path[0], path[1], 9)
        else:
            near = path[[0, -1]] if both else path[:1]
        apart = clearance(world.robot, world.scene, near)
        if not np.all((apart > 2e-4) & (apart < CLEARANCES[0])):
            continue
        touching += 1
        for way in (path, path[::-1].copy()):
            tight, of_both = tightened(world, way)
            assert clearance(world.robot, world.scene, dense_states(world, tight, 2)).min() > 0.0
            lengths += of_both
    assert touching >= 5
    assert lengths[0] <= 0.99 * lengths[1]


def test_robots_with_hulls_are_told_apart_by_them_on_tight_paths(fork_file):
    world = ArmWorld(load_robot(fork_file), Scene())
    straight, lengths = 0.0, np.zeros(2)
    for path in searched(world, 12, 4):
        tight, both = tightened(world, path)
        assert not rod_touches(world.robot, dense_states(world, tight, 2)).any()
        straight, lengths = straight + length(world, path[[0, -1]]), lengths + both
    # The rods are thin: shortcuts leave hardly anything to gain.
    assert straight < lengths[0] < 1.001 * lengths[1]


SURFACES = {
    "cloud": cloud_scene(4, 2000, 0.02),
    "meshes": scene_of(ball(0.5, 0.3, 0.3), ball(-0.4, 0.4, 0.5), box((0.3, 0.5, 0.2), 0.3, -0.6, 0.4, 0.7)),
}  # fmt: skip


@pytest.mark.parametrize("kind", SURFACES)
def test_tight_paths_touch_no_cloud_and_no_mesh(kind):
    world, lengths = ArmWorld(ur5(np.pi), SURFACES[kind]), np.zeros(2)
    for path in searched(world, 20, 4):
        tight, both = tightened(world, path)
        assert all_clearance(world.robot, world.scene, dense_states(world, tight, 1)).min() > 0.0
        lengths += both
    assert lengths[0] <= 0.99 * lengths[1]
