"""An arm's roadmap in one world: a planner that keeps the results of checks, and the paths that trees found."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter as now

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import counted, require_count
from evenroad._shared import OwnLock, one_at_a_time
from evenroad.planning import arm_trees
from evenroad.planning.arm_trees import checks_of
from evenroad.planning.connectors import ArmTrees
from evenroad.planning.read_request import request_in
from evenroad.planning.request import ConfigurationLike, Goal, Reading, unreached
from evenroad.planning.trees import RRTConnect
from evenroad.roadmap import Budget, PlanResult, Status
from evenroad.roadmap.answer import connected, gave_up, refusal
from evenroad.roadmap.attempt import NO_LIMIT, Attempt
from evenroad.roadmap.connector import Connection, Smooth
from evenroad.roadmap.point_roadmap import WorldRoadmap
from evenroad.roadmap.problem import Problem
from evenroad.roadmap.query import Query as PlanQuery
from evenroad.roadmap.result import NO_POINTS, make_result
from evenroad.robot import ArmWorld
from evenroad.robot_roadmap.arm_roadmap import ArmRoadmap
from evenroad.robot_roadmap.changed_world import changed_dynamic, names_changed, world_of_changes
from evenroad.robot_roadmap.query import GREED, Query, SearchResult, search
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

_LONG = 1e8
"""Number of seconds that stands for no limit."""


def links_of(n: int) -> int:
    """Return the number of n milestones that start and goal are linked to: of up to 256 all, of 1024 half."""
    return min(n, round(16.0 * np.sqrt(n)))


class ArmWorldRoadmap(WorldRoadmap):
    """An arm's roadmap in one world, with the results of earlier checks; made by :meth:`ArmRoadmap.within`.

    Threads may share it: their queries are answered one after the other, each with the results of earlier checks.  So
    the same queries in the same order have the same answers; in another order paths may differ, each proved.  Threads
    with one each, or a copy of one, do not wait, and their answers depend on their own queries alone.

    Attributes
    ----------
    roadmap : ArmRoadmap
    world : ArmWorld
    """

    world: ArmWorld

    def __init__(self, roadmap: ArmRoadmap, world: ArmWorld) -> None:
        self.roadmap, self.world = roadmap, world
        moving = require_within(roadmap, world)
        # What the roadmap has proved free of robot and static scene is only checked against the other obstacles.
        bare, left = left_to_check(world.robot, roadmap.scene, moving, world.scene)
        # The same object where possible: its cached tables are then found without comparing all values.
        bare = roadmap.bare if world.robot is roadmap.robot else bare
        dynamic = ArmWorld(bare, left, resolution=world.resolution, clearance=world.clearance)
        self._worlds = world, dynamic
        self._wraps = bool(np.any(world.space.wrapping))
        self._graph = roadmap.graph.within(np.array(world.space.low), np.array(world.space.high))
        self._lock = OwnLock()

    @one_at_a_time
    def within(self, world: ArmWorld) -> WorldRoadmap:
        """Return the roadmap in its world after that was changed, with what is known of all that is not near a change.

        Parameters
        ----------
        world : ArmWorld
            As a rule made of `world` by ``moved``, ``with_`` or ``without``.  In another one nothing is known yet, nor
            where there are clouds or meshes, or the robot holds something.

        Returns
        -------
        WorldRoadmap

        Raises
        ------
        InvalidValue
            As :meth:`ArmRoadmap.within`.

        Examples
        --------
        >>> import evenroad as er
        >>> world = er.ArmWorld("ur5", "box-reach")
        >>> kept = er.build_roadmap(er.ArmWorld("ur5"), er.draw("even", 32, 6)).within(world)
        >>> kept.plan("home", "inside").solved
        True
        >>> kept.within(world.without("box top")).plan("home", "inside").solved
        True
        """
        before, names, roadmap = self.world, names_changed(self.world, world), self.roadmap
        assert isinstance(roadmap, ArmRoadmap)
        if names is None or world.robot.holds or not names.isdisjoint(roadmap.scene.names):
            return roadmap.within(world)
        made: ArmWorldRoadmap = object.__new__(type(self))
        made.roadmap, made.world, made._wraps, made._lock = roadmap, world, self._wraps, OwnLock()
        made._worlds = world, changed_dynamic(self._worlds[1], roadmap.scene, before.scene, world.scene, names)
        ranges = np.array(world.space.low), np.array(world.space.high)
        changes = world_of_changes(self._worlds[1], before.scene, world.scene, names)
        made._graph = self._graph.within(*ranges, checks_of(changes))
        return made

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
        return search(self._graph, self._worlds, Query(start, goals, links, greed), most, deadline)

    def plan(
        self,
        start: ConfigurationLike,
        goal: Goal | Sequence[Goal],
        *,
        budget: Budget | None = None,
        smooth: Smooth = True,
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
        smooth : bool or "quick"
            Whether the path is made shorter; "quick": by straight shortcuts alone.
        trees : bool
            Whether trees are tried, after 90 motions along the roadmap; else more of its links and all motions are.

        Returns
        -------
        PlanResult
            Every motion of `path` is proved free.

        Raises
        ------
        InvalidValue, UnknownName
            If start or goal is not a configuration of the robot.
        """
        request = request_in(self.world, start, goal, Reading())
        if (result := unreached(request)) is not None:
            return result
        problem = Problem(
            self.world, request.start, request.goals, budget=budget or Budget(seconds=SECONDS), smooth=smooth
        )
        return self._solve(problem, trees)

    def solve(self, problem: Problem) -> PlanResult:
        """Plan along the roadmap, in its world, as planners of :func:`evenroad.plan` do."""
        return self._solve(problem, trees=True)

    @one_at_a_time
    def _solve(self, problem: Problem, trees: bool) -> PlanResult:
        how = dict(smooth=problem.smooth, budget=problem.budget, connector=ArmTrees(self.world))
        query = PlanQuery(problem.start, problem.goals, **how)  # type: ignore[arg-type]
        return self._planned(Attempt(self.world, query, NO_POINTS, "none", PLANNER), trees)

    def _planned(self, attempt: Attempt, trees: bool) -> PlanResult:
        """Return the result of a query."""
        first, goals, budget = attempt.query.start, attempt.query.goals, attempt.query.budget
        links = TRIED_LINKS if trees else links_of(self._size)
        most = NO_LIMIT if budget.motions is None else max(budget.motions - attempt.motions_checked, 0)
        most = min(most, TRIED_MOTIONS) if trees else most
        share = SHARE if trees else 1.0
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
        if trees and attempt.left() is not None:
            connection = self._by_trees(attempt, found)
            if connection.goal >= 0:
                return connected(attempt, connection)
        failed = gave_up(attempt, connection)
        if not trees and found.ended == "no path":
            text = f"the roadmap of {counted(self._size, 'milestone')} does not lead from start to goal"
            failed = replace(failed, status=Status.NOT_CONNECTED, message=text)
        return failed

    def _by_trees(self, attempt: Attempt, found: SearchResult) -> Connection:
        """Plan with trees, and insert their path into the roadmap."""
        attempt.planner = f"{PLANNER}, then trees"
        grown = attempt.connect(ArmTrees(self.world))
        if grown.goal >= 0:
            self._graph.insert(grown.path)
        checked = found.configurations + grown.configurations, attempt.motions_checked
        return replace(grown, configurations=checked[0], motions=checked[1])

    def _solved(self, attempt: Attempt, found: SearchResult) -> PlanResult:
        """Return the result of a path along the roadmap."""
        world, path, began, goals = self.world, found.path, now(), attempt.query.goals
        length = raw_length = self._length(path)
        counts = dict(
            nodes=self._size,
            configurations_checked=1 + len(goals) + found.configurations,
            edges_checked=attempt.motions_checked,
        )
        if attempt.query.smooth == "quick":
            path, counts["shortcut_motions"] = arm_trees.shorten(world, path)
        elif attempt.query.smooth:
            work = max(LEAST_WORK, (AMONG_SURFACES if world.native_scene.surfaces else WORK) - found.batches)
            path, counts["shortcut_motions"] = arm_trees.smooth(world, path, batches=work)
        if attempt.query.smooth:
            length, attempt.watch.seconds["shortcut"] = self._length(path), now() - began
        to = f" to goal {found.goal}" if len(goals) > 1 else ""
        return make_result(
            world,
            attempt.query.start,
            goals,
            Status.SOLVED,
            f"path of length {length:.6g} with {len(path)} waypoints{to}",
            planner=PLANNER,
            goal_index=found.goal,
            path=path,
            milestone_path=found.path,
            proof=world.proof,
            cost=length,
            milestone_cost=raw_length,
            counts=counts,
            timings=attempt.watch.seconds,
        )

    def _length(self, path: Floats) -> float:
        waypoints = path.tolist()
        # Where nothing wraps the sum is the same, in a tenth of the time.
        return path_length(path, self.world.space) if self._wraps else sum(map(math.dist, waypoints, waypoints[1:]))
