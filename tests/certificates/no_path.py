"""Flat arms among posts, certificates that there is no path, and the same files with something changed."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import label

import evenroad as er
from evenroad.certificates.no_path import certify_no_path
from evenroad_verify.errors import Refused
from evenroad_verify.no_path import MAGIC, verify_no_path
from tests.certificates.small import inputs_of, sources_in

LINK = """<link name="{}"><collision><origin xyz="0.25 0 0"/><geometry>{}</geometry></collision></link>"""
JOINT = """<joint name="{}" type="{}"><parent link="{}"/><child link="{}"/><origin xyz="{} 0 0"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3"/></joint>"""
BOX, PIPE = '<box size="0.5 0.06 0.06"/>', '<sphere radius="0.05"/>'


def flat_arm(kind="revolute", first=BOX):
    """A bar that turns in the plane, and a ball on a rod at its end that turns, too."""
    parts = [
        '<robot name="flat"><link name="base"/>',
        LINK.format("upper", first),
        LINK.format("fore", PIPE),
        JOINT.format("turn", kind, "base", "upper", 0),
        JOINT.format("bend", "revolute", "upper", "fore", 0.5),
        "</robot>",
    ]
    return "\n".join(parts)


TIP = """<link name="tip"/><joint name="weld" type="fixed"><parent link="fore"/><child link="tip"/>
  <origin xyz="0.4 0 0" rpy="0 0 0.5"/></joint></robot>"""


def posts(*places, radius=0.03):
    """Return a scene of posts, (x, y)."""
    lines = [
        f"  post{i}: {{shape: cylinder, radius: {radius}, length: 0.4, xyz: [{x!r}, {y!r}, 0]}}"
        for i, (x, y) in enumerate(np.array(places, dtype=float).tolist())
    ]
    return "\n".join(["obstacles:", *lines, ""])


def at(angle, distance):
    """Return a place around the foot of the arm."""
    return distance * np.cos(angle), distance * np.sin(angle)


class Place:
    """A robot and a scene in a folder, and which states can be joined, by a flood of fine cells."""

    def __init__(self, folder, scene, urdf=None, count=160, **of_world):
        folder.mkdir(exist_ok=True)
        self.folder, self.scene, self.count = folder, scene, count
        self.sources = sources_in(folder, scene, flat_arm() if urdf is None else urdf)
        read = er.load_scene(self.sources.scene)
        robot = er.robot.in_scene(er.load_robot(self.sources.robot), read)
        self.world = er.ArmWorld(robot, read, **of_world)
        self.inputs = inputs_of(self.sources)
        self._pieces = None

    @property
    def pieces(self):
        """Numbers of the pieces that free cells of both joints form, 0 where nothing is free."""
        if self._pieces is None:
            values = -3.0 + 6.0 * (np.arange(self.count) + 0.5) / self.count
            q = np.stack(np.meshgrid(values, values, indexing="ij"), axis=-1).reshape(-1, 2)
            self._pieces = label(self.world.valid(q).reshape(self.count, self.count), np.ones((3, 3)))[0]
        return self._pieces

    def joined(self, start, goal):
        """Return whether the flood joins two states."""
        cells = ((np.array([start, goal]) + 3.0) / 6.0 * self.count).astype(int)
        first, second = self.pieces[tuple(np.clip(cells, 0, self.count - 1).T)]
        return bool(first == second) and first > 0

    def free(self, rng, count):
        """Return free states."""
        q = rng.uniform(-3.0, 3.0, (40 * count, 2))
        return q[self.world.valid(q)][:count]

    def certificate(self, start, goals, poses=()):
        """Return the bytes of a certificate; NotAvailable where none is found."""
        file, goals = self.folder / "none.cert", np.array(goals, float).reshape(-1, len(start))
        certify_no_path(self.world, np.array(start, float), goals, self.sources, file, poses)
        return file.read_bytes()


@dataclass(frozen=True)
class Parts:
    """A file, taken apart: lines of its header, ends, balls, witnesses, and the answers of each tree."""

    lines: tuple[str, ...]
    ends: np.ndarray
    balls: np.ndarray
    witnesses: np.ndarray
    answers: tuple[np.ndarray, ...]

    @classmethod
    def of(cls, data):
        text, _, body = data[len(MAGIC) :].partition(b"\n\n")
        lines = text.decode().split("\n")
        said = dict(line.split(" ", 1) for line in lines)
        dim = sum(line.startswith("joint ") for line in lines)
        ends = 8 * dim * (1 + int(said["goals"]))
        balls, witnesses = ends + 18 * int(said["balls"]), 4 * int(said["witnesses"])
        table = np.frombuffer(body[ends:balls], [("body", "<u2"), ("ball", "<f4", 4)]).copy()
        answers, rest = [], body[balls + witnesses :]
        for line in lines:
            if line.startswith("cells "):
                count, *columns = map(int, line.split(" ")[1:])
                wide = 1 if 1 + len(columns) + int(said["witnesses"]) <= 256 else 2
                answers.append(np.frombuffer(rest[: wide * count], f"<u{wide}").copy())
                rest = rest[wide * count :]
        pairs = np.frombuffer(body[balls : balls + witnesses], "<u2").reshape(-1, 2).copy()
        return cls(tuple(lines), np.frombuffer(body[:ends]).reshape(-1, dim).copy(), table, pairs, tuple(answers))

    @property
    def data(self):
        """The file."""
        content = self.ends.tobytes() + self.balls.tobytes() + self.witnesses.tobytes()
        return (
            MAGIC
            + "\n".join(self.lines).encode()
            + b"\n\n"
            + content
            + b"".join(each.tobytes() for each in self.answers)
        )

    def saying(self, key, value):
        """Return the parts with another line in the header."""
        return replace(self, lines=tuple(f"{key} {value}" if line.startswith(key) else line for line in self.lines))


def accepts(data, inputs):
    """Return whether a certificate of no path is accepted."""
    try:
        verify_no_path(data, inputs)
    except Refused:
        return False
    return True
