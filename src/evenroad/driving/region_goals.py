"""Goals in regions: free poses of a region, and proofs that no path leads into one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import as_row
from evenroad.driving.car_world import SLICES, CarWorld
from evenroad.driving.goal_region import GoalRegion
from evenroad.errors import InvalidValue, shown
from evenroad.world.gridmap.disk_world import DiskWorld
from evenroad.world.protocol import Apart

MOST = 16
"""Largest number of poses of a region that are goals of a search."""
_TRIED = 512
"""Number of poses of a region that are tried: the first free ones are goals."""
_MOST_BOXES = 2_000_000
"""Largest number of boxes that a proof goes to: some tenths of a second."""


def as_regions(goals: Sequence[object], world: object) -> tuple[GoalRegion, ...]:
    """Return goals of a car or a disk as regions: a configuration is one of its own."""
    if not isinstance(world, CarWorld | DiskWorld):
        raise InvalidValue(f"regions are goals of cars and disks on maps, not in {shown(world)}")
    regions = []
    for goal in goals:
        if isinstance(goal, GoalRegion):
            if goal.angle is not None and world.dim == 2:
                raise InvalidValue("a disk has no angle: its goal region must have none")
            regions.append(goal)
        else:
            x, y, *angle = as_row("goal", goal, world.dim)  # type: ignore[arg-type]
            regions.append(GoalRegion((x, y), angle=angle[0] if angle else None))
    return tuple(regions)


def goals_in(world: object, region: GoalRegion) -> Floats:
    """Return free configurations of a region, (g, dim), spread over it; its middle alone where none is found."""
    assert isinstance(world, CarWorld | DiskWorld), "regions are of cars and disks"
    tried = region.sampled(_TRIED, world.dim)
    free = tried[np.asarray(world.valid(tried))]
    return free[:MOST] if len(free) else tried[:1]


def apart_from_regions(world: object, start: Floats, regions: tuple[GoalRegion, ...]) -> Apart | None:
    """Return the proof that no path leads from a start, (dim,), into any of the regions; None says nothing."""
    assert isinstance(world, CarWorld | DiskWorld), "regions are of cars and disks"
    if not all(_is_apart(world, start, region) for region in regions):
        return None
    where = "the goal region" if len(regions) == 1 else f"any of {len(regions)} goal regions"
    if isinstance(world, DiskWorld):
        return Apart(f"proved: there is no path; the free space around the start does not reach {where}", proved=True)
    how = f"in none of {SLICES} slices of the angle, nor from one to the next, does the footprint reach {where}"
    return Apart(f"proved: there is no path; {how}, however it moves", proved=True)


def _is_apart(world: CarWorld | DiskWorld, start: Floats, region: GoalRegion) -> bool:
    if isinstance(world, CarWorld):
        pose = np.array([*region.middle, region.angles[0]])
        half = np.array([*region.half, region.angles[1]])
        return bool(world.valid(start)) and world.vehicle.is_apart_from(start, pose, half, SLICES, _MOST_BOXES)
    corners = region.middle + region.half * np.array([(-1, -1), (-1, 1), (1, -1), (1, 1)])
    pixels = world.grid.frame.to_pixels(corners)
    rows, cols = world.grid.shape
    low = np.clip(np.ceil(pixels.min(axis=0)).astype(int) - 1, 0, (cols, rows))
    high = np.clip(np.floor(pixels.max(axis=0)).astype(int) + 1, 0, (cols, rows))
    reached = world.cells_of(world.component(start))
    return not reached[low[1] : high[1], low[0] : high[0]].any()
