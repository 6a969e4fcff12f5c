"""Bodies of boxes among boxes: the contract, overlap by linear programs, motions state by state, bad input."""

import math

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.geometry import Pose, rotation_from_quaternion, shapes
from evenroad.space import SE2, SE3, SO3, BoxSpace, Circle, JointSpace, Product
from evenroad.testing import WorldContract
from evenroad.world import FunctionWorld
from evenroad_studies.worlds.rigid import OrientedBox, SolidWorld, shell
from tests.refused import refused
from tests.studies.worlds.solids_oracle import (
    ELL,
    FLAT_ELL,
    IN_SPACE,
    SHIFTED_IN_THE_PLANE,
    WORLDS,
    a_turn,
    deepest,
    penetration,
)


class TestBodyInSpace(WorldContract):
    world = IN_SPACE
    free_between = False


class TestBodyThatDoesNotTurnInThePlane(WorldContract):
    world = SHIFTED_IN_THE_PLANE
    free_between = False


@pytest.mark.parametrize("world", WORLDS, ids=["SE3", "SE2", "3-D", "2-D"])
def test_a_pose_is_free_iff_no_point_is_in_two_boxes(world):
    q = world.space.from_cube(np.random.default_rng(1).random((40, world.space.cube_dim)))
    depth = np.array([deepest(world, row) for row in q])
    # A rectangle cannot shrink: met, it gives zero, up to the tolerance of the solver.
    assert not ((depth > -1e-5) & (depth < -1e-6)).any()
    np.testing.assert_array_equal(world.valid(q), depth < -1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_two_boxes_that_nearly_touch_are_told_apart(seed):
    """Slide a box along a line until the linear program says touching; a little less is free, a little more not."""
    random = np.random.default_rng(seed)
    for _ in range(8):
        half, other_half = random.uniform(0.0, 1.0, 3), random.uniform(0.1, 1.0, 3)
        obstacle = OrientedBox([0, 0, 0], other_half, a_turn(random))
        body, direction = OrientedBox([0, 0, 0], half, a_turn(random)), random.normal(size=3)
        direction /= np.linalg.norm(direction)
        inside, outside = 0.0, 10.0
        for _ in range(45):
            middle = (inside + outside) / 2
            if penetration(middle * direction, body.matrix, half, obstacle) >= 0.0:
                inside = middle
            else:
                outside = middle
        world = SolidWorld(BoxSpace([-20] * 3, [20] * 3), [body], [obstacle], 1.0)
        places = np.array([inside - 1e-5, inside + 1e-5])[:, np.newaxis] * direction
        np.testing.assert_array_equal(world.valid(places), [False, True])


@pytest.mark.parametrize("world", WORLDS, ids=["SE3", "SE2", "3-D", "2-D"])
def test_motions_get_the_verdict_of_their_states_one_by_one(world):
    state_by_state = FunctionWorld(world.space, world.valid, world.resolution)
    q = world.space.from_cube(np.random.default_rng(2).random((800, world.space.cube_dim)))
    a, b = q[:400], q[400:]
    b = world.space.interpolate(a, b, np.random.default_rng(3).random(400))
    verdicts = world.motion_valid(a, b)
    np.testing.assert_array_equal(verdicts, state_by_state.motion_valid(a, b))
    ends_free = world.valid(a) & world.valid(b)
    assert (ends_free & ~verdicts).any()
    assert verdicts.any()


def test_a_wall_without_thickness_stops_a_motion_and_room_inside_a_shell_is_free():
    room = OrientedBox.spanning((2, 2, 2), (8, 8, 8), name="room")
    ball = [OrientedBox([0, 0, 0], [0.5, 0.5, 0.5])]
    space = BoxSpace([0, 0, 0], [10, 10, 10])
    hollow, solid = SolidWorld(space, ball, shell(room), 0.1), SolidWorld(space, ball, [room], 0.1)
    inside, outside = np.array([[5.0, 5, 5]]), np.array([[1.0, 5, 5]])
    assert hollow.valid(inside).all()
    assert not solid.valid(inside).any()
    assert hollow.valid(outside).all()
    assert not hollow.motion_valid(inside, outside).any()
    assert hollow.motion_valid(inside, inside + 1.4).all()


def test_touching_is_meeting():
    cube = OrientedBox.spanning((0, 0, 0), (1, 1, 1))
    world = SolidWorld(BoxSpace([-5] * 3, [5] * 3), [cube], [cube], 0.1)
    assert world.valid([[1.0, 0, 0], [1, 1, 1], [1.0 + 1e-9, 0, 0]]).tolist() == [False, False, True]


def test_a_body_turns_the_short_way_and_through_the_half_turn_like_its_space():
    needle = [OrientedBox.spanning((0, -0.01), (2, 0.01))]
    space = SE2([0, 0], [10, 10])
    post = OrientedBox([5 + 1.5 * math.cos(3.0), 5 + 1.5 * math.sin(3.0)], [0.05, 0.05])
    world = SolidWorld(space, needle, [post], (0.1, 0.01))
    turn = np.array([[5, 5, 2.5], [5, 5, 2.5], [5, 5, 0.0]])
    end = np.array([[5, 5, -2.5], [5, 5, 0.0], [5, 5, -math.pi]])
    assert world.motion_valid(turn, end).tolist() == [False, True, True]
    assert world.motion_valid(end, turn).tolist() == [False, True, True]
    assert world.motion_valid(turn + np.array([0, 0, 2 * math.pi]), end).tolist() == [False, True, True]


def test_a_quaternion_and_its_negative_are_one_pose():
    a = IN_SPACE.space.from_cube(np.random.default_rng(4).random((300, 6)))
    b, flipped = np.roll(a, 1, axis=0), a.copy()
    flipped[:, 3:] *= -1.0
    np.testing.assert_array_equal(IN_SPACE.valid(a), IN_SPACE.valid(flipped))
    np.testing.assert_array_equal(IN_SPACE.motion_valid(a, b), IN_SPACE.motion_valid(flipped, b))


def test_a_pose_out_of_bounds_or_without_a_rotation_is_not_free():
    world = SolidWorld(SE3([0, 0, 0], [1, 1, 1]), ELL, [], (0.1, 0.1))
    q = np.array([[0.5, 0.5, 0.5, 1, 0, 0, 0], [1.5, 0.5, 0.5, 1, 0, 0, 0], [0.5, 0.5, 0.5, 0, 0, 0, 0]])
    assert world.valid(q).tolist() == [True, False, False]
    assert world.motion_valid(q, q[[0, 0, 0]]).tolist() == [True, False, False]


def test_the_explanation_names_the_obstacle():
    world = IN_SPACE
    q = world.space.from_cube(np.random.default_rng(6).random((200, 6)))
    blocked = q[~world.valid(q)][0]
    assert "crate" in world.explain(blocked)
    assert "bounds" in world.explain([-1.0, 0, 0, 1, 0, 0, 0])


def test_boxes_and_parameters_that_make_no_world_are_refused():
    for wrong in ([0.0], [0.0] * 4, [np.nan, 0, 0], "ab"):
        refused(InvalidValue, "centre", OrientedBox, wrong, [1, 1, 1])
    refused(InvalidValue, "half_extents", OrientedBox, [0, 0], [1, -1])
    refused(InvalidValue, "half_extents", OrientedBox, [0, 0], [1, 1, 1])
    refused(InvalidValue, "perpendicular", OrientedBox, [0, 0], [1, 1], [1, 0.1, 0, 1])
    refused(InvalidValue, "reflection", OrientedBox, [0, 0, 0], [1, 1, 1], [1, 0, 0, 0, 1, 0, 0, 0, -1])
    refused(InvalidValue, "low must not exceed high", OrientedBox.spanning, (0, 0), (1, -1))
    refused(InvalidValue, "norm", rotation_from_quaternion, xyzw=[0, 0, 0, 0])
    refused(InvalidValue, "shell", shell, FLAT_ELL[0])
    space = SE3([0, 0, 0], [10, 10, 10])
    refused(InvalidValue, "body must be one box or more", SolidWorld, space, [], [], (0.1, 0.1))
    refused(InvalidValue, "body must be OrientedBox values of 3", SolidWorld, space, FLAT_ELL, [], (0.1, 0.1))
    refused(InvalidValue, "obstacles must be OrientedBox", SolidWorld, space, ELL, ["crate"], (0.1, 0.1))
    for wrong in (0.1, (0.1,), (0.1, 0.0), (0.1, np.inf), (1e-12, 0.1)):
        refused(InvalidValue, "resolution", SolidWorld, space, ELL, [], wrong)
    refused(InvalidValue, "resolution", SolidWorld, BoxSpace([0, 0], [1, 1]), FLAT_ELL, [], (0.1, 0.1))


@pytest.mark.parametrize("space", [
    BoxSpace([0], [1]), JointSpace([0, 0], [1, 1]), Product([Circle(), BoxSpace([0, 0], [1, 1])]), SO3(),
], ids=["1-D", "joints", "heading first", "rotations"])  # fmt: skip
def test_spaces_that_no_body_moves_in_are_refused(space):
    refused(InvalidValue, "space must be", SolidWorld, space, ELL, [], 0.1)


def test_a_box_of_geometry_is_the_same_box_with_its_pose():
    place = Pose.from_rpy((1, 2, 3), (0.3, -0.2, 1.0))
    box = OrientedBox.of(shapes.Box((0.2, 0.4, 0.6), pose=place))
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    np.testing.assert_allclose(box.corners, place.apply(signs * (0.1, 0.2, 0.3)), atol=1e-15)


def test_solid_worlds_are_told_apart_by_all_that_decides_their_verdicts():
    body, far = [OrientedBox((0, 0), (0.1, 0.1))], [OrientedBox((0.8, 0.8), (0.1, 0.1))]
    space = SE2((0, 0), (1, 1))
    worlds = [
        SolidWorld(space, body, far, (0.1, 0.1)),
        SolidWorld(space, body, far, (0.1, 0.2)),
        SolidWorld(space, body, [], (0.1, 0.1)),
        SolidWorld(space, far, body, (0.1, 0.1)),
    ]
    assert len({world.fingerprint() for world in worlds}) == 4
    assert SolidWorld(space, list(body), tuple(far), (0.1, 0.1)).fingerprint() == worlds[0].fingerprint()
