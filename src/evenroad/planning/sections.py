"""Sections of paths of disks and cars: samples along them, and sections that are planned with more clearance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad._native.drive import CarQuery, Steering
from evenroad.driving.car_space import CarSpace, as_pieces, cusps_of
from evenroad.driving.car_world import CarWorld
from evenroad.planning.connectors import CELLS
from evenroad.world.gridmap.disk_world import DiskWorld

MOST_SAMPLES = 1000
"""Largest number of samples along a section that are looked at."""
ROUNDS, SHORTCUTS = 3, 60
"""Numbers of rounds of the search for a car's section, and of shortcuts of it."""
_MOST_MOTIONS = 200_000
"""Largest number of motions that are checked for a disk's section."""


@dataclass(frozen=True)
class Section:
    """A part of a path: its first configuration, and waypoints (p, 2) of a disk or rows (side, length) of a car."""

    first: Floats
    parts: Floats


class Samples(NamedTuple):
    """Samples along a section, (n, dim), close together, and the share of its length before each, (n,)."""

    at: Floats
    shares: Floats


class DiskSections:
    """Sections of a disk's path."""

    def __init__(self, world: DiskWorld) -> None:
        self._world = world
        self._larger: dict[float, DiskWorld] = {}

    def samples(self, section: Section) -> Samples:
        """Return samples along a section."""
        at = _lengths_of(section.parts)
        shares = np.linspace(0.0, 1.0, _samples(float(at[-1]), self._world.grid.resolution))
        samples = [np.interp(shares * at[-1], at, section.parts[:, axis]) for axis in (0, 1)]
        return Samples(np.column_stack(samples), shares)

    def distances(self, samples: Floats) -> Floats:
        """Return the distance of the bare disk from obstacles."""
        return np.asarray(self._world.distance(samples))

    def free_with(self, samples: Floats, clearance: float) -> Bools:
        """Return where the disk is free with a clearance."""
        return np.asarray(self._with(clearance).valid(samples))

    def _with(self, clearance: float) -> DiskWorld:
        if clearance not in self._larger:
            world = self._world
            margin = max(clearance, world.margin)
            self._larger[clearance] = DiskWorld(world.grid, world.radius - world.margin + margin, margin)
        return self._larger[clearance]

    def planned(self, section: Section, clearance: float) -> Section | None:
        """Return a section between the same samples with a clearance, or None."""
        world, first, last = self._with(clearance), section.parts[0], section.parts[-1]
        if not world.disk.may_reach(first, last[np.newaxis]):
            return None
        found = CELLS.connect(world, first, last[np.newaxis], most_motions=_MOST_MOTIONS)
        if found.goal < 0:
            return None
        path, _ = CELLS.smooth(world, found.path)
        return Section(first, np.vstack([first, path[1:-1], last]))

    def cut(self, section: Section, begin: float, end: float) -> Section:
        """Return what of a section lies between two shares of its length."""
        at = _lengths_of(section.parts)
        low, high = begin * at[-1], end * at[-1]
        if not low < high:
            return Section(section.first, np.empty((0, 2)))
        after = np.column_stack([np.interp((low, high), at, section.parts[:, axis]) for axis in (0, 1)])
        first = section.parts[0] if begin == 0.0 else after[0]
        last = section.parts[-1] if end == 1.0 else after[1]
        return Section(first, np.vstack([first, section.parts[(at > low) & (at < high)], last]))

    def joined(self, sections: Sequence[Section]) -> Section:
        """Return sections one after the other."""
        parts = np.vstack([each.parts for each in sections])
        repeats = np.concatenate([[False], (np.diff(parts, axis=0) == 0.0).all(axis=1)])
        return Section(parts[0], parts[~repeats])

    def cost(self, section: Section, prefer: float, at_obstacle: float) -> float:
        """Return the length, with what is near obstacles counted more."""
        return float(_lengths_of(section.parts)[-1]) * _factor(
            self.distances(self.samples(section).at), prefer, at_obstacle
        )


class CarSections:
    """Sections of a car's path."""

    def __init__(self, world: CarWorld, space: CarSpace) -> None:
        self._world, self._space = world, space
        self._unit = space.turning_radius or space.spot
        self._steering = Steering(space.turning_radius, space.spot, space.reverse, self._unit)
        self._larger: dict[float, CarWorld] = {}

    def samples(self, section: Section) -> Samples:
        """Return samples along a section."""
        after = _lengths_after(section.parts)
        step = float(after[-1]) / _samples(float(after[-1]), self._world.grid.resolution)
        poses = self._steering.poses_along(section.first, section.parts, step)
        shares = lengths_along(section.parts, step) / after[-1]
        shares[-1] = 1.0
        return Samples(poses, shares)

    def _at(self, section: Section, after: Floats, length: float) -> Floats:
        rows = between(section.parts, after, 0.0, length)
        pose: Floats = self._steering.poses_along(section.first, rows, 2.0 * after[-1] + 1.0)[-1]
        return pose

    def distances(self, samples: Floats) -> Floats:
        """Return the distance of the bare footprint from obstacles."""
        return np.asarray(self._world.distance(samples))

    def free_with(self, samples: Floats, clearance: float) -> Bools:
        """Return where the footprint is free with a clearance."""
        return np.asarray(self._with(clearance).valid(samples))

    def _with(self, clearance: float) -> CarWorld:
        if clearance not in self._larger:
            self._larger[clearance] = replace(self._world, clearance=max(clearance, self._world.clearance))
        return self._larger[clearance]

    def planned(self, section: Section, clearance: float) -> Section | None:
        """Return a section between the same poses with a clearance, or None."""
        world, after = self._with(clearance), _lengths_after(section.parts)
        last = self._at(section, after, float(after[-1]))
        if not np.asarray(world.valid(np.stack([section.first, last]))).all():
            return None
        query = CarQuery(world.vehicle, self._steering, section.first, last, 0)
        return Section(section.first, query.path(SHORTCUTS)[0]) if query.search(ROUNDS) else None

    def cut(self, section: Section, begin: float, end: float) -> Section:
        """Return what of a section lies between two shares of its length."""
        after = _lengths_after(section.parts)
        low, high = begin * float(after[-1]), end * float(after[-1])
        return Section(self._at(section, after, low), between(section.parts, after, low, high))

    def joined(self, sections: Sequence[Section]) -> Section:
        """Return sections one after the other."""
        return Section(sections[0].first, np.vstack([each.parts for each in sections]))

    def cost(self, section: Section, prefer: float, at_obstacle: float) -> float:
        """Return the length, with what is near obstacles counted more, and with changes of direction."""
        length = float(np.abs(section.parts[:, 1]).sum())
        turns = cusps_of(as_pieces(section.parts, self._space))
        return length * _factor(self.distances(self.samples(section).at), prefer, at_obstacle) + self._unit * turns


def between(rows: Floats, after: Floats, begin: float, end: float) -> Floats:
    """Return what of pieces, (k, 2), that end at these lengths, (k + 1,), lies between two lengths."""
    part = np.minimum(after[1:], end) - np.maximum(after[:-1], begin)
    kept = part > 0.0
    return np.column_stack([rows[kept, 0], np.copysign(part[kept], rows[kept, 1])])


def lengths_along(rows: Floats, step: float) -> Floats:
    """Return the length before each pose along pieces, (k, 2), as compiled code divides them by a step."""
    lengths = np.abs(rows[:, 1])
    counts = np.maximum(np.ceil(lengths / step), 1.0).astype(int)
    return np.concatenate([[0.0], np.cumsum(np.repeat(lengths / counts, counts))])


def _lengths_after(rows: Floats) -> Floats:
    return np.concatenate([[0.0], np.cumsum(np.abs(rows[:, 1]))])


def _lengths_of(path: Floats) -> Floats:
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])


def _samples(length: float, step: float) -> int:
    return int(np.clip(np.ceil(length / step), 8, MOST_SAMPLES)) + 1


def _factor(distances: Floats, prefer: float, at_obstacle: float) -> float:
    """Return how much more than its length a section costs, by distances along it."""
    near = 1.0 - np.clip(distances, 0.0, prefer) / prefer
    return 1.0 + at_obstacle * float(near.mean())
