"""What becomes of a robot's roadmap in the scene of a day: queries, and what one finds out for the next."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import counted, require_count
from evenroad._clock import now
from evenroad._shared import OwnLock, one_at_a_time
from evenroad.geometry.shapes import Shape
from evenroad.planning.arm_trees import tighten
from evenroad.planning.connectors import ArmTrees
from evenroad.planning.hemmed_in import with_reasons
from evenroad.planning.planner import Problem
from evenroad.roadmap import Budget, PlanResult, Status
from evenroad.roadmap.answer import connected, gave_up, refusal
from evenroad.roadmap.attempt import Attempt
from evenroad.roadmap.connector import Connection
from evenroad.roadmap.query import Query
from evenroad.roadmap.result import NO_POINTS, require_ends
from evenroad.robot import ArmWorld, Robot, Scene
from evenroad.robot_roadmap.ask import Asked, Checks, ask, prepare
from evenroad.robot_roadmap.cell import left_to_check
from evenroad.robot_roadmap.known_motions import KnownMotions, world_of
from evenroad.robot_roadmap.lazy_search import ENDS_TAKEN, SPENT
from evenroad.robot_roadmap.own_shapes import OwnShapesWorld
from evenroad.robot_roadmap.places import Goal, Place, ends_free, read_ends
from evenroad.robot_roadmap.pockets import links_of
from evenroad.robot_roadmap.search_memory import CUT_OFF, NODES, NONE
from evenroad.robot_roadmap.ways_out import learn_ways_out
from evenroad.space.path import path_length

PLANNER = "robot roadmap"

SECONDS = 5.0
"""Wall time of a query whose budget is not given."""

SHARE = 0.5
"""Of the time, for the roadmap; the rest is the trees', where it does not lead to the goal."""

GREED = 3.0
"""What the bound of the search is multiplied by: a third of the checks of a shortest way, and once they are shortened
its paths are no longer."""

NEARBY = 2.0
"""Of a start's links so many times their length counts more where no trees follow: a third to two thirds of the motions
until a way is found, that is 0 to 3 % longer once it is shortened."""

LINKS = 300
"""Each end is tried to be linked to so many milestones where nothing else is said; plans without trees go by
`links_of`: asked lazily, more links cost little but where ends are cut off, and there they are worth much."""

TRIED_LINKS, TRIED_MOTIONS = 40, 90
"""Where trees may follow, so many links of each end are tried, and so many motions: trees find ways out of narrow
places with fewer checks than long links do."""

WORK, AMONG_SURFACES, LEAST_WORK = 170, 50, 30
"""After so many batches of sixteen checks, those of search and proof among them, a path is not drawn tighter; after
fewer among clouds and triangles, where each takes longer; but so many it has.  With more the slowest queries take
longer, and paths become shorter by ever less."""

DEAR_LINKS, DEAR_WORK, MOST_LEARNED = 100, 800, 2000
"""Where checks are dear: so many links of each end are tried, paths are drawn tight with so many batches, and ends of
queries are learned until there are so many milestones more."""

SOON = 5000
"""So many motions ways out may take before shapes are asked: some milliseconds."""

_LONG = 1e8
"""Seconds that stand for no limit."""

_SOME = 64
"""Milestones among which one that is free today is looked for, to compile with."""

_ready: set[str] = set()
"""Backends whose programs are compiled."""


class SceneRoadmap:
    """A robot's roadmap in one scene, with what earlier queries found out there.

    Threads may share it: their queries are answered one after the other.  Each is answered with what those before it
    found out, so that the same queries in the same order have the same answers; in another order, as of threads, paths
    may be others, each proved as ever.  Threads with a roadmap in the scene each, or a copy of one,
    wait for nobody, and their answers depend on their own queries alone.

    Parameters
    ----------
    roadmap : RobotRoadmap
    scene : Scene
        What stands around the robot today.  The roadmap's cell is always there, named again or not.
    robot : Robot, optional
        The roadmap's robot with other limits or named states.  Default: as it is in the scene.
    shapes : sequence of Shape, optional
        The robot's own, as of :func:`evenroad.robot.reference.coal_world.original_shapes`, which decide where its
        capsules touch (extra ``mesh``).  Default: capsules alone.

    Attributes
    ----------
    world : ArmWorld
        The robot in its cell, with the day's obstacles.

    Raises
    ------
    InvalidValue
        If the robot is another than the roadmap's, or the scene has the cell in another way: the text says how.
    UnknownName
        If the scene names something that is not there.
    """

    def __init__(
        self,
        roadmap: KnownMotions,
        scene: Scene,
        robot: Robot | None = None,
        shapes: Sequence[Shape] | None = None,
    ) -> None:
        self.roadmap = roadmap
        self.world, day = world_of(roadmap, scene, robot)
        robot = self.world.robot
        # What the roadmap knows to be free of the robot and its cell is asked about the other obstacles alone.
        bare, left = left_to_check(robot, roadmap.cell, day, self.world.scene)
        # One and the same where it can be: what is known of it need not be looked up by all of its values.
        bare = roadmap.bare if robot is roadmap.robot else bare
        self._day = ArmWorld(bare, left, resolution=roadmap.resolution)
        self._asked: tuple[Checks, Checks] = self.world, self._day
        self._own: SceneRoadmap | None = None
        if shapes is not None:
            # With verdicts of its own: what blocks the capsules need not block the shapes.
            self._own = SceneRoadmap(roadmap, scene, robot)
            self._own._asked = OwnShapesWorld(self.world, shapes), OwnShapesWorld(self._day, shapes)
            self._own._make_ready()
        self._graph = roadmap.graph.within(np.array(self.world.space.low), np.array(self.world.space.high))
        self._wraps = bool(np.any(self.world.space.wrapping))
        self._lock = OwnLock()
        self._make_ready()

    def _make_ready(self) -> None:
        """Compile, or load, what a query takes before a clock runs; nothing is checked but the ends."""
        backend, roadmap = self._asked[0].backend, self.roadmap
        if backend not in _ready:
            prepare()
            first = int(np.argmax(self._asked[0].valid(roadmap.milestones[:_SOME])))
            end = roadmap.milestones[first : first + 1]
            asked = self._ask(end[0], end, 0, math.inf, 1)
            self._graph.learn(roadmap.milestones[:0])
            self._graph.around(roadmap.weights, 0.0, 1)
            tighten(self.world, np.repeat(end, 2, axis=0), batches=0)
            if asked.ended != ENDS_TAKEN:
                _ready.add(backend)

    @one_at_a_time
    def connect(
        self,
        start: Floats,
        goals: Floats,
        *,
        most_motions: int = 2**31 - 1,
        seconds: float = SECONDS,
        links: int = LINKS,
        greed: float = GREED,
    ) -> Connection:
        """Join a start, (dim,), to the goal, (g, dim), that the roadmap leads to.

        Each is tried to be linked to `links` milestones, of few to all; the path is the shortest one along the roadmap
        where `greed` is 1.
        """
        links = require_count("links", links)
        asked = self._ask(start, goals, most_motions, now() + seconds, links, greed)
        return Connection(asked.path, asked.goal, self._size, asked.milestones, asked.motions)

    def _ask(
        self,
        start: Floats,
        goals: Floats,
        most: int,
        deadline: float,
        links: int,
        greed: float = GREED,
        nearby: float = 0.0,
        **flags: bool,
    ) -> Asked:
        world, day = self._asked
        return ask(world, day, self._graph, start, goals, most, deadline, links, greed, nearby, **flags)

    @property
    def _size(self) -> int:
        return len(self.roadmap.milestones)

    def solve(self, problem: Problem) -> PlanResult:
        """Plan along the roadmap, in its world, as planners of :func:`evenroad.plan` do."""
        return self.plan(problem.start, problem.goals, budget=problem.budget, shorten=problem.smooth)

    @one_at_a_time
    def plan(
        self,
        start: Place,
        goal: Goal | Sequence[Goal],
        *,
        budget: Budget | None = None,
        shorten: bool = True,
        trees: bool = True,
    ) -> PlanResult:
        """Plan from a start to one of the goals: along the roadmap and, where it does not lead there soon, with trees.

        Parameters
        ----------
        start, goal : str, array_like of shape (dim,); of goals a sequence of such, too
            Numbers in the order of the group [rad or m], or a text as :func:`evenroad.robot.configuration` takes it.
            A goal may be a Pose or PoseGoal, too: then all postures that are found for it are goals.
        budget : Budget, optional
            Default: 5 s.  Half of the time is the roadmap's, the rest the trees'.
        shorten : bool
            Whether the path is made shorter.
        trees : bool
            Whether trees are tried, after 90 motions along the roadmap; else more of its links and all motions are.

        Returns
        -------
        PlanResult
            Every motion of `path` is proved free, of the robot's own shapes free at states where `proof` says so.  Of
            `milestone_path`, where `shorten`, motions may be free at states alone.

        Raises
        ------
        InvalidValue, UnknownName
            If start or goal is no configuration of the robot.
        """
        ends = read_ends(self.world, start, goal)
        if isinstance(ends, PlanResult):
            return ends
        first, goals, budget = ends[0], ends[1].configurations, budget or Budget(seconds=SECONDS)
        began, deadline = now(), budget.deadline()
        most = 2**31 - 1 if budget.motions is None else budget.motions
        # Trees grow among what is free for the capsules.
        follow = trees and (not self._dear or ends_free(self.world, first, goals))
        links = (DEAR_LINKS if self._dear else TRIED_LINKS) if follow else links_of(self._size)
        share = SHARE if follow or self._own is not None else 1.0
        limits = min(most, TRIED_MOTIONS) if follow else most, began + share * min(deadline - began, _LONG)
        order = GREED, 0.0 if follow else NEARBY
        asked = self._ask(first, goals, *limits, links, *order, proved=not shorten)
        if asked.ended in (NONE, CUT_OFF, SPENT) and follow and len(goals) == 1:
            soon = most if self._own is None else min(most, asked.motions + SOON)
            asked = self._by_ways_out(asked, first, goals, soon, limits[1], links)
        elif asked.ended in (NONE, CUT_OFF) and not follow and self.roadmap.one_turn.lifts.any():
            # What leads to the goal within one turn is not to be lost.
            before, left = asked, limits[0] - asked.motions
            asked = self._ask(first, goals, left, limits[1], links, *order, unturned=True).after(before)
        while asked.goal >= 0:
            if (result := self._solved(asked, first, goals, shorten, began)) is not None:
                return result
            # What was drawn tight could not be proved: the way itself has to be.
            before, left = asked, max(limits[0] - asked.motions, 0)
            asked = self._ask(first, goals, left, limits[1], links, *order).after(before)
        if self._own is not None:
            budget = budget.rest(deadline, asked.motions)
            return self._own.plan(first, goals, budget=budget, shorten=shorten, trees=trees)
        query = Query(first, goals, shorten=shorten, budget=budget, connector=ArmTrees(self.world))
        attempt = Attempt(self._asked[0], query, NO_POINTS, "none", PLANNER)
        attempt.deadline, attempt.motions_checked = deadline, asked.motions
        attempt.watch.seconds["search"] = now() - began
        if (refused := refusal(attempt)) is not None:
            return refused
        if asked.ended == ENDS_TAKEN:
            # Without the goals that are not free.
            asked = self._ask(first, goals[attempt.goals], *limits, links, *order)
            attempt.motions_checked = asked.motions
        connection = Connection(asked.path, asked.goal, self._size, asked.milestones, asked.motions)
        if asked.goal < 0 and follow and attempt.left() is not None:
            connection = self._by_trees(attempt, asked)
        if connection.goal >= 0:
            result = connected(attempt, connection)
            assert result.path is not None
            return replace(result, proof=self._proof(result.path))
        failed = gave_up(attempt, connection)
        if not follow and asked.ended != SPENT:
            text = f"the roadmap of {counted(self._size, 'milestone')} does not lead from start to goal today"
            failed = replace(failed, status=Status.NOT_CONNECTED, message=text)
        return with_reasons(self._asked[0], failed)

    def _by_ways_out(
        self, asked: Asked, start: Floats, goals: Floats, most: int, deadline: float, links: int
    ) -> Asked:
        """Ask again along what is known to be free, with ways learned that lead there from the ends."""
        left = most - asked.motions
        out = learn_ways_out(self.world, self._graph, self.roadmap.weights, (start, goals[0]), left, deadline)
        before = asked.milestones + out.configurations, asked.motions + out.motions
        batches = asked.batches + 2 * out.motions
        if out.complete:
            rest = min(TRIED_MOTIONS, max(most - before[1], 0))
            asked = self._ask(start, goals, rest, deadline, links, only_known=True)
            before = before[0] + asked.milestones, before[1] + asked.motions
        return asked._replace(milestones=before[0], motions=before[1], batches=batches + asked.batches)

    def _by_trees(self, attempt: Attempt, asked: Asked) -> Connection:
        """Return what trees find, and learn it."""
        attempt.planner = f"{PLANNER}, then trees"
        grown = attempt.connect(ArmTrees(self.world))
        if grown.goal >= 0:
            self._graph.learn(grown.path)
        checked = asked.milestones + grown.configurations, asked.motions + grown.motions
        return replace(grown, configurations=checked[0], motions=checked[1])

    def _solved(
        self, asked: Asked, start: Floats, goals: Floats, shorter: bool, began: float
    ) -> PlanResult | None:
        """Return the result of a query that the roadmap answered; None where it was not proved and cannot be."""
        world, path, found = self.world, asked.path, now()
        if self._dear:
            self._learn_ends(path)
        length = raw_length = self._length(path)
        checked = 1 + len(goals) + asked.milestones
        counts = dict(nodes=self._size, configurations_checked=checked, edges_checked=asked.motions)
        seconds = {"search": found - began}
        if shorter:
            most = WORK if world.lanes.surfaces is None else AMONG_SURFACES
            work = DEAR_WORK if self._dear else max(LEAST_WORK, most - asked.batches)
            path, counts["shortcut_motions"] = tighten(world, path, batches=work, proved=asked.proved)
            if not len(path):
                return None
            length, seconds["shortcut"] = self._length(path), now() - found
        to = f" to goal {asked.goal}" if len(goals) > 1 else ""
        result = PlanResult(
            status=Status.SOLVED,
            message=f"path of length {length:.6g} with {len(path)} waypoints{to}",
            start=start,
            goals=goals,
            origin=NO_POINTS,
            rule="none",
            planner=PLANNER,
            goal_index=asked.goal,
            path=path,
            milestone_path=asked.path,
            proof=self._proof(path),
            cost=length,
            milestone_cost=raw_length,
            counts=counts,
            timings=seconds,
            world=world,
        )
        return require_ends(world.space, result)

    def _learn_ends(self, path: Floats) -> None:
        """Make milestones of the ends of a path: links to them are shorter for the next query."""
        if len(path) > 2 and int(self._graph.desk[NODES]) < self._size + MOST_LEARNED:
            self._graph.learn(path[:2])
            self._graph.learn(path[-2:])

    @property
    def _dear(self) -> bool:
        """Whether others than the capsules are asked."""
        return not isinstance(self._asked[0], ArmWorld)

    def _proof(self, path: Floats) -> str:
        """Return what a path is known by: states alone where the capsules do not prove all of it."""
        return "resolution" if self._dear and not self.world.recheck(path).all() else self.world.proof

    def _length(self, path: Floats) -> float:
        places = path.tolist()
        # Where nothing wraps the sum is the same, in a tenth of the time.
        return path_length(path, self.world.space) if self._wraps else sum(map(math.dist, places, places[1:]))
