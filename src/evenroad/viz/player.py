"""A plan as one HTML file that plays offline: an arm in three dimensions, or a disk or a car on its map."""

from __future__ import annotations

import base64
import json
import os
from io import BytesIO
from pathlib import Path
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._checks import as_file, require_known
from evenroad._files import atomic_write
from evenroad.collision.arm_world import ArmWorld
from evenroad.driving.car_world import CarWorld
from evenroad.errors import NotAvailable
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.loading.robot_file import RobotFile
from evenroad.planning.result import PlanResult
from evenroad.robots.kinematics import joint_values, tip_links
from evenroad.scenes.scene import Obstacle
from evenroad.space.path import configuration_at
from evenroad.viz.arm import chosen_camera, kept_distance
from evenroad.viz.bodies import COLLISION, obstacle_part, robot_sets
from evenroad.viz.parts import by_colour, indexed
from evenroad.viz.result import plot_map
from evenroad.viz.stage import Part
from evenroad.world import MeasuresPaths, World
from evenroad.world.gridmap import DiskWorld

Data: TypeAlias = "dict[str, object]"
"""Data of a page, as JSON."""
Timed: TypeAlias = tuple[Floats, Floats]
"""Times from 0 on, (n,) [s], and the configurations at them, (n, dim)."""
WEB = Path(__file__).parent / "web"
SCRIPTS = ("time", "options", "live", "matrices", "painter", "camera", "arm", "handles", "map", "start")
"""Parts of the page's script, in their order: each may use the names of those before it."""
SAMPLES = 240
"""Number of states of a path that has no times."""
SECONDS = 4.0
"""Duration of a path that has no times [s]."""
_MOST = 600
"""Largest number of states of a trajectory that are kept."""


def save_page(
    path: str | os.PathLike[str],
    result: PlanResult,
    *,
    file: RobotFile | None = None,
    timed: Timed | None = None,
) -> None:
    """Write a page that plays a plan in any browser, without a network: one HTML file, atomically.

    Parameters
    ----------
    path : str or path-like
        An ``.html``.
    result : PlanResult
        A plan that knows its world: an arm in its scene, or a disk or a car on a map.
    file : RobotFile, optional
        The robot's file, which says how the robot looks.  Default: the one that it was loaded from in this process, if
        any; of a robot without a file, collision bodies are shown.
    timed : tuple of ndarray, optional
        Times from 0 on, (n,) [s], and the configurations at them, (n, dim), as of a trajectory.  Default: even speed,
        four seconds.

    Raises
    ------
    UnknownName
        For another suffix.
    NotAvailable
        If the world is another one, or there is no path.
    """
    out = as_file("what a page is saved to", path)
    require_known(f"kind of page, {os.fspath(path)!r}: suffix", out.suffix.lower(), (".html",))
    text = page_of(result, file=file, timed=timed)
    with atomic_write(out) as opened:
        opened.write(text.encode())


def page_of(result: PlanResult, *, file: RobotFile | None = None, timed: Timed | None = None) -> str:
    """Return the text of the page that :func:`save_page` writes."""
    world = result.world
    if not isinstance(world, ArmWorld | DiskWorld | CarWorld):
        raise NotAvailable("plans of arms and on maps can be played; this one has another world, or none: see its plot")
    if result.path is None:
        raise NotAvailable(f"there is no path to play: {result.message}")
    kept = kept_distance(result) if isinstance(world, ArmWorld) else ""
    times, states = states_of(result, world, timed)
    data: Data = {"title": f"{result.status}: {result.message}{kept}", "clearance": clearances(world, states)}
    if isinstance(world, ArmWorld):
        shown = arm_data(world, result, file) | values_of(world, times, states)
    else:
        shown = _map_data(world, states) | {"times": rounded(times, 4)}
    return filled(data | shown | {"timed": timed is not None})


def filled(data: Data) -> str:
    """Return the text of a page that shows some data."""
    # No text of a plan ends the script that holds it.
    text = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    script = "\n".join((WEB / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS)
    page, style = ((WEB / name).read_text(encoding="utf-8") for name in ("page.html", "page.css"))
    return page.replace("__STYLE__", style).replace("__SCRIPT__", script).replace("__DATA__", text)


def states_of(result: PlanResult, world: ArmWorld | DiskWorld | CarWorld, timed: Timed | None) -> Timed:
    """Return times, (n,) [s], and configurations at them, (n, dim); without a path the arm stays at the start."""
    if timed is not None:
        chosen = np.unique(np.linspace(0, len(timed[0]) - 1, _MOST).astype(int))
        return timed[0][chosen], timed[1][chosen]
    if result.path is None:
        return np.array([0.0, SECONDS]), np.stack([result.start, result.start])
    shares = np.linspace(0.0, 1.0, SAMPLES)
    return SECONDS * shares, configuration_at(result.path, world.space, shares)


def clearances(world: World, states: Floats) -> list[float] | None:
    """Return a lower bound of the distance from obstacles at each of some states, (n, dim), None if not known [m]."""
    if isinstance(world, ArmWorld):
        is_known = len(world.scene.obstacles) > 0 and bool(world.valid(states).all())
        return rounded(world.obstacle_distances(states), 4) if is_known else None
    if isinstance(world, CarWorld):
        return rounded(world.distance(states), 4)
    if not isinstance(world, MeasuresPaths):
        return None
    bounds = [world.path_clearance(np.stack([state, state])) for state in states[:: len(states) // 120 + 1]]
    if any(bound is None or not np.isfinite(bound) for bound in bounds):
        return None
    shares = np.linspace(0.0, 1.0, len(states)), np.linspace(0.0, 1.0, len(bounds))
    return rounded(np.interp(*shares, np.array(bounds, dtype=np.float64)), 4)


def values_of(world: ArmWorld, times: Floats, states: Floats) -> Data:
    """Return times and the values of each joint at them, None for joints that are fixed."""
    values = joint_values(world.robot, states)
    joints = world.robot.joints
    listed = [None if joint.kind == "fixed" else rounded(values[joint.name], 5) for joint in joints]
    return {"times": rounded(times, 4), "values": listed}


def arm_data(world: ArmWorld, result: PlanResult, file: RobotFile | None) -> Data:
    """Return the joints and bodies of an arm in its scene, and the side that it is seen from."""
    robot = world.robot
    number = {link: i for i, link in enumerate(robot.links)}
    joints = [
        {
            "name": joint.name,
            "kind": joint.kind,
            "parent": number[joint.parent],
            "child": i + 1,
            "origin": columns_of(joint.origin),
            "axis": list(joint.axis),
            "limits": [each if np.isfinite(each) else np.pi * np.sign(each) for each in (joint.lower, joint.upper)],
            "planned": joint.name in robot.group,
            "mimic": joint.mimic and [joint.mimic.joint, joint.mimic.multiplier, joint.mimic.offset],
        }
        for i, joint in enumerate(robot.joints)
    ]
    shown = robot_sets(robot, file)
    bodies = [obstacle_data(each) for each in world.scene.obstacles]
    for name, links in shown.sets.items():
        of_colour = [(link, each) for link, part in links.items() for each in by_colour(part)]
        bodies += [body_data(part, number[link], name, link) for link, part in of_colour]
    parts = [obstacle_part(each) for each in world.scene.obstacles]
    camera, _ = chosen_camera(result, world, shown.sets[COLLISION], parts)
    x, y, _ = camera.eye - camera.look_at
    return {
        "kind": "arm",
        "unit": "m",
        "name": robot.name,
        "joints": joints,
        "links": len(robot.links),
        "tips": [number[tip] for tip in tip_links(robot)],
        "sets": list(shown.sets),
        "note": shown.note,
        "bodies": bodies,
        "turn": round(float(np.arctan2(y, x)), 3),
    }


def obstacle_data(obstacle: Obstacle) -> Data:
    """Return the body of an obstacle, in its own frame, and its pose."""
    pose = columns_of(obstacle.body.pose)
    return body_data(obstacle_part(obstacle.at(IDENTITY)), 0, "scene", obstacle.name) | {"pose": pose}


def body_data(part: Part, link: int, kind: str, name: str) -> Data:
    """Return a body that moves with a link: of a set of the robot's bodies, or of the scene."""
    corners, directions, triangles = indexed(part)
    normals = np.zeros((len(corners), 4), dtype=np.int8)
    normals[:, :3] = np.rint(127.0 * directions)
    return {
        "link": link,
        "set": kind,
        "name": name,
        "colour": [round(each / 255.0, 3) for each in part.colours[0].tolist()],
        "v": _coded(corners.astype("<f4")),
        "n": _coded(normals),
        "t": _coded(triangles.reshape(-1).astype("<u4")),
    }


def _map_data(world: DiskWorld | CarWorld, states: Floats) -> Data:
    frame = world.grid.frame
    pixels = frame.to_pixels(states[:, :2])
    data: Data = {
        "kind": "map",
        "unit": "m" if frame.y_up else "px",
        "name": "a disk on its map" if isinstance(world, DiskWorld) else "a car on its map",
        **_obstacle_picture(world),
        "size": [frame.cols, frame.rows],
        "joints": [],
        "sets": [],
    }
    if isinstance(world, DiskWorld):
        return data | {"radius": world.radius / frame.resolution, "states": [rounded(row, 3) for row in pixels]}
    ahead = np.column_stack([np.cos(states[:, 2]), np.sin(states[:, 2])])
    right, down = (frame.to_pixels(states[:, :2] + ahead) - pixels).T
    turned = np.column_stack([pixels, np.unwrap(np.arctan2(down, right))])
    # Rows of the picture run down: what is to the left on a map with y up is at a smaller y.
    scale = np.array([1.0, -1.0 if frame.y_up else 1.0]) / frame.resolution
    outlines = [[rounded(corner, 4) for corner in outline * scale] for outline in world.footprint.outlines]
    return data | {"outlines": outlines, "states": [rounded(row, 4) for row in turned]}


def _obstacle_picture(world: DiskWorld | CarWorld) -> Data:
    """Return a picture of the cells, or the borders of polygons and of their holes, in cells."""
    if isinstance(world, CarWorld) and world.polygons is not None:
        to_pixels = world.grid.frame.to_pixels
        borders = [[to_pixels(border).round(3).tolist() for border in each] for each in world.polygons.polygons]
        return {"polygons": borders}
    picture = BytesIO()
    plot_map(world.grid).save(picture, format="png")
    return {"picture": "data:image/png;base64," + base64.b64encode(picture.getvalue()).decode()}


def columns_of(pose: Pose) -> list[float]:
    """Return the transform of a pose column by column, as the page multiplies them."""
    return rounded(pose.matrix.T.reshape(-1), 9)


def _coded(array: npt.NDArray[np.generic]) -> str:
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode()


def rounded(values: Floats, digits: int) -> list[float]:
    """Return numbers rounded to some digits after the point, for JSON."""
    listed: list[float] = np.round(values, digits).tolist()
    return listed
