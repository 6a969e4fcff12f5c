"""MuJoCo's models for our planners, and trajectories in its physics."""

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue, UnknownName
from evenroad.testing import WorldContract
from evenroad.trajectory import Limits, make_trajectory

mujoco = pytest.importorskip("mujoco")
from evenroad.adapters.mujoco import MujocoWorld, drive  # noqa: E402

POSTS, ROUND, THICK = np.array([(1.3, 0.0), (-1.2, 1.0), (0.4, -1.3)]), 0.15, 0.06
GEOM = f"<geom type='capsule' fromto='0 0 0 1 0 0' size='{THICK}' NAME/>"
SCENE = f"""<mujoco><option timestep="0.002"/><worldbody>
{"".join(f"<geom name='post{i}' type='sphere' size='{ROUND}' pos='{x} {y} 0'/>" for i, (x, y) in enumerate(POSTS))}
<geom name='floor' type='plane' size='5 5 1' pos='0 0 -3'/>
<body pos='0 0 -3'><freejoint name='cup'/><geom name='cup' type='box' size='.1 .1 .1'/></body>
<body name='upper'><joint name='turn' axis='0 0 1'/>{GEOM.replace("NAME", "name='upper'")}
<body name='fore' pos='1 0 0'><joint name='bend' axis='0 0 1' range='-160 160'/>{GEOM.replace("NAME", "name='fore'")}
</body></body></worldbody></mujoco>"""


SLOW = Limits((1.0, 1.0), (3.0, 3.0))


@pytest.fixture(scope="module")
def model():
    return mujoco.MjModel.from_xml_string(SCENE)


@pytest.fixture
def world(model):
    return MujocoWorld(model, resolution=0.02)


def _clearance(q):
    """Distance of both capsules from the posts, (n,)."""
    least = np.full(len(q), np.inf)
    at = np.zeros((len(q), 2))
    for angle in (q[:, 0], q[:, 0] + q[:, 1]):
        along = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        for post in POSTS:
            share = np.clip(((post - at) * along).sum(axis=1), 0, 1)
            apart = np.linalg.norm(at + share[:, None] * along - post, axis=1) - ROUND - THICK
            least = np.minimum(least, apart)
        at = at + along
    return least


class TestContract(WorldContract):
    world = MujocoWorld(mujoco.MjModel.from_xml_string(SCENE), resolution=0.02)
    free_between = False


def test_a_configuration_is_free_where_no_capsule_meets_a_post(world):
    q = world.space.from_cube(np.random.default_rng(1).random((3000, 2)))
    clear = _clearance(q)
    decided = np.abs(clear) > 1e-4
    np.testing.assert_array_equal(world.valid(q)[decided], clear[decided] > 0)
    touching = q[np.argmin(clear)]
    assert "touches" in world.explain(touching)
    assert "post" in world.explain(touching)


def test_a_plan_is_driven_in_the_physics_and_touches_nothing(world):
    result = er.plan(world, [0.6, 0.2], [-0.5, 0.9])
    assert result.solved
    assert _clearance(np.array(result.path)).min() > 0
    trajectory = make_trajectory(result.path, SLOW, world=world, names=("turn", "bend"))
    driven = drive(world, trajectory)
    assert driven.contacts == ()
    assert driven.largest_error < 0.02
    np.testing.assert_allclose(driven.positions[-1], result.path[-1], atol=5e-3)


def test_a_trajectory_through_a_post_is_seen_to_touch_it(world):
    driven = drive(
        world, make_trajectory([[0.6, 0.0], [-0.6, 0.0]], Limits((1.0, 1.0), (3.0, 3.0)), names=("turn", "bend"))
    )
    assert any("post0" in pair for pair in driven.contacts)


def test_what_no_world_can_be_made_of_is_refused(model):
    with pytest.raises(UnknownName, match="'cup'; known: bend, turn"):
        MujocoWorld(model, joints=["cup"])
    with pytest.raises(InvalidValue, match="qpos"):
        MujocoWorld(model, qpos=[0.0])
    slide = "<mujoco><worldbody><body><joint name='s' type='slide'/><geom size='.1'/></body></worldbody></mujoco>"
    with pytest.raises(InvalidValue, match="slide 's' .* range"):
        MujocoWorld(mujoco.MjModel.from_xml_string(slide))
