"""Scenes of problems, each with a path that was found."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D
from PIL import Image

from evenroad._arrays import Floats
from evenroad.errors import NotAvailable
from evenroad.geometry import rotation_from_quaternion
from evenroad.planning import PRM, PlanResult, plan
from evenroad.points import draw
from evenroad.roadmap import KNearest
from evenroad.robot import ArmWorld
from evenroad.space.path import configuration_at
from evenroad.viz import style
from evenroad.viz.arm import draw_arm_plan
from evenroad.viz.plan import draw_plan
from evenroad.world.gridmap import DiskWorld
from evenroad_studies.bench.task import Problem
from evenroad_studies.problems import PROBLEMS
from evenroad_studies.report.charts import DPI, new_figure
from evenroad_studies.worlds.chain import ChainWorld
from evenroad_studies.worlds.rigid import OrientedBox, SolidWorld

SCENES = ("maze-1", "maze-2", "maze-3", "chain-10d", "cubicles", "twistycool", "ur5-c", "ur5-a")
"""Problems that have a picture."""
SAME_SCENE = {"cubicles-6d": "cubicles", "twistycool-6d": "twistycool"}
"""Problems that share the picture of another one."""
TRIES = ((1024, 10), (2048, 10), (4096, 10), (2048, 40), (8192, 40))
"""Numbers of points and of neighbours that are tried in turn; a goal deep in a box needs more neighbours."""
CHAIN_POSES = 25
BODY_POSES = 13
"""Poses along the path that are drawn."""


def scenes_among(problems: Sequence[str]) -> tuple[str, ...]:
    """Return the scenes of the problems, in the order of :data:`SCENES`."""
    wanted = {SAME_SCENE.get(problem, problem) for problem in problems}
    return tuple(scene for scene in SCENES if scene in wanted and scene in PROBLEMS)


def draw_scene(name: str) -> Figure:
    """Return the picture of a problem's world with a found path; NotAvailable if there is none of such a world."""
    problem = PROBLEMS[name].make(0)
    match problem.world:
        case DiskWorld():
            return _figure_of(draw_plan(find_path(problem), problem.world))
        case ChainWorld():
            return draw_chain(problem, problem.world, name)
        case SolidWorld():
            return draw_solids(problem, problem.world, name)
        case ArmWorld():
            return _figure_of(draw_arm_plan(find_path(problem), problem.world))
    raise NotAvailable(f"there is no picture of the scene of {name}")


def _figure_of(picture: Image.Image) -> Figure:
    figure = new_figure(picture.width / DPI, picture.height / DPI, layout=None)
    figure.figimage(np.asarray(picture))
    return figure


def find_path(problem: Problem) -> PlanResult:
    """Return the first plan with a path, on scrambled Halton points; the last one if none has."""
    for n, k in TRIES:
        points = draw("halton", n, problem.world.space.cube_dim)
        query = (problem.world, problem.start, problem.goal)
        result = plan(*query, PRM(points, rule=KNearest(k), links=None))
        if result.solved:
            break
    return result


def draw_chain(problem: Problem, world: ChainWorld, title: str) -> Figure:
    """Return the horn with the chain at start, goal and, from light to dark, along a path."""
    figure = new_figure(8.0, 5.2)
    axes = figure.add_subplot()
    x, y, dx, dy = world.walls
    walls = np.stack([np.stack([x, y], axis=1), np.stack([x + dx, y + dy], axis=1)], axis=1)
    look: dict[str, Any] = dict(colors=style.OBSTACLE, linewidths=2.6, label="horn", zorder=4)
    axes.add_collection(LineCollection(list(walls), **look))
    result = find_path(problem)
    if result.path is not None:
        shades = colormaps["Blues"](np.linspace(0.25, 0.75, CHAIN_POSES))
        poses = configuration_at(result.path, world.space, np.linspace(0.0, 1.0, CHAIN_POSES))
        for pose, shade in zip(poses, shades, strict=True):
            axes.plot(*_joints(pose).T, color=shade, linewidth=1.0, zorder=2)
    for pose, colour, name in ((problem.start, style.START, "start"), (problem.goal, style.GOAL, "goal")):
        axes.plot(*_joints(pose).T, "o-", color=colour, linewidth=2.2, markersize=3.5, zorder=5, label=name)
    axes.plot(0.0, 0.0, "o", color=style.OBSTACLE, markersize=7, zorder=6)
    axes.set(aspect="equal", xlabel="x", ylabel="y")
    axes.set_title(f"{title}: {result.message}\n{result.origin}, {result.rule}", fontsize=9, wrap=True)
    axes.legend(fontsize=9, frameon=False, loc="upper left")
    return figure


def _joints(pose: Floats) -> Floats:
    """Return base, joints and tip in the plane, (links + 1, 2)."""
    headings = np.cumsum(pose)
    steps = np.stack([np.cos(headings), np.sin(headings)], axis=1) / len(pose)
    return np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])


FACES = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
"""Corners of a box's faces, in the order of `OrientedBox.corners`."""


def draw_solids(problem: Problem, world: SolidWorld, title: str) -> Figure:
    """Return two views of the obstacles, see-through, with the body along a path from start to goal."""
    figure = new_figure(12.0, 5.6, layout=None)
    figure.subplots_adjust(left=0.0, right=1.0, bottom=0.0, top=0.92, wspace=0.0)
    result = find_path(problem)
    poses = np.stack([problem.start, problem.goal])
    if result.path is not None:
        poses = configuration_at(result.path, world.space, np.linspace(0.0, 1.0, BODY_POSES))
    obstacles = np.concatenate([_faces(box.corners) for box in world.obstacles])
    for place, (elevation, azimuth) in enumerate(((68.0, -90.0), (24.0, -62.0)), 1):
        axes = figure.add_subplot(1, 2, place, projection="3d")
        _add_faces(axes, obstacles, (style.OBSTACLE, style.OBSTACLE), alpha=0.13, linewidths=0.25)
        _draw_body(axes, world.body, poses)
        _set_view(axes, obstacles.reshape(-1, 3), elevation, azimuth)
    figure.suptitle(f"{title}: {result.message}\n{result.origin}, {result.rule}", fontsize=9)
    return figure


def _draw_body(axes: Axes3D, body: Iterable[OrientedBox], poses: Floats) -> None:
    boxes = list(body)
    ends = {0: style.START, len(poses) - 1: style.GOAL}
    between = colormaps["autumn"](np.linspace(0.75, 0.0, len(poses)))
    for number, (pose, shade) in enumerate(zip(poses, between, strict=True)):
        rotation, place = np.eye(3), pose[:3]
        if len(pose) == 7:
            rotation = np.array(rotation_from_quaternion(xyzw=np.roll(pose[3:], -1).tolist())).reshape(3, 3)
        faces = np.concatenate([_faces(box.corners @ rotation.T + place) for box in boxes])
        alpha, width = (0.95, 0.4) if number in ends else (0.55, 0.15)
        _add_faces(axes, faces, (ends.get(number, shade), "black"), alpha=alpha, linewidths=width)


def _add_faces(axes: Axes3D, faces: Floats, colours: tuple[Any, Any], **look: float) -> None:
    """Draw faces in the colours of their areas and of their edges."""
    areas, edges = colours
    axes.add_collection3d(Poly3DCollection(faces, facecolors=areas, edgecolors=edges, clip_on=False, **look))


def _faces(corners: Floats) -> Floats:
    """Return the faces of a box, (6, 4, 3)."""
    return corners[np.array(FACES)]


def _set_view(axes: Axes3D, points: Floats, elevation: float, azimuth: float) -> None:
    low, high = points.min(axis=0), points.max(axis=0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low, zoom=1.05)
    axes.view_init(elev=elevation, azim=azimuth)
    axes.set_axis_off()
