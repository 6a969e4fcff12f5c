"""YAML files about a robot's bodies: capsules in place of its shapes, and MoveIt's padding and scale of links."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from os import PathLike
from pathlib import Path

import numpy as np

from evenroad._checks import require_known, require_positive
from evenroad._understood import Kind, require_understood
from evenroad._yaml import numbers, read_mapping, require_keys
from evenroad.errors import BrokenFile, InvalidValue, NotAvailable, shown
from evenroad.geometry.parts import spread
from evenroad.geometry.shapes import Capsule
from evenroad.robots.robot import Padding, Robot

MOST_PADDING = 1.0
"""Largest padding of a link [m]."""
_OTHERS = ("default_object_padding", "default_attached_padding")
_PADDING = ("default_robot_padding", "default_robot_link_padding")
_SCALE = ("default_robot_scale", "default_robot_link_scale")


def read_bodies(path: Path, links: Sequence[str]) -> dict[str, tuple[Capsule, ...]]:
    """Return link -> its capsules, for the links that the file names.

    The file has a list for each link, ``forearm: [{a: [0, 0, 0], b: [0, 0, 0.3], radius: 0.05}, {centre: [0, 0, 0.4],
    radius: 0.06}]``: capsules by their ends, spheres by their centres, in the link's frame [m].  Raises BrokenFile
    if it is missing or not of that form; UnknownName for a link that there is not, or another key; InvalidValue if a
    number is not one, a radius is not > 0, or a link has no body.
    """
    bodies = {}
    for link, entries in read_mapping(path, "file of bodies").items():
        require_known(f"link in {path}:", link, links)
        if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
            raise BrokenFile(f"link {link!r} in {path} must have a list of capsules and spheres")
        if not entries:
            raise InvalidValue(f"link {link!r} in {path} has no body; leave it out to keep those of the URDF")
        bodies[link] = tuple(_given_capsule(link, entry, path) for entry in entries)
    return bodies


def _given_capsule(link: str, entry: dict[str, object], path: Path) -> Capsule:
    where = f"a body of link {link!r} in {path}"
    if "centre" in entry:
        require_keys(entry, ("centre", "radius"), (), where)
        a = b = numbers(entry["centre"], 3, f"centre of {where}")
    else:
        require_keys(entry, ("a", "b", "radius"), ("centre",), where)
        a, b = (numbers(entry[end], 3, f"{end} of {where}") for end in ("a", "b"))
    (radius,) = numbers([entry["radius"]], 1, f"radius of {where}")
    require_positive(f"radius of {where}", radius)
    return Capsule((a[0], a[1], a[2]), (b[0], b[1], b[2]), radius, link=link)


def padding_of(robot: Robot, padding: Padding) -> dict[str, float]:
    """Return by how much links are larger against obstacles, link -> metres.

    Raises as :meth:`evenroad.robot.Robot.with_padding`.
    """
    if isinstance(padding, str | PathLike):
        return _read_padding(robot, Path(padding))
    if isinstance(padding, int | float) and not isinstance(padding, bool):
        return dict.fromkeys(robot.links, padded("padding", padding))
    if not isinstance(padding, Mapping):
        raise InvalidValue(f"padding must be a length, a mapping, link -> metres, or a file, got {shown(padding)}")
    for link, metres in padding.items():
        require_known(f"link of {robot.name!r}:", link, robot.links)
        padded(f"the padding of {link!r}", metres)
    return dict(padding)


def padded(what: str, metres: object) -> float:
    """Return a padding, 0 to 1 [m], or raise InvalidValue."""
    return require_positive(what, metres, or_zero=True, at_most=MOST_PADDING)


def _read_padding(robot: Robot, path: Path) -> dict[str, float]:
    """Return the padding of a file of MoveIt, whose parameters may lie in others, as in ``move_group``'s.

    A scale s of a link adds (s - 1) times the largest distance of its shapes from their middle.
    """
    said: dict[str, object] = {}
    for name, value in _entries(read_mapping(path, "file of padding")):
        if name in said:
            raise BrokenFile(f"{path} has {name} twice")
        said[name] = value
    if not said:
        raise BrokenFile(f"{path} has no padding: it must have {', '.join((*_PADDING, *_SCALE))}, or some of them")
    for name in _OTHERS:
        if said.get(name):
            raise NotAvailable(f"{name} in {path} must be 0, got {said[name]}: give a clearance in its place")
    metres = _by_link(robot, said, _PADDING, 0.0, path)
    scale = _by_link(robot, said, _SCALE, 1.0, path)
    for link in robot.links:
        if not scale[link] >= 1.0:
            raise InvalidValue(f"the scale of {link!r} in {path} must be at least 1, got {scale[link]:g}")
        padded(f"the padding of {link!r} in {path}", metres[link])
        if scale[link] > 1.0:
            metres[link] = padded(
                f"the scale of {link!r} in {path}, in metres,",
                metres[link] + (scale[link] - 1.0) * _farthest_from_middle(robot, link),
            )
    return metres


def _entries(document: Mapping[str, object]) -> Iterator[tuple[str, object]]:
    """Yield names and values of all parameters about padding, however deep they lie among those of others.

    Raises UnknownName for one that is misspelt.
    """
    known = (*_PADDING, *_SCALE, *_OTHERS)
    # What is another planner's parameter is left out; one that is nearly ours is meant for it.
    require_understood(document, Kind(known), "the file of padding", [])
    for name, value in document.items():
        if name in known:
            yield name, value
        elif isinstance(value, dict):
            yield from _entries(value)


def _by_link(
    robot: Robot, said: dict[str, object], names: tuple[str, str], default: float, path: Path
) -> dict[str, float]:
    """Return the number of each link, of the parameters for all and for single ones."""
    every, single = names
    (of_all,) = numbers(said.get(every, default), 1, f"{every} of {path}")
    found, own = dict.fromkeys(robot.links, of_all), said.get(single) or {}
    if not isinstance(own, dict):
        raise BrokenFile(f"{single} of {path} must be a mapping, link -> number, got {shown(own)}")
    for link, value in own.items():
        require_known(f"link in {single} of {path}:", link, robot.links)
        (found[link],) = numbers(value, 1, f"{single} of {link} in {path}")
    return found


def _farthest_from_middle(robot: Robot, link: str) -> float:
    """Return how far a link's shapes reach from their middles at most [m].

    A middle is that of the box around a shape, or the mean of its corners, about which MoveIt scales meshes; of a link
    that is its capsules, that of all of them.
    """
    bodies = [
        (np.concatenate([spread(parts), parts.around]), max(parts.radius, parts.beyond))
        for parts in robot.shapes
        if parts.link == link
    ]
    capsules = [each for each in robot.capsules if each.link == link]
    if capsules and not bodies:
        points = np.array([(each.a, each.b) for each in capsules]).reshape(-1, 3)
        bodies.append((points, max(each.radius for each in capsules)))
    far = [0.0]
    for points, width in bodies:
        corners = np.unique(points, axis=0)
        for middle in (corners.mean(axis=0), 0.5 * (corners.min(axis=0) + corners.max(axis=0))):
            far.append(float(np.linalg.norm(corners - middle, axis=1).max()) + width)
    return max(far)
