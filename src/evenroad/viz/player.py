"""A plan as one HTML file that plays offline: an arm in three dimensions, or a disk on its map."""

from __future__ import annotations

import base64
import json
import os
from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import as_file, require_known
from evenroad._files import atomic_write
from evenroad.errors import EvenroadError, NotAvailable
from evenroad.roadmap import PlanResult
from evenroad.robot import ArmWorld, Robot, tip_links
from evenroad.robot.kinematics import joint_values
from evenroad.robot.load import read_robot
from evenroad.robot.urdf_xml import RobotFile
from evenroad.space.path import configuration_at
from evenroad.viz.raster import Part, part_of
from evenroad.viz.result import plot_map
from evenroad.viz.solid import chosen_camera, link_colour, obstacle_colour, obstacle_surface
from evenroad.viz.surfaces import Surface, link_surfaces, surfaces_by_link
from evenroad.world import MeasuresPaths
from evenroad.world.gridmap import DiskWorld

TEMPLATE = Path(__file__).parent / "player.html"
SAMPLES = 240
"""Number of states of a path that has no times."""
SECONDS = 4.0
"""Duration of a path that has no times [s]."""
_MOST = 600
"""Largest number of states of a trajectory that are kept."""
_SAME = 2e-3
"""Difference between two surfaces below which they are of one body [m]."""
_SETS = ("visual", "collision", "capsules")
"""What a robot can be shown as."""


def save_page(
    path: str | os.PathLike[str],
    result: PlanResult,
    *,
    file: RobotFile | None = None,
    timed: tuple[Floats, Floats] | None = None,
) -> None:
    """Write a page that plays a plan in any browser, without a network: one HTML file, atomically.

    Parameters
    ----------
    path : str or path-like
        An ``.html``.
    result : PlanResult
        A plan that knows its world: an arm in its scene, or a disk on a map.
    file : RobotFile, optional
        The robot's file, whose visual and collision geometry can then be shown; capsules always can.
    timed : tuple of ndarray, optional
        Times from 0 on, (n,) [s], and the configurations at them, (n, dim), as of a trajectory.  Default: even speed,
        four seconds.

    Raises
    ------
    UnknownName
        For another suffix.
    NotAvailable
        If the world is neither of the two, or there is no path.
    """
    out = as_file("what a page is saved to", path)
    require_known(f"kind of page, {os.fspath(path)!r}: suffix", out.suffix.lower(), (".html",))
    text = page_of(result, file=file, timed=timed)
    with atomic_write(out) as opened:
        opened.write(text.encode())


def page_of(result: PlanResult, *, file: RobotFile | None = None, timed: tuple[Floats, Floats] | None = None) -> str:
    """Return the text of the page that :func:`save_page` writes."""
    world = result.world
    if not isinstance(world, ArmWorld | DiskWorld):
        raise NotAvailable("plans of arms and of disks on maps can be shown; this one has another world, or none")
    if result.path is None:
        raise NotAvailable(f"there is no path to play: {result.message}")
    if timed is None:
        times, states = np.linspace(0.0, SECONDS, SAMPLES), _evenly(result, world)
    else:
        chosen = np.unique(np.linspace(0, len(timed[0]) - 1, _MOST).astype(int))
        times, states = timed[0][chosen], timed[1][chosen]
    data: dict[str, Any] = {
        "title": f"{result.status}: {result.message}",
        "timed": timed is not None,
        "times": _rounded(times, 4),
        "clearance": _clearances(world, states),
    }
    data |= _of_arm(world, result, states, file) if isinstance(world, ArmWorld) else _of_map(world, states)
    # No text of a plan ends the script that holds it.
    text = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    return TEMPLATE.read_text(encoding="utf-8").replace("__DATA__", text)


def _evenly(result: PlanResult, world: ArmWorld | DiskWorld) -> Floats:
    assert result.path is not None
    return configuration_at(result.path, world.space, np.linspace(0.0, 1.0, SAMPLES))


def _clearances(world: Any, states: Floats) -> list[float] | None:
    """Return a lower bound of the distance from obstacles at each state; None where it is not known."""
    if not isinstance(world, MeasuresPaths):
        return None
    bounds = [world.path_clearance(np.stack([state, state])) for state in states[:: len(states) // 120 + 1]]
    if any(bound is None or not np.isfinite(bound) for bound in bounds):
        return None
    shares = np.linspace(0.0, 1.0, len(states)), np.linspace(0.0, 1.0, len(bounds))
    return _rounded(np.interp(*shares, np.array(bounds, dtype=np.float64)), 4)


def _of_arm(world: ArmWorld, result: PlanResult, states: Floats, file: RobotFile | None) -> dict[str, Any]:
    robot = world.robot
    values = joint_values(robot, states)
    number = {link: i for i, link in enumerate(robot.links)}
    joints = []
    for i, joint in enumerate(robot.joints):
        limits = [each if np.isfinite(each) else np.pi * np.sign(each) for each in (joint.lower, joint.upper)]
        joints.append({
            "name": joint.name,
            "kind": joint.kind,
            "parent": number[joint.parent],
            "child": i + 1,
            "origin": _rounded(joint.origin.matrix.T.reshape(-1), 9),
            "axis": list(joint.axis),
            "limits": limits,
            "planned": joint.name in robot.group,
            "mimic": joint.mimic and [joint.mimic.joint, joint.mimic.multiplier, joint.mimic.offset],
            "values": _rounded(values[joint.name], 5) if joint.kind != "fixed" else None,
        })  # fmt: skip
    bodies = [*_scene_bodies(world), *_robot_bodies(robot, file, number)]
    shown = [name for name in _SETS if any(body["set"] == name for body in bodies)]
    tips = [number[tip] for tip in tip_links(robot)]
    links = {link: part_of(surface, link_colour(0)) for link, surface in link_surfaces(robot, None).items()}
    obstacles = [part_of(obstacle_surface(each), obstacle_colour(each)) for each in world.scene.obstacles]
    x, y, _ = np.subtract(
        *(getattr(chosen_camera(result, world, links, obstacles)[0], end) for end in ("eye", "look_at"))
    )
    return {
        "kind": "arm",
        "unit": "m",
        "name": robot.name,
        "joints": joints,
        "links": len(robot.links),
        "tips": tips,
        "sets": shown,
        "bodies": bodies,
        "turn": round(float(np.arctan2(y, x)), 3),
    }


def _scene_bodies(world: ArmWorld) -> Iterator[dict[str, Any]]:
    for obstacle in world.scene.obstacles:
        yield _body(part_of(obstacle_surface(obstacle), obstacle_colour(obstacle)), 0, "scene", obstacle.name)


def _robot_bodies(robot: Robot, file: RobotFile | None, number: dict[str, int]) -> Iterator[dict[str, Any]]:
    sets = {"capsules": surfaces_by_link(robot.capsules)}
    for name, as_drawn in (("collision", False), ("visual", True)) if file is not None else ():
        assert file is not None
        try:
            shapes = read_robot(replace(file, as_drawn=as_drawn)).shapes
        except EvenroadError:
            # A drawing that cannot be read is no reason to show nothing.
            continue
        surfaces = {link: each for link, each in surfaces_by_link(shapes).items() if link in number}
        if surfaces and not any(_equal(surfaces, other) for other in sets.values()):
            sets[name] = surfaces
    for name, surfaces in sets.items():
        for i, (link, surface) in enumerate(surfaces.items()):
            yield _body(part_of(surface, link_colour(i)), number[link], name, link)


def _equal(one: dict[str, Surface], other: dict[str, Surface]) -> bool:
    """Return whether the surfaces of all links have as many corners and the same bounds."""

    def bounds(surface: Surface) -> Floats:
        return np.concatenate([surface[0].min(axis=0), surface[0].max(axis=0), [float(len(surface[0]))]])

    same_links = one.keys() == other.keys()
    return same_links and all(np.allclose(bounds(one[link]), bounds(other[link]), atol=_SAME) for link in one)


def _body(part: Part, link: int, kind: str, name: str) -> dict[str, Any]:
    """Return a body with each different pair of a corner and its normal once."""
    rows = np.column_stack([
        np.round(part.corners.reshape(-1, 3), 5), np.round(127.0 * part.normals.reshape(-1, 3))
    ])  # fmt: skip
    different, index = np.unique(rows, axis=0, return_inverse=True)
    normals = np.zeros((len(different), 4), dtype=np.int8)
    normals[:, :3] = different[:, 3:]
    return {
        "link": link,
        "set": kind,
        "name": name,
        "colour": [round(each / 255.0, 3) for each in part.colour],
        "v": _coded(different[:, :3].astype("<f4")),
        "n": _coded(normals),
        "t": _coded(index.reshape(-1).astype("<u4")),
    }


def _of_map(world: DiskWorld, states: Floats) -> dict[str, Any]:
    frame, picture = world.grid.frame, BytesIO()
    plot_map(world.grid).save(picture, format="png")
    return {
        "kind": "map",
        "unit": "m" if frame.y_up else "px",
        "name": "a disk on its map",
        "picture": "data:image/png;base64," + base64.b64encode(picture.getvalue()).decode(),
        "size": [frame.cols, frame.rows],
        "radius": world.radius / frame.resolution,
        "states": [_rounded(row, 3) for row in frame.to_pixels(states)],
        "joints": [],
        "sets": [],
    }


def _coded(array: Any) -> str:
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode()


def _rounded(values: Floats, digits: int) -> list[float]:
    rounded: list[float] = np.round(values, digits).tolist()
    return rounded
