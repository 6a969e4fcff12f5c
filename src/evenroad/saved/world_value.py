"""A world as plain JSON values, and back.

The values are those of the robot and the scene, or of the map and what moves on it, so that no file need be there.  Of
a world of constraints they are those of the world in which these are kept, with a mark.
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from evenroad._arrays import Bools
from evenroad._files import Json
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import BrokenFile, EvenroadError, NotAvailable
from evenroad.geometry.shapes import Mesh
from evenroad.loading.cache import file_of, robot_as_text, robot_of_text
from evenroad.loading.robot_file import RobotFile
from evenroad.scenes.obstacles import Obstacles
from evenroad.scenes.scene import Obstacle, Scene
from evenroad.scenes.written import read_scene, scene_files
from evenroad.world import World

if TYPE_CHECKING:
    from evenroad.driving.polygon_map import PolygonMap
    from evenroad.flight.flight_world import FlightWorld
    from evenroad.world.gridmap import GridMap, MapFrame

MOST_CELLS = 400_000_000
"""Largest number of cells of a map that is read."""
_OF_CAR = ("turning_radius", "reverse", "holonomic", "clearance")


def value_of(world: World | None) -> dict[str, Json] | None:
    """Return a world as plain JSON values; None of a world that has none, as one of a user's function."""
    if isinstance(world, ArmWorld):
        return _arm_value(world)
    if world is None:
        return None
    # Imported late: a plan of an arm has neither constraints nor a map.
    from evenroad.constraints.constrained_world import KeptWorld
    from evenroad.driving.car_world import CarWorld
    from evenroad.flight.flight_world import FlightWorld
    from evenroad.world.gridmap import DiskWorld

    if isinstance(world, FlightWorld):
        return _flight_value(world)
    if isinstance(world, KeptWorld):
        inner = value_of(world.world)
        return None if inner is None else {**inner, "keeps": True}
    if isinstance(world, DiskWorld):
        return {**_map_value(world.grid), "radius": world.radius, "clearance": world.margin}
    if isinstance(world, CarWorld):
        car = {name: getattr(world, name) for name in _OF_CAR}
        of_map = _map_value(world.grid) if world.polygons is None else _polygons_value(world.polygons)
        return {**of_map, "footprint": [outline.tolist() for outline in world.footprint.outlines], **car}
    return None


def _scene_value(scene: Scene) -> dict[str, Json] | None:
    try:
        files = scene_files(scene, "scene")
    except NotAvailable:
        return None
    return {"text": files.text, "files": files.files, "meshes": _names_of_meshes(scene)}


def _flight_value(world: FlightWorld) -> dict[str, Json] | None:
    scene = _scene_value(world.scene)
    names = ("radius", "speed", "acceleration", "bounds", "velocities")
    flight = {name: getattr(world, name) for name in names} | {"positions": world.positions}
    return None if scene is None else {"flight": flight, "scene": scene}


def _arm_value(world: ArmWorld) -> dict[str, Json] | None:
    if (scene := _scene_value(world.scene)) is None:
        return None
    file = file_of(world.robot)
    return {
        "robot": robot_as_text(world.robot),
        "file": None if file is None else {**asdict(file), "path": str(file.path.absolute())},
        "scene": scene,
        "resolution": world.resolution,
        "clearance": world.clearance,
    }


def world_of(value: object, where: object) -> World:
    """Return the world of plain JSON values; BrokenFile, which names the file `where`, if they are not such."""
    try:
        if not isinstance(value, dict):
            raise TypeError("it must be a mapping")
        if "robot" in value:
            robot, scene = robot_of_text(value["robot"]), _scene_of(value["scene"])
            return ArmWorld(robot, scene, value["resolution"], value["clearance"])
        if "flight" in value:
            from evenroad.flight.flight_world import FlightWorld

            flight = dict(value["flight"])
            positions, radius = flight.pop("positions"), flight.pop("radius")
            return FlightWorld(_scene_of(value["scene"]), radius, **flight).with_moved(positions, {})
        from evenroad.driving.car_world import CarWorld
        from evenroad.driving.footprint import Footprint
        from evenroad.world.gridmap import DiskWorld

        if "radius" in value:
            return DiskWorld(_map_of(value["map"]), value["radius"], value["clearance"])
        footprint, car = Footprint(value["footprint"]), {name: value[name] for name in _OF_CAR}
        if "polygons" in value:
            return _polygons_of(value["polygons"]).world(footprint=footprint, **car)
        return CarWorld(_map_of(value["map"]), footprint, **car)
    except (EvenroadError, TypeError, ValueError, AttributeError, LookupError, zlib.error) as error:
        raise BrokenFile(f"{where} is damaged: its world cannot be read: {error}") from error


def _scene_of(value: Mapping[str, Any]) -> Scene:
    # Imported late: most plans are not read.
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as folder:
        read = read_scene(value["text"], value["files"], Path(folder))
    return _with_names(read, value["meshes"])


def source_of(source: Mapping[str, Any], world: World | None) -> dict[str, Any]:
    """Return what a trajectory was made of, as its file says: its `source`, else its world, else nothing."""
    if source:
        return {"source": dict(source)}
    value = value_of(world)
    return {} if value is None else {"source": {"world": value}}


def file_in(value: Mapping[str, Any]) -> RobotFile | None:
    """Return the robot's file that a world was made of, if it is still there: it has what is drawn of the links."""
    said = value.get("file")
    if not isinstance(said, dict) or not Path(str(said.get("path"))).is_file():
        return None
    pairs = {name: tuple((str(a), str(b)) for a, b in said.get(name, ())) for name in ("packages", "arguments")}
    flags = {name: bool(said.get(name)) for name in ("use_visuals", "as_drawn", "upright_meshes")}
    return RobotFile(Path(said["path"]), **pairs, **flags)  # type: ignore[arg-type]


def _names_of_meshes(scene: Scene) -> dict[str, Json]:
    """Return obstacle -> name of its mesh, which a file of another name would change."""
    return {each.name: each.body.triangles.name for each in scene.obstacles if isinstance(each.body, Mesh)}


def _with_names(scene: Scene, names: Mapping[str, str]) -> Scene:
    """Return a scene whose meshes have these names, obstacle -> name."""
    if not names:
        return scene

    def renamed(each: Obstacle) -> Obstacle:
        if not isinstance(each.body, Mesh):
            return each
        return replace(each, body=replace(each.body, source=replace(each.body.triangles, name=names[each.name])))

    return replace(scene, obstacles=Obstacles(map(renamed, scene.obstacles)))


def _map_value(grid: GridMap) -> dict[str, Json]:
    cells = {name: _packed(getattr(grid, name)) for name in ("occupied", "unknown")}
    return {"map": {**asdict(grid.frame), **cells}}


def _map_of(value: Any) -> GridMap:
    from evenroad.world.gridmap import GridMap, MapFrame

    said = {name: value[name] for name in MapFrame.__dataclass_fields__}
    frame = MapFrame(**{**said, "origin": tuple(said["origin"])})
    if frame.rows * frame.cols > MOST_CELLS:
        raise ValueError(f"a map of more than {MOST_CELLS} cells")
    occupied, unknown = (_unpacked(value[name], frame) for name in ("occupied", "unknown"))
    return GridMap(occupied, frame, unknown)


def _polygons_value(polygon_map: PolygonMap) -> dict[str, Json]:
    """Return polygons as they are: their cells would be other obstacles."""
    return {
        "polygons": {
            "borders": [[border.tolist() for border in each] for each in polygon_map.polygons],
            "names": list(polygon_map.names),
            "bounds": [each.tolist() for each in polygon_map.bounds],
            "resolution": polygon_map.resolution,
        }
    }


def _polygons_of(value: Any) -> PolygonMap:
    from evenroad.driving.polygon_map import PolygonMap

    # A text would be the name of a file, and None stands for a default.
    if not isinstance(borders := value["borders"], list):
        raise TypeError("borders must be lists")
    low, high = value["bounds"]
    return PolygonMap(borders, bounds=(low, high), resolution=float(value["resolution"]), names=value["names"])


def _packed(cells: Bools) -> str:
    return base64.b64encode(zlib.compress(np.packbits(cells).tobytes(), 6)).decode()


def _unpacked(text: str, frame: MapFrame) -> Bools:
    count = frame.rows * frame.cols
    size = (count + 7) // 8
    # Few bytes can stand for very many: no more are made than the map has.
    content = zlib.decompressobj().decompress(base64.b64decode(text, validate=True), size + 1)
    if len(content) != size:
        raise ValueError(f"{count} cells expected")
    bits = np.unpackbits(np.frombuffer(content, dtype=np.uint8), count=count)
    return bits.astype(bool).reshape(frame.rows, frame.cols)
