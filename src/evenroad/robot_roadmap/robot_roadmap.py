"""A robot's roadmap, free of the robot itself and of its fixed cell, and what becomes of it in the scene of a day."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints, Ints32
from evenroad.roadmap import Budget, PlanResult, Status
from evenroad.roadmap.answer import connected, gave_up, refusal
from evenroad.roadmap.attempt import Attempt
from evenroad.roadmap.find_path import NO_POINTS, SECONDS
from evenroad.roadmap.hemmed import with_reasons
from evenroad.roadmap.query import FEW, LINKS, Query, read_places
from evenroad.robot import ArmWorld, Robot, Scene, configuration, in_scene
from evenroad.robot_roadmap.cell import day_and_all, require_same_robot
from evenroad.robot_roadmap.ask import ENDS_TAKEN, Asked, ask
from evenroad.robot_roadmap.known_graph import KnownGraph
from evenroad.robot_roadmap.turns import OneTurn, one_turn, whole_turns
from evenroad.world.protocol import Connection

Place = str | npt.ArrayLike
"""A configuration: numbers in the order of the group, or a text as :func:`evenroad.robot.configuration` takes it."""

SHARE = 0.5
"""Of the time, for the roadmap; the rest is the trees', where it does not lead to the goal."""

GREED = 3.0
"""What the bound of the search is multiplied by: its paths are longer, but not so after they were shortened."""

_LONG = 1e8
"""Seconds that stand for no limit."""


@dataclass(frozen=True, eq=False)
class RobotRoadmap:
    """Milestones and motions of a robot in its cell; made once by :func:`make_roadmap`, good for every scene.

    Attributes
    ----------
    robot : Robot
        Whose roadmap it is.
    cell : Scene
        What never moves around it.
    resolution : float
        Largest step of a motion check [rad].
    milestones : ndarray, shape (n, dim)
        Free of robot and cell, of which every beginning is well spread [rad or m]; read-only.
    edges : ndarray of int32, shape (m, 2)
        Motions that are proved free of robot and cell, smaller row first, ascending; read-only.
    turns : ndarray of int8, shape (m, dim)
        By how many turns each edge leads past its second milestone; read-only.
    weights : ndarray, shape (dim,)
        What a unit of each joint counts in the roadmap's metric.
    gamma : float
        The power of the chance of being free that milestones are as dense as.
    """

    robot: Robot
    cell: Scene
    resolution: float
    milestones: Floats
    edges: Ints32
    turns: Ints
    weights: Floats
    gamma: float

    @cached_property
    def world(self) -> ArmWorld:
        """The robot in its cell alone."""
        return ArmWorld(self.robot, self.cell, resolution=self.resolution)

    @cached_property
    def one_turn(self) -> OneTurn:
        """The ranges that the milestones are in."""
        return one_turn(self.world.space, whole_turns(self.robot))

    @cached_property
    def graph(self) -> KnownGraph:
        """The roadmap by node, for the compiled search."""
        return KnownGraph(self.milestones, self.edges, self.turns, self.one_turn, GREED)

    def in_scene(self, scene: Scene) -> SceneRoadmap:
        """Return the roadmap in the day's scene, for many queries in it: what one finds out serves the next."""
        return SceneRoadmap(self, scene)

    def plan(
        self, scene: Scene, start: Place, goal: Place | Sequence[Place], *, budget: Budget | None = None
    ) -> PlanResult:
        """Plan in the day's scene, see :meth:`SceneRoadmap.plan`."""
        return self.in_scene(scene).plan(start, goal, budget=budget)


class SceneRoadmap:
    """A robot's roadmap in one scene, with what earlier queries found out there; of one thread.

    Parameters
    ----------
    roadmap : RobotRoadmap
    scene : Scene
        What stands around the robot today.  The roadmap's cell is always there, named again or not.
    robot : Robot, optional
        The roadmap's robot with other limits or named states.  Default: as it is in the scene.

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

    def __init__(self, roadmap: RobotRoadmap, scene: Scene, robot: Robot | None = None) -> None:
        day, everything = day_and_all(roadmap.cell, scene)
        robot = in_scene(roadmap.robot if robot is None else robot, everything)
        require_same_robot(roadmap.robot, roadmap.cell, robot)
        resolution = roadmap.resolution
        self.roadmap = roadmap
        self.world = ArmWorld(robot, everything, resolution=resolution)
        # What the roadmap knows to be free of the robot and its cell is asked about the other obstacles alone.
        self._day = ArmWorld(replace(robot, pairs=()), day, resolution=resolution)
        self._graph = roadmap.graph.within(np.array(self.world.space.low), np.array(self.world.space.high))

    def connect(
        self,
        start: Floats,
        goals: Floats,
        *,
        most_motions: int = 2**31 - 1,
        seconds: float = SECONDS,
        links: int = LINKS,
    ) -> Connection:
        """Join a start, (dim,), to the goal, (g, dim), that the roadmap leads to.

        Start and goals have to be free; each is tried to be linked to `links` milestones, of few to all.
        """
        asked = self._ask(start, goals, most_motions, time.perf_counter() + seconds, links)
        return Connection(asked.path, asked.goal, self._size, asked.milestones, asked.motions)

    def _ask(self, start: Floats, goals: Floats, most: int, deadline: float, links: int) -> Asked:
        links = self._size if self._size <= FEW else links
        return ask(
            self.world,
            self._day,
            self._graph,
            start,
            goals,
            links=links,
            most_motions=most,
            deadline=deadline,
        )

    @property
    def _size(self) -> int:
        return len(self.roadmap.milestones)

    def plan(
        self,
        start: Place,
        goal: Place | Sequence[Place],
        *,
        budget: Budget | None = None,
        shorten: bool = True,
        trees: bool = True,
    ) -> PlanResult:
        """Plan from a start to one of the goals: along the roadmap and, where it does not lead there, with trees.

        Parameters
        ----------
        start, goal : str, array_like of shape (dim,); of goals a sequence of such, too
            Numbers in the order of the group [rad or m], or a text as :func:`evenroad.robot.configuration` takes it.
        budget : Budget, optional
            Default: 5 s.  Half of the time is the roadmap's, the rest the trees'.
        shorten : bool
            Whether the path is made shorter.
        trees : bool
            Whether trees are tried.

        Returns
        -------
        PlanResult
            Every motion of its path is proved free.

        Raises
        ------
        InvalidValue, UnknownName
            If start or goal is no configuration of the robot.
        """
        budget = Budget(seconds=SECONDS) if budget is None else budget
        places = read_places(self._place(start), self._places(goal), self.world.space)
        query = Query(*places, shorten=shorten, budget=budget)
        attempt = Attempt(self.world, query, NO_POINTS, "none", "robot roadmap")
        most = 2**31 - 1 if budget.motions is None else budget.motions
        if trees:
            most = min(most, self.cap)
        asked = self._asked(attempt, query.goals, most, trees)
        if asked.ended == ENDS_TAKEN:
            if (refused := refusal(attempt)) is not None:
                return refused
            asked = self._asked(attempt, query.goals[attempt.goals], most, trees)
        else:
            attempt.checked += 1 + len(query.goals)
        connection = Connection(asked.path, asked.goal, self._size, asked.milestones, asked.motions)
        attempt.motions_checked += asked.motions
        if asked.goal < 0 and trees and attempt.left() is not None:
            attempt.planner = "robot roadmap, then trees"
            grown = attempt.connect(self.world)
            connection = replace(
                grown,
                configurations=asked.milestones + grown.configurations,
                motions=asked.motions + grown.motions,
            )
            if grown.goal >= 0 and self.learns:
                self._graph.learn(grown.path)
        if connection.goal >= 0:
            return connected(attempt, connection)
        failed = gave_up(attempt, connection)
        if not trees:
            text = f"the roadmap of {self._size} milestones does not lead from start to goal today"
            failed = replace(failed, status=Status.NOT_CONNECTED, message=text)
        return with_reasons(self.world, failed)

    cap = 100
    learns = True
    links = 30

    def _asked(self, attempt: Attempt, goals: Floats, most: int, trees: bool) -> Asked:
        with attempt.watch("search"):
            seconds = SHARE * min(attempt.deadline - time.perf_counter(), _LONG)
            deadline = time.perf_counter() + max(seconds, 1e-3)
            return self._ask(attempt.query.start, goals, most, deadline, self.links if trees else LINKS)

    def _place(self, place: Place) -> npt.ArrayLike:
        """Return a configuration of a text; of numbers themselves."""
        if isinstance(place, str):
            return configuration(self.world.robot, place, self.world.scene)
        return place

    def _places(self, goal: Place | Sequence[Place]) -> npt.ArrayLike:
        if isinstance(goal, list | tuple) and any(isinstance(each, str) for each in goal):
            return [self._place(each) for each in goal]  # type: ignore[return-value]
        return self._place(goal)  # type: ignore[arg-type]
