"""Waypoints from the files of other planners: CSV, ROS 2's JointTrajectory as YAML or in a bag, and evenroad's JSON."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evenroad._arrays import Floats, set_fields
from evenroad._checks import as_file, require_extra
from evenroad._files import not_a, read_json_file, read_known
from evenroad._understood import Kind, require_understood
from evenroad._yaml import read_mapping
from evenroad.errors import BrokenFile, UnknownName, shown
from evenroad.trajectory.formats import FORMAT, MESSAGE, trajectory_of

MOST_NUMBERS = 50_000_000
"""Largest number of values of a path."""
_UNIT = re.compile(r"\s*\[(?P<unit>[^\]]*)\](?P<per>/s(\^2)?)?$")
"""The end of a column's name that says its unit, as ``[rad or m]/s``."""
_RATES = re.compile(r"\.(velocity|velocities|acceleration|accelerations|effort)$|_(vel|acc|effort)$")
"""The end of a column's name that says that it is no position."""
_TIMES = frozenset(("time", "t", "timestamp", "time_from_start", "sec", "seconds"))
_POINT = Kind(("positions",), harmless=("velocities", "accelerations", "effort", "time_from_start"))
_TRAJECTORY = Kind(("joint_names",), {"points": _POINT}, harmless=("header",))
_ROBOT_TRAJECTORY = Kind(
    parts={"joint_trajectory": _TRAJECTORY},
    refused={"multi_dof_joint_trajectory": "a path is of joints that have one value each"},
)


@dataclass(frozen=True, eq=False)
class Waypoints:
    """The waypoints of a file, (n, columns), and the joints that the columns are of; none where it does not say."""

    positions: Floats
    joints: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        positions = np.array(self.positions, dtype=np.float64)
        positions.setflags(write=False)
        set_fields(self, positions=positions)


def read_waypoints(path: object) -> Waypoints:
    """Return the waypoints of a file by its suffix.

    ``.csv`` and ``.txt``: numbers with commas, semicolons or spaces between them, under joints' names or without;
    columns of times, velocities and accelerations are not looked at.  ``.yaml``: a JointTrajectory, or MoveIt's
    RobotTrajectory.  ``.mcap``: a bag with one JointTrajectory.  ``.json``: a plan or a trajectory of evenroad.

    Raises UnknownName for another suffix or a key that is not known, BrokenFile if the file is damaged, NotAvailable if
    a bag needs rosbags.
    """
    file = as_file("a path", path, "or give its waypoints, an array")
    known = [suffix for suffix in READERS if file.name.lower().endswith(suffix)]
    if not known:
        raise UnknownName.among("format of a path", file.suffix or str(file), READERS)
    found = READERS[known[0]](file)
    if found.positions.ndim != 2 or 0 in found.positions.shape or found.positions.size > MOST_NUMBERS:
        raise BrokenFile(f"{file} must have one waypoint or more of one joint or more, got {found.positions.shape}")
    if not np.isfinite(found.positions).all():
        raise BrokenFile(f"{file} must have finite numbers: waypoint {_first_not_finite(found.positions)} has none")
    names = found.joints
    if len(set(names)) < len(names):
        raise BrokenFile(f"{file} names joint {next(each for each in names if names.count(each) > 1)!r} twice")
    return found


def _first_not_finite(positions: Floats) -> int:
    return int(np.flatnonzero(~np.isfinite(positions).all(axis=1))[0])


def _csv(file: Path) -> Waypoints:
    try:
        lines = [line for line in read_known(file, "path").decode("utf-8-sig").splitlines() if line.strip()]
        rows = list(_cells(lines))
    except (UnicodeDecodeError, csv.Error) as error:
        raise not_a("a table of text", file, str(error)) from error
    if not rows:
        raise BrokenFile(f"{file} is empty: a path has one waypoint or more")
    named = not all(map(_is_number, rows[0]))
    columns = _columns(rows[0], file) if named else dict(enumerate([""] * len(rows[0])))
    width, body = len(rows[0]), rows[named:]
    for number, row in enumerate(body):
        if len(row) != width or not all(_is_number(row[column]) for column in columns):
            raise BrokenFile(f"{file} must have {width} numbers in each line, got {shown(row)} for waypoint {number}")
    positions = np.array([[float(row[column]) for column in columns] for row in body]).reshape(len(body), len(columns))
    return Waypoints(positions, tuple(columns.values()) if named else ())


def _cells(lines: Sequence[str]) -> Iterable[list[str]]:
    """Yield the cells of each line; comments begin with #."""
    kept = [line for line in lines if not line.startswith("#")]
    mark = next((each for each in (",", ";", "\t") if kept and each in kept[0]), None)
    if mark is None:
        yield from (line.split() for line in kept)
        return
    for row in csv.reader(kept, delimiter=mark, skipinitialspace=True):
        yield [cell.strip() for cell in (row[:-1] if row[-1:] == [""] else row)]


def _columns(header: Sequence[str], file: Path) -> dict[int, str]:
    """Return the columns of positions, number -> joint."""
    columns: dict[int, str] = {}
    for number, cell in enumerate(header):
        unit = _UNIT.search(cell)
        name = cell[: unit.start()] if unit else cell
        if name.lower() in _TIMES or _RATES.search(name) or (unit and unit["per"]):
            continue
        if unit and "deg" in unit["unit"].lower():
            raise BrokenFile(f"{file} has {name!r} in degrees: angles must be in radians")
        columns[number] = name.removesuffix(".position")
    if not columns:
        raise BrokenFile(f"{file} names no joint in its first line: {shown(','.join(header))}")
    return columns


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _yaml(file: Path) -> Waypoints:
    document = read_mapping(file, "trajectory")
    whole = "joint_trajectory" in document
    require_understood(document, _ROBOT_TRAJECTORY if whole else _TRAJECTORY, str(file))
    message = document["joint_trajectory"] if whole else document
    if not isinstance(message, Mapping):
        raise BrokenFile(f"{file} must have a mapping as its joint_trajectory, got {shown(message)}")
    names, points = message.get("joint_names"), message.get("points")
    if not isinstance(names, list) or not isinstance(points, list) or not points:
        raise BrokenFile(f"{file} must have joint_names and points, lists, as a JointTrajectory has")
    if not all(isinstance(point, Mapping) for point in points):
        raise BrokenFile(f"{file} must have a mapping with positions for each of its points")
    return _of_message(file, [str(name) for name in names], [point.get("positions") for point in points])


def _of_message(file: Path, names: Sequence[str], positions: Sequence[object]) -> Waypoints:
    """Return the waypoints of a message; BrokenFile where a point has another number of positions."""
    for number, row in enumerate(positions):
        plain = isinstance(row, list) and all(isinstance(each, int | float) for each in row)
        if not plain or len(row) != len(names):  # type: ignore[arg-type]
            wanted = f"a position of each of its {len(names)} joints"
            raise BrokenFile(f"{file} must have {wanted} for each point, got {shown(row)} for point {number}")
    try:
        return Waypoints(np.array(positions, dtype=np.float64), tuple(names))
    except OverflowError as error:
        raise BrokenFile(f"{file} has a number that is too large: {error}") from error


def _mcap(file: Path) -> Waypoints:
    storage = require_extra("rosbags.rosbag2.storage_mcap", "ros", "a bag of ROS 2")
    stores = require_extra("rosbags.typesys", "ros", "a bag of ROS 2")
    store = stores.get_typestore(stores.Stores.ROS2_HUMBLE)
    reader = storage.McapReader(file)
    try:
        reader.open()
        try:
            there = [each for each in reader.connections if each.msgtype == MESSAGE]
            raws = [raw for _, _, raw in reader.messages(there)] if there else []
        finally:
            reader.close()
    except Exception as error:
        raise not_a("a bag of ROS 2", file, str(error)) from error
    if len(raws) != 1:
        raise BrokenFile(f"{file} must hold one {MESSAGE}, got {len(raws)}")
    message = store.deserialize_cdr(raws[0], MESSAGE)
    return _of_message(file, list(message.joint_names), [point.positions.tolist() for point in message.points])


def _json(file: Path) -> Waypoints:
    record = read_json_file(file, "plan or trajectory")
    if isinstance(record, dict) and record.get("format") == FORMAT:
        trajectory = trajectory_of(record, file)
        return Waypoints(trajectory.positions, trajectory.names)
    query = record.get("query") if isinstance(record, dict) else None
    joints = query.get("joints") if isinstance(query, dict) else None
    path = record.get("path") if isinstance(record, dict) else None
    if path is None:
        raise BrokenFile(f"{file} has no path: it must be a plan or a trajectory of evenroad that has one")
    try:
        return Waypoints(np.array(path, dtype=np.float64), tuple(map(str, joints or ())))
    except (TypeError, ValueError) as error:
        raise BrokenFile(f"{file} has a damaged path: {error}") from error


READERS: dict[str, Callable[[Path], Waypoints]] = {
    **dict.fromkeys((".csv", ".txt"), _csv),
    **dict.fromkeys((".yaml", ".yml"), _yaml),
    ".mcap": _mcap,
    ".json": _json,
}
"""Suffix -> function that reads a file."""
