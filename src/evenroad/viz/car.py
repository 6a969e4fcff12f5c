"""A picture of a car's plan on its map: all that the footprint sweeps, the path, start and goal."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageColor

from evenroad._arrays import Floats
from evenroad.driving.car_world import CarWorld
from evenroad.driving.polygon_map import PolygonMap
from evenroad.planning.result import PlanResult, Status
from evenroad.viz import style
from evenroad.viz.plan import LEAST_WIDTH, LONG_SIDE, kinds_of, paint_cells, shown_of
from evenroad.viz.sheet import Entry, Sheet, View

_SWEPT = (166, 206, 240)
"""Colour of what the footprint sweeps."""
_OUTLINES = 24
"""Largest number of footprints whose outlines are drawn along a path."""


def draw_car_plan(result: PlanResult, world: CarWorld) -> Image.Image:
    """Return a picture of a car's plan on its map, in map units; a start or goal in collision has a red outline."""
    low, high = shown_of(world.grid, result, world.footprint.reach)
    view = View(low, high, LONG_SIDE / float((high - low).max()), up=world.grid.frame.y_up)
    kinds = kinds_of(world.grid)
    if world.polygons is None:
        paint_cells(view, world.grid, kinds)
    else:
        paint_cells(view, world.grid, np.zeros_like(kinds))
        _draw_polygons(view, world.polygons)
    entries: list[Entry] = []
    if result.path is not None:
        _draw_swept(view, result.resample(max(0.5 * world.grid.resolution, 1.0 / view.shown_scale)), world)
        entries = [("swept", _SWEPT, "white"), ("path", style.PATH, None)]
    for pose, colour in ((result.start, style.START), (result.goal, style.GOAL)):
        red, green, blue = ImageColor.getrgb(colour)[:3]
        for part in world.footprint.placed(pose, world.footprint.parts):
            view.polygon(part, (red, green, blue, 115))
        view.dot(pose[:2], colour, 5)
    if result.status in (Status.START_INVALID, Status.GOAL_INVALID):
        pose = result.start if result.status is Status.START_INVALID else result.goal
        for outline in world.footprint.placed(pose, world.footprint.outlines):
            view.polygon(outline, None, style.COLLISION)
        entries.append(("collision", style.COLLISION, None))
    entries += [("start", style.START, "white"), ("goal", style.GOAL, "white")]
    above = "" if view.up else "y points down"
    return Sheet.of_view(view, LEAST_WIDTH, f"{result.status}: {result.message}", above, ("x", "y"), entries).image


def _draw_polygons(view: View, polygon_map: PolygonMap) -> None:
    """Draw polygons, their holes, and walls of no thickness."""
    for polygon in polygon_map.polygons:
        for number, border in enumerate(polygon):
            view.polygon(border, style.FREE if number else style.OBSTACLE, style.OBSTACLE)


def _draw_swept(view: View, poses: Floats, world: CarWorld) -> None:
    """Draw the footprint at poses, (n, 3), close together, the outlines of some, and the reference point's path."""
    footprint = world.footprint
    for pose in poses:
        for part in footprint.placed(pose, footprint.parts):
            view.polygon(part, _SWEPT)
    for pose in poses[:: max(1, len(poses) // _OUTLINES)]:
        for outline in footprint.placed(pose, footprint.outlines):
            view.polygon(outline, None, style.PATH)
    view.line(np.asarray(poses[:, :2]), style.PATH, 3)
