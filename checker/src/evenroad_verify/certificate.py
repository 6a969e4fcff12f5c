"""The file: a header of text, waypoints, answers and directions, as docs/certificates.md has it."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from evenroad_verify.errors import BadInput, Floats, demand, number, numbers
from evenroad_verify.shapes import rotation_of

MAGIC = b"evenroad certificate 1\n"
MOST_MOTIONS = 1 << 20
_Read = TypeVar("_Read")
_DIGEST = re.compile("[0-9a-f]{64}")
FARTHEST = 1000.0
"""Largest value of a joint [rad or m]."""


@dataclass(frozen=True)
class Kept:
    """A constraint: a unit vector of a link, or a `part` that is a point, is within an angle or a distance of a box.

    The box is turned by a quaternion.  Of a vector both `low` and `high` are its direction.
    """

    link: str
    is_axis: bool
    within: float
    part: Floats
    xyzw: Floats
    low: Floats
    high: Floats

    @property
    def limit(self) -> float:
        """Largest distance from the box [m]; of the ends of two unit vectors."""
        return 2.0 * float(np.sin(0.5 * min(self.within, np.pi))) if self.is_axis else self.within

    def off(self, at: Floats) -> Floats:
        """Return the distance of places, (n, 3), from the box."""
        seen = at @ rotation_of(self.xyzw)
        return np.asarray(np.linalg.norm(np.maximum(np.maximum(self.low - seen, seen - self.high), 0.0), axis=1))


@dataclass(frozen=True)
class Certificate:
    """What a file claims and its answers.

    `curves`, (motions, 3, joints), are the control points of each motion; `answers` are one number for each task, and
    `directions`, (d, 3), those of the answers that have one.
    """

    inputs: str
    joints: tuple[str, ...]
    curves: Floats
    answers: npt.NDArray[np.uint8]
    directions: Floats
    held: dict[str, float] = field(default_factory=dict)
    clearance: float = 0.0
    padding: dict[str, float] = field(default_factory=dict)
    kept: tuple[Kept, ...] = ()
    """Constraints, axes first."""
    tolerance: float = 0.0
    """How far the joints may be from the curves."""
    limits: tuple[tuple[str, float, float], ...] = ()
    """Joints with the velocity and acceleration that they do not exceed [rad or m, and s]."""
    robot: str | None = None
    """Digest of the file of the robot that it carries, None where it carries none; `scene` alike."""
    scene: str | None = None
    carried: tuple[bytes, ...] = ()
    pairs: tuple[tuple[int, ...], ...] = ()
    """Of a certificate of pairs: the numbers of two bodies, and the columns along which their cells are halved."""

    @property
    def start(self) -> Floats:
        """The first configuration."""
        return np.asarray(self.curves[0, 0])


def read_certificate(data: bytes) -> Certificate:
    """Return the certificate that some bytes are; Refused for any others."""
    return read_file(data, MAGIC, _certificate)


def read_file(data: bytes, magic: bytes, read: Callable[[dict[str, list[str]], memoryview], _Read]) -> _Read:
    """Return what `read` makes of the values of the header's lines, by their keys, and of the bytes that follow."""
    demand(data.startswith(magic), "this is no certificate of version 1")
    end = data.find(b"\n\n", len(magic))
    demand(end > 0, "its header does not end")
    body, said = memoryview(data)[end + 2 :], dict[str, list[str]]()
    try:
        for line in data[len(magic) : end].decode("utf-8").split("\n"):
            key, _, value = line.partition(" ")
            said.setdefault(key, []).append(value)
        return read(said, body)
    except (UnicodeDecodeError, BadInput, ValueError) as error:
        demand(False, f"its header is broken: {error}")
        raise


def _certificate(said: dict[str, list[str]], body: memoryview) -> Certificate:
    once = ("degree", "motions", "answers", "directions")
    head, tolerance = head_of(said, once, ("axis", "point", "limit", "tolerance")), said.get("tolerance", ["0"])
    demand(len(tolerance) == 1, "its header has a line twice")
    head["kept"] = tuple(map(_axis, said.get("axis", ()))) + tuple(map(_point, said.get("point", ())))
    head["tolerance"], head["limits"] = _length(tolerance[0]), tuple(map(_limit, said.get("limit", ())))
    limited = [name for name, *_ in head["limits"]]
    demand(len({*limited} & {*head["joints"]}) == len(limited), "a limit is of no joint of the path, or comes twice")
    dim = len(head["joints"])
    degree, motions, answers, directions = (count_of(said[key][0]) for key in once)
    demand(degree in (1, 2) and 0 < motions < MOST_MOTIONS, "it has no path, or too long a one")
    sizes = [8 * (degree * motions + 1) * dim, (answers + 2) // 3, 12 * directions]
    (path, packed, table), head["carried"] = tables_of(said, body, sizes)
    points = np.frombuffer(path, "<f8").reshape(-1, dim)
    demand(np.isfinite(points).all() and np.abs(points).max() <= FARTHEST, "a waypoint is no number, or too large")
    first, last = points[:-degree:degree], points[degree::degree]
    middle = points[1::2] if degree == 2 else 0.5 * (first + last)
    given = directions_of(table)
    curves = np.stack([first, middle, last], axis=1)
    return Certificate(**head, curves=curves, answers=unpacked(packed, answers), directions=given)


def directions_of(table: memoryview) -> Floats:
    """Return the directions of a table, (d, 3)."""
    given = np.frombuffer(table, "<f4").reshape(-1, 3).astype(float)
    demand(np.isfinite(given).all() and not (np.abs(given) > 2.0).any(), "a direction is no number, or too long")
    return given


def head_of(said: dict[str, list[str]], once: tuple[str, ...], others: tuple[str, ...] = ()) -> dict[str, Any]:
    """Return what every kind of certificate says, beside lines that it must have `once`, and `others`."""
    for key in ("inputs", *once):
        demand(len(said.get(key, ())) == 1, f"its header must have one line {key!r}")
    known = {"inputs", *once, *others, "joint", "held", "clearance", "padding", "robot", "scene"}
    demand(said.keys() <= known, "its header has lines that are not known")
    joints, clearance = said.get("joint", []), said.get("clearance", ["0"])
    robot, scene = (said.get(key, [None]) for key in ("robot", "scene"))
    demand(joints and len(set(joints)) == len(joints), "its header names a joint twice, or none")
    demand(len(clearance) == len(robot) == len(scene) == 1, "its header has a line twice")
    demand(all(each in (None, "-") or _DIGEST.fullmatch(each) for each in (*robot, *scene)), "a digest is none")
    return {
        "inputs": said["inputs"][0],
        "joints": tuple(joints),
        "held": _named(said.get("held", [])),
        "clearance": _length(clearance[0]),
        "padding": {link: _length(value) for link, value in _named(said.get("padding", [])).items()},
        "robot": robot[0],
        "scene": scene[0],
    }


def tables_of(
    said: dict[str, list[str]], body: memoryview, sizes: list[int]
) -> tuple[list[memoryview], tuple[bytes, ...]]:
    """Return the tables of some sizes that follow a header, and the files that it carries."""
    size, carries = sum(sizes), said.keys() & {"robot", "scene"}
    demand(len(body) == size or (carries and len(body) > size), "its length is not what its header says")
    stops = np.cumsum([0, *sizes]).tolist()
    return [body[begin:end] for begin, end in itertools.pairwise(stops)], tuple(_files(body[size:]))


def _files(data: memoryview) -> Iterator[bytes]:
    """Yield the files at the end of a certificate, each after its length in 8 bytes."""
    at = 0
    while at < len(data):
        size = int.from_bytes(data[at : at + 8], "little")
        demand(len(data) >= at + 8 + size, "a file that it carries is cut off")
        yield bytes(data[at + 8 : at + 8 + size])
        at += 8 + size


def count_of(text: str) -> int:
    """Return a count of a header."""
    demand(text.isascii() and text.isdigit() and len(text) < 10, f"not a count: {text[:20]!r}")
    return int(text)


def _length(value: Any) -> float:
    demand(0.0 <= number(value) <= 1.0, f"a clearance must be 0 to 1 m, got {value}")
    return number(value)


def _axis(line: str) -> Kept:
    *words, link = line.split(" ", 7)
    within, *vectors = numbers(words, 7).tolist()
    demand(within >= 0.0, "a constraint is within less than 0")
    direction = _unit(vectors[3:])
    return Kept(link, True, within, _unit(vectors[:3]), np.eye(4)[3], direction, direction)


def _point(line: str) -> Kept:
    *words, link = line.split(" ", 14)
    within, *rest = numbers(words, 14).tolist()
    demand(within >= 0.0, "a constraint is within less than 0")
    point, xyzw, low, high = np.split(np.array(rest), (3, 7, 10))
    demand(np.linalg.norm(xyzw) > 1e-9, "a quaternion is zero")
    return Kept(link, False, within, point, xyzw, low, high)


def _limit(line: str) -> tuple[str, float, float]:
    *words, name = line.split(" ", 2)
    velocity, acceleration = numbers(words, 2).tolist()
    demand(velocity >= 0.0 and acceleration >= 0.0, "a limit is less than 0")
    return name, velocity, acceleration


def _unit(vector: list[float]) -> Floats:
    length = float(np.linalg.norm(vector))
    demand(length > 1e-6, "an axis has no length")
    return np.array(vector) / length


def _named(lines: list[str]) -> dict[str, float]:
    """Return name -> value of lines ``VALUE NAME``."""
    pairs = [line.partition(" ") for line in lines]
    demand(len({name for _, _, name in pairs}) == len(pairs), "its header has a name twice")
    return {name: number(value) for value, _, name in pairs}


def unpacked(data: memoryview, count: int) -> npt.NDArray[np.uint8]:
    """Return `count` answers of 0 to 5, of which a byte holds three."""
    packed = np.frombuffer(data, np.uint8)
    demand(not (packed > 215).any(), "an answer is unknown")
    digits = np.stack([packed % 6, packed // 6 % 6, packed // 36], axis=1).reshape(-1)
    demand(not digits[count:].any(), "there are answers without a task")
    return digits[:count]
