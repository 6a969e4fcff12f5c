"""Loading a robot: a shipped one by its name, or any URDF."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from evenroad.errors import BrokenFile, UnknownName
from evenroad.robot.body_file import read_bodies
from evenroad.robot.cache import cached, keep, key_of
from evenroad.robot.capsule import Capsule
from evenroad.robot.fit import fit_capsules
from evenroad.robot.group import choose_group
from evenroad.robot.model import LinkBody, RobotModel
from evenroad.robot.pairs import computed_pairs, pairs_without
from evenroad.robot.robot import Robot
from evenroad.robot.srdf import Srdf, read_srdf
from evenroad.robot.urdf import Urdf, read_urdf
from evenroad.robot.volume import shape_volume, union_volume

DATA = Path(__file__).parent / "data"
ROBOTS = ("arm7", "ur5")
"""Names of the shipped robots."""

PathLike = str | os.PathLike[str]


def load_robot(
    source: PathLike,
    *,
    srdf: PathLike | None = None,
    group: str | Sequence[str] | None = None,
    bodies: PathLike | None = None,
) -> Robot:
    """Return a robot; see :func:`load_model`, which also tells how it was made."""
    return load_model(source, srdf=srdf, group=group, bodies=bodies).robot


def load_model(
    source: PathLike,
    *,
    srdf: PathLike | None = None,
    group: str | Sequence[str] | None = None,
    bodies: PathLike | None = None,
) -> RobotModel:
    """Return a robot and how it was made from its files.

    What was made is kept in the user's cache, by the content of all files (meshes, too).

    A link without collision geometry has no body, and nothing is found to touch it.  Where the URDF draws such a link
    that is no error, since sensors and frames are often drawn and nothing more, but the model names it, as do
    ``evenroad plan`` and ``evenroad robot``.

    Parameters
    ----------
    source : str or path-like
        A URDF file; or, where there is no such file, the name of a shipped robot: ``ur5``, ``arm7``.
    srdf : str or path-like, optional
        Its SRDF: groups, named states, pairs that need no test.  ``ur5`` has one of its own.
    group : str or sequence of str, optional
        A group of the SRDF, or names of joints (one text: with commas).  Default: the SRDF's only group, else every
        joint that moves and is no mimic.  The configuration is in the order of the URDF.
    bodies : str or path-like, optional
        YAML file of capsules and spheres, in place of those fitted (see :func:`read_bodies`).

    Raises
    ------
    UnknownName
        If there is neither such a file nor such a robot; if a group, a joint or a link is not known.
    BrokenFile
        If a file is missing, broken or lacks a piece, the links do not form a tree, a mesh is missing or empty, or the
        robot has no body at all.
    InvalidValue
        If a number is not one, or out of its range.
    NotAvailable
        If a mesh needs a library that is not installed.
    """
    path, own_srdf = find_robot(source)
    srdf_path = own_srdf if srdf is None else Path(srdf)
    bodies_path = None if bodies is None else Path(bodies)
    key = key_of(path, srdf_path, bodies_path, group)
    kept = cached(key)
    if kept is not None:
        return kept
    model = _build(path, srdf_path, bodies_path, group)
    # Files may have been saved while they were read: then nobody knows of which of their contents this is made.
    if key_of(path, srdf_path, bodies_path, group) == key:
        keep(key, model)
    return model


def find_robot(source: PathLike) -> tuple[Path, Path | None]:
    """Return the URDF, and for a shipped robot its SRDF if it has one.

    Raises
    ------
    UnknownName
        If there is neither such a file nor such a robot.
    """
    path = Path(source)
    if path.is_file() or path.suffix or len(path.parts) > 1:
        return path, None
    if str(source) not in ROBOTS:
        raise UnknownName(
            f"there is no robot file {str(source)!r}, and none of this name is shipped; shipped: {', '.join(ROBOTS)}"
        )
    own = DATA / f"{path}.srdf"
    return DATA / f"{path}.urdf", own if own.exists() else None


def _build(
    path: Path, srdf_path: Path | None, bodies_path: Path | None, group: str | Sequence[str] | None
) -> RobotModel:
    urdf = read_urdf(path)
    srdf = None if srdf_path is None else read_srdf(srdf_path, urdf)
    chosen = choose_group(urdf, srdf, group)
    given = {} if bodies_path is None else read_bodies(bodies_path, urdf.links)
    capsules = _capsules(urdf, given)
    if not capsules:
        raise BrokenFile(f"{path} has no collision geometry at all: the robot would never collide")
    robot = Robot(
        urdf.name,
        urdf.links,
        urdf.joints,
        tuple(capsule for link in urdf.links for capsule in capsules.get(link, ())),
        pairs=(),
        group=chosen,
        states={} if srdf is None else _states(srdf, chosen, group),
    )
    if srdf is not None and srdf.disabled:
        pairs, pairs_from = pairs_without(robot, srdf.disabled), "SRDF"
    else:
        pairs, pairs_from = computed_pairs(robot), "computed"
    links = tuple(_link_body(urdf, link, capsules[link], link in given) for link in capsules)
    drawn_only = tuple(link for link in urdf.drawn_only if link not in capsules)
    return RobotModel(replace(robot, pairs=pairs.tested), links, pairs_from, pairs.dropped, drawn_only)


def _capsules(urdf: Urdf, given: dict[str, tuple[Capsule, ...]]) -> dict[str, tuple[Capsule, ...]]:
    found: dict[str, tuple[Capsule, ...]] = {}
    for geometry in urdf.geometries:
        if geometry.link not in given:
            found[geometry.link] = found.get(geometry.link, ()) + fit_capsules(geometry)
    found |= given
    return {link: found[link] for link in urdf.links if link in found}


def _link_body(urdf: Urdf, link: str, capsules: tuple[Capsule, ...], given: bool) -> LinkBody:
    shapes = [geometry for geometry in urdf.geometries if geometry.link == link]
    return LinkBody(
        link=link,
        shapes=tuple(map(str, shapes)),
        shape_volume=sum(map(shape_volume, shapes)),
        capsules=len(capsules),
        capsule_volume=union_volume(capsules),
        given=given,
    )


def _states(
    srdf: Srdf, chosen: tuple[str, ...], wanted: str | Sequence[str] | None
) -> dict[str, dict[str, float]]:
    """Return the named states that give a value to every joint chosen: of two of a name, that of the group wanted."""

    def strangeness(group_and_name: tuple[str, str]) -> tuple[bool, bool]:
        group, _ = group_and_name
        return group != wanted, srdf.groups[group] != chosen

    found: dict[str, dict[str, float]] = {}
    for group, name in sorted(srdf.states, key=strangeness):
        values = srdf.states[group, name]
        if set(chosen) <= set(values):
            found.setdefault(name, dict(values))
    return found
