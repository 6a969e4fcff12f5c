"""Reading a scene: a YAML file of the obstacles around a robot."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from evenroad._checks import require_known, require_positive
from evenroad._yaml import numbers, read_mapping, require_keys
from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import PRIMITIVES, shape_of
from evenroad.robot.load import DATA
from evenroad.robot.moveit_scene import read_planning_scene, read_scene_text
from evenroad.robot.scene import Obstacle, Scene

SCENES = ("box-reach", "box-reach-narrow")
"""Names of the shipped scenes."""
_SECTIONS = ("name", "allowed", "states", "limits")
_OPTIONAL = ("xyz", "rpy", "quaternion", "cell")


def is_scene(path: str | os.PathLike[str]) -> bool:
    """Return whether a file is a scene and no map: a ``.scene``, or YAML with the key ``obstacles`` or ``world``."""
    if Path(path).suffix == ".scene":
        return True
    try:
        return not {"obstacles", "world"}.isdisjoint(read_mapping(find_scene(path), "scene"))
    except BrokenFile:
        return False


def find_scene(source: str | os.PathLike[str]) -> Path:
    """Return the file of a scene: `source` itself or, where there is no such file, the shipped one of that name."""
    path = Path(source)
    if not path.is_file() and path.parent == Path() and path.stem in SCENES and path.suffix in ("", ".yaml"):
        return DATA / f"{path.stem}.yaml"
    return path


def load_scene(source: str | os.PathLike[str]) -> Scene:
    """Return a scene from its file, or a shipped one by name: ``box-reach.yaml``, ``box-reach-narrow.yaml``.

    ::

        obstacles:                                # frame: the robot's root link; metres, radians
          table: {shape: box, size: [1, 1.2, 0.05], xyz: [0.25, 0, -0.025], rpy: [0, 0, 0.1], cell: true}
          ball: {shape: sphere, radius: 0.1, xyz: [0.5, 0, 0.5]}
          post: {shape: cylinder, radius: 0.05, length: 1.0, xyz: [0, 0.6, 0.5]}   # along z; so is a capsule
        allowed:                                  # contacts that are not tested
          table: [base_link]
        states:                                   # named configurations, joint by joint
          home: {joint_1: 0.0, joint_2: -1.57}
        limits:                                   # ranges to plan in, within the robot's own
          joint_1: [-3.14, 3.14]

    The length of a capsule is without its caps; ``quaternion: [w, x, y, z]`` may stand for ``rpy``; ``cell: true``
    marks what belongs to the fixed cell.  MoveIt's scenes are read, too (:mod:`evenroad.robot.moveit_scene`).

    Raises BrokenFile if the file is missing, not YAML, lacks something, or has a key twice; UnknownName for a key, a
    shape or an obstacle that there is not; InvalidValue for a value of the wrong type or range.
    """
    path = find_scene(source)
    if not path.is_file():
        raise BrokenFile(
            f"there is no scene file {path}; shipped: {', '.join(f'{name}.yaml' for name in SCENES)}"
        )
    if path.suffix == ".scene":
        return read_scene_text(path)
    document = read_mapping(path, "scene")
    if "obstacles" not in document and "world" in document:
        return read_planning_scene(document, path)
    require_keys(document, ("obstacles",), _SECTIONS, f"the scene {path}")
    entries = _mapping(document["obstacles"], f"obstacles in {path}")
    obstacles = tuple(
        _obstacle(name, _mapping(entry, f"obstacle {name!r} in {path}"), path)
        for name, entry in entries.items()
    )
    allowed: set[tuple[str, str]] = set()
    for obstacle, links in _mapping(document.get("allowed"), f"allowed in {path}").items():
        require_known(f"obstacle in 'allowed' of {path}:", obstacle, entries)
        if not isinstance(links, list) or not all(isinstance(link, str) for link in links):
            raise InvalidValue(
                f"allowed contacts of {obstacle!r} in {path} must be a list of links, got {links!r}"
            )
        allowed.update((link, obstacle) for link in links)
    states: dict[str, dict[str, float]] = {}
    for name, values in _mapping(document.get("states"), f"states in {path}").items():
        states[name] = {}
        for joint, value in _mapping(values, f"state {name!r} in {path}").items():
            (states[name][joint],) = numbers(value, 1, f"joint {joint!r} of state {name!r} in {path}")
    limits = {
        joint: _range(value, f"limits of joint {joint!r} in {path}")
        for joint, value in _mapping(document.get("limits"), f"limits in {path}").items()
    }
    return Scene(str(document.get("name", path.stem)), obstacles, frozenset(allowed), states, limits)


def _obstacle(name: str, entry: dict[str, Any], path: Path) -> Obstacle:
    where = f"obstacle {name!r} in {path}"
    shape = entry.get("shape")
    if not isinstance(shape, str) or shape not in PRIMITIVES:
        raise UnknownName.among(f"shape of {where}:", shape, PRIMITIVES)
    dimensions = PRIMITIVES[shape].dimensions
    require_keys(entry, ("shape", *(key for key, _ in dimensions)), _OPTIONAL, where)
    size: tuple[float, ...] = ()
    for key, count in dimensions:
        size += numbers(entry[key], count, f"{key} of {where}")
    for value in size:
        require_positive(f"the size of {where}", value)
    xyz = numbers(entry.get("xyz", [0, 0, 0]), 3, f"xyz of {where}")
    if "rpy" in entry and "quaternion" in entry:
        raise InvalidValue(f"{where} must have one of rpy and quaternion, got both")
    if "quaternion" in entry:
        quaternion = numbers(entry["quaternion"], 4, f"quaternion of {where}")
        try:
            pose = Pose.from_quaternion(xyz, quaternion)
        except InvalidValue as error:
            raise InvalidValue(f"{where}: {error}") from None
    else:
        pose = Pose.from_rpy(xyz, numbers(entry.get("rpy", [0, 0, 0]), 3, f"rpy of {where}"))
    cell = entry.get("cell", False)
    if not isinstance(cell, bool):
        raise InvalidValue(f"cell of {where} must be true or false, got {cell!r}")
    return Obstacle(name, shape_of(shape, size, pose), cell)


def _range(value: object, what: str) -> tuple[float, float]:
    lower, upper = numbers(value, 2, what)
    if not lower < upper:
        raise InvalidValue(f"{what} must satisfy lower < upper, got {value!r}")
    return lower, upper


def _mapping(value: object, where: str) -> dict[str, Any]:
    if value is None:
        return {}
    if not isinstance(value, dict):
        raise BrokenFile(f"{where} must consist of 'key: value' entries, got {value!r}")
    return {str(key): entry for key, entry in value.items()}
