"""Other planners' paths: proved free, or the first touch, or nearer than 1e-7 m and so undecided."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._call import explains_calls
from evenroad._checks import as_batch, counted
from evenroad.certificates.certify import DECIDED
from evenroad.certificates.first_touch import Found, first_touch, in_contact, near_at, states_at
from evenroad.certificates.world_claim import WorldClaim, nested, world_claim
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue, UnknownName, shown
from evenroad.loading.find import find_robot
from evenroad.loading.load import read_robot
from evenroad.loading.robot_file import RobotFile
from evenroad.robots.kinematics import held_values, joint_values
from evenroad.robots.robot import Robot
from evenroad.space.joints import SLACK
from evenroad.trajectory.waypoints_file import Waypoints, read_waypoints

PathLike = str | os.PathLike[str]


@dataclass(frozen=True)
class PathTouch:
    """Where a path first touches, or is too near to decide.

    Attributes
    ----------
    waypoint : int
        The waypoint before it, from 0.
    share : float
        The share of the motion from there to the next waypoint, 0 to 1.
    bodies : (str, str) or None
        A link and an obstacle, or two links; None where the proof would take too long, and nothing is that near.
    configuration : tuple of float
        The state there: in contact, or nearer than 1e-7 m [rad or m].
    free_until : (int, float)
        Waypoint and share up to which all is proved free; of a touch less than 1e-6 of the motion before it, but where
        the path comes nearer than 1e-7 m long before.
    """

    waypoint: int
    share: float
    bodies: tuple[str, str] | None
    configuration: tuple[float, ...]
    free_until: tuple[int, float]


@dataclass(frozen=True)
class PathCheck:
    """What is known of a path: free, as is proved; touching, as a state shows; or undecided, nearer than 1e-7 m.

    Attributes
    ----------
    status
        "free", "touches" or "undecided".
    motions : int
        Straight motions between the path's waypoints.
    touch : PathTouch or None
        Where it touches, or is not decided.
    bodies : str
        What was tested: the shapes of the robot's file, or the bodies of the world.
    notes : tuple of str
        What is unusual in the path.
    """

    status: Literal["free", "touches", "undecided"]
    motions: int
    touch: PathTouch | None
    bodies: str
    notes: tuple[str, ...] = ()

    @property
    def free(self) -> bool:
        """Whether the whole path is proved free."""
        return self.status == "free"

    def __str__(self) -> str:
        if self.touch is None:
            return f"free: {counted(self.motions, 'straight motion')} proved, with no gap between states"
        first, second = self.touch.bodies or ("", "")
        where = f"at share {self.touch.share:.7f} of the motion after waypoint {self.touch.waypoint}"
        if self.touch.bodies is None:
            return f"undecided: the proof would take too long {where}"
        if self.status == "undecided":
            return f"undecided: {first!r} is nearer than {DECIDED:g} m to {second!r} {where}"
        return f"touches: {first!r} and {second!r} {where}"


@explains_calls
def certify_path(path: npt.ArrayLike | PathLike, world: ArmWorld, *, robot: PathLike | None = None) -> PathCheck:
    """Prove a path of any planner free, or find where it first touches.

    The motions between waypoints are straight in the joints, as the numbers say: a joint without limits is not taken
    the shorter way around.  All that the world tests is tested: its pairs of links, and links with obstacles, at their
    clearance.  Distances are computed in double precision.

    Parameters
    ----------
    path : array_like, shape (n, dof), or str or path-like
        Waypoints in the order of the robot's joints [rad or m]; or a file: ``.csv`` with or without names of joints,
        ``.yaml`` or ``.mcap`` with a JointTrajectory, or the ``.json`` of a plan or a trajectory.
    world : ArmWorld
        Robot, scene and clearance.
    robot : str or path-like, optional
        The file or the name of the world's robot: then the shapes of this file decide, meshes by their triangles.
        Default: the bodies of the world, which contain these shapes and may be up to 0.1 mm larger.

    Returns
    -------
    PathCheck

    Raises
    ------
    InvalidValue
        If the path is none for this robot, or leaves the limits of its joints.
    UnknownName
        If its file names joints that the robot does not have, or lacks some.
    BrokenFile
        If the file is damaged.

    Examples
    --------
    >>> import evenroad as er
    >>> world = er.ArmWorld("ur5", "box-reach")
    >>> print(er.certify_path(er.plan(world, "home", "inside").path, world))
    free: 8 straight motions proved, with no gap between states
    >>> straight = [world.robot.configuration(state, world.scene) for state in ("home", "inside")]
    >>> er.certify_path(straight, world).touch.bodies
    ('wrist_1_link', 'box top')
    """
    if not isinstance(world, ArmWorld):
        raise InvalidValue(f"world must be an ArmWorld, of a robot and a scene, got {shown(world)}")
    waypoints, held, notes = path_of(path, world.robot)
    shapes = None if robot is None else read_robot(RobotFile(find_robot(robot)[0])).shapes
    if held:
        world = replace(world, robot=with_held(world.robot, held))
    return check_path(world_claim(world, shapes), waypoints, notes)


def check_path(claim: WorldClaim, path: Floats, notes: tuple[str, ...] = ()) -> PathCheck:
    """Return what is known of a path, (n, dim), that keeps its limits."""
    if len(path) == 1:
        path = np.repeat(path, 2, axis=0)
    motions = len(path) - 1
    bodies = in_contact(claim.one_by_one(claim.still), path[0]) if claim.still else None
    bodies = bodies or nested(claim, path[0])
    found = Found(0.0, 0.0) if bodies is not None else first_touch(claim, path)
    if found is None:
        return PathCheck("free", motions, None, claim.kinds, notes)
    at = found.free_until if found.contact is None else found.contact
    q = states_at(path, np.array([at]))[0]
    bodies = bodies or near_at(claim, q)
    waypoint, share = _split(at, motions)
    touch = PathTouch(waypoint, share, bodies, tuple(q.tolist()), _split(found.free_until, motions))
    return PathCheck("undecided" if found.contact is None else "touches", motions, touch, claim.kinds, notes)


def with_held(robot: Robot, held: Mapping[str, float]) -> Robot:
    """Return a robot whose other joints are where a path has them, joint -> value [rad or m]."""
    return replace(robot, held={**robot.held, **held}) if held else robot


def _split(at: float, motions: int) -> tuple[int, float]:
    waypoint = min(int(at), motions - 1)
    return waypoint, at - waypoint


def path_of(path: object, robot: Robot) -> tuple[Floats, Mapping[str, float], tuple[str, ...]]:
    """Return the waypoints of a path, (n, dof), values of other joints that its file has, and notes; or refuse it."""
    if isinstance(path, str | os.PathLike):
        waypoints = read_waypoints(path)
        columns, held = _ordered(waypoints, robot) if waypoints.joints else (waypoints.positions, {})
    else:
        columns, held = np.asarray(path), {}
    batch = as_batch("path", columns, robot.dof)
    if not len(batch):
        raise InvalidValue("a path must have one waypoint or more")
    _require_within_limits(batch, robot)
    return batch, held, tuple(_odd(batch, robot))


def _ordered(waypoints: Waypoints, robot: Robot) -> tuple[Floats, dict[str, float]]:
    """Return the columns in the robot's order, and the values of its other joints, which the path may not move."""
    named = dict(zip(waypoints.joints, waypoints.positions.T, strict=True))
    known = [joint.name for joint in robot.joints if joint.kind != "fixed"]
    for name in named:
        if name not in known:
            raise UnknownName.among(f"joint of a path of {robot.name!r}:", name, known)
    missing = [name for name in robot.group if name not in named]
    if missing:
        raise UnknownName(f"the path lacks joint {missing[0]!r}; it needs {', '.join(robot.group)}")
    columns = np.column_stack([named[name] for name in robot.group])
    held = {}
    follows = joint_values(robot, columns)
    for name in (each for each in named if each not in robot.group):
        own = held_values(robot)
        if name not in own:
            if not np.allclose(named[name], follows[name], rtol=0.0, atol=SLACK):
                raise InvalidValue(f"the path has joint {name!r}, which follows another one, where it cannot be")
            continue
        if np.ptp(named[name]) > SLACK:
            raise InvalidValue(f"the path moves joint {name!r}, which is held: give the robot a group with it")
        held[name] = float(named[name][0])
    return columns, held


def _require_within_limits(path: Floats, robot: Robot) -> None:
    low, high = robot.limits.T
    outside = np.argwhere((path < low - SLACK) | (path > high + SLACK))
    if not len(outside):
        return
    waypoint, column = outside[0].tolist()
    turned = np.deg2rad(path)
    turns = np.array([_is_turning(robot, name) for name in robot.group])
    fits = ((turned >= low - SLACK) & (turned <= high + SLACK))[:, turns].all()
    degrees = "; are these degrees? angles are in radians" if fits and np.abs(path[:, turns]).max() > math.pi else ""
    name, value = robot.group[column], path[waypoint, column]
    limits = f"its limits {low[column]:g} .. {high[column]:g}"
    raise InvalidValue(f"waypoint {waypoint} of the path has joint {name!r} at {value:g}, outside {limits}{degrees}")


def _is_turning(robot: Robot, name: str) -> bool:
    return next(joint.kind != "prismatic" for joint in robot.joints if joint.name == name)


def _odd(path: Floats, robot: Robot) -> list[str]:
    """Return notes on what may be meant otherwise: turns beyond half a turn, and what looks like degrees."""
    notes = []
    for column, name in enumerate(robot.group):
        if not np.isinf(robot.limits[column]).any():
            continue
        if np.abs(path[:, column]).max() > 4.0 * math.pi:
            notes.append(f"joint {name!r} goes to {np.abs(path[:, column]).max():g} rad: are these degrees?")
        if len(path) > 1 and (most := np.abs(np.diff(path[:, column])).max()) > math.pi:
            notes.append(f"joint {name!r} turns by {most:g} rad in one motion, and not the shorter way around")
    return notes
