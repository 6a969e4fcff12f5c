"""The connector of each kind of world: trees for an arm, a search of cells for a map, else plain trees."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from evenroad._arrays import Floats
from evenroad._native.planning import Answer, Drivers, Improver, Points, answer
from evenroad._time_limit import BudgetSpent
from evenroad.collision.arm_world import ArmWorld
from evenroad.planning import arm_trees
from evenroad.planning.attempt import NO_LIMIT
from evenroad.planning.connector import Connection, Connector, Search, Smooth
from evenroad.planning.drivers import drivers, drivers_by, native_points
from evenroad.planning.shortcut import shortcut
from evenroad.points.reversed_halton import cube_points, shifted_cube_points
from evenroad.space.batch import as_batch
from evenroad.world import World

if TYPE_CHECKING:
    from evenroad.world.gridmap.disk_world import DiskWorld

RESTART = 4_000
"""Number of motions of the first search. Most queries need fewer; after it, other trees begin."""
LATER = 4
"""Factor of the length of later searches: a query that is hard once mostly stays hard with other trees."""
BEFORE_QUICK_PROOF, BEFORE_PROOF = 12_000, 60_000
"""Numbers of motions after which the world tries to prove that there is no path.

By then most hard queries have an answer.  The proof takes a few times as long as the search so far.
"""
FEW_JOINTS = 7
"""Number of joints above which proofs begin later: motions per query grow with its square, and proofs take longer."""
BEFORE_PROOF_OF_CELLS = 200_000
"""Number of motions before the proof of a search of cells, which begins again afterwards."""

SMOOTHING, LONG_SMOOTHING = 500, 2000
"""Number of batches of sixteen checks after which waypoints of an arm's path stop sliding; `LONG_SMOOTHING` is for the
shortest paths."""

Smoothing = Literal["none", "quick", "full", "with clearance"]
"""Names of the kinds of smoothing in compiled code."""


def smoothing_of(smooth: Smooth) -> Smoothing:
    """Return the name of this kind of smoothing in compiled code."""
    return "quick" if smooth == "quick" else "with clearance" if smooth else "none"


def samples_of(dim: int, variant: int) -> Points:
    """Return the points that trees of `dim` joints grow towards; each variant >= 1 has others."""
    return Points(shifted_cube_points(dim, variant)) if variant else native_points(cube_points, dim)


def drivers_of(dim: int, variant: int) -> Drivers:
    """Return the sequences that drive the queries of arms with `dim` joints; each variant >= 1 has another one."""
    return drivers_by(samples_of(dim, variant), dim) if variant else drivers(dim)


def restarts(dim: int) -> Iterator[Search]:
    """Yield searches of trees that restart repeatedly, because the time of one search varies a lot.

    Lengths after the first are 1, 1, 2, 1, 1, 2, 4 ... units (M. Luby, A. Sinclair and D. Zuckerman, 1993).
    """
    motions, more = 0, max(1.0, dim / FEW_JOINTS) ** 2
    for number in count():
        most = RESTART * (LATER * luby(number) if number else 1)
        before, motions = motions, motions + most
        is_quick, is_any = (before < more * due <= motions for due in (BEFORE_QUICK_PROOF, BEFORE_PROOF))
        yield Search(most, "any" if is_any else "quick" if is_quick else "none")


def luby(i: int) -> int:
    """Return term i >= 1 of 1, 1, 2, 1, 1, 2, 4, 1, 1, 2, 1, 1, 2, 4, 8 ..."""
    power = 1 << i.bit_length()
    return power // 2 if power == i + 1 else luby(i - power // 2 + 1)


@dataclass(frozen=True)
class ArmTrees:
    """Two trees in compiled code, every motion proved free; for arms."""

    planner: ClassVar[str] = "trees"
    varies: ClassVar[bool] = True

    shortest: bool = False
    """Whether smoothed paths are the shortest, even if they come near to obstacles."""

    def searches(self, dim: int) -> Iterator[Search]:
        """See :func:`restarts`."""
        return restarts(dim)

    def connect(self, world: World, start: Floats, goals: Floats, *, variant: int, most_motions: int) -> Connection:
        """See :func:`evenroad.planning.arm_trees.connect`; each variant >= 1 is driven by another even sequence."""
        terminals = np.concatenate([start[np.newaxis], goals])
        return arm_trees.joined(_arm(world), terminals, samples_of(len(start), variant), most_motions)

    def answer(
        self,
        world: ArmWorld,
        start: Floats,
        goal: Floats,
        *,
        variant: int,
        most_motions: int,
        search_seconds: float,
        smooth: Smooth,
    ) -> Answer:
        """Return the answer of one call of compiled code: the smoothed path to one goal, (dim,), or why there is none.

        Trees grow for at most `search_seconds`.
        """
        by, smoothing = drivers_of(len(start), variant), smoothing_of(smooth)
        if self.shortest and smoothing == "with clearance":
            smoothing = "full"
        found = answer(world.checker, start, goal, by, most_motions, search_seconds, smoothing)
        # In a new world, making the one with more clearance takes as long as a short plan.
        if smoothing == "with clearance" and found.ended == "solved" and found.nodes > 2:
            # Without time to make the world with more clearance, the path stays as trees found it.
            try:
                found.smooth_with_clearance(world.checker, world.roomier.checker, by)
            except BudgetSpent:
                return found
        return found

    def improver(
        self, world: World, terminals: Floats, first: tuple[Floats, int, int], *, variant: int, is_smoothing: bool
    ) -> Improver:
        """Return the improver of a `first` path: the path, the row of its goal, and the motions checked for it."""
        by = drivers_of(terminals.shape[1], variant)
        return arm_trees.improver(_arm(world), terminals, by, first, is_smoothing=is_smoothing)

    def smooth(self, world: World, path: Floats, *, quick: bool = False) -> tuple[Floats, int]:
        """See :func:`evenroad.planning.arm_trees.smooth_with_clearance`; if `quick`, its :func:`shorten`."""
        if len(path) == 2:
            # A single motion is the shortest path.
            return path, 0
        if quick:
            return arm_trees.shorten(_arm(world), path)
        if self.shortest:
            return arm_trees.smooth(_arm(world), path, batches=LONG_SMOOTHING)
        return arm_trees.smooth_with_clearance(_arm(world), path, batches=SMOOTHING)


@dataclass(frozen=True)
class Cells:
    """A search over the cells of a map in compiled code; for disks, exact."""

    planner: ClassVar[str] = "cells"
    varies: ClassVar[bool] = False

    def searches(self, dim: int) -> Iterator[Search]:
        """Yield the search before a proof, then the whole search."""
        yield Search(BEFORE_PROOF_OF_CELLS, "any")
        yield Search(NO_LIMIT, "none")

    def connect(
        self, world: World, start: Floats, goals: Floats, *, variant: int = 0, most_motions: int = NO_LIMIT
    ) -> Connection:
        """Find a path from a free map point, (2,), to the goal, of (g, 2), that is nearest on the lattice.

        It leads over cell centres, and over half cells in narrow passages.  A path is found wherever
        `DiskWorld.may_connect` holds, except through passages hardly wider than the disk.  At most `most_motions` are
        checked.  There are no variants.

        For goals more than 1000 pixels away, a search over tiles of the map comes first, and only cells near its path
        are searched.  The result may be longer than over all cells: by at most 3 % in 59 far queries on four kinds of
        maps.
        """
        first = as_batch("start", np.reshape(start, (1, -1)), 2)[0]
        last = as_batch("goals", goals, 2)
        found = _disk(world).disk.find_path(first, last, most_motions)
        return Connection(found.points, found.goal, found.expanded, 0, found.motions)

    def smooth(self, world: World, path: Floats, *, quick: bool = False) -> tuple[Floats, int]:
        """Return a path of free motions, (q, 2), that is not longer than `path`, (p, 2), and the number of checks."""
        points = as_batch("path", path, 2)
        return _disk(world).disk.straighten(points) if len(points) > 1 else (points.copy(), 0)


@dataclass(frozen=True)
class PlainTrees:
    """Two trees in Python that check batches of motions in any world; for users' own functions."""

    planner: ClassVar[str] = "trees"
    varies: ClassVar[bool] = True

    def searches(self, dim: int) -> Iterator[Search]:
        """See :func:`restarts`."""
        return restarts(dim)

    def connect(self, world: World, start: Floats, goals: Floats, *, variant: int, most_motions: int) -> Connection:
        """See :func:`evenroad.planning.plain_trees.grow_trees`."""
        # Imported late: an arm has compiled trees.
        from evenroad.planning.plain_trees import grow_trees

        return grow_trees(world, start, goals, variant=variant, most_motions=most_motions)

    def smooth(self, world: World, path: Floats, *, quick: bool = False) -> tuple[Floats, int]:
        """See :func:`evenroad.planning.shortcut.shortcut`."""
        return shortcut(world, path)


def _arm(world: World) -> ArmWorld:
    assert isinstance(world, ArmWorld), "these trees are an arm's"
    return world


def _disk(world: World) -> DiskWorld:
    # Imported late: a plan of an arm has no map.
    from evenroad.world.gridmap.disk_world import DiskWorld

    assert isinstance(world, DiskWorld), "this search is a disk's"
    return world


ARM_TREES, CELLS, PLAIN_TREES = ArmTrees(), Cells(), PlainTrees()


def connector_of(world: World) -> Connector | None:
    """Return the compiled connector for this kind of world, or None if there is none."""
    if isinstance(world, ArmWorld):
        return ARM_TREES
    # Imported late: a plan of an arm has no map.
    from evenroad.world.gridmap.disk_world import DiskWorld

    return CELLS if isinstance(world, DiskWorld) else None


def trees_for(world: World, *, shortest: bool = False) -> Connector:
    """Return the trees for this kind of world: compiled ones for an arm, else plain ones."""
    if isinstance(world, ArmWorld):
        return ArmTrees(shortest=True) if shortest else ARM_TREES
    return PLAIN_TREES
