"""Files of roadmaps; those of arms hold their robot and static scene.  And reading a roadmap of any world."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, replace
from itertools import islice
from typing import Any

import numpy as np

from evenroad._checks import require_positive
from evenroad._npz import Arrays, Path, read_json, require_array
from evenroad.errors import BrokenFile, EvenroadError
from evenroad.geometry import Mesh, PointCloud, Pose, TriangleMesh
from evenroad.roadmap.npz import OF_ALL, point_roadmap, read_roadmap, write_roadmap
from evenroad.roadmap.point_roadmap import Roadmap
from evenroad.robot import Obstacle, Scene
from evenroad.robot.cache import robot_of, written
from evenroad.robot.prepared_robots import prepared
from evenroad.robot_roadmap.arm_roadmap import ArmRoadmap, read_only
from evenroad.robot_roadmap.turns import TURN
from evenroad.world.bisection import require_few_segments

_SETTINGS = ("resolution", "clearance")
_ARRAYS = ("milestones", "edges", "turns", "weights")
_SURFACES = ("surface_points", "surface_triangles")
"""Names of the arrays of clouds and meshes of the static scene, one after the other."""
_OF_ARMS = OF_ALL | {"robot", "scene", "settings", *_ARRAYS, *_SURFACES}
_SCENE = ("name", "obstacles", "allowed", "states", "limits")


def save_arm_roadmap(path: Path, roadmap: ArmRoadmap) -> None:
    """Write an arm's roadmap with its robot and its static scene."""
    settings = {name: getattr(roadmap, name) for name in _SETTINGS}
    arrays: Arrays = dict(
        robot=np.array(json.dumps(asdict(roadmap.robot), default=written)),
        scene=np.array(json.dumps(_scene_record(roadmap.scene))),
        settings=np.array(json.dumps(settings)),
        **_surfaces(roadmap.scene),
        **{name: getattr(roadmap, name) for name in _ARRAYS},
    )
    write_roadmap(path, arrays)


def load_roadmap(file: Path) -> Roadmap:
    """Read a roadmap that ``roadmap.save(file)`` wrote.

    Parameters
    ----------
    file : path-like
        A file of ``roadmap.save``; that of an arm holds the robot and its static scene, too.

    Returns
    -------
    Roadmap
        ``roadmap.within(world)`` refuses a world that it was not built for, and says what differs.

    Raises
    ------
    BrokenFile
        If the file is missing, is no such npz or was damaged, or comes from another version of evenroad.

    Examples
    --------
    >>> import evenroad as er
    >>> er.build_roadmap(er.ArmWorld("ur5"), er.draw("even", 32, 6)).save("ur5.roadmap")
    >>> er.load_roadmap("ur5.roadmap").robot.name
    'ur5'
    """
    arrays = read_roadmap(file, _OF_ARMS)
    if "robot" not in arrays:
        return point_roadmap(file, arrays)
    settings = read_json(file, "settings", arrays["settings"], _SETTINGS)
    try:
        robot, scene = robot_of(json.loads(str(arrays["robot"]))), _scene(file, arrays)
        fields: dict[str, Any] = {name: arrays[name] for name in _ARRAYS} | settings
        made = ArmRoadmap(robot=robot, scene=scene, **fields)
        _check(file, made)
    except BrokenFile:
        raise
    except EvenroadError as error:
        raise BrokenFile(f"{file}: {error}") from error
    except (TypeError, ValueError, LookupError, AttributeError, RecursionError) as error:
        raise BrokenFile(f"{file} lacks some of what a roadmap of an arm holds: {error!r}") from error
    return read_only(made)


def _check(path: Path, made: ArmRoadmap) -> None:
    """Raise BrokenFile unless milestones, edges and turns are possible for a roadmap of the robot."""
    dim, n, m = len(made.robot.group), len(made.milestones), len(made.edges)
    if not n:
        raise BrokenFile(f"{path}: it must have a milestone or more")
    require_positive("resolution", made.resolution)
    require_positive("clearance", made.clearance, or_zero=True)
    require_few_segments(made.resolution, prepared(made.robot).longest / made.resolution)
    require_array(path, "milestones", made.milestones, np.float64, (n, dim))
    require_array(path, "turns", made.turns, np.int8, (m, dim))
    require_array(path, "weights", made.weights, np.float64, (dim,))
    one = made.one_turn
    if not np.all((made.milestones >= one.low) & (made.milestones <= one.high)):
        raise BrokenFile(f"{path}: milestones must be within the ranges of their joints")
    if not (np.all(made.weights > 0.0) and np.isfinite(made.weights).all()):
        raise BrokenFile(f"{path}: weights must be finite and > 0")
    if np.any(made.turns[:, ~one.wraps]) or np.any(np.abs(made.turns) > 1):
        raise BrokenFile(f"{path}: edges must lead past their ends by at most one turn of {TURN:.3f}")


def _scene_record(scene: Scene) -> dict[str, Any]:
    return dict(
        name=scene.name,
        obstacles=[
            (o.name, o.shape, _size(o), o.xyz, o.rotation, o.cell, getattr(_surface(o), "name", ""), o.clearance)
            for o in scene.obstacles
        ],
        allowed=sorted(scene.allowed),
        states=scene.states,
        limits=scene.limits,
    )


def _surface(obstacle: Obstacle) -> TriangleMesh | None:
    return obstacle.body.triangles if isinstance(obstacle.body, Mesh) else None


def _size(obstacle: Obstacle) -> tuple[float, ...]:
    """Return the dimensions of a body: of a cloud its radius and number of points, of a mesh two numbers of rows."""
    if isinstance(obstacle.body, PointCloud):
        return obstacle.body.radius, len(obstacle.body.points)
    mesh = _surface(obstacle)
    return obstacle.size if mesh is None else (len(mesh.vertices), len(mesh.triangles))


def _surfaces(scene: Scene) -> Arrays:
    points, triangles = [np.empty((0, 3))], [np.empty((0, 3), dtype=np.int64)]
    for obstacle in scene.obstacles:
        if isinstance(obstacle.body, PointCloud):
            points.append(obstacle.body.points)
        elif (mesh := _surface(obstacle)) is not None:
            points.append(mesh.vertices)
            triangles.append(mesh.triangles)
    return {_SURFACES[0]: np.concatenate(points), _SURFACES[1]: np.concatenate(triangles)}


def _scene(path: Path, arrays: Arrays) -> Scene:
    record = read_json(path, "scene", arrays["scene"], _SCENE)
    points, triangles = (iter(arrays[name]) for name in _SURFACES)

    # Files of earlier versions have no clearance.
    def obstacle(
        name: str, shape: str, size: list[float], xyz: Any, rotation: Any, cell: bool, surface: str, more: float = 0.0
    ) -> Obstacle:
        pose = Pose(tuple(xyz), tuple(rotation))
        if shape == PointCloud.kind:
            return Obstacle(name, PointCloud(_rows(points, size[1]), size[0], pose=pose), cell, clearance=more)
        if shape == Mesh.kind:
            mesh = TriangleMesh(_rows(points, size[0]), _rows(triangles, size[1]), surface)
            return Obstacle(name, Mesh(mesh, pose=pose), cell, clearance=more)
        return replace(Obstacle.of(name, shape, size, xyz, rotation, cell), clearance=more)

    return Scene(
        tuple(obstacle(*fields) for fields in record["obstacles"]),
        name=record["name"],
        allowed=frozenset((link, name) for link, name in record["allowed"]),
        states=record["states"],
        limits={joint: (lower, upper) for joint, (lower, upper) in record["limits"].items()},
    )


def _rows(rows: Iterator[Any], count: float) -> Any:
    return np.array(list(islice(rows, int(count))))
