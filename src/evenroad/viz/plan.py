"""A plan on its map: obstacles, roadmap, path, start and goal at a glance."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.patheffects import Normal, Stroke
from matplotlib.transforms import Affine2D

from evenroad._files import atomic_write
from evenroad.roadmap import PlanResult, Status
from evenroad.viz import style

if TYPE_CHECKING:
    from evenroad.world import GridMap
    from evenroad.world.gridmap.disk import DiskWorld

LONG_SIDE_INCHES = 10.0
DPI = 130


def save_plan_picture(path: str | os.PathLike[str], result: PlanResult, world: DiskWorld) -> None:
    """Draw a plan as PNG, atomically; see :func:`draw_plan`."""
    low, high = _outline(world.grid)
    width, height = high - low
    scale = LONG_SIDE_INCHES / max(width, height)
    figure = Figure(
        figsize=(max(4.0, width * scale), max(3.0, height * scale) + 0.8), dpi=DPI, layout="constrained"
    )
    FigureCanvasAgg(figure)
    draw_plan(figure.add_subplot(), result, world)
    with atomic_write(path) as file:
        figure.savefig(file, format="png")


def draw_plan(axes: Axes, result: PlanResult, world: DiskWorld) -> None:
    """Draw map, milestones, free edges, raw path, path, start and goal into matplotlib axes, in map units.

    An end whose disk is in collision gets a cross, with a line to the obstacle that is nearest.
    """
    _draw_map(axes, world.grid)
    if result.roadmap is not None:
        nodes, edges = result.roadmap.configurations, result.roadmap.edges
        axes.add_collection(LineCollection(list(nodes[edges]), colors=style.EDGE, linewidths=0.5, zorder=2))
        axes.plot(*nodes[: result.roadmap.milestones].T, ".", color=style.MILESTONE, markersize=3.5, zorder=3)
    halo = [Stroke(linewidth=5.0, foreground=style.HALO), Normal()]
    if result.path is not None and result.milestone_path is not None:
        axes.plot(
            *result.milestone_path.T, color=style.RAW_PATH, linewidth=1.4, zorder=4, label="roadmap path"
        )
        _draw_swept_disks(axes, result.path, world.radius)
        axes.plot(*result.path.T, color=style.PATH, linewidth=2.4, zorder=6, path_effects=halo, label="path")
    for end, colour, name in ((result.start, style.START, "start"), (result.goal, style.GOAL, "goal")):
        axes.add_patch(Circle(tuple(end), world.radius, color=colour, alpha=0.45, linewidth=0, zorder=7))
        axes.plot(*end, "o", color=colour, markersize=8, markeredgecolor="white", zorder=8, label=name)
    if result.status in (Status.START_INVALID, Status.GOAL_INVALID):
        _mark_collision(axes, result, world)
    _set_frame(axes, result, world.grid)


def _draw_map(axes: Axes, gridmap: GridMap) -> None:
    frame = gridmap.frame
    # imshow draws in pixel coordinates; the affine map takes those to map units, yaw included.
    corners = frame.to_map(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    (a, b), (c, d), (e, f) = corners[1] - corners[0], corners[2] - corners[0], corners[0]
    axes.imshow(
        gridmap.occupied,
        extent=(0.0, frame.cols, frame.rows, 0.0),
        cmap=ListedColormap([style.FREE, style.OBSTACLE]),
        vmin=0,
        vmax=1,
        interpolation="nearest",
        transform=Affine2D.from_values(a, b, c, d, e, f) + axes.transData,
        zorder=1,
    )


def _draw_swept_disks(axes: Axes, path: np.ndarray, radius: float) -> None:
    """Show the robot itself at each waypoint, so that one sees how close it passes."""
    size = np.full(len(path), 2 * radius)
    disks = EllipseCollection(
        size,
        size,
        np.zeros(len(path)),
        units="xy",
        offsets=path,
        offset_transform=axes.transData,
        facecolors="none",
        edgecolors=style.PATH,
        linewidths=0.8,
        zorder=5,
    )
    axes.add_collection(disks)


def _mark_collision(axes: Axes, result: PlanResult, world: DiskWorld) -> None:
    end = result.start if result.status is Status.START_INVALID else result.goal
    touched = world.nearest_obstacle(end[np.newaxis])[0]
    axes.add_patch(Circle(tuple(end), world.radius, fill=False, color=style.COLLISION, linewidth=2, zorder=9))
    axes.plot(*np.stack([end, touched]).T, color=style.COLLISION, linewidth=2, zorder=9)
    axes.plot(
        *touched,
        "X",
        color=style.COLLISION,
        markersize=11,
        markeredgecolor="white",
        zorder=10,
        label="collision",
    )


def _set_frame(axes: Axes, result: PlanResult, gridmap: GridMap) -> None:
    low, high = _outline(gridmap)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(*((low[1], high[1]) if gridmap.frame.y_up else (high[1], low[1])))
    axes.set_aspect("equal")
    axes.set_facecolor(style.OUTSIDE)
    axes.set_xlabel("x" if gridmap.frame.y_up else "x (right)")
    axes.set_ylabel("y" if gridmap.frame.y_up else "y (down)")
    title = f"{result.status}: {result.message}\n{result.origin}, {result.rule}"
    axes.set_title(style.without_math(title), fontsize=9, wrap=True)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.06), ncols=5, frameon=False, fontsize=9)


def _outline(gridmap: GridMap) -> tuple[np.ndarray, np.ndarray]:
    frame = gridmap.frame
    corners = frame.to_map(
        np.array([[0.0, 0.0], [frame.cols, 0.0], [0.0, frame.rows], [frame.cols, frame.rows]])
    )
    return corners.min(axis=0), corners.max(axis=0)
