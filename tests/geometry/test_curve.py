"""Curves of poses: through what they are given, on lines and circles, close enough together."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from evenroad.errors import InvalidValue
from evenroad.geometry.curve import SAG, STEP, TURN, circle, polyline, spline
from evenroad.geometry.pose import Pose

CORNER = [Pose((0, 0, 0)), Pose((0.2, 0, 0), rpy=(0, 0, 0.5)), Pose((0.2, 0.3, 0), rpy=(0, 0.3, 0.5))]


def rows(poses):
    return np.array([[*pose.rotation, *pose.xyz] for pose in poses])


def turns(poses):
    rotations = Rotation.from_matrix(poses[:, :9].reshape(-1, 3, 3))
    return (rotations[:-1].inv() * rotations[1:]).magnitude()


@pytest.mark.parametrize(
    "curve", [polyline(CORNER), polyline(CORNER, 0.05), spline(CORNER), circle(*CORNER)],
    ids=["polyline", "blend", "spline", "circle"],
)  # fmt: skip
def test_neighbouring_poses_are_near_each_other_and_the_ends_are_those_given(curve):
    assert np.linalg.norm(np.diff(curve.poses[:, 9:], axis=0), axis=1).max() < 1.5 * STEP
    assert turns(curve.poses).max() < 1.5 * TURN
    np.testing.assert_allclose(curve.poses[[0, -1]], rows(CORNER)[[0, -1]], atol=1e-12)
    assert curve.lengths[-1] == pytest.approx(np.linalg.norm(np.diff(curve.poses[:, 9:], axis=0), axis=1).sum())


@pytest.mark.parametrize("make", [polyline, spline, lambda poses: circle(*poses)])
def test_without_a_blend_the_curve_passes_through_every_pose(make):
    curve = make(CORNER)
    np.testing.assert_allclose(curve.poses[curve.via], rows(CORNER), atol=1e-12)


def test_a_polyline_stops_at_its_corner_and_turns_steadily_along_its_lines():
    curve = polyline(CORNER)
    assert curve.stops.tolist() == [40]
    np.testing.assert_allclose(curve.poses[:41, 10:], 0.0, atol=1e-12)
    assert np.ptp(turns(curve.poses[:41])) < 1e-9
    assert not polyline([Pose((0, 0, 0)), Pose((0.1, 0, 0)), Pose((0.3, 0, 0))]).stops.size


def test_with_a_blend_it_goes_round_the_corner_without_a_stop_no_farther_than_told():
    curve = polyline(CORNER, 0.05)
    assert curve.stops.size == 0
    at = curve.poses[:, 9:]
    off = np.minimum(np.abs(at[:, 1]), np.abs(at[:, 0] - 0.2))
    near = np.linalg.norm(at - [0.2, 0, 0], axis=1)
    assert off[near > 0.05 + 1e-9].max() < 1e-12
    assert 0.0 < near.min() < 0.05
    steps = np.diff(at, axis=0)
    along = steps / np.linalg.norm(steps, axis=1, keepdims=True)
    assert np.linalg.norm(np.diff(along, axis=0), axis=1).max() < 0.2


def test_a_circle_has_its_radius_and_its_chords_are_near_to_it():
    centre, radius = np.array([0.3, 0.1, 0.2]), 0.08
    points = [Pose(centre + radius * np.array([np.cos(a), 0.6 * np.sin(a), 0.8 * np.sin(a)])) for a in (0.3, 2.0, 5.0)]
    curve = circle(*points)
    gaps = np.linalg.norm(curve.poses[:, 9:] - centre, axis=1)
    np.testing.assert_allclose(gaps, radius, atol=1e-12)
    middles = 0.5 * (curve.poses[:-1, 9:] + curve.poses[1:, 9:])
    assert radius - np.linalg.norm(middles - centre, axis=1).min() <= SAG
    assert curve.lengths[-1] == pytest.approx(radius * 4.7, rel=1e-3)


def test_points_on_a_line_make_no_circle():
    with pytest.raises(InvalidValue, match=r"three points that are not on a line, got the start at \(0, 0, 0\)"):
        circle(Pose((0, 0, 0)), Pose((0.1, 0, 0)), Pose((0.2, 0, 0)))


def test_a_curve_of_kilometres_is_refused():
    with pytest.raises(InvalidValue, match="the curve is 1e\\+06 m long"):
        polyline([Pose((0, 0, 0)), Pose((1e6, 0, 0))])
