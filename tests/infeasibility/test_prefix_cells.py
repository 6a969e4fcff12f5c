"""Proofs by the first joints that there is no path: never where there is one."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import label

from evenroad.geometry.shapes import Capsule
from evenroad.infeasibility.adaptive_cells import search_cells
from evenroad.infeasibility.prefix_cells import BEYOND, SLACK, Bodies, CellTests, first_links, piece_of, thinner
from evenroad.infeasibility.proof import apart, inner_bodies
from evenroad.planning import plan
from evenroad.roadmap import Budget
from evenroad.robot import ArmWorld, Robot, Scene, in_scene, load_robot
from evenroad.robots.joint import Joint, Mimic
from evenroad.scenes.scene import Obstacle
from tests.plan_on import may_connect
from tests.robots.kernel_arms import STRAIGHT, Z, edge, random_scene, random_tree, walk
from tests.robots.post_scenes import at, flat_arm, free_places, posts
from tests.robots.urdf_texts import joint, link, urdf, write


def bodies(world):
    return Bodies(world.robot, world.with_bodies, world.margin)


def is_apart(world, a, b):
    found = apart(world, a, b[np.newaxis])
    return found is not None and found.proved


def test_a_post_beside_the_upper_arm_locks_it():
    world = ArmWorld(flat_arm(), posts(at(1.0, 0.3)))
    a, b = np.array([0.0, 0.5]), np.array([2.0, 0.5])
    assert not may_connect(world, a, b)
    result = plan(world, a, b, limits=Budget(motions=300_000))
    assert result.status == "not_connected"
    assert result.message.startswith("proved: there is no path: joint joint0 alone cannot get there")
    assert "shown for the robot's capsules" in result.message
    assert result.timings["proof"] > 0.0


def test_a_post_that_only_the_forearm_meets_locks_nothing():
    world = ArmWorld(flat_arm(), posts(at(1.0, 0.8)))
    assert may_connect(world, np.array([0.0, 0.5]), np.array([2.0, 0.5]))


def test_a_joint_that_turns_on_goes_round_the_other_way():
    a, b = np.array([0.0, 0.5]), np.array([2.0, 0.5])
    one = ArmWorld(flat_arm("continuous"), posts(at(1.0, 0.3)))
    assert may_connect(one, a, b)
    assert plan(one, a, b).solved
    for turn in np.linspace(-3.0, 3.0, 7):
        # Wherever the range happens to be cut.
        angles = 1.0 + turn, -1.0 + turn
        two = ArmWorld(flat_arm("continuous"), posts(*(at(angle, 0.3) for angle in angles)))
        start, goal = np.array([turn, 0.5]), np.array([2.0 + turn, 0.5])
        assert not may_connect(two, start, goal)
        assert may_connect(two, start, np.array([turn + 0.3, -0.5]))


@pytest.mark.parametrize("seed", range(6))
def test_what_is_proved_a_finer_flood_confirms(seed):
    rng = np.random.default_rng(seed)
    angles, distances = rng.uniform(-3.0, 3.0, 6), np.append(rng.uniform(0.2, 1.0, 5), 0.3)
    world = ArmWorld(flat_arm(), posts(*map(at, angles, distances), radius=0.03))
    count = 500
    middles = -3.0 + 6.0 * (np.arange(count) + 0.5) / count
    grid = np.stack(np.meshgrid(middles, middles, indexing="ij"), axis=-1)
    pieces, _ = label(world.valid(grid.reshape(-1, 2)).reshape(count, count), np.ones((3, 3)))
    ends = free_places(world, rng, 10)
    cells = np.clip(((ends + 3.0) / 6.0 * count).astype(int), 0, count - 1)
    ours = pieces[tuple(cells.T)]
    found = 0
    for i in range(len(ends)):
        for j in range(i):
            if is_apart(world, ends[i], ends[j]):
                assert ours[i] != ours[j]
                found += 1
    assert found > 0


def balls_alone(robot):
    """The robot with a ball for each capsule, of which verdicts are what they are; without contacts of links."""
    balls = tuple(replace(capsule, b=capsule.a, radius=0.06) for capsule in robot.capsules)
    return replace(robot, capsules=balls, pairs=())


@pytest.mark.parametrize("seed", range(12))
def test_a_walk_that_is_proved_free_stays_in_the_piece_that_it_starts_in(seed):
    """Arms with joints that turn, turn on, slide and follow others, among obstacles near enough to lock some."""
    rng = np.random.default_rng(seed)
    robot = random_tree(seed)
    robot = balls_alone(robot) if seed % 3 else robot
    world = ArmWorld(robot, random_scene(seed, count=10, clear=0.4, spread=0.6))
    starts = free_places(world, rng, 2)
    for start in starts:
        places = walk(world, rng, start, 25)
        for joints, most in ((1, 300), (2, 3_000), (3, 6_000)):
            if joints > world.space.dim:
                break
            for reach in (np.inf, 0.5):
                piece = piece_of(bodies(world), start, (reach,) * joints, most)
                if piece is not None:
                    assert all(map(piece.holds, places))


@pytest.mark.parametrize("seed", range(6))
def test_no_cell_is_blocked_that_holds_a_free_place_next_to_contact(seed):
    """Of one ball on an arm that turns or slides, where a millimetre decides."""
    rng = np.random.default_rng(seed)
    kinds = ("revolute", "prismatic", "continuous")[seed % 3]
    ends = {"revolute": (-3.0, 3.0), "prismatic": (-0.5, 0.5), "continuous": (-math.inf, math.inf)}[kinds]
    axis = (1.0, 0.0, 0.0) if kinds == "prismatic" else Z
    joint = Joint("joint", kinds, "base", "arm", (0.0, 0.0, 0.0), STRAIGHT, axis, *ends)
    place = (0.0, 0.3, 0.0) if kinds == "prismatic" else (0.5, 0.0, 0.0)
    length = 0.2 * (seed >= 3)
    ball = Capsule(place, (place[0], place[1] + length, 0.0), 0.08, link="arm")
    robot = Robot("one", ("base", "arm"), (joint,), (ball,), (), ("joint",))
    posts_at = [(rng.uniform(-0.5, 0.5), 0.3) if kinds == "prismatic" else at(rng.uniform(-3, 3), 0.5)]
    world = ArmWorld(robot, posts(*posts_at))
    q = world.space.from_cube(rng.random((4_000, 1)))
    free, _ = edge(world, q, most=4_000, least=30)
    for most in (23, 40, 61, 90, 150):
        for start in free[:: len(free) // 30]:
            piece = piece_of(bodies(world), start, (np.inf,), most)
            # None is said where it is blocked.
            assert piece is not None
            assert piece.holds(start)


@pytest.mark.parametrize("turn", [-3.0, -1.0, 0.0, 2.0])
def test_a_joint_that_turns_on_is_one_piece_all_the_way_round(turn):
    """Blocked is a band of the second joint, by a ring; the first goes round as often as it likes."""
    robot = flat_arm("continuous")
    lift = replace(robot.joints[1], axis=(0.0, 1.0, 0.0), xyz=(0.0, 0.0, 0.0), lower=-1.5, upper=1.5)
    robot = replace(
        robot, joints=(robot.joints[0], lift), capsules=(Capsule((0.0, 0.0, 0.0), (0.5, 0.0, 0.0), 0.05, link="link1"),)
    )
    ring = [Obstacle.of(f"ball{i}", "sphere", (0.06,), (*at(0.2 * i, 0.4), 0.0)) for i in range(32)]
    world = ArmWorld(robot, Scene(tuple(ring), name="ring"))
    up, down = np.array([turn, 0.8]), np.array([turn + 2.0, -0.8])
    assert not may_connect(world, up, down)
    assert may_connect(world, up, np.array([turn + 3.1, 0.7]))
    assert may_connect(world, up, np.array([turn - 3.1, 0.7]))


def test_a_place_at_a_limit_is_in_a_cell_that_is_looked_at():
    """Also where cells are so small that the first lies within what a configuration may be beyond its limit."""
    robot = flat_arm(joints=1, limit=1e-4)
    world = ArmWorld(robot, posts(at(1.0, 0.3)))
    piece = piece_of(bodies(world), np.array([-1e-4]), (np.inf,), 2_000)
    assert piece is not None
    for q in (-1e-4, -1e-4 - 1e-5, 0.0, 1e-4, 1e-4 + 1e-5):
        assert piece.holds(np.array([q]))
    assert first_links(robot, 1).joints[0].upper == 1e-4 + BEYOND


def test_a_scene_that_narrows_a_range_narrows_what_is_proved():
    """The post is where the whole range leads around it the other way, the narrow one does not."""
    robot = flat_arm(limit=6.0)
    a, b = np.array([0.0, 0.5]), np.array([2.0, 0.5])
    around = np.array([2.0 - math.tau, 0.5])
    world = ArmWorld(robot, posts(at(1.0, 0.3)))
    assert may_connect(world, a, around)
    assert not may_connect(world, a, b)
    narrow = Scene(world.scene.obstacles, name="narrow", limits={"joint0": (-2.0, 3.0)})
    world = ArmWorld(in_scene(robot, narrow), narrow)
    assert not may_connect(world, a, b)


def test_links_of_the_first_joints_block_each_other_where_the_pair_is_tested():
    """An upper arm that cannot pass its own base: shown without any obstacle, and soon."""
    robot = flat_arm(limit=6.0)
    base = Capsule((0.3, -0.3, -0.2), (0.3, -0.3, 0.2), 0.05, link="base")
    robot = replace(robot, capsules=(*robot.capsules, base), pairs=(("base", "link0"),))
    world = ArmWorld(robot, Scene(name="empty"))
    a, b = np.array([0.0, 0.5]), np.array([-1.6, 0.5])
    assert apart(world, a, b[np.newaxis], quickly=True).proved
    result = plan(world, a, b)
    assert result.status == "not_connected"
    free = ArmWorld(replace(robot, pairs=()), Scene(name="empty"))
    assert may_connect(free, a, b)


def test_what_a_later_joint_moves_is_gone_with_its_followers():
    robot = flat_arm(joints=3)
    finger = Joint(
        "finger", "revolute", "link0", "claw", (0.5, 0, 0), STRAIGHT, Z, -9.0, 9.0, mimic=Mimic("joint2", 2.0)
    )
    robot = replace(
        robot,
        links=(*robot.links, "claw"),
        joints=(*robot.joints, finger),
        capsules=(*robot.capsules, Capsule((0.0, 0.0, 0.0), (0.2, 0.0, 0.0), 0.03, link="claw")),
    )
    first = first_links(robot, 2)
    assert first.group == ("joint0", "joint1")
    assert [capsule.link for capsule in first.capsules] == ["link0", "link1"]
    # Not so the ones that a joint of the group moves, which stand before.
    assert first_links(robot, 3).capsules == robot.capsules


def test_first_links_keep_what_is_held_and_bodies_thinner_than_a_cell_prove_nothing():
    robot = replace(flat_arm(joints=4), group=("joint1", "joint2", "joint3"), held={"joint0": 0.7})
    assert first_links(robot, 2).held["joint0"] == 0.7
    robot = first_links(flat_arm(), 2)
    assert thinner(robot, np.array([1.0, 1.0]), SLACK).capsules == ()
    world = ArmWorld(flat_arm(), posts(at(1.0, 0.3)))
    assert piece_of(bodies(world), np.array([0.0, 0.5]), (np.inf, np.inf), 4) is None


PLATE = "<collision><origin xyz='0.25 0 0'/><geometry><box size='0.5 0.01 0.02'/></geometry></collision>"


@pytest.fixture(scope="module")
def plate(tmp_path_factory):
    """A thin plate that turns about its end, as the file has it."""
    limit = "<limit lower='-1' upper='1' velocity='1' effort='1'/>"
    text = urdf(link("base", ""), link("plate", PLATE), joint("turn", "base", "plate", inside=limit, axis="0 0 1"))
    return load_robot(write(tmp_path_factory.mktemp("plate"), text.replace("0 0 0.3", "0 0 0")))


def block(*xyz, turn=0.0):
    cosine, sine = math.cos(turn), math.sin(turn)
    rotation = (cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0)
    return Scene((Obstacle.of("block", "box", (0.5, 0.4, 0.4), xyz, rotation),), name="block")


def cell_tests(of):
    return CellTests(of, first_links(of.robot, 1))


def test_no_cell_of_true_shapes_is_blocked_that_a_corner_leaves_at_its_rim(plate):
    """The corner moves by nearly as much as is said of the whole link."""
    half, seen = 0.05, {True: 0, False: 0}
    for deep in np.linspace(0.012, 0.03, 60):
        world = ArmWorld(plate, block(0.7, 0.205 - deep, 0.0))
        blocked = not cell_tests(inner_bodies(world)).unblocked(np.array([half]), np.zeros((1, 1)))[0]
        free = world.valid(np.array([[-half], [0.0]]))
        assert not free[1]
        assert not (blocked and free[0])
        seen[bool(blocked)] += 1
        seen[bool(free[0])] += 1
    assert min(seen.values()) > 10


@pytest.mark.parametrize("share", [0.5, 0.95])
def test_bodies_that_touch_by_less_than_what_is_left_out_block_no_cell(plate, share):
    """Of capsules and of true shapes: what rounding and left out corners may add to bodies shows nothing."""
    still, middle = np.zeros(1), np.zeros((1, 1))

    def corner_in_block(deep):
        # The corner alone, which no capsule inside of the plate comes near to.
        away = (0.25 - deep) / math.sqrt(2.0)
        return ArmWorld(plate, block(0.5 + away, 0.005 + away, 0.0, turn=0.25 * math.pi))

    one = replace(flat_arm(joints=1), capsules=(Capsule((0.3, 0.0, 0.0), (0.3, 0.0, 0.0), 0.04, link="link0"),))
    arm, cornered = ArmWorld(one, posts((0.3, 0.09 - share * 1e-4))), corner_in_block(share * 5e-4)
    for world, of in ((arm, bodies(arm)), (cornered, inner_bodies(cornered))):
        assert not world.valid(middle)[0]
        assert cell_tests(of).unblocked(still, middle)[0]
    # A millimetre shows it.
    arm, cornered = ArmWorld(one, posts((0.3, 0.089))), corner_in_block(1e-3)
    for of in (bodies(arm), inner_bodies(cornered)):
        assert not cell_tests(of).unblocked(still, middle)[0]


def test_a_start_in_a_blocked_cell_or_in_none_shows_nothing():
    """It contradicts the checks, so what they say of other cells is no proof."""
    world = ArmWorld(flat_arm(), posts(at(1.0, 0.3)))
    blocked, free, beyond = np.array([1.0, 0.5]), np.array([0.0, 0.5]), np.array([-3.5, 0.5])
    assert piece_of(bodies(world), free, (np.inf,), 200) is not None
    for start in (blocked, beyond):
        assert piece_of(bodies(world), start, (np.inf,), 200) is None
    behind = np.array([2.0, 0.5])
    assert search_cells(bodies(world), free, behind[np.newaxis], 1, 4_000) == "apart"
    for start, goals in ((blocked, [behind]), (free, [blocked]), (free, [behind, blocked]), (beyond, [behind])):
        assert search_cells(bodies(world), start, np.array(goals), 1, 4_000) != "apart"


def test_where_a_thinner_body_touches_its_cell_is_blocked_throughout():
    """Every capsule of every place of the cell, not its spheres, touches what the thin one touches in the middle."""
    rng = np.random.default_rng(5)
    world = ArmWorld(flat_arm(), posts(at(1.0, 0.3), at(-1.5, 0.7), at(2.2, 0.9)))
    half = np.array([0.01, 0.02])
    thin = replace(world, robot=thinner(world.robot, half, SLACK))
    middles = rng.uniform(-2.9, 2.9, (20_000, 2))
    middles = middles[~thin.valid(middles)]
    assert len(middles) > 500
    corners = middles[:, np.newaxis] + half * rng.uniform(-1.0, 1.0, (16, 2))
    elbow = 0.5 * np.stack([np.cos(corners[..., 0]), np.sin(corners[..., 0])], axis=-1)
    both = corners.sum(axis=-1)
    tip = elbow + 0.5 * np.stack([np.cos(both), np.sin(both)], axis=-1)
    gaps = np.full(corners.shape[:2], np.inf)
    for obstacle in world.scene.obstacles:
        centre = np.array(obstacle.body.pose.xyz[:2])
        for first, last in ((np.zeros(2), elbow), (elbow, tip)):
            along = np.clip(np.sum((centre - first) * (last - first), axis=-1) / 0.25, 0.0, 1.0)
            gap = np.linalg.norm(first + along[..., np.newaxis] * (last - first) - centre, axis=-1)
            gaps = np.minimum(gaps, gap - 0.04 - 0.05)
    assert gaps.max() < 0.0
