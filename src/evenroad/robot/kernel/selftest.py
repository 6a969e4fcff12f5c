"""A self-test of the lanes, once per process, on a small robot with known results."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad._shared import once
from evenroad.errors import NotAvailable, UnknownName
from evenroad.geometry.shapes import Capsule
from evenroad.robot.joint import Joint
from evenroad.robot.kernel.lane_world import LaneWorld
from evenroad.robot.kernel.obstacles import obstacle_rows, tested_contacts
from evenroad.robot.kernel.robot_tables import robot_tables
from evenroad.robot.kernel.scene_tables import ArmTables, arm_tables
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Obstacle, Scene

BACKENDS = ("auto", "lanes", "scalar")

_STRAIGHT = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
_ROTATED = (0.8, -0.6, 0.0, 0.6, 0.8, 0.0, 0.0, 0.0, 1.0)

_FREE = 0b1001101111100001001101101101101111001101001101101011101100110100
"""Bit i: whether configuration i is free, in double precision; a test keeps it so."""


@once
def lanes_failure() -> str | None:
    """Return why the lanes are of no use here; None where they compile and give the verdicts that they should."""
    try:
        from evenroad.robot.kernel.batch import configurations_free

        # No motion is looked at: how fast joints move capsules is not asked.
        world = LaneWorld(small_tables().lanes, small_bounds().ravel(), 1.0)
        free = configurations_free(world, small_batch())
    except Exception as error:
        # Whatever goes wrong in compiling for a machine we have not seen, there is the other way.
        first_line = next(iter(str(error).strip().splitlines()), "")
        return f"{type(error).__name__}: {first_line}"
    return None if np.array_equal(free, expected_results()) else "verdicts of a self-test are wrong"


def expected_results() -> npt.NDArray[np.bool_]:
    """Return which rows of `small_batch` are free."""
    return np.array([_FREE >> i & 1 for i in range(len(small_batch()))], dtype=np.bool_)


def small_batch() -> npt.NDArray[np.float64]:
    """Return 64 configurations of the small robot, none within 0.1 mm of contact."""
    # Fractions of multiples of powers of 1 / 1.2207: spread evenly over the cube.
    shares = np.outer(np.arange(64), [0.8191725, 0.6710436, 0.5497005]) % 1.0
    return _read_only(np.array([-3.0, -2.75, 0.0]) + shares * np.array([6.0, 5.5, 0.3]))


def small_bounds() -> npt.NDArray[np.float64]:
    """Return lows, highs and periods of its joints, (3, 3)."""
    return _read_only(np.array([[-4.0, -2.8, 0.0], [4.0, 2.8, 0.3], [np.inf, np.inf, np.inf]]))


def small_tables() -> ArmTables:
    """Return tables that have a case of everything: joints, shapes of obstacles, a pair of links."""
    chain = (
        Joint("turn", "revolute", "base", "upper", (0.0, 0.0, 0.1), _ROTATED, (0.0, 0.0, 1.0), -4.0, 4.0),
        Joint("bend", "revolute", "upper", "lower", (0.4, 0.0, 0.0), _STRAIGHT, (0.0, 1.0, 0.0), -2.8, 2.8),
        Joint("slide", "prismatic", "lower", "tool", (0.3, 0.0, 0.0), _STRAIGHT, (1.0, 0.0, 0.0), 0.0, 0.3),
    )
    capsules = (
        Capsule((0.0, 0.0, -0.1), (0.0, 0.0, 0.2), 0.1, link="base"),
        Capsule((0.1, 0.0, 0.0), (0.4, 0.0, 0.0), 0.05, link="upper"),
        Capsule((0.0, 0.0, 0.0), (0.3, 0.0, 0.0), 0.04, link="lower"),
        Capsule((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), 0.03, link="tool"),
    )
    pairs = (("base", "lower"), ("base", "tool"), ("upper", "tool"))
    links = ("base", "upper", "lower", "tool")
    robot = Robot("small", links, chain, capsules, pairs, ("turn", "bend", "slide"))
    obstacles = (
        Obstacle.of("table", "box", (3.0, 3.0, 0.1), (0.0, 0.0, -0.4)),
        Obstacle.of("block", "box", (0.2, 0.2, 0.5), (0.5, 0.4, 0.0), _ROTATED),
        Obstacle.of("ball", "sphere", (0.15,), (-0.4, 0.4, 0.1)),
        Obstacle.of("post", "cylinder", (0.08, 0.6), (-0.45, -0.2, 0.1), _ROTATED),
        Obstacle.of("pipe", "capsule", (0.05, 0.4), (0.4, -0.4, 0.2), _STRAIGHT),
    )
    tables, scene = robot_tables(robot), Scene(obstacles, name="small")
    return arm_tables(tables, obstacle_rows(scene), tested_contacts(tables.capsules, links, scene))[0]


def _read_only(array: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return `array` as worlds pass theirs: code is compiled anew for each mix of read-only and other arrays."""
    array.setflags(write=False)
    return array


def chosen_backend(backend: str) -> str:
    """Return which of the two backends `backend` stands for here."""
    if backend not in BACKENDS:
        raise UnknownName.among("backend", backend, BACKENDS)
    if backend == "scalar":
        return "scalar"
    failure = lanes_failure()
    if failure is not None and backend == "lanes":
        raise NotAvailable(f"the lanes do not work on this machine ({failure}); backend='scalar' does")
    return "lanes" if failure is None else "scalar"
