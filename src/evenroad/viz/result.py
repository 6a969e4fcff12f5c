"""Pictures of plans in any world, and of maps."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

from evenroad._checks import as_file
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import NotAvailable
from evenroad.planning.result import PlanResult
from evenroad.viz.arm import draw_arm_plan
from evenroad.viz.sheet import save_png
from evenroad.world import World

if TYPE_CHECKING:
    from evenroad.world.gridmap.gridmap import GridMap

_FREE, _UNKNOWN, _OCCUPIED = 254, 205, 40
"""Grey values of free, unknown and occupied cells."""
_LONG_SIDE = 600
"""Least length of the long side of a map's picture [pixels]."""


def plot_result(
    result: PlanResult, path: str | os.PathLike[str] | None = None, world: World | None = None
) -> Image.Image:
    """Return what :meth:`PlanResult.plot` does."""
    world = result.world if world is None else world
    picture = draw_arm_plan(result, world) if isinstance(world, ArmWorld) else _draw_other(result, world)
    return _kept(picture, path)


def _draw_other(result: PlanResult, world: World | None) -> Image.Image:
    """Return the picture of a plan that is kept by constraints, on a map, or of a flight."""
    # Imported late: a picture of an arm needs none of it.
    from evenroad.constraints.constrained_world import KeptWorld
    from evenroad.driving.car_world import CarWorld
    from evenroad.flight.flight_world import FlightWorld
    from evenroad.viz.car import draw_car_plan
    from evenroad.viz.flight import draw_flight_plan
    from evenroad.viz.plan import draw_plan
    from evenroad.world.gridmap import DiskWorld

    match world:
        case KeptWorld():
            return plot_result(result, world=world.world)
        case DiskWorld():
            return draw_plan(result, world)
        case CarWorld():
            return draw_car_plan(result, world)
        case FlightWorld():
            return draw_flight_plan(result, world)
    known = "its world is not known: plot(world=...)" if world is None else f"its world is a {type(world).__name__}"
    raise NotAvailable(f"plans of disks and cars on maps, of arms and of flights can be drawn, but of this one {known}")


def plot_parts(parts: Sequence[PlanResult], path: str | os.PathLike[str] | None = None) -> Image.Image:
    """Return the pictures of plans, one below the other; of those in which something moves."""
    moving = [each for each in parts if each.cost or not each.solved]
    if not moving:
        raise NotAvailable("there is nothing to draw: nothing moves")
    pictures = [plot_result(each) for each in moving]
    size = max(each.width for each in pictures), sum(each.height for each in pictures)
    sheet, top = Image.new("RGB", size, "white"), 0
    for each in pictures:
        sheet.paste(each, ((size[0] - each.width) // 2, top))
        top += each.height
    return _kept(sheet, path)


def plot_map(gridmap: GridMap, path: str | os.PathLike[str] | None = None) -> Image.Image:
    """Return what :meth:`GridMap.plot` does."""
    shades = np.where(gridmap.unknown, _UNKNOWN, np.where(gridmap.occupied, _OCCUPIED, _FREE)).astype(np.uint8)
    times = max(1, _LONG_SIDE // max(gridmap.shape))
    return _kept(Image.fromarray(np.kron(shades, np.ones((times, times), dtype=np.uint8))), path)


def _kept(picture: Image.Image, path: str | os.PathLike[str] | None) -> Image.Image:
    """Return a picture, saved where a file is named."""
    if path is not None:
        save_png(picture, as_file("what a picture is saved to", path))
    return picture
