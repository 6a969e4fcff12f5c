"""The strict check of rigid bodies' paths: proofs with no gap, beside an oracle that looks at states close together."""

import math

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.space import SE2, SE3, BoxSpace
from evenroad.world.protocol import ValidatesPaths
from evenroad_studies.worlds.rigid import OrientedBox, SolidWorld
from tests.studies.free_paths import nearest
from tests.studies.worlds.solids_oracle import WORLDS, deepest, gap


def motions(world, count):
    random = np.random.default_rng(7)
    q = world.space.from_cube(random.random((count, world.space.cube_dim)))
    q = q[world.valid(q)]
    return q[:-1], world.space.interpolate(q[:-1], q[1:], random.random(len(q) - 1))


@pytest.mark.parametrize("world", WORLDS, ids=["SE3", "SE2", "3-D", "2-D"])
def test_the_oracle_says_of_poses_what_a_linear_program_says(world):
    q = world.space.from_cube(np.random.default_rng(8).random((20, world.space.cube_dim)))
    np.testing.assert_array_equal(gap(world, q) > 0.0, [deepest(world, row) < -1e-6 for row in q])


@pytest.mark.parametrize("world", WORLDS, ids=["SE3", "SE2", "3-D", "2-D"])
def test_a_proved_motion_is_free_at_a_twentieth_of_the_resolution_and_a_refused_one_touches(world):
    a, b = motions(world, 2_500)
    weak = world.motion_valid(a, b)
    strict = np.array([world.validate(np.stack(ends))[0] for ends in zip(a, b, strict=True)])
    assert not (strict & ~weak).any()
    refused = np.flatnonzero(weak & ~strict)
    assert len(refused), "sampled verdicts have gaps that the proof finds"
    # Half of the distance between two states that are looked at.
    assert all(nearest(world, np.stack([a[i], b[i]])) < 0.0025 for i in refused[:20])
    assert all(nearest(world, np.stack([a[i], b[i]])) > 0.0 for i in np.flatnonzero(strict)[:12])


@pytest.mark.parametrize(
    ("space", "turn"), [(SE2([0, 0], [10, 10]), [0.0]), (SE3([0] * 3, [10] * 3), [1.0, 0.0, 0.0, 0.0])]
)
@pytest.mark.parametrize("beside", [0.0, 0.002])
def test_a_thin_post_between_two_states_is_found_and_one_beside_the_way_is_passed(space, turn, beside):
    dim = len(space.parts[0].low)
    body = OrientedBox([0.0] * dim, [0.1] * dim)
    post = OrientedBox([5.0, 5.1 + 0.001 + beside, 5.0][:dim], [0.001, 0.002, 0.001][:dim])
    world = SolidWorld(space, [body], [post], (3.0, 1.0))
    path = np.array([[*[1.0, 5.0, 5.0][:dim], *turn], [*[9.0, 5.0, 5.0][:dim], *turn]])
    assert world.motion_valid(path[:1], path[1:])[0]
    assert world.validate(path).tolist() == [beside > 0.0]


def test_a_turn_on_the_spot_that_grazes_a_post_is_refused():
    needle = [OrientedBox.spanning((0, -0.01), (2, 0.01))]
    post = OrientedBox([5 + 1.5 * math.cos(0.33), 5 + 1.5 * math.sin(0.33)], [0.02, 0.02])
    world = SolidWorld(SE2([0, 0], [10, 10]), needle, [post], (0.5, 0.5))
    path = np.array([[5.0, 5.0, 0.0], [5.0, 5.0, 1.0], [5.0, 5.0, 2.0]])
    assert world.motion_valid(path[:-1], path[1:]).all()
    assert world.validate(path).tolist() == [False, True]


def test_one_verdict_a_motion_and_none_outside_of_the_space():
    world = SolidWorld(BoxSpace([0, 0], [1, 1]), [OrientedBox([0, 0], [0.1, 0.1])], [], 0.1)
    assert isinstance(world, ValidatesPaths)
    path = np.array([[0.1, 0.1], [0.9, 0.9], [0.9, 0.9], [1.5, 0.9]])
    assert world.validate(path).tolist() == [True, True, False]
    assert world.validate(np.array([[0.1, 0.1]])).shape == (0,)
    with pytest.raises(InvalidValue, match="path must have shape"):
        world.validate([0.1, 0.1])
