"""``er.load``: whatever evenroad or others wrote to a file, by its suffix and its content."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from evenroad._call import explains_calls
from evenroad._checks import as_file
from evenroad._files import read_json_file, read_known
from evenroad.errors import BrokenFile, InvalidValue, UnknownName, shown

if TYPE_CHECKING:
    from evenroad.driving.polygon_map import PolygonMap
    from evenroad.flight.flight_trajectory import FlightTrajectory
    from evenroad.planning.result import PlanResult
    from evenroad.points.pointset import PointSet
    from evenroad.roadmap.roadmap import Roadmap
    from evenroad.scenes.scene import Scene
    from evenroad.task.result import TaskResult
    from evenroad.trajectory.formats import Saved
    from evenroad.world.gridmap import GridMap

_POLYGONS = ".geojson"
_POINTS = (".npy", ".npz", ".csv")
_SCENES = (".scene", ".urdf", ".glb", ".gltf")
_MAPS = (".yaml", ".yml", ".png", ".pgm", ".bmp", ".map")


@explains_calls
def load(
    path: str | os.PathLike[str],
) -> PlanResult | TaskResult | Saved | FlightTrajectory | Scene | GridMap | PolygonMap | Roadmap | PointSet:
    """Return what a file holds: a plan, a task's answer, a trajectory, a scene, a map, a roadmap or points.

    Robots are not among these, as a URDF may also be a scene: `load_robot` reads them.

    Parameters
    ----------
    path : str or path-like
        A ``.json`` of a result, a task or a trajectory, also of ``evenroad plan``; a ``.roadmap``; points in ``.npy``,
        ``.npz`` or ``.csv``; a scene or a map, or the name of a shipped one; polygons in ``.geojson``.

    Returns
    -------
    PlanResult, TaskResult, Trajectory, CarTrajectory, FlightTrajectory, Scene, GridMap, PolygonMap, Roadmap or PointSet

    Raises
    ------
    UnknownName
        For another suffix.
    BrokenFile
        If the file is missing or damaged.

    Examples
    --------
    >>> import evenroad as er
    >>> er.load("office.yaml")
    GridMap(160 x 240 cells of 0.05, 26% occupied)
    """
    file = as_file("what is loaded", path)
    if file.is_dir():
        raise BrokenFile(f"{path} is a folder, not a file")
    suffix = file.suffix.lower()
    if suffix == ".json":
        return _of_json(path)
    if suffix == ".roadmap":
        from evenroad.roadmap.npz import load_roadmap

        return load_roadmap(path)
    if suffix in _POINTS:
        return _of_points(path)
    if suffix == _POLYGONS:
        from evenroad.driving.polygon_map import PolygonMap

        return PolygonMap(path)
    from evenroad.loading.find import ROBOTS
    from evenroad.scenes.scene_file import SCENES, is_scene, load_scene
    from evenroad.world.gridmap.load import SHIPPED, find_map

    if not suffix and not (file.exists() or find_map(path).is_file() or file.name in SCENES):
        if file.name in ROBOTS:
            raise UnknownName(f"{file.name!r} is a robot: er.load_robot({file.name!r}) reads it")
        maps = [name.partition(".")[0] for name in SHIPPED]
        raise UnknownName.among("file, scene or map", file.name, (*SCENES, *maps))
    if suffix in _SCENES or (suffix in ("", ".yaml", ".yml") and (file.stem in SCENES or is_scene(path))):
        return load_scene(path)
    if suffix in _MAPS or not suffix:
        from evenroad.world.gridmap import load_map

        if suffix in (".yaml", ".yml") and file.is_file() and b"joint_names:" in read_known(path, "map")[:4096]:
            raise BrokenFile(f"{path} is a trajectory for ROS 2; trajectories are read from their .json")
        return load_map(path)
    raise UnknownName.among("kind of file", suffix, (".json", ".roadmap", _POLYGONS, *_POINTS, *_SCENES, *_MAPS))


def _of_json(path: str | os.PathLike[str]) -> PlanResult | TaskResult | Saved | FlightTrajectory:
    record = read_json_file(path, "plan or trajectory")
    if isinstance(record, dict) and "query" in record:
        from evenroad.io import plan_of

        return plan_of(record, path)[0]
    if isinstance(record, dict) and str(record.get("format")).startswith("evenroad.task "):
        from evenroad.task.save import task_result_of

        return task_result_of(record, path)
    if isinstance(record, dict) and record.get("format") == "evenroad flight 1":
        from evenroad.flight.flight_trajectory import flight_of

        return flight_of(record, path)
    if isinstance(record, dict) and "format" in record:
        from evenroad.trajectory.formats import saved_of

        return saved_of(record, path)
    raise BrokenFile(f"{path} is neither a plan nor a trajectory of evenroad, got {shown(type(record).__name__)}")


def _of_points(path: str | os.PathLike[str]) -> PointSet | Roadmap:
    from evenroad.points.npz import load_points

    try:
        return load_points(path)
    except (BrokenFile, InvalidValue):
        from evenroad.roadmap.npz import load_roadmap

        if not os.fspath(path).lower().endswith(".npz"):
            raise
        try:
            return load_roadmap(path)
        except (BrokenFile, InvalidValue):
            pass
        raise
