"""An arm's roadmap in one world: a planner that keeps the results of checks, and the paths that trees found."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol, runtime_checkable

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import counted, require_count
from evenroad._clock import now
from evenroad._shared import OwnLock, one_at_a_time
from evenroad.planning.arm_trees import smooth
from evenroad.planning.connectors import ArmTrees
from evenroad.planning.trees import RRTConnect
from evenroad.roadmap import Budget, PlanResult, Status
from evenroad.roadmap.answer import connected, gave_up, refusal
from evenroad.roadmap.attempt import NO_LIMIT, Attempt
from evenroad.roadmap.connector import Connection
from evenroad.roadmap.point_roadmap import WorldRoadmap
from evenroad.roadmap.problem import Problem
from evenroad.roadmap.query import Query as PlanQuery
from evenroad.roadmap.result import NO_POINTS, make_result
from evenroad.robot import ArmWorld
from evenroad.robot_roadmap.arm_roadmap import ArmRoadmap
from evenroad.robot_roadmap.query import EXPENSIVE, GREED, Checks, Query, SearchResult, search
from evenroad.robot_roadmap.start_and_goals import (
    ConfigurationLike,
    Goal,
    read_start_and_goals,
    start_and_goals_free,
)
from evenroad.robot_roadmap.static_scene import left_to_check, require_within
from evenroad.space.path import path_length

PLANNER = "roadmap"

SECONDS = RRTConnect.seconds
"""Default wall time of a query [s]."""

SHARE = 0.5
"""Fraction of the time given to the roadmap; trees get the rest."""

TRIED_LINKS, TRIED_MOTIONS = 40, 90
"""Largest numbers of links of start and goal, and of motions, where trees may follow: trees leave narrow passages with
fewer checks than long links do."""

WORK, AMONG_SURFACES, LEAST_WORK = 170, 50, 30
"""Number of batches of sixteen checks of a query, search included, after which smoothing stops; the same among clouds
and triangles, where checks take longer; and the least number for smoothing."""

EXPENSIVE_LINKS, EXPENSIVE_WORK, MOST_INSERTED = 100, 800, 2000
"""Where evaluations are expensive: links of start and goal, batches of smoothing along the capsules, and the largest
number of milestones that queries insert."""

BY_CAPSULES = 5000
"""Largest number of motions of a plan along the capsules before a more expensive world is queried: some
milliseconds."""

_LONG = 1e8
"""Number of seconds that stands for no limit."""

_SOME = 64
"""Number of milestones among which a free one is searched, to compile with."""

_ready: set[str] = set()
"""Backends whose programs are compiled."""


def links_of(n: int) -> int:
    """Return the number of n milestones that start and goal are linked to: of up to 256 all, of 1024 half."""
    return min(n, round(16.0 * np.sqrt(n)))


@runtime_checkable
class ExpensiveWorld(Protocol):
    """A world of an arm that checks other bodies where its capsules touch; a dataclass with a field `capsules`."""

    @property
    def capsules(self) -> ArmWorld:
        """The world of the capsules, which contain the bodies: what is free for them is free."""


class ArmWorldRoadmap(WorldRoadmap):
    """An arm's roadmap in one world, with the results of earlier checks; made by :meth:`ArmRoadmap.within`.

    Threads may share it: their queries are answered one after the other, each with the results of earlier checks.  So
    the same queries in the same order have the same answers; in another order paths may differ, each proved.  Threads
    with one each, or a copy of one, do not wait, and their answers depend on their own queries alone.

    Attributes
    ----------
    roadmap : ArmRoadmap
    world : ArmWorld
        The world of the queries; it may check more than the capsules.
    """

    def __init__(self, roadmap: ArmRoadmap, world: Checks) -> None:
        self.roadmap, self.world = roadmap, world
        self.capsules = capsules = world if isinstance(world, ArmWorld) else world.capsules  # type: ignore[attr-defined]
        moving = require_within(roadmap, capsules)
        # What the roadmap has proved free of robot and static scene is only checked against the other obstacles.
        bare, left = left_to_check(capsules.robot, roadmap.scene, moving, capsules.scene)
        # The same object where possible: its cached tables are then found without comparing all values.
        bare = roadmap.bare if capsules.robot is roadmap.robot else bare
        dynamic = ArmWorld(bare, left, resolution=capsules.resolution, clearance=capsules.clearance)
        self._worlds: tuple[Checks, Checks] = capsules, dynamic
        self._first: ArmWorldRoadmap | None = None
        self._wraps = bool(np.any(capsules.space.wrapping))
        self._graph = roadmap.graph.within(np.array(capsules.space.low), np.array(capsules.space.high))
        self._lock = OwnLock()
        if self._expensive:
            # Its own states: what blocks the capsules may not block the other bodies.
            self._first = ArmWorldRoadmap(roadmap, capsules)
            self._worlds = world, replace(world, capsules=dynamic)  # type: ignore[type-var]
        self._make_ready()

    def _make_ready(self) -> None:
        """Compile, or load, what a query needs before a clock runs; only start and goal are checked."""
        world, milestones = self._worlds[0], self.roadmap.milestones
        if world.backend in _ready:
            return
        first = int(np.argmax(world.valid(milestones[:_SOME])))
        here = milestones[first : first + 1]
        found = search(self._graph, self._worlds, Query(here[0], here, 1), 0, math.inf)
        smooth(self.capsules, np.repeat(here, 2, axis=0), batches=0)
        if found.ended != "not free":
            _ready.add(world.backend)

    @property
    def _expensive(self) -> bool:
        return not isinstance(self.world, ArmWorld)

    @property
    def _size(self) -> int:
        return len(self.roadmap.milestones)

    @one_at_a_time
    def connect(
        self,
        start: Floats,
        goals: Floats,
        *,
        most_motions: int = NO_LIMIT,
        seconds: float = SECONDS,
        links: int | None = None,
        greed: float = GREED,
    ) -> Connection:
        """Join a start, (dim,), to the goal, (g, dim), that the roadmap leads to; the path is not shortened.

        Each terminal is tried to be linked to `links` milestones, by default as :func:`links_of` says; the path is the
        shortest one along the roadmap if `greed` is 1.
        """
        links = links_of(self._size) if links is None else require_count("links", links)
        found = self._search(start, goals, most_motions, now() + seconds, links, greed)
        return Connection(found.path, found.goal, self._size, found.configurations, found.motions)

    def _search(
        self, start: Floats, goals: Floats, most: int, deadline: float, links: int, greed: float = GREED
    ) -> SearchResult:
        query = Query(start, goals, links, greed, EXPENSIVE if self._expensive else 1.0)
        return search(self._graph, self._worlds, query, most, deadline)

    @one_at_a_time
    def plan(
        self,
        start: ConfigurationLike,
        goal: Goal | Sequence[Goal],
        *,
        budget: Budget | None = None,
        shorten: bool = True,
        trees: bool = True,
    ) -> PlanResult:
        """Plan from a start to one of the goals: along the roadmap, and with trees if it does not find a path soon.

        Parameters
        ----------
        start, goal : str, array_like of shape (dim,); of goals a sequence of such, too
            Numbers in the order of the group [rad or m], or a text as :func:`evenroad.robot.configuration` takes it.
            A goal may be a Pose or PoseGoal, too: then all postures that are found for it are goals.
        budget : Budget, optional
            Default: 5 s.  Half of the time is for the roadmap, the rest for trees.
        shorten : bool
            Whether the path is made shorter.
        trees : bool
            Whether trees are tried, after 90 motions along the roadmap; else more of its links and all motions are.

        Returns
        -------
        PlanResult
            Every motion of `path` is proved free; other bodies than the capsules are free at states if `proof` says so.

        Raises
        ------
        InvalidValue, UnknownName
            If start or goal is not a configuration of the robot.
        """
        read = read_start_and_goals(self.capsules, start, goal)
        if isinstance(read, PlanResult):
            return read
        first, goals, budget = read[0], read[1].configurations, budget or Budget(seconds=SECONDS)
        trees_of = ArmTrees(self.capsules)
        query = PlanQuery(first, goals, shorten=shorten, budget=budget, connector=trees_of)
        attempt = Attempt(self._worlds[0], query, NO_POINTS, "none", PLANNER)
        if self._first is not None and start_and_goals_free(self.capsules, first, goals):
            found = self._first.plan(first, goals, budget=_by_capsules(budget), shorten=shorten, trees=trees)
            if found.solved:
                return found
            attempt.motions_checked = found.counts.get("edges_checked", 0)
        return self._planned(attempt, trees)

    def solve(self, problem: Problem) -> PlanResult:
        """Plan along the roadmap, in its world, as planners of :func:`evenroad.plan` do."""
        return self.plan(problem.start, problem.goals, budget=problem.budget, shorten=problem.smooth)

    def _planned(self, attempt: Attempt, trees: bool) -> PlanResult:
        """Return the result of a query."""
        first, goals, budget = attempt.query.start, attempt.query.goals, attempt.query.budget
        # Trees grow where the capsules are free.
        follow = trees and (not self._expensive or start_and_goals_free(self.capsules, first, goals))
        links = links_of(self._size) if not follow else EXPENSIVE_LINKS if self._expensive else TRIED_LINKS
        most = NO_LIMIT if budget.motions is None else max(budget.motions - attempt.motions_checked, 0)
        most = min(most, TRIED_MOTIONS) if follow else most
        share = SHARE if follow else 1.0
        deadline = attempt.began + share * min(attempt.deadline - attempt.began, _LONG)
        found = self._search(first, goals, most, deadline, links)
        if found.goal < 0 and (refused := refusal(attempt)) is not None:
            return refused
        if found.ended == "not free":
            # Only the free goals.
            found = self._search(first, goals[attempt.goals], most, deadline, links)
            found = found._replace(goal=int(attempt.goals[found.goal]) if found.goal >= 0 else -1)
        attempt.motions_checked += found.motions
        attempt.watch.seconds["search"] = now() - attempt.began
        if found.goal >= 0:
            return self._solved(attempt, found)
        connection = Connection(found.path, found.goal, self._size, found.configurations, found.motions)
        if follow and attempt.left() is not None:
            connection = self._by_trees(attempt, found)
            if connection.goal >= 0:
                result = connected(attempt, connection)
                assert result.path is not None
                return replace(result, proof=self._proof(result.path))
        failed = gave_up(attempt, connection)
        if not follow and found.ended == "no path":
            text = f"the roadmap of {counted(self._size, 'milestone')} does not lead from start to goal"
            failed = replace(failed, status=Status.NOT_CONNECTED, message=text)
        return failed

    def _by_trees(self, attempt: Attempt, found: SearchResult) -> Connection:
        """Plan with trees, and insert their path into the roadmap."""
        attempt.planner = f"{PLANNER}, then trees"
        grown = attempt.connect(ArmTrees(self.capsules))
        if grown.goal >= 0:
            self._graph.insert(grown.path)
        checked = found.configurations + grown.configurations, attempt.motions_checked
        return replace(grown, configurations=checked[0], motions=checked[1])

    def _solved(self, attempt: Attempt, found: SearchResult) -> PlanResult:
        """Return the result of a path along the roadmap."""
        capsules, path, began, goals = self.capsules, found.path, now(), attempt.query.goals
        if self._expensive and len(path) > 2 and self._graph.size < self._size + MOST_INSERTED:
            # Links of later queries are shorter.
            self._graph.insert(path[:2])
            self._graph.insert(path[-2:])
        length = raw_length = self._length(path)
        counts = dict(
            nodes=self._size,
            configurations_checked=1 + len(goals) + found.configurations,
            edges_checked=attempt.motions_checked,
        )
        if attempt.query.shorten:
            work = WORK if capsules.surfaces is None else AMONG_SURFACES
            work = EXPENSIVE_WORK if self._expensive else max(LEAST_WORK, work - found.batches)
            path, counts["shortcut_motions"] = smooth(capsules, path, batches=work)
            length, attempt.watch.seconds["shortcut"] = self._length(path), now() - began
        to = f" to goal {found.goal}" if len(goals) > 1 else ""
        return make_result(
            self._worlds[0],
            attempt.query.start,
            goals,
            Status.SOLVED,
            f"path of length {length:.6g} with {len(path)} waypoints{to}",
            planner=PLANNER,
            goal_index=found.goal,
            path=path,
            milestone_path=found.path,
            proof=self._proof(path),
            cost=length,
            milestone_cost=raw_length,
            counts=counts,
            timings=attempt.watch.seconds,
        )

    def _proof(self, path: Floats) -> str:
        """Return the proof of a path: ``resolution`` where the capsules do not prove all of it."""
        proved = not self._expensive or self.capsules.validate(path).all()
        return self.capsules.proof if proved else "resolution"

    def _length(self, path: Floats) -> float:
        waypoints = path.tolist()
        # Where nothing wraps the sum is the same, in a tenth of the time.
        return path_length(path, self.capsules.space) if self._wraps else sum(map(math.dist, waypoints, waypoints[1:]))


def _by_capsules(budget: Budget) -> Budget:
    """Return the budget of a plan along the capsules."""
    seconds = None if budget.seconds is None else SHARE * budget.seconds
    motions = BY_CAPSULES if budget.motions is None else min(BY_CAPSULES, budget.motions)
    return replace(budget, seconds=seconds, motions=motions)
