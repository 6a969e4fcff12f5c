"""Certificates of the shipped robots, written once, and the same files with something changed."""

import itertools
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np

import evenroad as er
from evenroad.certificates.certify import Sources, certify
from evenroad_verify.certificate import MAGIC
from evenroad_verify.claim import Inputs, read_inputs
from evenroad_verify.command import verify_all
from evenroad_verify.errors import Refused
from tests.robots.oracle import clearance

PLAN = ["plan", "box-reach", "--robot", "ur5", "--start", "home", "--goal", "inside", "--no-picture"]
CONTACT = 2e-6
"""How deep bodies may be in contact for the oracle, which is no more exact along its spheres [m]."""

CHANGES = {
    "grown": ("size: [0.41, 0.01, 0.36], xyz: [0.705, 0.185", "size: [0.41, 0.21, 0.36], xyz: [0.705, 0.185"),
    "moved": ("[0.705, 0, 0.376]", "[0.705, 0, 0.276]"),
    "not allowed": ("  table: [base_link, shoulder_link]", "  table: [base_link]"),
    "limits": ("elbow_joint: [-3.141592653589793, 3.141592653589793]", "elbow_joint: [-3.1, 1.0]"),
}
"""Texts of box-reach that are replaced to make it worse: what was proved in it is no longer so."""


class Written:
    """A plan, its files and its certificate."""

    def __init__(self, robot, scene, start, goal, clearance=0.0):
        self.world = er.ArmWorld(robot, scene, clearance=clearance)
        self.path = er.plan(self.world, start, goal).path
        self.sources = Sources.named(robot, scene)
        self.file = Path(mkdtemp()) / "plan.cert"
        certify(self.world, self.path, self.sources, self.file)
        self.data = self.file.read_bytes()

    @property
    def words(self):
        """What is typed to check it."""
        files = (self.file, self.sources.robot, self.sources.scene, self.sources.srdf)
        return [str(each) for each in files if each is not None]

    def inputs(self, scene=None, robot=None):
        """Return the inputs, perhaps with other files in place of its own."""
        return read_inputs(robot or self.sources.robot, scene or self.sources.scene, self.sources.srdf, {})


@cache
def box_reach():
    return Written("ur5", "box-reach", "home", "inside")


@cache
def shelf():
    goal = er.PoseGoal(er.Pose((0.62, -0.22, 0.25), rpy=(0, 1.5708, 0)), free_axis="z")
    return Written("ur5", "shelf", "home", goal)


def accepts(data, inputs: Inputs):
    """Return whether a certificate is accepted."""
    try:
        verify_all(data, inputs)
    except Refused:
        return False
    return True


def parts_of(data):
    """Return the header's lines, the waypoints, the packed answers and the directions, which may be changed."""
    text, _, body = data[len(MAGIC) :].partition(b"\n\n")
    lines = text.decode().split("\n")
    said = dict(line.split(" ", 1) for line in lines)
    joints = sum(line.startswith("joint ") for line in lines)
    points = 8 * (int(said["motions"]) * int(said["degree"]) + 1) * joints
    packed = (int(said["answers"]) + 2) // 3
    waypoints = np.frombuffer(body[:points], "<f8").reshape(-1, joints).copy()
    end = points + packed + 12 * int(said["directions"])
    directions = np.frombuffer(body[points + packed : end], "<f4").reshape(-1, 3).copy()
    return lines, waypoints, bytearray(body[points : points + packed]), directions


def joined(lines, waypoints, packed, directions):
    """Return the file of such parts."""
    head = MAGIC + "\n".join(lines).encode() + b"\n\n"
    return head + waypoints.astype("<f8").tobytes() + bytes(packed) + directions.astype("<f4").tobytes()


def with_digest(data, inputs: Inputs):
    """Return a certificate as if it was written for these inputs."""
    head, _, rest = data.partition(b"inputs ")
    return head + b"inputs " + inputs.digest.encode() + rest[64:]


def touches(written, waypoints, states=30):
    """Return whether an oracle that shares nothing with the checker sees a contact on a path."""
    share = np.linspace(0.0, 1.0, states)[:, np.newaxis]
    q = np.concatenate([a + share * (b - a) for a, b in itertools.pairwise(waypoints)])
    return clearance(written.world.robot, written.world.scene, q, samples=25).min() < -CONTACT
