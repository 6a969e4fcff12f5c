"""Links that are larger against obstacles: lengths, and MoveIt's files of padding and scales."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from os import PathLike
from pathlib import Path

import numpy as np

from evenroad._checks import require_known, require_positive
from evenroad._understood import Kind, require_understood
from evenroad._yaml import numbers, read_mapping
from evenroad.errors import BrokenFile, InvalidValue, NotAvailable, shown
from evenroad.geometry.parts import spread
from evenroad.robots.robot import Padding, Robot

MOST_PADDING = 1.0
"""Largest padding of a link [m]."""
_OTHERS = ("default_object_padding", "default_attached_padding")
_PADDING = ("default_robot_padding", "default_robot_link_padding")
_SCALE = ("default_robot_scale", "default_robot_link_scale")


def with_padding(robot: Robot, padding: Padding) -> Robot:
    """Return what :meth:`evenroad.robot.Robot.with_padding` does."""
    every = dict(robot.padding) | {link: float(metres) for link, metres in padding_of(robot, padding).items()}
    return replace(robot, padding=tuple(sorted((link, metres) for link, metres in every.items() if metres > 0.0)))


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
    # Other planners' parameters are skipped; a misspelt one of ours is refused.
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

    The middle of a shape is that of the box around it, or the mean of its corners, about which MoveIt scales meshes.  A
    link that is its capsules has one middle for all of them.
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
