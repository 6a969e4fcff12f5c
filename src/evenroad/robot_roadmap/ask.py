"""Asking a roadmap in a scene for a way: by one compiled program, or motion by motion where the lanes do not work."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple, Protocol, TypeGuard

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad._clock import now
from evenroad._compiled import compile_beside
from evenroad.robot import ArmWorld
from evenroad.robot.arm_world import RECHECK_TOLERANCE
from evenroad.robot.kernel.layout import program
from evenroad.robot.kernel.motion_states import COUNTS
from evenroad.robot_roadmap import lazy_search as search
from evenroad.robot_roadmap import search_memory as at
from evenroad.robot_roadmap.dear_search import DEARLY, NOT_ASKED, NOT_PROVED, next_dear_question
from evenroad.robot_roadmap.known_graph import KnownGraph
from evenroad.robot_roadmap.lazy_search import ENDS_TAKEN, PAUSED, SPENT
from evenroad.robot_roadmap.search_memory import (
    BLOCKED,
    DOUBTED,
    EDGE,
    FOUND,
    FREE,
    FULL,
    NODE,
    PROVED,
    STRAIGHT,
    UNKNOWN,
)
from evenroad.world import World

_SLICE = 1000
"""Batches of sixteen checks between two looks at the clock: about 10 ms."""


class Checks(World, Protocol):
    """A world that proves motions, and says who does: ``lanes`` are asked by compiled code."""

    @property
    def backend(self) -> str:
        """Who checks."""

    def motion_certified(self, a: Floats, b: Floats, tolerance: float) -> Bools:
        """Return which motions, (m, dim) each, are free: (m,)."""


class Asked(NamedTuple):
    """What a search ended with: a path, (p, dim), and its goal or -1; milestones and motions that were asked about; how
    many batches of sixteen checks that took, where it is known; and whether every motion had to be proved.
    """

    ended: int
    path: Floats
    goal: int
    milestones: int
    motions: int
    batches: int = 0
    proved: bool = True

    def after(self, before: Asked) -> Asked:
        """Return this search with what was asked about in one before it, too."""
        checked = self.milestones + before.milestones, self.motions + before.motions
        return self._replace(milestones=checked[0], motions=checked[1])


class ProvesSoon(Checks, Protocol):
    """A world that can say for little of some motions that they are free."""

    def proved(self, q: Floats) -> Bools:
        """Return which configurations, (n, dim), are known to be free for little: (n,)."""

    def motion_proved(self, a: Floats, b: Floats) -> Bools:
        """Return which motions, (m, dim) each, are proved free for little: (m,); of the others nothing is said."""


def _proves_soon(world: Checks) -> TypeGuard[ProvesSoon]:
    return hasattr(world, "motion_proved")


def prepare() -> None:
    """Begin to compile what a plan along a roadmap takes, in processes beside this one, unless it is kept already."""
    # The last needed, and the longest, first: this process begins at the other end.
    compile_beside(
        "evenroad.robot.kernel.tighten",
        "evenroad.robot_roadmap.lane_search",
        "evenroad.robot_roadmap.known_graph",
        "evenroad.robot.kernel.lane_check",
        "evenroad.robot.kernel.motion_checks",
        # What ways out take.
        "evenroad.robot.kernel.trees",
        "evenroad.robot.kernel.shorten",
    )


def ask(
    world: Checks,
    day: Checks,
    graph: KnownGraph,
    start: Floats,
    goals: Floats,
    most_motions: int,
    deadline: float,
    links: int,
    greed: float,
    nearby: float = 0.0,
    *,
    only_known: bool = False,
    unturned: bool = False,
    proved: bool = True,
) -> Asked:
    """Search for a way from a start, (dim,), to one of some goals, (g, dim), each tried to be linked to so many.

    Of what the roadmap knows to be free of robot and cell, `day` is asked; of the rest the whole world.  `greed` and
    `nearby` are as `KnownGraph.prepare` has them.  With `only_known` the query is the last one, and nothing is gone
    along but what is known to be free by now.  With `unturned` ends are linked to milestones as these are, not turned
    to be near.  All motions of the way are proved.  Where `proved` is False, as before a path is drawn tight, lanes
    prove a straight motion and links of ends that nearly touch something; others are free at their states.
    """
    if isinstance(world, ArmWorld) and world.fixed_contact is not None:
        # Of what no joint moves compiled code is told nothing.
        return Asked(ENDS_TAKEN, np.empty((0, len(start))), -1, 0, 0)
    room = 1
    while True:
        graph.prepare(start, goals, links, greed, nearby, room, only_known=only_known, unturned=unturned)
        if _by_one_program(world) and _by_one_program(day):
            asked = _by_lanes(world, day, graph, most_motions, deadline, proved)
        else:
            asked = _by_questions(world, day, graph, most_motions, deadline)
        if asked.ended != FULL:
            return asked
        room *= 2


def _by_one_program(world: Checks) -> TypeGuard[ArmWorld]:
    return isinstance(world, ArmWorld) and world.backend == "lanes"


def _by_lanes(
    world: ArmWorld, day: ArmWorld, graph: KnownGraph, most_motions: int, deadline: float, proved: bool
) -> Asked:
    path, (day_checks, day_tables, day_by_joint, doubles) = graph.path, day.lanes.places
    _, arguments = world.lanes.arguments(COUNTS + doubles)
    own = day_checks, day_tables, day_by_joint, arguments[-1] + 8 * COUNTS
    (find_way, clearance), fresh = _find_way(), 1
    wider = 0 if proved else world.lanes.wider(clearance)
    while True:
        ended = find_way(*graph.places, fresh, most_motions, _SLICE, wider, *own, *arguments)
        fresh = 0
        if ended != PAUSED:
            break
        if now() >= deadline:
            ended = SPENT
            break
    rows, milestones, motions, goal, batches = graph.report.tolist()
    found = path[:rows][::-1].copy()
    return Asked(ended, found, goal if ended == FOUND else -1, milestones, motions, batches, proved)


@cache
def _find_way() -> tuple[Callable[..., int], float]:
    """Return the program, and how far ends are from obstacles whose links may wait for their proof [m]."""
    # Imported late: where the vector type cannot even be defined, all else still works.
    from evenroad.robot.kernel.tighten import CLEARANCE
    from evenroad.robot_roadmap.lane_search import find_way

    return find_way, CLEARANCE


def _by_questions(world: Checks, day: Checks, graph: KnownGraph, most_motions: int, deadline: float) -> Asked:
    """Ask motion by motion: lazily what an arm itself checks; of other worlds, where checks are dear, few motions."""
    dear = not isinstance(world, ArmWorld)
    known = FREE if dear else PROVED
    desk, path, nothing = graph.desk, graph.path, np.empty((0, len(graph.asked[0])))
    milestones = motions = 0
    if not world.valid(graph.ends).all():
        return Asked(ENDS_TAKEN, nothing, -1, 0, 0)
    graph.ends[:] = world.space.interpolate(graph.ends, graph.ends, 0.0)
    if _proves_soon(world):
        for end in np.flatnonzero(~world.proved(graph.ends)).tolist():
            graph.doubt(end)
    memory, way, rows, _ = graph.places
    question, verdict = -1, UNKNOWN
    while True:
        if dear:
            question = next_dear_question(memory, question, verdict, NOT_ASKED, NOT_PROVED, way, rows)
        else:
            question = _next_question(memory, question, verdict, way, rows)
        if question == FOUND:
            found, goal = path[: desk[at.BY]][::-1].copy(), int(desk[at.TO]) - 1
            return Asked(FOUND, found, goal, milestones, motions)
        dearly, question = divmod(question, DEARLY)
        if question > STRAIGHT:
            return Asked(question, nothing, -1, milestones, motions)
        if motions >= most_motions or now() >= deadline:
            return Asked(SPENT, nothing, -1, milestones, motions)
        a, b = graph.asked[:1], graph.asked[1:]
        if question == NODE:
            milestones += 1
            verdict = known if day.valid(a)[0] else BLOCKED
            continue
        judge = day if question == EDGE and desk[at.BY] < desk[at.BASE] else world
        motions += 1 - dearly
        if _proves_soon(judge) and not dearly:
            verdict = FREE if judge.motion_proved(a, b)[0] else DOUBTED
        else:
            verdict = known if judge.motion_certified(a, b, RECHECK_TOLERANCE)[0] else BLOCKED


@program
def _next_question(desk: int, answered: int, verdict: int, path: int, rows: int) -> int:
    """Take the answer to a question, or begin where there was none, and return the next one; a way is told."""
    s = at.search_at(desk)
    search.hear(s, answered, verdict)
    question = search.step(s)
    if question == FOUND:
        search.tell(s, path, rows)
    return question
