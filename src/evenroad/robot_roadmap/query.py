"""A query of a roadmap in a scene: by one compiled program, or motion by motion where lanes do not work."""

from __future__ import annotations

from typing import NamedTuple, Protocol, TypeGuard

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad._clock import now
from evenroad._compiled import compile_beside
from evenroad.robot import ArmWorld
from evenroad.robot.arm_world import VALIDATION_TOLERANCE
from evenroad.robot.kernel.addresses import address
from evenroad.robot.kernel.motion_states import COUNTS
from evenroad.robot_roadmap import memory as at
from evenroad.robot_roadmap.memory import (
    BLOCKED,
    EDGE,
    FOUND,
    FULL,
    NODE,
    PAUSED,
    PROVED,
    SPENT,
    STRAIGHT,
    TAKEN,
)
from evenroad.robot_roadmap.scene_graph import Query, SceneGraph
from evenroad.robot_roadmap.search import next_check
from evenroad.world import World

_SLICE = 1000
"""Batches of sixteen checks between two looks at the clock: about 10 ms."""


class Checks(World, Protocol):
    """A world that proves motions; compiled code calls its ``lanes`` where they work."""

    @property
    def backend(self) -> str:
        """The kind of compiled check."""

    def motion_certified(self, a: Floats, b: Floats, tolerance: float) -> Bools:
        """Return which motions, (m, dim) each, are free: (m,)."""


class SearchResult(NamedTuple):
    """How a search ended: a path, (p, dim), and its goal or -1; numbers of configurations, motions and, where known,
    batches of sixteen checks.
    """

    ended: int
    path: Floats
    goal: int
    configurations: int
    motions: int
    batches: int = 0


def prepare() -> None:
    """Compile what a plan along a roadmap needs, in processes beside this one, unless it is cached."""
    # The one that is needed last takes longest and goes first; this process begins at the other end.
    compile_beside(
        "evenroad.robot_roadmap.lane_search",
        "evenroad.robot_roadmap.scene_graph",
        "evenroad.robot.kernel.lane_check",
        "evenroad.robot.kernel.motion_checks",
    )


def search(
    graph: SceneGraph, worlds: tuple[Checks, Checks], query: Query, most_motions: int, deadline: float
) -> SearchResult:
    """Search for a path all of whose motions are proved.

    The first world has everything; the second has what the roadmap did not check.
    """
    world, growth = worlds[0], 1
    if isinstance(world, ArmWorld) and world.fixed_contact is not None:
        # Compiled code gets no capsules that no joint moves.
        return SearchResult(TAKEN, np.empty((0, len(query.start))), -1, 0, 0)
    while True:
        graph.prepare(query, growth)
        if all(map(_is_compiled, worlds)):
            ended = _by_lanes(graph, worlds, most_motions, deadline)  # type: ignore[arg-type]
        else:
            ended = _by_calls(graph, worlds, most_motions, deadline)
        if ended != FULL:
            return _result(graph, ended)
        growth *= 2


def _result(graph: SceneGraph, ended: int) -> SearchResult:
    rows, goal, configurations, motions, batches = graph.header[at.ROWS : at.BATCHES + 1].tolist()
    if ended != FOUND:
        rows, goal = 0, -1
    path = graph.arrays["path"][:rows][::-1].copy()
    return SearchResult(ended, path, goal, configurations, motions, batches)


def _is_compiled(world: Checks) -> TypeGuard[ArmWorld]:
    return isinstance(world, ArmWorld) and world.backend == "lanes"


def _by_lanes(
    graph: SceneGraph, worlds: tuple[ArmWorld, ArmWorld], most_motions: int, deadline: float
) -> int:
    # Imported late: where the vector type cannot even be defined, all else still works.
    from evenroad.robot_roadmap.lane_search import find_path

    world, dynamic = (each.lanes for each in worlds)
    moved, (checks, resolution, *rest) = dynamic.addresses, world.arguments(COUNTS + dynamic.addresses[3])[1]
    # Both use this thread's memory, one behind the other.
    behind = rest[-1] + 8 * COUNTS
    full = np.array([checks, *rest])
    part = np.array([*moved[:3], behind, rest[-1]])
    fresh = 1
    while True:
        ended = find_path(
            address(graph.header), fresh, most_motions, _SLICE, resolution, address(part), address(full)
        )
        fresh = 0
        if ended != PAUSED:
            return ended
        if now() >= deadline:
            return SPENT


def _by_calls(graph: SceneGraph, worlds: tuple[Checks, Checks], most_motions: int, deadline: float) -> int:
    """Evaluate motion by motion."""
    (world, dynamic), header, memory = worlds, graph.header, address(graph.header)
    terminals, (a, b) = graph.arrays["terminals"][: header[at.TERMINALS]], np.split(graph.arrays["motion"], 2)
    if not world.valid(terminals).all():
        return TAKEN
    terminals[:] = world.space.interpolate(terminals, terminals, 0.0)
    check, result = -1, 0
    while True:
        check = next_check(memory, check, result)
        if check > STRAIGHT:
            return check
        if header[at.MOTIONS] >= most_motions or now() >= deadline:
            return SPENT
        if check == NODE:
            header[at.CONFIGURATIONS] += 1
            free = dynamic.valid(a)[0]
        else:
            header[at.MOTIONS] += 1
            judge = dynamic if check == EDGE and header[at.BY] < header[at.BASE] else world
            free = judge.motion_certified(a, b, VALIDATION_TOLERANCE)[0]
        result = PROVED if free else BLOCKED
