"""Formats of trajectories on disk: JSON, which can be read back, CSV, and ROS 2's JointTrajectory as YAML and as a bag.

`WRITERS` lists them.  The format of another vendor is a file beside ``urscript.py``, and a line in the list.
"""

from __future__ import annotations

import json
import math
import os
import tempfile
from collections.abc import Callable, Collection, Iterable, Sequence
from pathlib import Path
from typing import TypeAlias

import numpy as np
import yaml

from evenroad._arrays import Floats, set_fields
from evenroad._checks import require_extra
from evenroad._files import Json, atomic_write, read_json_file
from evenroad._seal import has_digest, with_digest
from evenroad.errors import BrokenFile, UnknownName
from evenroad.saved.world_value import source_of, world_of
from evenroad.trajectory.car_formats import FORMAT as OF_CARS
from evenroad.trajectory.car_formats import PATH, Message, car_csv, car_json, car_record, car_trajectory_of, nav_path
from evenroad.trajectory.car_states import CarTrajectory
from evenroad.trajectory.checked import require_within_limits
from evenroad.trajectory.corners import MOST_STATES
from evenroad.trajectory.limits import Limits
from evenroad.trajectory.trajectory import ON_MAPS, Trajectory
from evenroad.trajectory.urscript import movej_script, servoj_script

FORMAT = "evenroad trajectory 1"
TOPIC, PATH_TOPIC = "/joint_trajectory", "/plan"
_TABLES = ("positions", "velocities", "accelerations")
MESSAGE = "trajectory_msgs/msg/JointTrajectory"


Saved: TypeAlias = Trajectory | CarTrajectory
"""A trajectory of an arm or a disk, or of a car."""


def save_trajectory(path: str | os.PathLike[str], trajectory: Saved, order: Sequence[str] | None = None) -> None:
    """Write a trajectory in the format of the file's suffix, atomically.

    Parameters
    ----------
    path : str or path-like
        ``.json`` (read by :func:`load_trajectory`), ``.csv``, ``.yaml`` (ROS 2's ``trajectory_msgs/JointTrajectory``),
        ``.mcap`` (the same as a bag, on the topic ``/joint_trajectory``; extra ``ros``), ``.script`` (URScript, timed)
        or ``.movej.script`` (URScript, by waypoints).  Robots on maps have the first four, and ROS 2's
        ``nav_msgs/Path`` in place of joints.
    trajectory : Trajectory or CarTrajectory
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
    paths: Iterable[str | os.PathLike[str]], trajectory: Saved, order: Sequence[str] | None = None
) -> None:
    """Write a trajectory to several files by :func:`save_trajectory`; to none if one format cannot express it."""
    if isinstance(trajectory, CarTrajectory):
        contents = [(path, CAR_WRITERS[format_of(path, CAR_WRITERS)](trajectory)) for path in paths]
    else:
        contents = [(path, WRITERS[format_of(path)](trajectory, order)) for path in paths]
    for path, data in contents:
        with atomic_write(path) as file:
            file.write(data)


def format_of(path: str | os.PathLike[str], writers: Collection[str] | None = None) -> str:
    """Return the suffix of a file for trajectories, by default of arms, or raise UnknownName."""
    name, suffixes = Path(path).name.lower(), WRITERS if writers is None else writers
    known = [suffix for suffix in suffixes if name.endswith(suffix) and name != suffix]
    if not known:
        raise UnknownName.among("format of a trajectory", Path(path).suffix or str(path), suffixes)
    return max(known, key=len)


def load_trajectory(path: str | os.PathLike[str]) -> Saved:
    """Read a trajectory from the JSON of :func:`save_trajectory`.

    It has not been checked in a world: its `proof` is ``unchecked`` until :func:`proved_in`.  Raises BrokenFile if it
    is damaged, its numbers are inconsistent, or they violate its own limits.
    """
    return saved_of(read_json_file(path, "trajectory"), path)


def saved_of(record: Json, path: str | os.PathLike[str]) -> Saved:
    """Return the trajectory of an arm, a disk or a car of a JSON record of a file; errors as :func:`trajectory_of`."""
    is_of_car = isinstance(record, dict) and record.get("format") == OF_CARS
    trajectory = car_trajectory_of(record, path) if is_of_car else trajectory_of(record, path)
    if trajectory.source.get("world") is not None:
        set_fields(trajectory, world=world_of(trajectory.source["world"], path))
    return trajectory


def trajectory_of(record: Json, path: str | os.PathLike[str]) -> Trajectory:
    """Return the trajectory of a JSON record of a file; BrokenFile if its numbers are inconsistent."""
    if not isinstance(record, dict) or record.get("format") != FORMAT:
        if isinstance(record, dict) and str(record.get("format")).startswith("evenroad flight "):
            raise BrokenFile(f"{path} has the polynomials of a flight, without its world: view its plan instead")
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
        **source_of(trajectory.source, trajectory.world),
    }


def record_of(trajectory: Saved) -> dict[str, object]:
    """Return a trajectory as plain JSON values for :func:`saved_of`."""
    return car_record(trajectory) if isinstance(trajectory, CarTrajectory) else trajectory_record(trajectory)


def _json(trajectory: Trajectory, order: Sequence[str] | None) -> bytes:
    return (json.dumps(with_digest(trajectory_record(trajectory, order)), allow_nan=False) + "\n").encode()


def _csv(trajectory: Trajectory, order: Sequence[str] | None) -> bytes:
    names, tables = trajectory.columns(order)
    of, units = "" if _is_on_map(trajectory) else " [rad or m]", ("", "/s", "/s^2")
    header = ["time [s]", *(f"{name}{of}{unit}" for unit in units for name in names)]
    rows = np.column_stack([trajectory.times, *tables]).tolist()
    lines = [header, *(map(repr, row) for row in rows)]
    return "".join(",".join(line) + "\n" for line in lines).encode()


def _text(message: Message) -> bytes:
    dumper = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
    text: str = yaml.dump(message, Dumper=dumper, sort_keys=False, default_flow_style=None, width=1000)
    return text.encode()


def _yaml(trajectory: Trajectory, order: Sequence[str] | None) -> bytes:
    if _is_on_map(trajectory):
        return _text(_path_of(trajectory, lambda _, **fields: fields))
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
    return _text({"header": header, "joint_names": list(names), "points": points})


def _is_on_map(trajectory: Saved) -> bool:
    """Return whether it is of a robot on a map; an arm, which may have joints of such names, has a controller."""
    if isinstance(trajectory, CarTrajectory):
        return True
    return trajectory.names in (ON_MAPS[:2], ON_MAPS) and not trajectory.controller


def _path_of(trajectory: Saved, make: Callable[..., Message]) -> Message:
    """Return the trajectory of a robot on a map as ``nav_msgs/Path``: a disk has no heading."""
    poses = trajectory.positions
    return nav_path(trajectory.times, poses if poses.shape[1] == 3 else np.pad(poses, ((0, 0), (0, 1))), make)


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


def _mcap(trajectory: Saved, order: Sequence[str] | None = None) -> bytes:
    rosbags = require_extra("rosbags.rosbag2", "ros", "a bag of ROS 2")
    stores = require_extra("rosbags.typesys", "ros", "a bag of ROS 2")
    store = stores.get_typestore(stores.Stores.ROS2_HUMBLE)

    def make(kind: str, **fields: object) -> Message:
        return store.types[kind](**fields)

    if _is_on_map(trajectory):
        message, kind, topic = _path_of(trajectory, make), PATH, PATH_TOPIC
    else:
        assert isinstance(trajectory, Trajectory), "a car is on a map"
        message, kind, topic = joint_trajectory(trajectory, make, order), MESSAGE, TOPIC
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / "bag"
        with rosbags.Writer(bag, version=9, storage_plugin=rosbags.StoragePlugin.MCAP) as writer:
            connection = writer.add_connection(topic, kind, typestore=store)
            writer.write(connection, 0, store.serialize_cdr(message, kind))
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
CAR_WRITERS: dict[str, Callable[[CarTrajectory], bytes]] = {
    ".json": car_json,
    ".csv": car_csv,
    ".yaml": lambda trajectory: _text(_path_of(trajectory, lambda _, **fields: fields)),
    ".mcap": _mcap,
}
"""The same for cars."""
