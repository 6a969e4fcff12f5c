"""Robots kept between runs: fitting capsules to meshes and sampling contacts takes seconds."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from evenroad import __version__
from evenroad._files import atomic_write, cache_folder
from evenroad.errors import BrokenFile
from evenroad.geometry.hulls import Hull
from evenroad.geometry.shapes import Capsule
from evenroad.robot.joint import Joint, Mimic
from evenroad.robot.robot import LinkBody, Robot, RobotModel
from evenroad.robot.urdf_xml import find_mesh, mesh_names, read_urdf_xml

_FORMAT = 7
"""Counted up when the same files would give another robot, or the files of this cache look different."""


def key_of(urdf: Path, srdf: Path | None, bodies: Path | None, group: str | Sequence[str] | None) -> str:
    """Return the hash of all that decides the robot: the content of its files, meshes included, and the group.

    Raises BrokenFile, InvalidValue if a file is missing, or the URDF broken: a cached robot is never returned for
    files that are gone.
    """
    digest = hashlib.sha256(f"{_FORMAT}|{__version__}|{urdf.name}|{group!r}".encode())
    for part in _parts(urdf, srdf, bodies):
        digest.update(hashlib.sha256(part).digest())
    return digest.hexdigest()


def cached(key: str) -> RobotModel | None:
    """Return the robot kept under this key; None when there is none, or it is damaged and to be made again."""
    with suppress(OSError, ValueError, KeyError, TypeError):
        return _model(json.loads(_file(key).read_text(encoding="utf-8")))
    return None


def keep(key: str, model: RobotModel) -> None:
    """Put a robot into the cache; where that cannot be written, the next run takes longer and that is all."""
    file = _file(key)
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(file) as stream:
            stream.write(json.dumps(asdict(model), default=np.ndarray.tolist).encode())


def _parts(urdf: Path, srdf: Path | None, bodies: Path | None) -> Iterator[bytes]:
    root = read_urdf_xml(urdf)
    files = [("robot", urdf), ("SRDF", srdf), ("file of bodies", bodies)]
    files += [("mesh", find_mesh(name, urdf, link)) for link, name in mesh_names(root)]
    for what, path in files:
        try:
            # An empty file is refused where none at all is fine.
            yield b"absent" if path is None else b"present" + path.read_bytes()
        except OSError as error:
            raise BrokenFile(f"cannot read the {what} {path}: {error.strerror or error}") from error


def _file(key: str) -> Path:
    return cache_folder() / "robots" / f"{key[:32]}.json"


def _model(record: dict[str, Any]) -> RobotModel:
    return RobotModel(
        robot=_robot(record["robot"]),
        bodies=tuple(LinkBody(**body | {"shapes": tuple(body["shapes"])}) for body in record["bodies"]),
        pairs_from=record["pairs_from"],
        dropped=tuple((first, second, reason) for first, second, reason in record["dropped"]),
        drawn_only=tuple(record["drawn_only"]),
        always_touching=tuple((first, second) for first, second in record["always_touching"]),
        never_free=record["never_free"],
    )


def _robot(record: dict[str, Any]) -> Robot:
    return Robot(
        name=record["name"],
        links=tuple(record["links"]),
        joints=tuple(_joint(joint) for joint in record["joints"]),
        capsules=tuple(
            Capsule(capsule["a"], capsule["b"], capsule["radius"], link=capsule["link"])
            for capsule in record["capsules"]
        ),
        pairs=tuple((first, second) for first, second in record["pairs"]),
        group=tuple(record["group"]),
        held=record["held"],
        states=record["states"],
        hulls=tuple(Hull(hull["points"], hull["radius"], hull["link"]) for hull in record["hulls"]),
        pairs_given=record["pairs_given"],
        resting=tuple((first, second) for first, second in record["resting"]),
    )


def _joint(record: dict[str, Any]) -> Joint:
    mimic = record["mimic"]
    return Joint(**_with_tuples(record) | {"mimic": None if mimic is None else Mimic(**mimic)})


def _with_tuples(record: dict[str, Any]) -> dict[str, Any]:
    return {key: tuple(value) if isinstance(value, list) else value for key, value in record.items()}
