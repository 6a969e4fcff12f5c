"""A picture of a plan on its map: obstacles, roadmap, path, start and goal."""

from __future__ import annotations

import itertools
import os
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageColor

from evenroad._arrays import Floats
from evenroad.planning.result import PlanResult, Status
from evenroad.viz import style
from evenroad.viz.sheet import Entry, Sheet, View, save_png

if TYPE_CHECKING:
    from evenroad.world.gridmap import DiskWorld, GridMap

LONG_SIDE = 1200
"""Pixels of the long side of what is shown of a map."""
LEAST_WIDTH = 960
"""Least width of a picture: its legend is as wide [pixels]."""


def save_plan_picture(path: str | os.PathLike[str], result: PlanResult, world: DiskWorld) -> None:
    """Save the picture of :func:`draw_plan` as PNG, atomically."""
    save_png(draw_plan(result, world), path)


def draw_plan(result: PlanResult, world: DiskWorld) -> Image.Image:
    """Return a picture of a plan on its map: milestones, free edges, raw path, path, start and goal, in map units.

    A start or goal in collision gets a cross, with a line to the nearest obstacle.
    """
    view = draw_plan_view(result, world)
    title = f"{result.status}: {result.message}"
    if result.rule != "none":
        title += f"; {result.origin}, {result.rule}"
    entries: list[Entry] = []
    if result.path is not None:
        raw = "path before shortcuts" if result.roadmap is None else "roadmap path"
        entries = [(raw, style.RAW_PATH, None), ("path", style.PATH, None)]
    entries += [("start", style.START, "white"), ("goal", style.GOAL, "white")]
    if result.status in (Status.START_INVALID, Status.GOAL_INVALID):
        entries.append(("collision", style.COLLISION, None))
    above = "" if view.up else "y points down"
    return Sheet.of_view(view, LEAST_WIDTH, title, above, ("x", "y"), entries).image


def draw_plan_view(result: PlanResult, world: DiskWorld) -> View:
    """Return what :func:`draw_plan` shows of the map and the plan, without frame and words."""
    low, high = shown_of(world.grid, result, world.radius)
    view = View(low, high, LONG_SIDE / float((high - low).max()), up=world.grid.frame.y_up)
    _draw_map(view, result, world)
    if result.roadmap is not None:
        nodes, edges = result.roadmap.configurations, result.roadmap.edges
        for edge in nodes[edges]:
            view.line(edge, style.EDGE, 0.5)
        for node in nodes[: result.roadmap.milestones]:
            view.circle(node, 2.0 / view.shown_scale, style.MILESTONE)
    if result.path is not None and result.milestone_path is not None:
        view.line(result.milestone_path, style.RAW_PATH, 2)
        for waypoint in result.path:
            # The robot at each waypoint shows how close it passes.
            view.circle(waypoint, world.radius, None, style.PATH, 1)
        view.line(result.path, style.HALO, 6)
        view.line(result.path, style.PATH, 3)
    for end, colour in ((result.start, style.START), (result.goal, style.GOAL)):
        red, green, blue = ImageColor.getrgb(colour)[:3]
        view.circle(end, world.radius, (red, green, blue, 115))
        view.dot(end, colour, 5)
    if result.status in (Status.START_INVALID, Status.GOAL_INVALID):
        end = result.start if result.status is Status.START_INVALID else result.goal
        touched = world.nearest_obstacle(end[np.newaxis])[0]
        view.circle(end, world.radius, None, style.COLLISION, 2)
        view.line(np.stack([end, touched]), style.COLLISION, 2)
        for slant in ((1.0, 1.0), (1.0, -1.0)):
            arm = 7.0 / view.shown_scale * np.array(slant)
            view.line(np.stack([touched - arm, touched + arm]), style.COLLISION, 4)
    return view


_MAP_COLOURS = (
    *(style.FREE, style.OBSTACLE, style.UNKNOWN, style.START_COMPONENT, style.GOAL_COMPONENT),
    style.OUTSIDE,
)


def _draw_map(view: View, result: PlanResult, world: DiskWorld) -> None:
    """Paint the map; if it is proved that there is no path, the components of start and goal have their own colours."""
    kinds = kinds_of(world.grid)
    if result.status is Status.NOT_CONNECTED and not world.may_connect(result.start, result.goal):
        for configuration, kind in ((result.start, 3), (result.goal, 4)):
            kinds[world.cells_of(world.component(configuration))] = kind
    paint_cells(view, world.grid, kinds)


def kinds_of(grid: GridMap) -> npt.NDArray[np.uint8]:
    """Return the number of each cell's colour, (rows, cols)."""
    kinds = np.where(grid.occupied, 1, 0).astype(np.uint8)
    kinds[grid.unknown] = 2
    return kinds


def paint_cells(view: View, grid: GridMap, kinds: npt.NDArray[np.uint8]) -> None:
    """Paint each pixel with the colour of its cell."""
    cells = Image.fromarray(kinds)
    cells.putpalette([part for colour in _MAP_COLOURS for part in ImageColor.getrgb(colour)[:3]])
    # Positions of the image's corners in the map's pixels, yaw included.
    corner, right, below = grid.frame.to_pixels(view.positions(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])))
    (a, d), (b, e), (c, f) = right - corner, below - corner, corner
    how = Image.Resampling.NEAREST
    turned = cells.transform(view.image.size, Image.Transform.AFFINE, (a, b, c, d, e, f), how, fillcolor=5)
    view.image.paste(turned.convert("RGB"))


def shown_of(grid: GridMap, result: PlanResult, reach: float) -> tuple[Floats, Floats]:
    """Return the lower and upper corner of what is shown: what is known of the map and the query, with a margin."""
    frame, known = grid.frame, ~grid.unknown
    rows, cols = (np.flatnonzero(known.any(axis=axis)) for axis in (1, 0))
    if not rows.size:
        rows, cols = np.arange(frame.rows), np.arange(frame.cols)
    sides = itertools.product((cols[0], cols[-1] + 1), (rows[0], rows[-1] + 1))
    corners = frame.to_map(np.array(list(sides), dtype=float))
    if known.all():
        return corners.min(axis=0), corners.max(axis=0)
    around = [end[:2] + reach * np.array([[-1.0], [1.0]]) for end in (result.start, result.goal)]
    shown = np.concatenate([corners, *around])
    margin = 0.03 * (shown.max(axis=0) - shown.min(axis=0)).max()
    return shown.min(axis=0) - margin, shown.max(axis=0) + margin
