"""Plans along a robot's roadmap in a scene: lazily, with trees where start or goal is cut off."""

from __future__ import annotations

import time
from dataclasses import replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad.roadmap import Budget, PlanResult
from evenroad.roadmap.answer import connected, gave_up, refusal
from evenroad.roadmap.attempt import Attempt
from evenroad.roadmap.find_path import NO_POINTS, SECONDS
from evenroad.roadmap.hemmed import with_reasons
from evenroad.roadmap.query import FEW, LINKS, Query, read_places
from evenroad.robot import ArmWorld, Scene
from evenroad.robot.trees import lane_arguments
from evenroad.robot_roadmap.robot_roadmap import RobotRoadmap
from evenroad.world.protocol import Connection

MOST_MOTIONS = 1_000_000


class SceneRoadmap:
    """A robot's roadmap in one scene, with what earlier queries found out there.

    Attributes
    ----------
    roadmap : RobotRoadmap
    world : ArmWorld
        The robot in its cell, with the day's obstacles.
    """

    def __init__(self, roadmap: RobotRoadmap, scene: Scene) -> None:
        robot, resolution = roadmap.robot, roadmap.resolution
        self.roadmap = roadmap
        self.world = ArmWorld(robot, in_cell(roadmap.cell, scene), resolution=resolution)
        # What the roadmap knows to be free of the robot and its cell is asked about the other obstacles alone.
        self._day = ArmWorld(replace(robot, pairs=()), scene, resolution=resolution)
        self._milestones = np.zeros(len(roadmap.milestones), dtype=np.int8)
        self._edges = np.zeros(len(roadmap.edges), dtype=np.int8)

    @property
    def planner(self) -> str:
        return "robot roadmap"

    def connect(
        self, start: Floats, goals: Floats, *, most_motions: int = MOST_MOTIONS, links: int = LINKS
    ) -> Connection:
        """Join a start, (dim,), to the goal, (g, dim), that the roadmap leads to on the shortest way."""
        from evenroad.robot_roadmap.lazy_search import Checks, ends_of, lazy_path

        ways = self.roadmap.ways
        n, m, g = len(self._milestones), len(self._edges), len(goals)
        ends = ends_of(ways, start, goals, n if n <= FEW else links)
        edges = np.zeros(m + n * (1 + g) + g, dtype=np.int8)
        edges[:m] = self._edges
        path, goal, configurations, motions = lazy_path(
            ways,
            ends,
            self._milestones,
            edges,
            most_motions,
            Checks(*lane_arguments(self._day)),
            Checks(*lane_arguments(self.world)),
        )
        self._edges[:] = edges[:m]
        return Connection(path, goal, n, configurations, motions)

    def plan(
        self,
        start: npt.ArrayLike,
        goal: npt.ArrayLike,
        *,
        budget: Budget | None = None,
        shorten: bool = True,
        trees: bool = True,
    ) -> PlanResult:
        """Plan from start to goal: along the roadmap, else with trees."""
        budget = Budget(seconds=SECONDS) if budget is None else budget
        query = Query(*read_places(start, goal, self.world.space), shorten=shorten, budget=budget)
        attempt = Attempt(self.world, query, NO_POINTS, "robot roadmap", "robot roadmap")
        if (refused := refusal(attempt)) is not None:
            return refused
        with attempt.watch("search"):
            connection = self.connect(query.start, query.goals[attempt.goals])
        if connection.goal < 0 and trees:
            attempt.motions_checked += connection.motions
            attempt.planner = "robot roadmap, then trees"
            connection = attempt.connect(self.world)
        if connection.goal >= 0:
            return connected(attempt, connection)
        return with_reasons(self.world, gave_up(attempt, connection))


def in_cell(cell: Scene, scene: Scene) -> Scene:
    """Return a scene with the obstacles of the cell that it does not have itself."""
    names = {obstacle.name for obstacle in scene.obstacles}
    missing = [obstacle for obstacle in cell.obstacles if obstacle.name not in names]
    return replace(scene, obstacles=(*missing, *scene.obstacles), allowed=scene.allowed | cell.allowed)
