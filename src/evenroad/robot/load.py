"""Loading a robot: a shipped one by its name, or any URDF."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from evenroad._checks import require_known, require_positive
from evenroad._yaml import numbers, read_mapping, require_keys
from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from evenroad.geometry.fit import fit_capsules
from evenroad.geometry.fit_points import union_volume
from evenroad.geometry.hulls import Piece, piece_of
from evenroad.geometry.shapes import Capsule
from evenroad.robot.cache import cached, keep, key_of
from evenroad.robot.pairs import self_pairs
from evenroad.robot.robot import LinkBody, Robot, RobotModel
from evenroad.robot.srdf import Srdf, choose_group, read_srdf
from evenroad.robot.urdf import Urdf, read_urdf

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
    """Return a robot; see :func:`load_model`, which also tells how it was made.

    Warns of pairs of links that touch in every sampled configuration though they are tested, and of robots that are in
    self-collision in all of them.
    """
    model = load_model(source, srdf=srdf, group=group, bodies=bodies)
    if model.always_touching:
        pairs = ", ".join(f"{first} and {second}" for first, second in model.always_touching)
        warnings.warn(
            f"{model.robot.name!r} is in collision in every sampled configuration: {pairs}; disable these pairs in the"
            " SRDF, or give smaller bodies",
            stacklevel=2,
        )
    elif model.never_free:
        warnings.warn(f"{model.robot.name!r}: {model.never_free}", stacklevel=2)
    return model.robot


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

    Raises UnknownName if there is neither such a file nor such a robot.
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
    disabled = None if srdf is None or not srdf.disabled else srdf.disabled
    pairs = self_pairs(robot, _pieces(urdf, given), disabled)
    links = tuple(_link_body(urdf, link, capsules[link], link in given) for link in capsules)
    drawn_only = tuple(link for link in urdf.drawn_only if link not in capsules)
    return RobotModel(
        replace(
            robot, pairs=pairs.tested, hulls=pairs.hulls, pairs_given=disabled is not None, resting=pairs.held
        ),
        links,
        "computed" if disabled is None else "SRDF",
        pairs.dropped,
        drawn_only,
        pairs.always,
        pairs.never_free,
    )


def _capsules(urdf: Urdf, given: dict[str, tuple[Capsule, ...]]) -> dict[str, tuple[Capsule, ...]]:
    found: dict[str, tuple[Capsule, ...]] = {}
    for shape in urdf.shapes:
        if shape.link not in given:
            found[shape.link] = found.get(shape.link, ()) + fit_capsules(shape)
    found |= given
    return {link: found[link] for link in urdf.links if link in found}


def _pieces(urdf: Urdf, given: dict[str, tuple[Capsule, ...]]) -> dict[str, list[Piece]]:
    """Return what every link with a body consists of: the capsules given, or the shapes of the URDF."""
    shapes = [shape for shape in urdf.shapes if shape.link not in given]
    pieces: dict[str, list[Piece]] = {}
    for shape in (*shapes, *(capsule for capsules in given.values() for capsule in capsules)):
        pieces.setdefault(shape.link, []).append(piece_of(shape))
    return pieces


def _link_body(urdf: Urdf, link: str, capsules: tuple[Capsule, ...], given: bool) -> LinkBody:
    shapes = [shape for shape in urdf.shapes if shape.link == link]
    return LinkBody(
        link=link,
        shapes=tuple(map(str, shapes)),
        shape_volume=sum(shape.volume for shape in shapes),
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


def read_bodies(path: Path, links: Sequence[str]) -> dict[str, tuple[Capsule, ...]]:
    """Return link -> its capsules, for the links that the file names.

    The file has a list for each link, ``forearm: [{a: [0, 0, 0], b: [0, 0, 0.3], radius: 0.05}, {centre: [0, 0, 0.4],
    radius: 0.06}]``: capsules by their end points, spheres by their centres, in the link's frame [m].

    Raises
    ------
    BrokenFile
        If the file is missing, not YAML, not of that form, or has a link or a key twice.
    UnknownName
        If it names a link that there is not, or another key.
    InvalidValue
        If a number is not one, a radius is not > 0, or a link has no body.
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
