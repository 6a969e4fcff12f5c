"""Roadmaps of robots on disk: one .npz that knows its robot and its cell, checked on load."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict
from itertools import islice
from typing import Any

import numpy as np

from evenroad import __version__
from evenroad._checks import require_positive
from evenroad._npz import Arrays, Path, digest, read_json, read_npz, require_array, write_npz
from evenroad.errors import BrokenFile, EvenroadError, InvalidValue
from evenroad.geometry import Mesh, PointCloud, Pose, TriangleMesh
from evenroad.robot import Obstacle, Robot, Scene
from evenroad.robot.cache import robot_of
from evenroad.robot.known_robots import prepared
from evenroad.robot.robot import require_robot
from evenroad.robot_roadmap.cell import require_same_cell, require_same_robot
from evenroad.robot_roadmap.robot_roadmap import RobotRoadmap
from evenroad.robot_roadmap.turns import TURN
from evenroad.world.bisection import require_few_segments

FORMAT = 3
_SETTINGS = ("resolution", "gamma", "ends")
_ARRAYS = ("milestones", "edges", "turns", "weights")
_SURFACES = ("points", "triangles")
"""Of the cell's clouds and meshes, one after the other."""
_NAMES = {"format", "version", "robot", "cell", "settings", "digest", *_ARRAYS, *_SURFACES}
_CELL = ("name", "obstacles", "allowed", "states", "limits")


def save_robot_roadmap(path: Path, roadmap: RobotRoadmap) -> None:
    """Write a robot's roadmap with its robot and its cell, atomically.

    Raises BrokenFile if the file cannot be written; whatever was at `path` is then untouched.
    """
    settings = {name: getattr(roadmap, name) for name in _SETTINGS}
    arrays: Arrays = dict(
        format=np.array(FORMAT),
        version=np.array(__version__),
        robot=np.array(json.dumps(asdict(roadmap.robot), default=np.ndarray.tolist)),
        cell=np.array(json.dumps(_cell_record(roadmap.cell))),
        settings=np.array(json.dumps(settings)),
        **_surfaces(roadmap.cell),
        **{name: getattr(roadmap, name) for name in _ARRAYS},
    )
    write_npz(path, arrays | {"digest": np.array(digest(arrays))}, compressed=True)


def load_robot_roadmap(path: Path, robot: Robot | None = None, cell: Scene | None = None) -> RobotRoadmap:
    """Read a roadmap written by :func:`save_robot_roadmap`.

    Parameters
    ----------
    path : path-like
        The file.
    robot, cell : Robot and Scene, optional
        What it has to have been made for; the file knows both itself.

    Raises
    ------
    BrokenFile
        If the file is missing, is no such npz or was damaged, or comes from another version of evenroad.
    InvalidValue
        If it was made for another robot, tool, group or cell; the text says what differs.
    """
    if robot is not None:
        require_robot(robot)
    arrays = read_npz(path, "roadmap of a robot", _NAMES)
    expected = str(arrays.pop("digest"))
    if digest(arrays) != expected:
        raise BrokenFile(f"{path}: its content does not match its digest; the file was changed or damaged")
    made_by = arrays["format"].tolist(), str(arrays["version"])
    if made_by != (FORMAT, __version__):
        raise BrokenFile(
            f"{path} has format {made_by[0]} of evenroad {made_by[1]}, this is format {FORMAT} of {__version__}:"
            " make the roadmap anew, since what it calls free was checked by that version"
        )
    settings = read_json(path, "settings", arrays["settings"], _SETTINGS)
    try:
        made_robot, made_cell = robot_of(json.loads(str(arrays["robot"]))), _cell(path, arrays)
        fields: dict[str, Any] = {name: arrays[name] for name in _ARRAYS} | settings
        made = RobotRoadmap(robot=made_robot, cell=made_cell, **fields)
        _check(path, made)
    except BrokenFile:
        raise
    except EvenroadError as error:
        raise BrokenFile(f"{path}: {error}") from error
    except (TypeError, ValueError, LookupError, AttributeError, RecursionError) as error:
        raise BrokenFile(f"{path} lacks some of what a roadmap of a robot holds: {error!r}") from error
    if cell is not None:
        require_same_cell(made.cell, cell)
    if robot is not None:
        try:
            require_same_robot(made.robot, made.cell, robot)
        except InvalidValue as error:
            raise InvalidValue(f"{path}: {error}") from None
    for name in _ARRAYS:
        arrays[name].setflags(write=False)
    return made


def _check(path: Path, made: RobotRoadmap) -> None:
    """Raise BrokenFile unless milestones, edges and turns are what a roadmap of the robot can have."""
    dim, n, m = len(made.robot.group), len(made.milestones), len(made.edges)
    if not n:
        raise BrokenFile(f"{path}: it must have a milestone or more")
    require_positive("resolution", made.resolution)
    require_few_segments(made.resolution, prepared(made.robot).longest / made.resolution)
    require_array(path, "milestones", made.milestones, np.float64, (n, dim))
    require_array(path, "edges", made.edges, np.int32, (m, 2))
    require_array(path, "turns", made.turns, np.int8, (m, dim))
    require_array(path, "weights", made.weights, np.float64, (dim,))
    one = made.one_turn
    if not np.all((made.milestones >= one.low) & (made.milestones <= one.high)):
        raise BrokenFile(f"{path}: milestones must be within the ranges of their joints")
    if not (np.all(made.weights > 0.0) and np.isfinite(made.weights).all()):
        raise BrokenFile(f"{path}: weights must be finite and > 0")
    if m and not (made.edges.min() >= 0 and made.edges.max() < n):
        raise BrokenFile(f"{path}: edges must join milestones 0 .. {n - 1}")
    if np.any(made.turns[:, ~one.wraps]) or np.any(np.abs(made.turns) > 1):
        raise BrokenFile(f"{path}: edges must lead past their ends by at most one turn of {TURN:.3f}")


def _cell_record(cell: Scene) -> dict[str, Any]:
    return dict(
        name=cell.name,
        obstacles=[
            (o.name, o.shape, _size(o), o.xyz, o.rotation, o.cell, getattr(_surface(o), "name", ""))
            for o in cell.obstacles
        ],
        allowed=sorted(cell.allowed),
        states=cell.states,
        limits=cell.limits,
    )


def _surface(obstacle: Obstacle) -> TriangleMesh | None:
    return obstacle.body.triangles if isinstance(obstacle.body, Mesh) else None


def _size(obstacle: Obstacle) -> tuple[float, ...]:
    """Return the dimensions of a body; of a cloud its radius and number of points, of a mesh two numbers of rows."""
    if isinstance(obstacle.body, PointCloud):
        return obstacle.body.radius, len(obstacle.body.points)
    mesh = _surface(obstacle)
    return obstacle.size if mesh is None else (len(mesh.vertices), len(mesh.triangles))


def _surfaces(cell: Scene) -> Arrays:
    points, triangles = [np.empty((0, 3))], [np.empty((0, 3), dtype=np.int64)]
    for obstacle in cell.obstacles:
        if isinstance(obstacle.body, PointCloud):
            points.append(obstacle.body.points)
        elif (mesh := _surface(obstacle)) is not None:
            points.append(mesh.vertices)
            triangles.append(mesh.triangles)
    return {"points": np.concatenate(points), "triangles": np.concatenate(triangles)}


def _cell(path: Path, arrays: Arrays) -> Scene:
    record = read_json(path, "cell", arrays["cell"], _CELL)
    points, triangles = iter(arrays["points"]), iter(arrays["triangles"])

    def obstacle(
        name: str, shape: str, size: list[float], xyz: Any, rotation: Any, cell: bool, surface: str
    ) -> Obstacle:
        pose = Pose(tuple(xyz), tuple(rotation))
        if shape == PointCloud.kind:
            return Obstacle(name, PointCloud(_rows(points, size[1]), size[0], pose=pose), cell)
        if shape == Mesh.kind:
            mesh = TriangleMesh(_rows(points, size[0]), _rows(triangles, size[1]), surface)
            return Obstacle(name, Mesh(mesh, pose=pose), cell)
        return Obstacle.of(name, shape, size, xyz, rotation, cell)

    return Scene(
        tuple(obstacle(*fields) for fields in record["obstacles"]),
        name=record["name"],
        allowed=frozenset((link, name) for link, name in record["allowed"]),
        states=record["states"],
        limits={joint: (lower, upper) for joint, (lower, upper) in record["limits"].items()},
    )


def _rows(rows: Iterator[Any], count: float) -> Any:
    return np.array(list(islice(rows, int(count))))
