"""An arm follows a handle: also from a stretched posture, and without a swing towards what is out of reach."""

import numpy as np
import pytest

import evenroad as er
from evenroad.robots.kinematics import link_poses
from evenroad.viz.follow import follow

WORLD = er.ArmWorld("ur5")
LINK = WORLD.robot.links[-1]


def tip_of(q):
    return link_poses(WORLD.robot, q[np.newaxis])[0, -1]


def pulled(q, by):
    """Return the configuration that follows a handle which is pulled from the tip, and where the handle is then."""
    there = tip_of(q)
    there[:3, 3] += by
    return follow(WORLD, q, LINK, er.Pose.from_matrix(there)), there


@pytest.mark.parametrize("metres", [0.005, 0.05, 0.1])
def test_a_stretched_arm_bends_when_its_tip_is_pulled_towards_the_base(metres):
    q, there = pulled(WORLD.robot.configuration("home"), (0.0, 0.0, -metres))
    np.testing.assert_allclose(tip_of(q), there, atol=2e-3)


@pytest.mark.parametrize("by", [(0.0, 0.0, 0.5), (2.0, 0.0, 0.0), (0.0, -3.0, 1.0)])
def test_towards_what_is_out_of_reach_no_joint_moves_far_at_a_time(by):
    q = np.array([0.3, -1.2, 0.8, -1.0, 0.2, 0.1])
    for _ in range(20):
        after, _ = pulled(q, by)
        assert np.abs(after - q).max() < 0.3 + 1e-9
        q = after
    low, high, _ = WORLD.bounds
    assert ((low <= q) & (q <= high)).all()
