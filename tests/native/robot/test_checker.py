"""The native checks of an arm at their boundary: what is refused, what threads get, what builds agree on.

That verdicts are right is shown in tests/collision, by oracles that know nothing of the kernel.
"""

import threading

import numpy as np
import pytest

from evenroad._native import VARIANT, variants
from evenroad.collision.native_robot import robot_arrays
from evenroad.collision.native_scene import native_scene
from evenroad.collision.prepared_robots import prepared
from evenroad.errors import InvalidValue
from evenroad.robot import ArmWorld, load_robot
from tests.robots.kernel_arms import box_scene, random_scene, random_tree, ur5
from tests.robots.mesh_arms import write_fork_arm

NATIVE = variants.load().robot


@pytest.fixture(scope="module")
def fork_arm(tmp_path_factory):
    """An arm of boxes, a cylinder and a mesh, whose hulls decide where its capsules touch."""
    return load_robot(write_fork_arm(tmp_path_factory.mktemp("fork")))


def arrays_of(robot):
    """The arrays that a native robot is made of, to be changed at will."""
    made = prepared(robot)
    given = robot_arrays(robot, made.tables, made.bounds)
    return {part: {name: array.copy() for name, array in arrays.items()} for part, arrays in given.items()}


@pytest.mark.parametrize(
    ("part", "name", "place", "value", "words"),
    [
        ("frames", "parent", 0, 1, "frames.parent must be below 1"),
        ("frames", "parent", 2, -1, "frames.parent"),
        ("frames", "coordinate", 0, 3, "frames.coordinate must be below 3"),
        ("bodies", "frame", 1, 99, "bodies.frame"),
        ("bodies", "hulls", 1, 10_000, "bodies.hulls"),
        ("capsules", "body", 0, 1, "capsules.body must rise"),
        ("capsules", "body", -1, 99, "capsules.body must name bodies"),
        ("capsules", "first_sample", 1, 0, "capsules.first_sample must rise"),
        ("capsules", "first_sample", -1, 10_000, "within capsules.samples"),
        ("pairs", "bodies", (0, 1), 77, "pairs.bodies"),
        ("pairs", "by_hulls", 0, 500, "pairs.by_hulls"),
        ("hulls", "first_part", 1, 0, "hulls.first_part must rise"),
        ("hulls", "first_part", -1, 10_000, "hulls.first_part must rise"),
        ("hulls", "first_point", -1, 10_000, "parts.first_point must rise, within parts.points"),
        ("shapes", "around_first", 1, 10_000, "shapes.around_first must rise"),
        ("shapes", "inside_first", 0, -1, "shapes.inside_first must rise"),
    ],
)
def test_indices_that_point_nowhere_are_refused(fork_arm, part, name, place, value, words):
    given = arrays_of(fork_arm)
    given[part][name][place] = value
    with pytest.raises(InvalidValue, match=words):
        NATIVE.Robot(**given)


def test_arrays_that_are_missing_too_short_or_of_another_kind_are_refused(fork_arm):
    for change, words in (
        (lambda given: given["capsules"].pop("half"), "capsules must have half"),
        (lambda given: given["frames"].update(offset=np.zeros(1)), "frames must be equally long"),
        (
            lambda given: given["capsules"].update(radius=given["capsules"]["radius"].astype(np.float32)),
            "float64",
        ),
        (lambda given: given["pairs"].update(speeds=np.zeros((3, 1))), "arms.pairs must be"),
    ):
        given = arrays_of(fork_arm)
        change(given)
        with pytest.raises(InvalidValue, match=words):
            NATIVE.Robot(**given)


def test_what_is_no_array_of_finite_floats_is_left_to_python():
    world = ArmWorld(ur5(), box_scene())
    checker = world.checker
    rows = np.zeros((4, 6))
    for given in (
        [0.0] * 6,
        rows.astype(np.float32),
        rows[:, ::2],
        rows.T,
        rows[:, :5],
        np.full((1, 6), np.nan),
        None,
    ):
        assert checker.valid(given) is None
        assert checker.motion_valid(given, rows) is None
    assert checker.motion_valid(rows, rows[:3]) is None
    with pytest.raises(InvalidValue, match=r"must have shape \(n, 6\), got \(4, 5\)"):
        world.valid(rows[:, :5])
    assert world.valid(rows.tolist()).shape == (4,)
    assert type(world.valid(rows[0])) is bool
    assert world.valid(rows[:0]).shape == (0,)


def test_eight_threads_get_what_one_gets():
    world = ArmWorld(ur5(), random_scene(5))
    rng = np.random.default_rng(2)
    batches = [world.space.from_cube(rng.random((300, 6))) for _ in range(8)]
    expected = [(world.valid(q), world.motion_valid(q[:-1], q[1:])) for q in batches]
    found = [[] for _ in batches]

    def work(i):
        for _ in range(20):
            found[i].append((world.valid(batches[i]), world.motion_valid(batches[i][:-1], batches[i][1:])))

    threads = [threading.Thread(target=work, args=(i,)) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for one, several in zip(expected, found, strict=True):
        assert len(several) == 20
        for each in several:
            np.testing.assert_array_equal(each[0], one[0])
            np.testing.assert_array_equal(each[1], one[1])


@pytest.mark.parametrize("variant", [each for each in variants.usable() if each not in (variants.SANITIZED, VARIANT)])
@pytest.mark.parametrize("arm", ["ur5", "tree", "fork"])
def test_every_build_gives_the_same_verdicts(variant, arm, fork_arm, monkeypatch):
    """Of random states; within micrometres of contact builds without fused sums may differ, never to the free side."""
    monkeypatch.setenv(variants.ENVIRONMENT, variant)
    other = variants.load().robot
    robot = {"ur5": ur5(), "tree": random_tree(8), "fork": fork_arm}[arm]
    world = ArmWorld(robot, random_scene(103, spread=0.7, clear=0.45))
    q = world.space.from_cube(np.random.default_rng(7).random((4_000, world.space.dim)))
    free = world.valid(q)
    assert 0.02 < free.mean() < 0.98
    made = prepared(world.robot)
    theirs = other.Robot(**robot_arrays(world.robot, made.tables, made.bounds))
    monkeypatch.setattr("evenroad.collision.native_scene.native", other)
    scene = native_scene(theirs, made.tables, world.robot.links, world.scene, 0.0)
    checker = other.Checker(theirs, scene, world.resolution, 0.0, False)
    np.testing.assert_array_equal(checker.valid(q), free)
    np.testing.assert_array_equal(checker.motion_valid(q[:400], q[400:800]), world.motion_valid(q[:400], q[400:800]))


def test_a_contact_is_found_where_a_state_is_blocked():
    world = ArmWorld(ur5(), random_scene(5))
    q = world.space.from_cube(np.random.default_rng(1).random((500, 6)))
    for row, free in zip(q, world.valid(q), strict=True):
        contact = world.checker.find_contact(row)
        assert (contact.kind == "nothing") == free
        assert (contact.kind == "obstacle") == (contact.capsule >= 0)
        assert (contact.other >= 0) == (not free)
