"""A picture of a plan on its map: obstacles, roadmap, path, start and goal."""

from __future__ import annotations

import itertools
import os
from typing import TYPE_CHECKING, Any

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
    from evenroad.world.gridmap import DiskWorld, GridMap

LONG_SIDE_INCHES = 10.0
DPI = 130


def save_plan_picture(path: str | os.PathLike[str], result: PlanResult, world: DiskWorld) -> None:
    """Draw a plan as PNG, atomically; see :func:`draw_plan`."""
    figure = plan_figure(result, world)
    with atomic_write(path) as file:
        figure.savefig(file, format="png")


def plan_figure(result: PlanResult, world: DiskWorld) -> Figure:
    """Return the picture of a plan as a figure of matplotlib."""
    low, high = _shown(result, world)
    width, height = LONG_SIDE_INCHES * (high - low) / (high - low).max()
    figure = Figure(figsize=(max(4.0, width), max(3.0, height) + 0.8), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    draw_plan(figure.add_subplot(), result, world)
    return figure


def draw_plan(axes: Axes, result: PlanResult, world: DiskWorld) -> None:
    """Draw map, milestones, free edges, raw path, path, start and goal into matplotlib axes, in map units.

    A start or goal in collision gets a cross, with a line to the nearest obstacle.
    """
    _draw_map(axes, world.grid, _cells_with_components(result, world))
    if result.roadmap is not None:
        nodes, edges = result.roadmap.configurations, result.roadmap.edges
        axes.add_collection(LineCollection(list(nodes[edges]), colors=style.EDGE, linewidths=0.5, zorder=2))
        axes.plot(*nodes[: result.roadmap.milestones].T, ".", color=style.MILESTONE, markersize=3.5, zorder=3)
    halo = [Stroke(linewidth=5.0, foreground=style.HALO), Normal()]
    if result.path is not None and result.milestone_path is not None:
        raw = "path before shortcuts" if result.roadmap is None else "roadmap path"
        axes.plot(*result.milestone_path.T, color=style.RAW_PATH, linewidth=1.4, zorder=4, label=raw)
        _draw_swept_disks(axes, result.path, world.radius)
        axes.plot(*result.path.T, color=style.PATH, linewidth=2.4, zorder=6, path_effects=halo, label="path")
    for end, colour, name in ((result.start, style.START, "start"), (result.goal, style.GOAL, "goal")):
        axes.add_patch(Circle(tuple(end), world.radius, color=colour, alpha=0.45, linewidth=0, zorder=7))
        axes.plot(*end, "o", color=colour, markersize=8, markeredgecolor="white", zorder=8, label=name)
    if result.status in (Status.START_INVALID, Status.GOAL_INVALID):
        _mark_collision(axes, result, world)
    _set_frame(axes, result, world)


def _cells_with_components(result: PlanResult, world: DiskWorld) -> np.ndarray:
    """Return the index in `_MAP_COLOURS` of each cell.

    Where it is proved that there is no path, the components of start and goal have colours of their own.
    """
    grid = world.grid
    kinds = np.where(grid.occupied, 1, 0)
    kinds[grid.unknown] = 2
    if result.status is Status.NOT_CONNECTED and not world.may_connect(result.start, result.goal):
        for configuration, kind in ((result.start, 3), (result.goal, 4)):
            kinds[world.cells_of(world.component(configuration))] = kind
    return kinds


_MAP_COLOURS = (style.FREE, style.OBSTACLE, style.UNKNOWN, style.START_COMPONENT, style.GOAL_COMPONENT)


def _draw_map(axes: Axes, gridmap: GridMap, kinds: np.ndarray) -> None:
    frame = gridmap.frame
    # imshow draws in pixel coordinates; the affine map takes those to map units, yaw included.
    corners = frame.to_map(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    (a, b), (c, d), (e, f) = corners[1] - corners[0], corners[2] - corners[0], corners[0]
    to_axes = Affine2D.from_values(a, b, c, d, e, f) + axes.transData
    extent = (0.0, frame.cols, frame.rows, 0.0)
    colours: dict[str, Any] = dict(cmap=ListedColormap(_MAP_COLOURS), vmin=0, vmax=len(_MAP_COLOURS) - 1)
    axes.imshow(kinds, extent=extent, interpolation="nearest", transform=to_axes, zorder=1, **colours)


def _draw_swept_disks(axes: Axes, path: np.ndarray, radius: float) -> None:
    """Draw the robot at each waypoint, to show how close it passes."""
    size = np.full(len(path), 2 * radius)
    look: dict[str, Any] = dict(facecolors="none", edgecolors=style.PATH, linewidths=0.8, zorder=5)
    options: dict[str, Any] = dict(units="xy", offsets=path, offset_transform=axes.transData)
    axes.add_collection(EllipseCollection(size, size, np.zeros(len(path)), **options, **look))


def _mark_collision(axes: Axes, result: PlanResult, world: DiskWorld) -> None:
    end = result.start if result.status is Status.START_INVALID else result.goal
    touched = world.nearest_obstacle(end[np.newaxis])[0]
    look: dict[str, Any] = dict(color=style.COLLISION, linewidth=2, zorder=9)
    axes.add_patch(Circle(tuple(end), world.radius, fill=False, **look))
    axes.plot(*np.stack([end, touched]).T, **look)
    marker: dict[str, Any] = dict(marker="X", markersize=11, markeredgecolor="white", linewidth=0)
    axes.plot(*touched, color=style.COLLISION, zorder=10, label="collision", **marker)


def _set_frame(axes: Axes, result: PlanResult, world: DiskWorld) -> None:
    low, high = _shown(result, world)
    up = world.grid.frame.y_up
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]) if up else (high[1], low[1]), aspect="equal")
    axes.set(facecolor=style.OUTSIDE, xlabel="x" if up else "x (right)", ylabel="y" if up else "y (down)")
    title = f"{result.status}: {result.message}"
    if result.rule != "none":
        title += f"\n{result.origin}, {result.rule}"
    axes.set_title(style.without_math(title), fontsize=9, wrap=True)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.06), ncols=5, frameon=False, fontsize=9)


def _shown(result: PlanResult, world: DiskWorld) -> tuple[np.ndarray, np.ndarray]:
    """Return the lower and upper corner of what is shown: what is known of the map and the query, with a margin."""
    frame, known = world.grid.frame, ~world.grid.unknown
    rows, cols = (np.flatnonzero(known.any(axis=axis)) for axis in (1, 0))
    if not rows.size:
        rows, cols = np.arange(frame.rows), np.arange(frame.cols)
    sides = itertools.product((cols[0], cols[-1] + 1), (rows[0], rows[-1] + 1))
    corners = frame.to_map(np.array(list(sides), dtype=float))
    if known.all():
        return corners.min(axis=0), corners.max(axis=0)
    disks = [to_axes + world.radius * np.array([[-1.0], [1.0]]) for to_axes in (result.start, result.goal)]
    shown = np.concatenate([corners, *disks])
    margin = 0.03 * (shown.max(axis=0) - shown.min(axis=0)).max()
    return shown.min(axis=0) - margin, shown.max(axis=0) + margin
