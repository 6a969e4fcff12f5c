"""Tips and configurations for their poses: the native kernel against rotations of SciPy and a slow solver."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from evenroad._native.robot import Chain
from evenroad.errors import InvalidValue
from evenroad.geometry.pose import Pose
from evenroad.poses.pose_task import PoseTask

DIM = 5


def random_chain(seed):
    """Joints that turn and slide, two of which follow one coordinate; the last coordinate moves nothing."""
    rng = np.random.default_rng(seed)
    coordinates, slides = np.array([0, 1, 2, 1, 3]), rng.random(5) < 0.25
    rows = np.zeros((6, 14))
    rows[:, :9] = Rotation.random(6, rng=rng).as_matrix().reshape(6, 9)
    rows[:, 9:12] = rng.uniform(-0.4, 0.4, (6, 3))
    rows[:5, 12], rows[:5, 13] = rng.choice([-1.0, 0.5, 1.0], 5), rng.uniform(-1, 1, 5)
    return coordinates, slides, rows


def place(chain, q):
    """Return rotation and origin of the tip, and (z axis, origin) of each joint."""
    coordinates, slides, rows = chain
    rotation, origin, axes = np.eye(3), np.zeros(3), []
    for i, row in enumerate(rows):
        origin, rotation = origin + rotation @ row[9:12], rotation @ row[:9].reshape(3, 3)
        if i < len(coordinates):
            value, z = row[12] * q[coordinates[i]] + row[13], rotation[:, 2]
            if slides[i]:
                origin = origin + value * z
            else:
                rotation = rotation @ Rotation.from_rotvec([0, 0, value]).as_matrix()
            axes.append((z, origin))
    return rotation, origin, axes


def error_of(task, rotation, origin):
    """Return how far the tip is from a task, and how it is to turn, each less a little more than half its tolerance."""
    move = np.array(task.pose.xyz) - origin if task.placed else np.zeros(3)
    turn = np.zeros(3)
    if task.pointing:
        axis, direction = rotation @ task.pointing[0], np.array(task.pointing[1])
        across = np.cross(axis, direction)
        turn = across / np.linalg.norm(across) * np.arctan2(np.linalg.norm(across), axis @ direction)
    elif task.turned:
        turn = Rotation.from_matrix(task.pose.rotation_matrix @ rotation.T).as_rotvec()
    parts = []
    for part, allowed in ((move, task.position_tolerance), (turn, task.angle_tolerance)):
        size = np.linalg.norm(part)
        parts.append(np.zeros(3) if size <= max(allowed, 1e-10) else part * (1.0 - 0.5 * allowed / size))
    return np.concatenate(parts)


def moved_by_a_step(chain, task, q, low, high):
    coordinates, slides, rows = chain
    rotation, origin, axes = place(chain, q)
    error = error_of(task, rotation, origin)
    jacobian = np.zeros((6, DIM))
    for coordinate, slide, row, (z, at) in zip(coordinates, slides, rows, axes, strict=False):
        turn = np.zeros(3) if slide or not task.turned else z
        if task.pointing:
            turn = turn - (turn @ task.pointing[1]) * np.array(task.pointing[1])
        move = (z if slide else np.cross(z, origin - at)) * task.placed
        jacobian[:, coordinate] += row[12] * np.concatenate([move, turn])
    used = np.ones(DIM)
    while True:
        square = jacobian * used @ jacobian.T + (0.03 * error @ error + 1e-16) * np.eye(6)
        step = used * (jacobian.T @ np.linalg.solve(square, error))
        stuck = ((q >= high) & (step > 0)) | ((q <= low) & (step < 0))
        if not stuck.any():
            return np.clip(q + step * 0.8 / max(0.8, np.abs(step).max()), low, high)
        used[stuck] = 0.0


def random_tasks(rng):
    pose, axis, up = Pose(rng.uniform(-0.5, 0.5, 3), Rotation.random(rng=rng).as_matrix()), (0.6, 0.0, 0.8), (0, 0, 1.0)
    return [
        PoseTask(pose),
        PoseTask(pose, turned=False),
        PoseTask(pose, (axis, up)),
        PoseTask(pose, (axis, up), placed=False, angle_tolerance=0.2),
        PoseTask(pose, position_tolerance=0.05, angle_tolerance=0.3),
    ]


@pytest.mark.parametrize("seed", range(8))
def test_steps_are_those_of_damped_least_squares_within_the_limits(seed):
    chain, rng = random_chain(seed), np.random.default_rng(seed)
    native = Chain(*chain, DIM)
    limits = np.array([[-0.6] * DIM, [0.7] * DIM])
    for task in random_tasks(rng):
        q = rng.uniform(*limits)
        for _ in range(4):
            one, missing = native.reach(q[np.newaxis], task.row, limits, 1, 1)
            if (one == q).all():
                break
            q = moved_by_a_step(chain, task, q, *limits)
            np.testing.assert_allclose(one[0], q, atol=1e-8)
            error = error_of(task, *place(chain, q)[:2])
            assert missing[0] == pytest.approx(error @ error, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("seed", range(8))
def test_the_tip_is_where_its_joints_bring_it(seed):
    chain = random_chain(seed)
    q = np.random.default_rng(seed).uniform(-4, 4, (20, DIM))
    for row, pose in zip(q, Chain(*chain, DIM).tip_poses(q), strict=True):
        rotation, origin, _ = place(chain, row)
        np.testing.assert_allclose(pose, [*rotation.ravel(), *origin], atol=1e-13)


def test_what_is_reached_is_reached_and_nothing_goes_on_when_enough_are():
    chain, unlimited = random_chain(1), np.array([[-np.inf] * DIM, [np.inf] * DIM])
    native, rng = Chain(*chain, DIM), np.random.default_rng(1)
    _, origin, _ = place(chain, rng.uniform(-1, 1, DIM))
    task, starts = PoseTask(Pose(origin), turned=False), rng.uniform(-1, 1, (50, DIM))
    q, missing = native.reach(starts, task.row, unlimited, 60, 10)
    assert (missing == 0.0).sum() == 10
    last = int(np.flatnonzero(missing == 0.0)[-1])
    assert np.isinf(missing[last + 1 :]).all()
    assert (q[last + 1 :] == starts[last + 1 :]).all()
    for row in q[missing == 0.0]:
        np.testing.assert_allclose(place(chain, row)[1], origin, atol=1e-9)


def test_a_goal_whose_distance_has_no_square_ends_the_search_at_once():
    chain, unlimited = Chain(*random_chain(1), DIM), np.array([[-np.inf] * DIM, [np.inf] * DIM])
    task = PoseTask().row
    task[9:12] = 1e300
    assert np.isinf(chain.reach(np.zeros((1, DIM)), task, unlimited, 2**31 - 1, 1)[1]).all()


def test_a_line_is_followed_until_a_joint_would_jump():
    chain, unlimited = random_chain(2), np.array([[-np.inf] * DIM, [np.inf] * DIM])
    native, q = Chain(*chain, DIM), np.random.default_rng(2).uniform(-1, 1, DIM)
    rotation, origin, _ = place(chain, q)
    poses = np.tile([*rotation.ravel(), *origin], (9, 1))
    poses[:, 9] += np.linspace(0, 0.02, 9)
    poses[6:, 9:] += 0.2
    task = PoseTask(turned=False).row
    path = native.follow(q, np.empty(0), task, poses, unlimited, 60, 0.2)
    assert path.shape == (6, DIM)
    np.testing.assert_allclose([place(chain, row)[1] for row in path], poses[:6, 9:], atol=1e-9)
    assert len(native.follow(q, np.empty(0), task, poses[5:].copy(), unlimited, 60, 9.0)) == 4
    # With spare joints the last configuration may be chosen.
    towards = native.reach(path[-1:] + 0.1, PoseTask(Pose(poses[5, 9:]), turned=False).row, unlimited, 60, 1)[0][0]
    other = native.follow(q, towards, task, poses[:6].copy(), unlimited, 60, 0.2)
    np.testing.assert_allclose(other[-1], towards, atol=1e-9)
    np.testing.assert_allclose([place(chain, row)[1] for row in other], poses[:6, 9:], atol=1e-9)


def test_chains_and_tasks_that_do_not_fit_are_refused():
    coordinates, slides, rows = random_chain(0)
    with pytest.raises(InvalidValue, match="coordinates must be from 0 to below 3, got 3"):
        Chain(coordinates, slides, rows, 3)
    with pytest.raises(InvalidValue, match=r"rows must have shape \(6, 14\)"):
        Chain(coordinates, slides, rows[:5].copy(), DIM)
    chain, limits, task = Chain(coordinates, slides, rows, DIM), np.zeros((2, DIM)), PoseTask().row
    with pytest.raises(InvalidValue, match=r"q must have shape \(1, 5\), got \(1, 4\)"):
        chain.reach(np.zeros((1, 4)), task, limits, 1, 1)
    with pytest.raises(InvalidValue, match=r"limits must have shape \(2, 5\)"):
        chain.reach(np.zeros((1, DIM)), task, np.zeros((2, 4)), 1, 1)
    with pytest.raises(InvalidValue, match="limits must be lows and highs"):
        chain.reach(np.zeros((1, DIM)), task, np.full((2, DIM), np.nan), 1, 1)
    with pytest.raises(InvalidValue, match=r"task must have shape \(22,\)"):
        chain.follow(np.zeros(DIM), np.zeros(DIM), task[:4].copy(), np.zeros((2, 12)), limits, 1, 0.1)
    with pytest.raises(InvalidValue, match="the turn of a task must be 0, 1 or 2"):
        chain.reach(np.zeros((1, DIM)), np.full(22, 7.0), limits, 1, 1)
