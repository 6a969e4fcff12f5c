"""A scene of evenroad: obstacles, allowed contacts, narrower limits, and what the robot holds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from evenroad_verify.errors import Pose, number, numbers, require
from evenroad_verify.files import Files
from evenroad_verify.meshes import read_mesh
from evenroad_verify.shapes import DIMENSIONS, Shape, balls, hull, pose_of, primitive, rotation_of
from evenroad_verify.yaml_subset import parse_yaml

GROUND = 100.0
"""A plane is a box of this half width, and as deep: enough for a robot that does not reach as far [m]."""
_SECTIONS = {"obstacles", "allowed", "states", "limits", "attach", "name"}


@dataclass(frozen=True)
class Obstacle:
    """Some shapes of one name; `above` is how far the root is from a plane, None for all other shapes."""

    name: str
    shapes: tuple[Shape, ...]
    above: float | None = None


@dataclass(frozen=True)
class Held:
    """A body that moves with a link, and the links that it may touch."""

    name: str
    shapes: tuple[Shape, ...]
    link: str
    touches: tuple[str, ...]


@dataclass(frozen=True)
class Scene:
    """What surrounds the robot; `allowed` are pairs of an obstacle and a link, or a held object, that may touch."""

    obstacles: tuple[Obstacle, ...]
    allowed: frozenset[tuple[str, str]]
    limits: dict[str, tuple[float, float]]
    held: tuple[Held, ...]


def read_scene(files: Files, path: Path) -> Scene:
    """Return a scene of its file."""
    try:
        text = files.read(path).decode("utf-8")
    except UnicodeDecodeError:
        text = "\t"
    document = _mapping(parse_yaml(text))
    require(document.keys() <= _SECTIONS, f"the scene has keys that are not known here: {', '.join(document)}")
    obstacles = tuple(_obstacle(files, path, name, entry) for name, entry in _named(document.get("obstacles")))
    names = {each.name for each in obstacles}
    require(len(names) == len(obstacles), "two obstacles have one name")
    allowed, held = set(), []
    for name, links in _mapping(document.get("allowed")).items():
        require(name in names, f"{name} is allowed to be touched, and is no obstacle")
        allowed |= {(name, link) for link in _texts(links)}
    for name, entry in _named(document.get("attach")):
        link, touches = str(entry.pop("link", "")), _texts(entry.pop("touches", []))
        allowed |= {(obstacle, name) for obstacle in touches if obstacle in names}
        body = _obstacle(files, path, name, entry)
        held.append(Held(name, body.shapes, link, tuple(each for each in touches if each not in names)))
    limits = {joint: tuple(numbers(both, 2).tolist()) for joint, both in _mapping(document.get("limits")).items()}
    return Scene(
        obstacles, frozenset(allowed), {joint: (low, high) for joint, (low, high) in limits.items()}, tuple(held)
    )


def _mapping(value: object) -> dict[str, object]:
    require(value is None or isinstance(value, dict), f"the scene has {str(value)[:40]!r} in place of keys")
    return dict(value) if isinstance(value, dict) else {}


def _texts(value: object) -> list[str]:
    require(
        isinstance(value, list) and all(isinstance(each, str) for each in value), "contacts with parts are not known"
    )
    return [str(each) for each in value] if isinstance(value, list) else []


def _named(value: object) -> Iterator[tuple[str, dict[str, object]]]:
    """Yield name and entry, in full, of a mapping, or of a list whose entries have a name."""
    if isinstance(value, list):
        entries = [_mapping(each) for each in value]
        pairs = [(str(each.pop("name", f"{each.get('shape')} {i}")), each) for i, each in enumerate(entries)]
    else:
        pairs = [(name, _mapping(entry)) for name, entry in _mapping(value).items()]
    for name, entry in pairs:
        short = [kind for kind in DIMENSIONS if kind in entry]
        if "shape" not in entry and len(short) == 1:
            inner, (key, *more) = entry.pop(short[0]), DIMENSIONS[short[0]]
            require(isinstance(inner, dict) or not more, f"{name} lacks its {', '.join(more)}")
            own = inner if isinstance(inner, dict) else {key: inner}
            require(not own.keys() & {"shape", *entry}, f"{name} has a key twice")
            entry = {"shape": short[0], **own, **entry}
        yield name, entry


def _obstacle(files: Files, path: Path, name: str, entry: dict[str, object]) -> Obstacle:
    kind, pose = str(entry.get("shape")), _pose(entry)
    of_kind = {"mesh": {"file", "scale", "convex"}, "cloud": {"file", "radius"}, "plane": set[str]()} | {
        key: set(each) for key, each in DIMENSIONS.items()
    }
    require(kind in of_kind, f"{name} is of the unknown shape {kind}")
    known = {"shape", "xyz", "rpy", "xyzw", "cell", "clearance"} | of_kind[kind]
    require(entry.keys() <= known, f"{name} has keys that are not known here: {', '.join(entry.keys() - known)}")
    above, shapes = None, list[Shape]()
    if kind == "plane":
        above = float(pose[0][:, 2] @ pose[1])
        pose, above = (pose[0], (above - 0.5 * GROUND) * pose[0][:, 2]), abs(above)
        kind, entry = "box", {"size": [2 * GROUND, 2 * GROUND, GROUND]}
    if kind == "mesh":
        scale, file = entry.get("scale", "1"), path.parent / str(entry.get("file"))
        scales = numbers(scale if isinstance(scale, list) else [scale] * 3, 3)
        shapes = read_mesh(files.read(file), file.name, scales)
        convex = entry.get("convex", "false")
        require(convex in ("true", "false"), f"{name} has a convex that is not true or false")
        if convex == "true":
            shapes = [hull(shapes)]
    elif kind == "cloud":
        shapes = [balls(files.read(path.parent / str(entry.get("file"))), number(entry.get("radius", "0.01")))]
    else:
        shape = primitive(kind, entry)
        require(shape is not None, f"{name} has no size")
        shapes = [shape] if shape is not None else []
    wide = number(entry.get("clearance", "0"))
    require(0.0 <= wide <= 1.0, f"{name} has a clearance that is not 0 to 1 m")
    return Obstacle(name, tuple(replace(each.at(pose), radius=each.radius + wide) for each in shapes), above)


def _pose(entry: dict[str, object]) -> Pose:
    xyz = numbers(entry.get("xyz", ["0"] * 3), 3)
    require(not {"rpy", "xyzw"} <= entry.keys(), "an obstacle has two rotations")
    if "xyzw" not in entry:
        return pose_of(xyz, numbers(entry.get("rpy", ["0"] * 3), 3))
    return rotation_of(numbers(entry["xyzw"], 4)), xyz
