"""Proofs enlarge bodies by how fast a motion moves them: a tip that gets ever faster does not pass its post."""

import math

import numpy as np
import pytest

import evenroad as er
from evenroad.geometry.parts import Parts
from evenroad.geometry.shapes import Capsule
from evenroad.robots.joint import Joint, Mimic
from evenroad.robots.robot import Robot

STRAIGHT = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
TINY = 2e-5
"""Radius of the tip and of the post [m]: what one is missed by is seen."""
PLACE = (0.4, 0.0, 0.0)
"""Of the tip on the last link [m]."""


def turned(axis, angle):
    """The rotation about an axis (Rodrigues)."""
    x, y, z = axis
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * across + (1.0 - math.cos(angle)) * across @ across


def with_tip(joints, place, radius, shaped):
    """A chain of joints with a ball at a place on its last link.

    Where it is `shaped` the ball is the true shape of a capsule of a centimetre.
    """
    links, group = ["link 0", *(each.child for each in joints)], [each.name for each in joints if each.mimic is None]
    ball = Capsule(place, place, 0.01 if shaped else radius, link=links[-1])
    shapes = (Parts(np.array([[place]]), links[-1], "sphere", radius=radius),) if shaped else ()
    return Robot("chain", tuple(links), tuple(joints), (ball,), (), tuple(group), shapes=shapes)


def random_chain(rng, kinds, mimic=False, shaped=False):
    """A chain of joints with axes at random and a ball of a fiftieth of a millimetre at its tip."""
    joints = []
    for i, kind in enumerate(kinds):
        axis = rng.normal(size=3)
        follows = Mimic(f"joint {i - 1}", -1.5) if mimic and i == 2 else None
        joints.append(
            Joint(
                f"joint {i}", kind, f"link {i}", f"link {i + 1}", tuple(rng.normal(scale=0.3, size=3)), STRAIGHT,
                tuple(axis / np.linalg.norm(axis)), -6.0, 6.0, mimic=follows,
            )
        )  # fmt: skip
    return with_tip(joints, PLACE, TINY, shaped)


def tip(robot, q):
    """Where the ball is."""
    values, place, rotation = dict(zip(robot.group, q, strict=True)), np.zeros(3), np.eye(3)
    for joint in robot.joints:
        value = values[joint.name] if joint.mimic is None else joint.mimic.multiplier * values[joint.mimic.joint]
        place = place + rotation @ np.array(joint.xyz)
        if joint.kind == "prismatic":
            place = place + rotation @ np.array(joint.axis) * value
        else:
            rotation = rotation @ turned(joint.axis, value)
    return place + rotation @ np.array(robot.capsules[0].a)


R, P = "revolute", "prismatic"


@pytest.mark.parametrize("shaped", [False, True])
@pytest.mark.parametrize(
    ("kinds", "mimic"), [((R, R, R, R), False), ((R, P, R, R), False), ((P, R, P, R), False), ((R, R, R, R), True)]
)
def test_a_post_near_the_end_of_a_motion_is_not_missed(kinds, mimic, shaped):
    """There a stretch moves the tip by more than it does in its middle: without accelerations some would be proved."""
    rng = np.random.default_rng([len(kinds), kinds.count(P), mimic])
    # Shapes decide where stretches move something by little, or by less than the tolerance.
    tolerance = 0.5 if shaped else 1e-6
    posts = 0
    while posts < 100:
        robot = random_chain(rng, kinds, mimic, shaped)
        for _ in range(10):
            a = rng.uniform(-1.5, 1.5, len(robot.group))
            b = a + rng.uniform(-1.5, 1.5, len(a))
            at = tip(robot, b + rng.uniform(0.0001, 0.001) * (a - b))
            # One that is faster at the end, and past the post by more than it is wide.
            last, before = (np.linalg.norm(tip(robot, q) - at) for q in (b, b + 0.1 * (a - b)))
            middle = np.linalg.norm(tip(robot, b + 0.2 * (a - b)) - tip(robot, b + 0.1 * (a - b)))
            if last < 2.5 * TINY or before < 1.05 * middle:
                continue
            world = er.ArmWorld(robot, er.Scene([er.Sphere(TINY, xyz=tuple(at))]), resolution=9.0)
            if not world.valid(b):
                continue
            posts += 1
            assert not world.motion_certified(a[np.newaxis], b[np.newaxis], tolerance)[0]
            half = 0.5 * (a + b)
            assert not world.motion_certified(half[np.newaxis], b[np.newaxis], tolerance)[0]


def ever_faster(kind, turn, shaped):
    """A chain whose tip gets faster by all that its acceleration allows, and a motion that begins where it rests."""
    x, _, z = np.eye(3).tolist()
    if kind == "wheel":
        # A wheel rolls: the point that touches the ground is at rest.
        joints, place, way = ((P, x), (R, z)), (0.0, 1.0, 0.0), (turn, turn)
    else:
        # One slide takes back what another one, which a joint turns away, slides out.
        joints, place, way = ((P, x), (R, z), (P, x)), (0.0, 0.0, 0.0), (-1.0, turn, 1.0)
    chain = [
        Joint(
            f"joint {i}", kind, f"link {i}", f"link {i + 1}", (0.0, 0.0, 0.0), STRAIGHT, tuple(axis), min(end, 0.0),
            max(end, 0.0),
        )
        for i, ((kind, axis), end) in enumerate(zip(joints, way, strict=True))
    ]  # fmt: skip
    return with_tip(chain, place, TINY / 10, shaped), np.array(way)


@pytest.mark.parametrize("shaped", [False, True])
@pytest.mark.parametrize("kind", ["wheel", "slides"])
def test_a_post_near_the_end_of_a_motion_that_gets_faster_throughout_is_not_missed(kind, shaped):
    """With half of the bound of accelerations some would be proved."""
    rng = np.random.default_rng(5)
    for _ in range(100):
        robot, b = ever_faster(kind, rng.uniform(0.5, 1.2), shaped)
        # The way from the post to the end is little, but more than both are wide.
        last = np.linalg.norm(tip(robot, b) - tip(robot, 0.999 * b))
        at = tip(robot, (1.0 - rng.uniform(0.5, 1.0) * 1e-3 * TINY / last) * b)
        world = er.ArmWorld(robot, er.Scene([er.Sphere(TINY / 10, xyz=tuple(at))]), resolution=9.0)
        assert world.valid(b)
        assert not world.motion_certified(np.zeros((1, len(b))), b[np.newaxis], 1e-6)[0]
