"""Files of the trajectories of robots on maps: JSON, which can be read back, CSV, and ROS 2's `nav_msgs/Path`."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable
from dataclasses import asdict
from typing import Any, TypeAlias

import numpy as np

from evenroad._arrays import Floats
from evenroad._files import Json
from evenroad._seal import has_digest, with_digest
from evenroad.errors import BrokenFile
from evenroad.saved.world_value import source_of
from evenroad.trajectory.car_states import CarTrajectory
from evenroad.trajectory.corners import MOST_STATES
from evenroad.trajectory.drive_limits import DriveLimits

FORMAT = "evenroad car trajectory 1"
FRAME = "map"
"""Frame of the poses in messages, as navigation calls that of its map."""
PATH = "nav_msgs/msg/Path"
Message: TypeAlias = Any
"""A message of ROS 2, or a mapping of its fields."""
_SAME = 1e-6
"""Largest difference between the states of a file and those of its pieces, relative to the largest one."""


def nav_path(times: Floats, poses: Floats, make: Callable[..., Message]) -> Message:
    """Return poses x, y, angle, (n, 3), as ROS 2's ``nav_msgs/Path``, each with its time, (n,), as the stamp.

    `make` is called as ``make("std_msgs/msg/Header", stamp=..., frame_id=...)``.
    """

    def header(time: float) -> Message:
        seconds, nanoseconds = divmod(round(time * 1e9), 1_000_000_000)
        return make(
            "std_msgs/msg/Header",
            stamp=make("builtin_interfaces/msg/Time", sec=seconds, nanosec=nanoseconds),
            frame_id=FRAME,
        )

    def stamped(time: float, x: float, y: float, angle: float) -> Message:
        turned = {"x": 0.0, "y": 0.0, "z": math.sin(0.5 * angle), "w": math.cos(0.5 * angle)}
        pose = make(
            "geometry_msgs/msg/Pose",
            position=make("geometry_msgs/msg/Point", x=x, y=y, z=0.0),
            orientation=make("geometry_msgs/msg/Quaternion", **turned),
        )
        return make("geometry_msgs/msg/PoseStamped", header=header(time), pose=pose)

    rows = np.column_stack([times, poses]).tolist()
    return make(PATH, header=header(0.0), poses=[stamped(*row) for row in rows])


def car_csv(trajectory: CarTrajectory) -> bytes:
    """Return the states as a table: times, poses, and what a controller of a car takes."""
    header = "time [s],x,y,angle [rad],speed,angular speed [rad/s],curvature\n"
    driven = trajectory.states
    columns = (trajectory.times, driven.positions, driven.speeds, driven.velocities[:, 2], driven.curvatures)
    rows = np.column_stack(columns).tolist()
    return (header + "".join(",".join(map(repr, row)) + "\n" for row in rows)).encode()


def car_record(trajectory: CarTrajectory) -> dict[str, object]:
    """Return a car's trajectory as plain JSON values, for :func:`car_trajectory_of`."""
    texts = [[each if math.isfinite(each) else str(each) for each in row] for row in trajectory.pieces.tolist()]
    return {
        "format": FORMAT,
        "start": trajectory.start.tolist(),
        "pieces": texts,
        "limits": asdict(trajectory.limits),
        **{name: getattr(trajectory, name) for name in ("step", "deviation", "blends", "stops", "proof", "duration")},
        "times": trajectory.times.tolist(),
        "poses": trajectory.positions.tolist(),
        "speeds": trajectory.speeds.tolist(),
        **source_of(trajectory.source, trajectory.world),
    }


def car_json(trajectory: CarTrajectory) -> bytes:
    """Return a car's trajectory as JSON."""
    return (json.dumps(with_digest(car_record(trajectory)), allow_nan=False) + "\n").encode()


def car_trajectory_of(record: dict[str, Json], path: str | os.PathLike[str]) -> CarTrajectory:
    """Return the trajectory of a JSON record of a file, unchecked; BrokenFile if its numbers are inconsistent."""
    has_digest(record, path)
    try:
        trajectory = _from_record(record)
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise BrokenFile(f"{path} is a damaged trajectory: {error}") from error
    return trajectory


def _from_record(record: dict[str, Json]) -> CarTrajectory:
    pieces, start = np.array(record["pieces"], dtype=np.float64), np.array(record["start"], dtype=np.float64)
    step, source = float(record["step"]), record.get("source", {})
    if start.shape != (3,) or pieces.ndim != 2 or pieces.shape[1:] != (3,) or not np.isfinite(start).all():
        raise ValueError("start must be x, y, angle, and pieces rows of three numbers")
    spot = np.isinf(pieces[:, 0])
    if np.isnan(pieces).any() or (pieces[spot, 0] != pieces[spot, 1]).any() or np.isinf(pieces[~spot]).any():
        raise ValueError("pieces must be of numbers, and turns on the spot have one infinite curvature")
    if len(pieces) == 0 or not (np.isfinite(pieces[:, 2]) & (pieces[:, 2] != 0.0)).all():
        raise ValueError("every piece must have a length")
    limits = DriveLimits(**record["limits"])
    if spot.any() and None in (limits.angular_speed, limits.angular_acceleration):
        raise ValueError("turns on the spot must have limits")
    if not isinstance(source, dict) or not 0.0 < step < math.inf:
        raise ValueError("its source must be a mapping, and its step > 0")
    trajectory = CarTrajectory(
        start=start,
        pieces=pieces,
        limits=limits,
        step=step,
        deviation=float(record["deviation"]),
        blends=int(record["blends"]),
        stops=int(record["stops"]),
        source=source,
    )
    if not trajectory.duration / step < MOST_STATES:
        raise ValueError(f"there must be at most {MOST_STATES} states")
    poses, here = np.array(record["poses"], dtype=np.float64), trajectory.positions
    if poses.shape != here.shape or not np.abs(poses - here).max() <= _SAME * (1.0 + np.abs(here).max()):
        raise ValueError("its poses are not those of its pieces")
    return trajectory
