"""Parts of messages that all nodes share: how messages are made, time stamps, poses and headings."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from functools import cache
from importlib import import_module
from typing import Any, TypeAlias

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import as_row
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.geometry.pose import Pose

Message: TypeAlias = Any
"""A message of ROS 2, or a value of any library that has its fields."""
Make: TypeAlias = Callable[..., Message]
"""Maker of messages, called as ``make("nav_msgs/msg/Path", header=..., poses=...)``."""

FARTHEST = 1e7
"""Largest coordinate of a pose [m]."""
_UPRIGHT = 1e-3
"""Largest x and y of the quaternion of something that lies flat."""


def ros_message(kind: str, **fields: object) -> Message:
    """Make a message of ROS itself, which takes lists, not arrays."""
    plain = {key: value.tolist() if isinstance(value, np.ndarray) else value for key, value in fields.items()}
    try:
        return ros_type(kind)(**plain)
    except ImportError as error:
        raise NotAvailable(
            f"messages of ROS 2 need a sourced workspace, or the extra: pip install 'evenroad[ros2]' ({error})"
        ) from error


@cache
def ros_type(kind: str) -> Message:
    """Return the class of a message, service or action of ROS, such as ``nav_msgs/msg/Path``; else ImportError."""
    package, part, name = kind.split("/")
    try:
        return getattr(import_module(f"{package}.{part}"), name)
    except AttributeError as error:
        raise ImportError(f"{package} has no {name}") from error


def seconds_of(stamp: Message) -> float:
    """Return a time stamp or a duration in seconds."""
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def time_message(make: Make, seconds: float, kind: str = "builtin_interfaces/msg/Time") -> Message:
    """Return seconds >= 0 as a time stamp or a duration."""
    whole, nanoseconds = divmod(round(seconds * 1e9), 1_000_000_000)
    return make(kind, sec=whole, nanosec=nanoseconds)


def header_message(make: Make, frame: str, stamp: float) -> Message:
    """Return a header with a time stamp in seconds."""
    return make("std_msgs/msg/Header", stamp=time_message(make, stamp), frame_id=frame)


def xyz_of(point: Message, what: str) -> tuple[float, float, float]:
    """Return the coordinates of a point, which must be finite."""
    x, y, z = as_row(what, [point.x, point.y, point.z], 3, within=FARTHEST)
    return x, y, z


def xyzw_of(quaternion: Message, what: str) -> tuple[float, float, float, float]:
    """Return a unit quaternion; one that nobody has filled in is no rotation."""
    row = as_row(what, [quaternion.x, quaternion.y, quaternion.z, quaternion.w], 4)
    length = math.hypot(*row)
    if length == 0.0:
        return 0.0, 0.0, 0.0, 1.0
    if abs(length - 1.0) > 0.1:
        raise InvalidValue(f"{what} must be a quaternion of length 1, got {list(row)} of length {length:.6g}")
    x, y, z, w = (value / length for value in row)
    return x, y, z, w


def pose_of(message: Message, what: str) -> Pose:
    """Return the pose of a ``geometry_msgs/Pose``."""
    return Pose(xyz_of(message.position, f"the position of {what}"), xyzw=xyzw_of(message.orientation, what))


def heading(quaternion: Message, what: str) -> float:
    """Return the angle about z, in (-pi, pi], of a quaternion that turns about z alone."""
    x, y, z, w = xyzw_of(quaternion, f"the orientation of {what}")
    if max(abs(x), abs(y)) > _UPRIGHT:
        raise InvalidValue(f"{what} must lie flat, its orientation is turned by x {x:.6g}, y {y:.6g}")
    angle = 2.0 * math.atan2(z, w)
    return math.atan2(math.sin(angle), math.cos(angle)) if abs(angle) > math.pi else angle


def planar_pose(message: Message, what: str) -> tuple[float, float, float]:
    """Return x, y and heading of a ``geometry_msgs/Pose`` on the floor."""
    x, y, _ = xyz_of(message.position, f"the position of {what}")
    return x, y, heading(message.orientation, what)


def path_message(make: Make, poses: Floats, frame: str, stamp: float) -> Message:
    """Return poses on the floor, (p, 3): x, y, angle, as a ``nav_msgs/Path``; all of them share one header."""
    header, stamped = header_message(make, frame, stamp), []
    sines, cosines = np.sin(0.5 * poses[:, 2]).tolist(), np.cos(0.5 * poses[:, 2]).tolist()
    for x, y, sine, cosine in zip(poses[:, 0].tolist(), poses[:, 1].tolist(), sines, cosines, strict=True):
        turn = make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=sine, w=cosine)
        point = make("geometry_msgs/msg/Point", x=x, y=y, z=0.0)
        pose = make("geometry_msgs/msg/Pose", position=point, orientation=turn)
        stamped.append(make("geometry_msgs/msg/PoseStamped", header=header, pose=pose))
    return make("nav_msgs/msg/Path", header=header, poses=stamped)


def require_recent(stamps: Iterable[tuple[str, float]], now: float, oldest: float) -> None:
    """Raise InvalidValue for a stamp that is older than `oldest` [s], 0 for any; a stamp of zero stands for now."""
    for what, stamp in stamps:
        if oldest > 0.0 and stamp != 0.0 and now - stamp > oldest:
            raise InvalidValue(f"{what} is {now - stamp:.3f} s old, more than stale_after = {oldest:g} s")
