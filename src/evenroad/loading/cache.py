"""A cache of robots between runs: fitting capsules to meshes and sampling contacts takes seconds.

A digest seals each file, as a flipped bit is as likely in a radius as in a bracket.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from copy import deepcopy
from dataclasses import asdict, is_dataclass, replace
from functools import lru_cache
from pathlib import Path
from types import UnionType
from typing import Generic, TypeVar, get_args, get_origin, get_type_hints

import numpy as np

from evenroad import __version__
from evenroad._arrays import Floats
from evenroad._files import atomic_write, cache_folder, read_known
from evenroad._fingerprint import fingerprint_of
from evenroad._seal import read_sealed, sealed
from evenroad.geometry.mesh import TriangleMesh
from evenroad.geometry.shapes import Mesh, Shape
from evenroad.loading.description import RobotDescription
from evenroad.loading.model import RobotModel
from evenroad.loading.robot_file import RobotFile
from evenroad.robots.robot import Robot

Value = TypeVar("Value")
_FORMAT = 28
"""Version of the cache: it counts up when the same files give another robot, or the format changes."""


def key_of(
    description: RobotDescription, others: Iterable[tuple[str, Path | None]], group: str | Sequence[str] | None
) -> str:
    """Return the hash of a robot's description, the content of its meshes and of other files, and the group.

    Other files have a name for errors.  BrokenFile if one is missing: a cached robot is never returned for files that
    are gone.
    """
    unchecked = [
        (joint.acceleration, joint.deceleration, joint.jerk, joint.hard, joint.of) for joint in description.joints
    ]
    said = fingerprint_of(
        replace(description, shapes=()), unchecked, [_said(shape) for shape in description.shapes], group
    )
    digest = hashlib.sha256(f"{_FORMAT}|{__version__}|{said}".encode())
    sources = [shape.source for shape in description.shapes if isinstance(shape, Mesh)]
    meshes = [("mesh", source) for source in sources if isinstance(source, Path)]
    for what, path in (*meshes, *others):
        # An empty file is refused where none at all is fine.
        content = b"absent" if path is None else b"present" + read_known(path, what)
        digest.update(hashlib.sha256(content).digest())
    return digest.hexdigest()


def _said(shape: Shape) -> object:
    """Return all values of a shape in full; its repr is rounded."""
    if not isinstance(shape, Mesh) or isinstance(shape.source, TriangleMesh):
        return shape
    return shape.kind, str(shape.source), shape.scale, shape.pose, shape.link


def cached(key: str) -> RobotModel | None:
    """Return the cached robot of this key; None when there is none, or its file is damaged.

    A damaged file is logged in one line.
    """
    content = read_sealed(_file(key), key, "the robot")
    model = None if content is None else _restored(RobotModel, json.loads(content))
    assert model is None or isinstance(model, RobotModel), "what is sealed was written by this version"
    return model


def keep(key: str, model: RobotModel) -> None:
    """Write a robot into the cache; where that fails, the next run takes longer."""
    file = _file(key)
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(file) as stream:
            stream.write(sealed(json.dumps(asdict(model), default=_written).encode(), key))


def _written(array: Floats) -> object:
    """Return an array for JSON; triangles are bytes, which are read faster."""
    if array.ndim < 3:
        return array.tolist()
    return {"shape": array.shape, "bytes": base64.b64encode(array.tobytes()).decode()}


def robot_as_text(robot: Robot) -> str:
    """Return a robot as a text, JSON with infinite limits."""
    return json.dumps(asdict(robot), default=_written)


def robot_of_text(text: str) -> Robot:
    """Return the robot of a text; TypeError, KeyError or ValueError if it is not such."""
    robot = _restored(Robot, json.loads(text))
    if not isinstance(robot, Robot):
        raise TypeError("a robot must be a mapping")
    return robot


_AT_ONCE = 100_000_000
"""Age below which a file might be saved again without a new time stamp [ns]."""
_FOLDERS = ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH")


def stamps(files: Iterable[object]) -> dict[Path, tuple[int, ...]]:
    """Return the time, size and inode of each file; what is no file is left out."""
    found: dict[Path, tuple[int, ...]] = {}
    for path in files:
        if isinstance(path, Path):
            with suppress(OSError):
                status = path.stat()
                found[path] = status.st_mtime_ns, status.st_size, status.st_ino
    return found


class Remembered(Generic[Value]):
    """Values that this process made of files, each until one of its files is saved again."""

    def __init__(self, most: int) -> None:
        self._kept: dict[object, tuple[dict[Path, tuple[int, ...]], Value]] = {}
        self._most = most

    def __iter__(self) -> Iterator[Value]:
        return (value for _, value in list(self._kept.values()))

    def get(self, asked: object) -> Value | None:
        """Return what was made of the same files, as they are."""
        files, value = self._kept.get(_asked_here(asked), ({}, None))
        return None if value is None or stamps(files) != files else value

    def keep(self, asked: object, files: dict[Path, tuple[int, ...]], value: Value) -> None:
        """Remember a value, but not where a robot's file, the first, includes others, or one was saved just now."""
        content = next(iter(files)).read_bytes()
        plain = b"<robot" in content and b"<xacro:" not in content and b"<mujoco" not in content
        just_now = max(saved for saved, *_ in files.values()) > time.time_ns() - _AT_ONCE
        if not plain or just_now or stamps(files) != files:
            return
        for oldest in list(self._kept)[: max(0, len(self._kept) + 1 - self._most)]:
            self._kept.pop(oldest, None)
        self._kept[_asked_here(asked)] = files, value


_known: Remembered[tuple[RobotModel, RobotModel]] = Remembered(32)
"""The robots of this process, each with a copy for comparison."""


def known(asked: object) -> RobotModel | None:
    """Return the robot that was made of the same files in this process, if none of them was saved since."""
    both = _known.get(asked)
    if both is None:
        return None
    # Mappings are the only part of a robot that can change.
    model, copy = both
    same = (model.robot.states, model.robot.held) == (copy.robot.states, copy.robot.held)
    return model if same else None


def know(asked: object, files: dict[Path, tuple[int, ...]], model: RobotModel) -> None:
    """Remember a robot for this process."""
    robot = replace(model.robot, states=deepcopy(model.robot.states), held=dict(model.robot.held))
    _known.keep(asked, files, (model, replace(model, robot=robot)))


def file_of(robot: Robot) -> RobotFile | None:
    """Return the file that a robot was loaded from in this process, if that is known.

    Since then it may have got other limits, by its scene, links of what it holds, and a tool.  Of several files that
    fit, it is the one with the most joints, and of these the newest.
    """
    joined, name = _joined(robot), robot.name.partition(" with ")[0]
    known = [model for model, _ in reversed(list(_known)) if model.robot.name in (name, robot.name)]
    fit = [model for model in known if _joined(model.robot) <= joined]
    return max(fit, key=lambda model: len(model.robot.joints)).file if fit else None


def _joined(robot: Robot) -> frozenset[object]:
    """Return what a robot's joints join, and where."""
    return frozenset((each.name, each.parent, each.child, each.xyz, each.rotation, each.axis) for each in robot.joints)


def _asked_here(asked: object) -> object:
    return asked, os.getcwd(), *map(os.environ.get, _FOLDERS)


def _file(key: str) -> Path:
    return cache_folder() / "robots" / f"{key[:32]}.json"


@lru_cache
def _fields_of(kind: type) -> dict[str, object]:
    return get_type_hints(kind)


def _restored(kind: object, value: object) -> object:
    """Return the value of this type that `asdict` and JSON made this of."""
    if isinstance(kind, UnionType):
        return None if value is None else _restored(get_args(kind)[0], value)
    if kind == Floats and isinstance(value, dict):
        return np.frombuffer(base64.b64decode(value["bytes"])).reshape(value["shape"])
    if isinstance(kind, type) and is_dataclass(kind) and isinstance(value, dict):
        make: Callable[..., object] = kind
        fields = _fields_of(kind)
        return make(**{name: _restored(fields[name], each) for name, each in value.items()})
    if get_origin(kind) is tuple and isinstance(value, list):
        inner = get_args(kind)
        kinds = (inner[0],) * len(value) if Ellipsis in inner else inner
        return tuple(map(_restored, kinds, value))
    return value
