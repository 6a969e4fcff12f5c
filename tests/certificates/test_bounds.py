"""No computed gap exceeds the true one: against kinematics that the checker does not share, and more digits."""

import numpy as np
import pytest

import evenroad as er
from evenroad_verify.certificate import Certificate
from evenroad_verify.claim import LEAST, ROUNDING, claim_of, read_inputs
from evenroad_verify.proof import BOXES, CORNERS, Motions
from tests.certificates.small import sources_in
from tests.certificates.tree import POST, URDF
from tests.robots.oracle import link_poses

BALLS = {"a": [(0.1, 0.2, 0)], "b": [(0, 0.1, 0.3)], "c": [(0.2, -0.1, 0.1), (0.3, 0.2, 0)], "d": [(-0.2, 0.3, 0.1)]}
COMMON = {"the obstacles": (), "b": (0,), "c": (0,), "d": (0,)}
"""Second body of a pair -> columns of the joints that move both."""


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    sources = sources_in(tmp_path_factory.mktemp("tree"), POST, URDF)
    rng = np.random.default_rng(0)
    curves = rng.uniform(-0.6, 0.6, (6, 3, 3)) + rng.uniform(-1.5, 1.5, (6, 1, 3))
    certificate = Certificate("", ("A", "B", "C"), curves, np.zeros(0, np.uint8), np.zeros((0, 3)))
    return (
        claim_of(read_inputs(sources.robot, sources.scene, None, {}), certificate),
        certificate,
        er.load_robot(sources.robot),
    )


def true_gap(robot, names, curve, times, frozen, direction):
    """Return the least gap along a direction at some times of a curve, with the joints that move both bodies frozen."""
    t = times[:, np.newaxis]
    q = (1 - t) ** 2 * curve[0] + 2 * t * (1 - t) * curve[1] + t**2 * curve[2]
    q[:, frozen] = q[len(q) // 2, frozen]
    poses = link_poses(robot, q)
    along = []
    for name in names:
        balls = [("base", (0.4, 0.3, 0.2))] if name == "the obstacles" else [(name, each) for each in BALLS[name]]
        along.append([(poses[link][1] + poses[link][0] @ np.array(at)) @ direction for link, at in balls])
    return (np.min(along[1], axis=0) - np.max(along[0], axis=0)).min() - 0.1


def tasks_of(claim, rng, count):
    pair = rng.integers(len(claim.pairs), size=count)
    level = rng.integers(0, 12, size=count)
    nodes = np.array([(claim.pairs[each].first, claim.pairs[each].second) for each in pair])
    return np.stack([rng.integers(6, size=count), rng.integers(0, 2**level), level, *nodes.T, pair], axis=1)


@pytest.mark.parametrize("by", [BOXES, CORNERS])
def test_no_gap_exceeds_the_true_one_at_any_time(tree, by):
    claim, certificate, robot = tree
    curves = certificate.curves
    rng = np.random.default_rng(by)
    tasks, directions = tasks_of(claim, rng, 300), rng.normal(size=(300, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    gaps = Motions(claim, certificate).gaps(tasks, np.full(300, by), directions)
    exact = []
    for task, direction, gap in zip(tasks, directions, gaps, strict=True):
        motion, number, level, _, _, pair = task
        times = (number + np.linspace(0.0, 1.0, 41)) / 2.0**level
        names = claim.pairs[pair].names
        true = true_gap(robot, names, curves[motion], times, list(COMMON[names[1]]), direction)
        assert gap <= true + 1e-12
        # What is lost is of second order in the length of an interval, where boxes lose nothing.
        if by == CORNERS:
            assert gap >= true - 60.0 * 4.0**-level - 1e-12
            exact.append(true - gap < 1e-4)
    assert by == BOXES or np.mean(exact) > 0.2


def test_the_error_of_a_gap_is_far_below_what_it_must_exceed(tree):
    claim, certificate, robot = tree
    curves = certificate.curves
    rng = np.random.default_rng(7)
    tasks, directions = tasks_of(claim, rng, 200), rng.normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    # In so short an interval the gap is that of one state, less than a picometre or two.
    tasks[:, 1], tasks[:, 2] = rng.integers(0, 2**40, size=200), 40
    _, out = claim.frames.far(certificate.curves, certificate.tolerance)
    gaps = Motions(claim, certificate).gaps(tasks, np.full(200, CORNERS), directions)
    errors = []
    for task, direction, gap in zip(tasks, directions, gaps, strict=True):
        time, names = np.array([(task[1] + 0.5) / 2.0**40]), claim.pairs[task[5]].names
        errors.append(gap - true_gap(robot, names, curves[task[0]], time, list(COMMON[names[1]]), direction))
    reach = (np.array(claim.nodes.reach) + out[np.array(claim.nodes.frame)]).max()
    bound = ROUNDING * 3 * reach * (1.0 + np.abs(curves).max() * 1.5)
    assert max(errors) < bound < 0.01 * LEAST
    assert min(errors) > -1e-11
