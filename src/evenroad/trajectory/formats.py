"""Formats of trajectories on disk: JSON, which can be read back, CSV, and ROS 2's JointTrajectory as YAML and as a bag.

`WRITERS` lists them.  The format of another vendor is a file beside ``urscript.py``, and a line in the list.
"""

from __future__ import annotations

import json
import math
import os
import tempfile
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import yaml

from evenroad._arrays import Floats
from evenroad._checks import require_extra
from evenroad._files import Json, atomic_write, read_json_file
from evenroad._seal import has_digest, with_digest
from evenroad.errors import BrokenFile, UnknownName
from evenroad.trajectory.checked import require_within_limits
from evenroad.trajectory.corners import MOST_STATES
from evenroad.trajectory.limits import Limits
from evenroad.trajectory.trajectory import Trajectory
from evenroad.trajectory.urscript import movej_script, servoj_script

FORMAT = "evenroad trajectory 1"
TOPIC = "/joint_trajectory"
Message: TypeAlias = Any
"""A message of ROS 2; its types are made at run time."""
_TABLES = ("positions", "velocities", "accelerations")
MESSAGE = "trajectory_msgs/msg/JointTrajectory"


def save_trajectory(path: str | os.PathLike[str], trajectory: Trajectory, order: Sequence[str] | None = None) -> None:
    """Write a trajectory in the format of the file's suffix, atomically.

    Parameters
    ----------
    path : str or path-like
        ``.json`` (read by :func:`load_trajectory`), ``.csv``, ``.yaml`` (ROS 2's ``trajectory_msgs/JointTrajectory``),
        ``.mcap`` (the same as a bag, on the topic ``/joint_trajectory``; extra ``ros``), ``.script`` (URScript, timed)
        or ``.movej.script`` (URScript, by waypoints).
    trajectory : Trajectory
    order : sequence of str, optional
        The joints of the controller, in its order; default: moving joints, then held ones.

    Raises
    ------
    UnknownName
        For another suffix, or a joint that the trajectory does not have.
    InvalidValue
        If a moving joint is missing, or a URScript does not have six joints.
    NotAvailable
        If rosbags is not installed.
    BrokenFile
        If the file cannot be written.
    """
    save_trajectories([path], trajectory, order)


def save_trajectories(
    paths: Iterable[str | os.PathLike[str]], trajectory: Trajectory, order: Sequence[str] | None = None
) -> None:
    """Write a trajectory to several files by :func:`save_trajectory`; to none if one format cannot express it."""
    contents = [(path, WRITERS[format_of(path)](trajectory, order)) for path in paths]
    for path, data in contents:
        with atomic_write(path) as file:
            file.write(data)


def format_of(path: str | os.PathLike[str]) -> str:
    """Return the suffix of a file for trajectories, or raise UnknownName."""
    name = Path(path).name.lower()
    known = [suffix for suffix in WRITERS if name.endswith(suffix) and name != suffix]
    if not known:
        raise UnknownName.among("format of a trajectory", Path(path).suffix or str(path), WRITERS)
    return max(known, key=len)


def load_trajectory(path: str | os.PathLike[str]) -> Trajectory:
    """Read a trajectory from the JSON of :func:`save_trajectory`.

    It has not been checked in a world: its `proof` is ``unchecked`` until :func:`proved_in`.  Raises BrokenFile if it
    is damaged, its numbers are inconsistent, or they violate its own limits.
    """
    return trajectory_of(read_json_file(path, "trajectory"), path)


def trajectory_of(record: Json, path: str | os.PathLike[str]) -> Trajectory:
    """Return the trajectory of a JSON record of a file; BrokenFile if its numbers are inconsistent."""
    if not isinstance(record, dict) or record.get("format") != FORMAT:
        wrote = "as `evenroad plan --trajectory` writes it"
        raise BrokenFile(f"{path} is not a trajectory: its 'format' must be {FORMAT!r}, {wrote}")
    has_digest(record, path)
    try:
        return _from_record(record)
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise BrokenFile(f"{path} is a damaged trajectory: {error}") from error


def _from_record(record: Json) -> Trajectory:
    names = tuple(map(str, record["joint_names"]))
    limits = Limits(**record["limits"])
    times = np.array(record["times"], dtype=np.float64)
    tables = [np.array(record[name], dtype=np.float64) for name in _TABLES]
    shape = (len(times), len(names))
    waypoints = np.array(record["waypoints"], dtype=np.float64)
    radii = tuple(map(float, record["radii"]))
    if waypoints.ndim != 2 or len(waypoints) < 2 or waypoints.shape[1] != len(names):
        raise ValueError("waypoints must have one number a joint")
    if len(times) < 1 or len(limits.velocity) != len(names) or any(table.shape != shape for table in tables):
        raise ValueError(f"times, joint_names, limits and states must belong together, {shape}")
    if len(times) > MOST_STATES:
        raise ValueError(f"there must be at most {MOST_STATES} states")
    if not all(np.isfinite(table).all() for table in (times, waypoints, *tables)):
        raise ValueError("states must be finite numbers")
    steps = np.diff(times)
    if times[0] != 0.0 or (steps <= 0.0).any() or not np.allclose(steps, steps[:1], rtol=1e-6, atol=0.0):
        raise ValueError("times must begin with 0 and grow by equal steps")
    if len(radii) not in (0, len(waypoints) - 2) or not all(0.0 <= radius < math.inf for radius in radii):
        raise ValueError("radii must be one number >= 0 for each waypoint within the path, or none")
    held = {str(name): float(value) for name, value in record["held"].items()}
    if not all(map(math.isfinite, held.values())):
        raise ValueError("positions of held joints must be finite numbers")
    if len(set(names) | set(held)) < len(names) + len(held):
        raise ValueError("every joint must be named once")
    source = record.get("source", {})
    if not isinstance(source, dict):
        raise ValueError("its source must be a mapping")
    trajectory = Trajectory(
        names=names,
        times=times,
        positions=tables[0],
        velocities=tables[1],
        accelerations=tables[2],
        waypoints=waypoints,
        limits=limits,
        deviation=float(record["deviation"]),
        stops=int(record["stops"]),
        highest={str(kind): float(share) for kind, share in record["highest"].items()},
        held=held,
        controller=tuple(map(str, record["controller"])),
        radii=radii,
        source=source,
    )
    require_within_limits(trajectory)
    return trajectory


def trajectory_record(trajectory: Trajectory, order: Sequence[str] | None = None) -> dict[str, object]:
    """Return a trajectory as plain JSON values for :func:`load_trajectory`."""
    kinds = "velocity", "acceleration", "jerk", "deceleration"
    limits = {
        kind: value for kind in kinds if (value := getattr(trajectory.limits, kind)) is not None or kind == "jerk"
    }
    return {
        "format": FORMAT,
        "units": {"time": "s", "angle": "rad", "length": "m"},
        "joint_names": list(trajectory.names),
        "held": dict(trajectory.held),
        "controller": trajectory.columns(order)[0],
        "limits": limits,
        "duration": trajectory.duration,
        "deviation": trajectory.deviation,
        "stops": trajectory.stops,
        "highest": dict(trajectory.highest),
        "proof": trajectory.proof,
        "radii": trajectory.radii,
        "waypoints": trajectory.waypoints.tolist(),
        "times": trajectory.times.tolist(),
        **{name: getattr(trajectory, name).tolist() for name in _TABLES},
        **({"source": dict(trajectory.source)} if trajectory.source else {}),
    }


def _json(trajectory: Trajectory, order: Sequence[str] | None) -> bytes:
    return (json.dumps(with_digest(trajectory_record(trajectory, order)), allow_nan=False) + "\n").encode()


def _csv(trajectory: Trajectory, order: Sequence[str] | None) -> bytes:
    names, tables = trajectory.columns(order)
    units = ("", "/s", "/s^2")
    header = ["time [s]", *(f"{name} [rad or m]{unit}" for unit in units for name in names)]
    rows = np.column_stack([trajectory.times, *tables]).tolist()
    lines = [header, *(map(repr, row) for row in rows)]
    return "".join(",".join(line) + "\n" for line in lines).encode()


def _yaml(trajectory: Trajectory, order: Sequence[str] | None) -> bytes:
    names, tables = trajectory.columns(order)
    points = [
        {
            **dict(zip(_TABLES, (row.tolist() for row in rows), strict=True)),
            "effort": [],
            "time_from_start": dict(zip(("sec", "nanosec"), _stamp(time), strict=True)),
        }
        for time, *rows in zip(trajectory.times, *tables, strict=True)
    ]
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}
    message = {"header": header, "joint_names": list(names), "points": points}
    dumper = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
    text: str = yaml.dump(message, Dumper=dumper, sort_keys=False, default_flow_style=None, width=1000)
    return text.encode()


def joint_trajectory(
    trajectory: Trajectory, make: Callable[..., Message], order: Sequence[str] | None = None
) -> Message:
    """Return a trajectory as ROS 2's ``trajectory_msgs/JointTrajectory``.

    Parameters
    ----------
    trajectory, order
        As for :func:`save_trajectory`.
    make : callable
        Maker of messages, called as ``make("std_msgs/msg/Header", stamp=..., frame_id=...)``.
    """
    names, tables = trajectory.columns(order)

    def point(time: float, *rows: Floats) -> Message:
        fields = dict(zip(_TABLES, rows, strict=True))
        since = dict(zip(("sec", "nanosec"), _stamp(time), strict=True))
        duration = make("builtin_interfaces/msg/Duration", **since)
        return make("trajectory_msgs/msg/JointTrajectoryPoint", **fields, effort=np.zeros(0), time_from_start=duration)

    header = make("std_msgs/msg/Header", stamp=make("builtin_interfaces/msg/Time", sec=0, nanosec=0), frame_id="")
    points = [point(time, *rows) for time, *rows in zip(trajectory.times, *tables, strict=True)]
    return make(MESSAGE, header=header, joint_names=list(names), points=points)


def _mcap(trajectory: Trajectory, order: Sequence[str] | None) -> bytes:
    rosbags = require_extra("rosbags.rosbag2", "ros", "a bag of ROS 2")
    stores = require_extra("rosbags.typesys", "ros", "a bag of ROS 2")
    store = stores.get_typestore(stores.Stores.ROS2_HUMBLE)
    message = joint_trajectory(trajectory, lambda kind, **fields: store.types[kind](**fields), order)
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / "bag"
        with rosbags.Writer(bag, version=9, storage_plugin=rosbags.StoragePlugin.MCAP) as writer:
            connection = writer.add_connection(TOPIC, MESSAGE, typestore=store)
            writer.write(connection, 0, store.serialize_cdr(message, MESSAGE))
        return (bag / "bag.mcap").read_bytes()


def _stamp(time: float) -> tuple[int, int]:
    """Return whole seconds and nanoseconds."""
    return divmod(round(time * 1e9), 1_000_000_000)


WRITERS: dict[str, Callable[[Trajectory, Sequence[str] | None], bytes]] = {
    ".json": _json,
    ".csv": _csv,
    ".yaml": _yaml,
    ".mcap": _mcap,
    ".script": lambda trajectory, order: servoj_script(trajectory, order).encode(),
    ".movej.script": lambda trajectory, order: movej_script(trajectory, order).encode(),
}
"""Suffix -> function that returns the contents of a file."""
