"""Cells that are split where a way may lead: what they show closed is closed, by bodies of capsules and true shapes."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from scipy.ndimage import label

from evenroad._native.infeasibility import reached_cells
from evenroad.infeasibility.adaptive_cells import search_cells
from evenroad.infeasibility.prefix_cells import Bodies, piece_of
from evenroad.infeasibility.proof import inner_bodies
from evenroad.robot import ArmWorld, Scene, load_robot
from evenroad.scenes.obstacle import Obstacle
from evenroad.scenes.scene import smaller_scene
from tests.infeasibility.cells_by_scipy import ended as by_scipy
from tests.robots.kernel_arms import random_rotation, random_scene, random_tree, walk
from tests.robots.mesh_arms import write_fork_arm
from tests.robots.post_scenes import at, flat_arm, free_places, posts
from tests.robots.solid_scenes import as_meshes, solids
from tests.robots.urdf_texts import joint, link, urdf, write


def test_what_is_cut_off_a_finer_flood_confirms():
    count, apart, shown = 500, [], []
    middles = -3.0 + 6.0 * (np.arange(count) + 0.5) / count
    grid = np.stack(np.meshgrid(middles, middles, indexing="ij"), axis=-1)
    for seed in range(4):
        rng = np.random.default_rng(seed)
        angles, distances = rng.uniform(-3.0, 3.0, 6), np.append(rng.uniform(0.2, 1.0, 5), 0.3)
        world = ArmWorld(flat_arm(), posts(*map(at, angles, distances), radius=0.03))
        pieces, _ = label(world.valid(grid.reshape(-1, 2)).reshape(count, count), np.ones((3, 3)))
        ends = free_places(world, rng, 8)
        ours = pieces[tuple(np.clip(((ends + 3.0) / 6.0 * count).astype(int), 0, count - 1).T)]
        bodies = Bodies(world.robot, world.with_bodies, world.margin)
        for i, k in combinations(range(len(ends)), 2):
            apart.append(ours[i] != ours[k])
            shown.append(search_cells(bodies, ends[i], ends[k : k + 1], 2, 20_000) == "apart")
    apart, shown = np.array(apart), np.array(shown)
    assert not (shown & ~apart).any()
    # Of those that are apart nearly all are shown to be.
    assert shown.sum() >= 0.8 * apart.sum() > 10


@pytest.mark.parametrize(
    ("kind", "joints", "most"), [("revolute", 2, 9_000), ("continuous", 2, 9_000), ("revolute", 1, 500)]
)
def test_searches_end_as_those_of_scipys_graphs(kind, joints, most):
    """Paths, proofs, and searches that neither ends; goals are one or several, and some are blocked."""
    found = []
    for seed in range(4):
        rng = np.random.default_rng(seed)
        angles, distances = rng.uniform(-3.0, 3.0, 6), np.append(rng.uniform(0.2, 1.0, 5), 0.3)
        world = ArmWorld(flat_arm(kind), posts(*map(at, angles, distances), radius=0.03))
        ends, bodies = free_places(world, rng, 6), Bodies(world.robot, world.with_bodies, world.margin)
        blocked = rng.uniform(-3.0, 3.0, (50, 2))
        for goals in (ends[1:2], ends[2:3], ends[3:], blocked[~world.valid(blocked)][:1]):
            found.append(search_cells(bodies, ends[0], goals, joints, most))
            assert found[-1] == by_scipy(bodies, ends[0], goals, joints, most)
    assert len(set(found)) > 1


def test_first_joints_that_move_no_body_show_nothing():
    """As of a robot whose links have nothing inside."""
    world = ArmWorld(flat_arm(), posts(at(1.0, 0.3)))
    bodies = Bodies(replace(world.robot, capsules=()), world.with_bodies, world.margin)
    assert search_cells(bodies, np.zeros(2), np.ones((1, 2)), 2, 9_000) == "undecided"


@pytest.mark.parametrize("seed", range(8))
def test_cells_that_are_reached_are_a_component_of_scipys(seed):
    """In grids of one to three axes, some of which are circles: those are laid out three times."""
    rng = np.random.default_rng(seed)
    count = rng.integers(2, 9, int(rng.integers(1, 4)))
    wraps = rng.random(len(count)) < 0.5
    free = rng.random(count) < 0.6
    first = tuple(rng.integers(count))
    free[first] = True
    repeats = np.where(wraps, 3, 1)
    pieces = label(np.tile(free, repeats))[0]
    reached = pieces == pieces[tuple(np.array(first) + np.where(wraps, count, 0))]
    while True:
        # What one turn reaches, others do.
        shape = [each for pair in zip(repeats, count, strict=True) for each in pair]
        folded = reached.reshape(shape).any(axis=tuple(range(0, 2 * len(count), 2)))
        wider = np.isin(pieces, np.unique(pieces[np.tile(folded, repeats) & (pieces > 0)]))
        if (wider == reached).all():
            break
        reached = wider
    at_first = int(np.ravel_multi_index(first, tuple(count)))
    ours = reached_cells(free.ravel(), count, wraps, at_first)
    assert (ours.reshape(free.shape) == folded).all()


@pytest.mark.parametrize("seed", range(6))
def test_no_walk_that_is_proved_free_leads_to_what_is_cut_off(seed):
    """Arms with joints that turn, turn on, slide and follow others."""
    rng = np.random.default_rng(seed)
    world = ArmWorld(random_tree(seed), random_scene(seed, count=10, clear=0.4, spread=0.6))
    bodies = Bodies(world.robot, world.with_bodies, world.margin)
    for start in free_places(world, rng, 2):
        place = walk(world, rng, start, 25)[-1:]
        for joints, most in ((1, 300), (2, 3_000), (3, 6_000)):
            if joints <= world.space.dim:
                assert search_cells(bodies, start, place, joints, most) != "apart"


@pytest.mark.parametrize("as_mesh", [False, True])
def test_walks_of_true_shapes_stay_in_the_piece_that_they_start_in(tmp_path, as_mesh):
    """A fork, a cylinder and a box, on joints that turn and slide, among solids that some ways do not pass."""
    robot = replace(load_robot(write_fork_arm(tmp_path)), pairs=())
    assert robot.shapes
    closed = 0
    for seed in range(6):
        rng, scene = np.random.default_rng(seed), solids(seed, count=14)
        world = ArmWorld(robot, as_meshes(scene)[0] if as_mesh else scene)
        bodies, ends = inner_bodies(world), free_places(world, rng, 6)
        for start in ends[:2]:
            places = walk(world, rng, start, 20)
            for joints, most in ((2, 4_000), (3, 20_000)):
                assert search_cells(bodies, start, places[-1:], joints, most) != "apart"
                piece = piece_of(bodies, start, (np.inf,) * joints, most)
                assert piece is None or all(map(piece.holds, places))
                closed += piece is not None and not piece.reached.all()
    assert as_mesh or closed > 0


def test_true_shapes_close_a_way_that_bodies_inside_of_them_leave_open(tmp_path):
    """A plate of 12 mm turns about a pole between two bars: capsules inside of it vanish in all but small cells."""
    limit = "<limit lower='-3' upper='3' velocity='2' effort='1'/>"
    plate = "<collision><origin xyz='0.3 0 0'/><geometry><box size='0.5 0.012 0.3'/></geometry></collision>"
    text = urdf(
        link("base"),
        link("hub"),
        link("plate", plate),
        joint("turn", "base", "hub", inside=limit, axis="0 0 1"),
        joint("tilt", "hub", "plate", inside=limit, axis="1 0 0"),
    )
    robot = load_robot(write(tmp_path, text))
    bars = [Obstacle.of(f"bar{i}", "box", (0.05, 0.05, 0.5), (*at(angle, 0.3), 0.6)) for i, angle in enumerate((1, -2))]
    bodies = inner_bodies(ArmWorld(robot, Scene(tuple(bars), name="bars")))
    start, beyond, beside = np.array([0.0, 0.2]), np.array([[2.0, 0.1]]), np.array([[0.3, -0.4]])
    assert search_cells(bodies, start, beyond, 2, 8_000) == "apart"
    assert search_cells(replace(bodies, shapes=None), start, beyond, 2, 8_000) != "apart"
    assert search_cells(bodies, start, beside, 2, 20_000) != "apart"


def test_a_ball_about_any_place_of_a_smaller_obstacle_lies_in_the_obstacle():
    rng, by = np.random.default_rng(3), 0.02
    kinds = {"box": 3, "sphere": 1, "cylinder": 2, "capsule": 2}
    made = [
        Obstacle.of(f"{kind}{i}", kind, rng.uniform(0.015, 0.2, sizes), rng.uniform(-1, 1, 3), random_rotation(rng))
        for kind, sizes in kinds.items()
        for i in range(6)
    ]
    scene = Scene(tuple(made), name="all")
    small = smaller_scene(scene, by)
    assert 0 < len(small.names) < len(made)
    for name, row in zip(small.names, small.rows, strict=True):
        was = scene.rows[scene.names.index(name)]
        assert (row[4:] == was[4:]).all()
        inside = rng.uniform(-1.0, 1.0, (4_000, 3)) * (0.5 * row[1:4] if row[0] == 0 else row[1:4].max())
        inside = inside[within(row, inside)]
        assert len(inside)
        moved = rng.normal(size=inside.shape)
        moved *= by / np.linalg.norm(moved, axis=1, keepdims=True)
        assert within(was, inside + moved, 1e-12).all()


def within(row, places, slack=0.0):
    """Whether places, (n, 3), in the frame of an obstacle are in it."""
    kind, (x, y, z) = ("box", "sphere", "cylinder", "capsule")[int(row[0])], row[1:4]
    aside, along = np.hypot(places[:, 0], places[:, 1]), np.abs(places[:, 2])
    if kind == "box":
        return (np.abs(places) <= 0.5 * np.array([x, y, z]) + slack).all(axis=1)
    if kind == "sphere":
        return np.linalg.norm(places, axis=1) <= x + slack
    if kind == "cylinder":
        return (aside <= x + slack) & (along <= 0.5 * y + slack)
    return np.hypot(aside, np.maximum(along - 0.5 * y, 0.0)) <= x + slack
