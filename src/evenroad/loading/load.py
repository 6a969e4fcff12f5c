"""Loading a robot: a shipped one by its name, or any URDF, xacro or MJCF."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypedDict, Unpack

from evenroad._call import explains_calls, require_options
from evenroad.errors import BrokenFile
from evenroad.geometry.hulls import Piece
from evenroad.geometry.inner import inner_of
from evenroad.geometry.mesh_shape import gap_notes
from evenroad.geometry.parts import parts_of
from evenroad.geometry.shapes import Mesh
from evenroad.loading.bodies_file import read_bodies
from evenroad.loading.cache import cached, keep, key_of, know, known, stamps
from evenroad.loading.description import RobotDescription, require_few_links
from evenroad.loading.find import find_robot
from evenroad.loading.groups import EVERY, choose_group, chosen_states, group_notes, held_states
from evenroad.loading.link_bodies import capsules_of, link_body, opened, pieces_of, shapes_of
from evenroad.loading.model import RobotModel
from evenroad.loading.ready_posture import held_apart
from evenroad.loading.robot_file import RobotFile
from evenroad.loading.srdf import Srdf, read_srdf, with_moving_base
from evenroad.loading.units import size_notes
from evenroad.loading.urdf import read_urdf
from evenroad.loading.xml_file import outermost
from evenroad.robots.free_joints import without_moved
from evenroad.robots.pairs import SelfPairs, pairs_of, self_pairs
from evenroad.robots.robot import Padding, Robot

SHAPES, CAPSULES = "shapes", "capsules"
"""Values of `bodies`: the file's shapes decide where capsules touch an obstacle, or capsules alone decide."""
PathLike = str | os.PathLike[str]


class RobotOptions(TypedDict, total=False):
    """Options of reading a robot; see :func:`load_model`."""

    srdf: PathLike | None
    group: str | Sequence[str] | None
    bodies: PathLike | None
    use_visuals: bool
    upright_meshes: bool
    packages: Mapping[str, PathLike] | None
    arguments: Mapping[str, str] | None
    progress: Callable[[int, int, str], None] | None
    padding: Padding | None


@dataclass(frozen=True)
class _Request:
    """Files of a robot, the group that is planned for, and whether shapes of the file decide contacts."""

    file: RobotFile
    srdf: Path | None
    bodies: Path | None
    group: str | tuple[str, ...] | None
    with_shapes: bool


@explains_calls
def load_robot(source: PathLike, **options: Unpack[RobotOptions]) -> Robot:
    """Return a robot from its file, or a shipped one by its name.

    Warns of tested pairs of links that touch in every sampled configuration, and of robots in self-collision in all of
    them.

    Parameters
    ----------
    source : str or path-like
        A URDF, xacro or MJCF; or, where there is no such file, ``ur5`` or ``arm7``.
    **options
        As :func:`evenroad.robot.load_model` takes them, which also returns how the robot was made.

    Returns
    -------
    Robot

    Raises
    ------
    UnknownName
        If there is neither such a file nor such a robot, or a group, joint, link or keyword is not known.
    BrokenFile
        If a file is missing, broken or lacks a piece.
    InvalidValue
        If a number is none, or out of its range.
    NotAvailable
        If an extra is needed that is not installed.

    Examples
    --------
    >>> import evenroad as er
    >>> er.load_robot("ur5").joint_names[:2]
    ('shoulder_pan_joint', 'shoulder_lift_joint')
    """
    require_options("load_robot", options, RobotOptions)
    model = load_model(source, **options)
    if model.always_touching:
        pairs = ", ".join(f"{first} and {second}" for first, second in model.always_touching)
        advice = "disable these pairs in the SRDF, or give smaller bodies"
        always = f"{model.robot.name!r} is in collision in every sampled configuration"
        warnings.warn(f"{always}: {pairs}; {advice}", stacklevel=2)
    elif model.never_free:
        warnings.warn(f"{model.robot.name!r}: {model.never_free}", stacklevel=2)
    return model.robot


@explains_calls
def load_model(source: PathLike, **options: Unpack[RobotOptions]) -> RobotModel:
    """Return a robot and how it was made from its files.

    The robot is kept in the user's cache, by the content of all files, meshes included.  A link without collision
    geometry touches nothing; the model names such links, and all that was read otherwise than it stands in the file.

    Parameters
    ----------
    source : str or path-like
        A URDF, xacro or MJCF (extra ``[mjcf]``); or, where there is no such file, the name of a
        shipped robot: ``ur5``, ``arm7``; with the extra ``[robots]`` also ``panda`` and others.
    srdf : str or path-like, optional
        Its SRDF: groups, named states, pairs that need no test.  Robots by name have one of their own.
    group : str or sequence of str, optional
        Groups of the SRDF and joints (one text: with commas), which are planned for in this order.  Default: the
        SRDF's only group, or the longest chain among several, else every joint that moves and is no mimic, in the order
        of the file.
    bodies : str or path-like, optional
        ``shapes``, the default: where capsules touch an obstacle the file's shapes decide.  ``capsules``: these alone
        do.  Or a YAML file of capsules and spheres, in place of shapes of the file (see :func:`read_bodies`).
    use_visuals : bool
        Links without collision geometry use their visuals.
    upright_meshes : bool
        The y axis of a link's glTF, which is up by the format's specification, becomes z.  By default meshes of links
        are not turned, as in RViz.
    packages : mapping of str to path-like, optional
        Folders of ROS packages, beside those that are found.
    arguments : mapping of str to str, optional
        Arguments of a xacro.
    progress : callable, optional
        Called with step, steps and a text before each body is fitted; not at all for a robot from the cache.

    padding : mapping of str to float, float, str or path-like, optional
        By how much links are larger against obstacles [m], as :meth:`evenroad.robot.Robot.with_padding` takes it.

    Raises UnknownName if there is neither such a file nor such a robot, or a group, joint, link or keyword is not
    known; BrokenFile if a file is missing, broken or lacks a piece, the links do not form a tree, a mesh is missing or
    empty, or the robot has no body at all; InvalidValue if a number is not one, or out of its range; NotAvailable if an
    extra is needed that is not installed.
    """
    require_options("load_model", options, RobotOptions)
    request = _requested(source, options)
    model = known(request) or _model_of(request, options.get("progress"))
    padding = options.get("padding")
    return model if padding is None else replace(model, robot=model.robot.with_padding(padding))


def _requested(source: PathLike, options: RobotOptions) -> _Request:
    path, own_srdf = find_robot(source)
    packages, arguments = options.get("packages") or {}, options.get("arguments") or {}
    file = RobotFile(
        path,
        options.get("use_visuals", False),
        tuple((name, os.fspath(folder)) for name, folder in sorted(packages.items())),
        tuple(sorted(arguments.items())),
        upright_meshes=options.get("upright_meshes", False),
    )
    srdf, bodies, group = options.get("srdf"), options.get("bodies"), options.get("group")
    named = None if bodies is None else os.fspath(bodies)
    return _Request(
        file,
        own_srdf if srdf is None else Path(srdf),
        None if named in (None, SHAPES, CAPSULES) else Path(named),
        group if group is None or isinstance(group, str) else tuple(group),
        named != CAPSULES,
    )


def _model_of(request: _Request, progress: Callable[[int, int, str], None] | None) -> RobotModel:
    """Return a robot from the user's cache, or from its files."""
    file, others = request.file, [("SRDF", request.srdf), ("file of bodies", request.bodies)]
    before = stamps((file.path, request.srdf, request.bodies))
    description = read_robot(file)
    before |= stamps(shape.source for shape in description.shapes if isinstance(shape, Mesh))
    others += [] if request.with_shapes else [(CAPSULES, None)]
    key = key_of(description, others, request.group)
    model = cached(key)
    if model is None:
        model = _build(request, description, progress)
        # Files may have been saved while they were read: the robot may then mix two versions.
        if key_of(description, others, request.group) == key:
            keep(key, model)
    model = replace(model, file=file)
    know(request, before, model)
    return model


def read_robot(file: RobotFile) -> RobotDescription:
    """Return what the file of a robot says: an MJCF with the suffix ``.xml`` or ``.mjcf``, else a URDF or xacro."""
    if not is_mjcf(file):
        return read_urdf(file)
    # Imported late: most robots are URDFs.
    from evenroad.loading.mjcf import read_mjcf

    return read_mjcf(file)


def is_mjcf(file: RobotFile) -> bool:
    """Return whether a robot's file is an MJCF."""
    return file.path.suffix in (".xml", ".mjcf") and outermost(file.path) != "robot"


def _build(
    request: _Request, description: RobotDescription, progress: Callable[[int, int, str], None] | None
) -> RobotModel:
    group, path = request.group, request.file.path
    description, srdf, chosen = _planned(description, request.srdf, group)
    given = {} if request.bodies is None else read_bodies(request.bodies, description.links)
    require_few_links(len(description.links), len({shape.link for shape in description.shapes}), path)
    description = replace(description, shapes=opened(description.shapes))
    shapes = shapes_of(description, given)
    capsules = capsules_of(description, given, progress)
    if not capsules:
        hint = "; --use-visuals takes what is drawn" if description.drawn_only else ""
        raise BrokenFile(f"{path} has no collision geometry at all: the robot would never collide{hint}")
    robot = Robot(
        description.name,
        description.links,
        description.joints,
        tuple(capsule for link in description.links for capsule in capsules.get(link, ())),
        pairs=(),
        group=chosen,
        states=_states(description, srdf, chosen, group),
        planes=description.planes,
        # Capsules that the user gives replace a link's shapes as they are.
        inner=inner_of(shapes),
        shapes=parts_of(shapes) if request.with_shapes else (),
    )
    robot, pairs = _with_pairs(robot, description, srdf, pieces_of(shapes))
    return RobotModel(
        robot,
        tuple(link_body(description, link, capsules[link], link in given) for link in capsules),
        pairs_from="SRDF" if robot.pairs_given else "computed" if description.untested is None else "MJCF",
        dropped=pairs.dropped,
        drawn_only=tuple(link for link in description.drawn_only if link not in capsules),
        always_touching=pairs.always,
        never_free=pairs.never_free,
        notes=(
            *without_moved(description.notes, description.joints, chosen),
            *(() if srdf is None else srdf.notes),
            *group_notes(description, srdf, group),
            *size_notes(capsules, description.joints),
            *gap_notes("link", ((shape.link, shape) for shape in description.shapes)),
            *map(_contained, pairs.contained),
        ),
    )


def _states(
    description: RobotDescription, srdf: Srdf | None, chosen: tuple[str, ...], group: str | Sequence[str] | None
) -> dict[str, dict[str, float]]:
    """Return the named states with a value for every joint chosen; those of the SRDF replace others of their name."""
    own = {name: dict(values) for name, values in description.states.items() if set(chosen) <= set(values)}
    return own | ({} if srdf is None else chosen_states(srdf, chosen, group))


def _with_pairs(
    robot: Robot, description: RobotDescription, srdf: Srdf | None, pieces: dict[str, list[Piece]]
) -> tuple[Robot, SelfPairs]:
    """Return a robot with the pairs of links that are tested, and what is known of all pairs."""
    # Pairs that an MJCF lets touch have a reason each; pairs of an SRDF have one for all.
    untested = {frozenset((a, b)): why for a, b, why in description.untested or ()}
    by_srdf = srdf is not None and bool(srdf.disabled)
    if srdf is not None and by_srdf:
        untested = dict.fromkeys(srdf.disabled, "disabled in the SRDF") | untested
        # Without an SRDF, pairs that touch at the held values are not tested while joints are held there.
        robot = replace(robot, held=held_states(srdf, robot))
        apart = held_apart(robot, pieces, pairs_of(robot, pieces, untested), srdf.states.values())
        robot = replace(robot, held={**robot.held, **apart})
    said = by_srdf or description.untested is not None
    pairs = self_pairs(robot, pieces, untested if said else None, drop_touching=not by_srdf)
    return replace(robot, pairs=pairs.tested, hulls=pairs.hulls, pairs_given=by_srdf, resting=pairs.held), pairs


def _planned(
    description: RobotDescription, srdf_path: Path | None, group: str | Sequence[str] | None
) -> tuple[RobotDescription, Srdf | None, tuple[str, ...]]:
    """Return the robot, its SRDF and the group that is planned for; its base moves if the group says so."""
    if srdf_path is None:
        return description, None, choose_group(description, None, group)
    moving = with_moving_base(description, srdf_path)
    if group not in (None, EVERY):
        srdf = read_srdf(srdf_path, moving)
        chosen = choose_group(moving, srdf, group)
        if not set(chosen) <= set(description.order):
            return moving, srdf, chosen
    srdf = read_srdf(srdf_path, description)
    return replace(description, notes=moving.notes), srdf, choose_group(description, srdf, group)


def _contained(pair: tuple[str, str]) -> str:
    first, second = pair
    return (
        f"{first!r} and {second!r}, of which one goes into the other as drawn, are not tested against each other: an"
        " SRDF that disables other pairs alone has them tested"
    )
