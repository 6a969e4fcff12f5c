"""A rigid body of boxes on its way among boxes, in space."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt
from matplotlib import colormaps
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D

from evenroad.geometry import rotation_from_quaternion
from evenroad.research.bench.problem import Problem
from evenroad.research.report.figures.canvas import new_figure
from evenroad.research.report.figures.found_path import find_path, poses_along
from evenroad.viz import style
from evenroad.world.solids import OrientedBox, SolidWorld

POSES = 13
_FACES = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
"""Corners of a box's faces, in the order of `OrientedBox.corners`."""


def draw_solids(problem: Problem, world: SolidWorld, title: str) -> Figure:
    """Return two views of the obstacles, see-through, with the body along a path from start to goal."""
    figure = new_figure(12.0, 6.0, layout=None)
    figure.subplots_adjust(left=0.0, right=1.0, bottom=0.0, top=0.92, wspace=0.0)
    result = find_path(problem)
    poses = np.stack([problem.start, problem.goal])
    if result.path is not None:
        poses = poses_along(world.space, result.path, POSES)
    obstacles = np.concatenate([_faces(box.corners) for box in world.obstacles])
    for place, (elevation, turn) in enumerate(((68.0, -90.0), (24.0, -62.0)), 1):
        axes = figure.add_subplot(1, 2, place, projection="3d")
        axes.add_collection3d(
            Poly3DCollection(
                obstacles, facecolors=style.OBSTACLE, alpha=0.13, edgecolors=style.OBSTACLE, linewidths=0.25
            )
        )
        _draw_body(axes, world.body, poses)
        _set_view(axes, obstacles.reshape(-1, 3), elevation, turn)
    figure.suptitle(f"{title}: {result.message}\n{result.origin}, {result.rule}", fontsize=9)
    return figure


def _draw_body(axes: Axes3D, body: Iterable[OrientedBox], poses: npt.NDArray[np.float64]) -> None:
    boxes = list(body)
    between = colormaps["autumn"](np.linspace(0.75, 0.0, len(poses)))
    for number, (pose, shade) in enumerate(zip(poses, between, strict=True)):
        ends = {0: style.START, len(poses) - 1: style.GOAL}
        colour = ends.get(number, shade)
        turn, place = np.eye(3), pose[:3]
        if len(pose) == 7:
            turn = np.array(rotation_from_quaternion(pose[3:].tolist())).reshape(3, 3)
        faces = np.concatenate([_faces(box.corners @ turn.T + place) for box in boxes])
        strong = number in ends
        axes.add_collection3d(
            Poly3DCollection(
                faces,
                facecolors=colour,
                edgecolors="black",
                linewidths=0.4 if strong else 0.15,
                alpha=0.95 if strong else 0.55,
            )
        )


def _faces(corners: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the faces of a box, (6, 4, 3)."""
    return corners[np.array(_FACES)]


def _set_view(axes: Axes3D, points: npt.NDArray[np.float64], elevation: float, turn: float) -> None:
    low, high = points.min(axis=0), points.max(axis=0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low, zoom=0.95)
    axes.view_init(elev=elevation, azim=turn)
    axes.set_axis_off()
