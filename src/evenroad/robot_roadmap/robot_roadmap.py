"""A robot's roadmap, made once for it and its fixed cell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from evenroad.geometry.shapes import Shape
from evenroad.planning.planner import Problem
from evenroad.planning.trees import RRTConnect
from evenroad.roadmap import Budget, PlanResult
from evenroad.robot import Scene
from evenroad.robot_roadmap.known_motions import KnownMotions, world_of
from evenroad.robot_roadmap.places import Goal, Place, read_ends
from evenroad.robot_roadmap.scene_roadmap import SceneRoadmap


@dataclass(frozen=True, eq=False)
class RobotRoadmap(KnownMotions):
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
    ends : int
        How many ends in pockets they learned from, at most.
    """

    def in_scene(self, scene: Scene, shapes: Sequence[Shape] | None = None) -> SceneRoadmap:
        """Return the roadmap in the day's scene, for many queries in it: what one finds out serves the next."""
        return SceneRoadmap(self, scene, shapes=shapes)

    def plan(
        self, scene: Scene, start: Place, goal: Goal | Sequence[Goal], *, budget: Budget | None = None
    ) -> PlanResult:
        """Plan one query in the day's scene: with trees, whose slowest queries are the nearer ones in a new scene.

        For more queries, or to go along the roadmap, take :meth:`in_scene`; see :meth:`SceneRoadmap.plan` for the
        arguments.
        """
        world, _ = world_of(self, scene)
        if world.backend != "lanes":
            # Trees do not grow.
            return self.in_scene(scene).plan(start, goal, budget=budget)
        ends = read_ends(world, start, goal)
        if isinstance(ends, PlanResult):
            return ends
        first, given = ends
        budget = budget or Budget(seconds=RRTConnect.seconds)
        problem = Problem(world, first, given.configurations, budget=budget, apart=given.apart(world))
        return RRTConnect().solve(problem)
