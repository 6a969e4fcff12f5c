"""ArmRoadmap: milestones and motions that touch neither the arm itself nor its static scene, for many scenes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from evenroad._above import above
from evenroad._arrays import Floats, Ints, Ints32
from evenroad._native.robot_roadmap import SceneGraph
from evenroad._npz import Path
from evenroad.roadmap.point_roadmap import Roadmap, WorldRoadmap
from evenroad.robot import ArmWorld, Robot, Scene
from evenroad.robot.prepared_robots import prepared
from evenroad.robot_roadmap.turns import OneTurn, one_turn, whole_turns


@dataclass(frozen=True, eq=False, repr=False)
class ArmRoadmap(Roadmap):
    """A roadmap of an arm, proved free of the arm itself and of its static scene; made by ``er.build_roadmap``.

    Attributes
    ----------
    robot : Robot
        The robot, with empty hands.
    scene : Scene
        The static scene: all that never moves.
    milestones : ndarray, shape (n, dim)
        Free configurations, the first n of which are well spread for every n [rad or m]; read-only.
    edges : ndarray of int32, shape (m, 2)
        Motions that are proved free, smaller row first, ascending; read-only.
    turns : ndarray of int8, shape (m, dim)
        Number of turns by which each edge leads past its second milestone; read-only.
    weights : ndarray, shape (dim,)
        Weight of each joint in the roadmap's metric.
    resolution, clearance : float
        Those of the world that it was built in [rad, m].
    """

    robot: Robot
    scene: Scene
    milestones: Floats
    edges: Ints32
    turns: Ints
    weights: Floats
    resolution: float
    clearance: float = 0.0

    def _of(self) -> str:
        return f"{self.robot.name!r} in {self.scene.name!r}"

    @cached_property
    def world(self) -> ArmWorld:
        """The robot in its static scene alone."""
        return ArmWorld(self.robot, self.scene, resolution=self.resolution, clearance=self.clearance)

    @cached_property
    def bare(self) -> Robot:
        """The robot without self-collision pairs, which the roadmap has checked."""
        return replace(self.robot, pairs=())

    @cached_property
    def one_turn(self) -> OneTurn:
        """The ranges that the milestones are in."""
        # Of the robot alone: a world would have to be compiled.
        return one_turn(prepared(self.robot)[0], whole_turns(self.robot))

    @cached_property
    def graph(self) -> SceneGraph:
        """The roadmap by milestone, for the native search."""
        return scene_graph(self.milestones, self.edges, self.turns, self.one_turn)

    def within(self, world: Any) -> WorldRoadmap:
        """Return a planner in a world of this arm, which keeps the result of every check.

        Parameters
        ----------
        world : ArmWorld
            The robot in a scene of other obstacles.  Limits may be narrower, and the robot may hold something.

        Raises
        ------
        InvalidValue
            If the robot is another one, an object of the static scene stands elsewhere, or the world's clearance is
            larger than the roadmap's; the text says what differs.

        Examples
        --------
        >>> import evenroad as er
        >>> roadmap = er.build_roadmap(er.ArmWorld("ur5"), er.draw("even", 32, 6))
        >>> roadmap.within(er.ArmWorld("ur5", "box-reach")).plan("home", "inside").solved
        True
        """
        planner: WorldRoadmap = above("ArmRoadmap.within")(self, world)
        return planner

    def save(self, file: Path) -> None:
        """Write it with its robot and static scene, atomically; ``er.load_roadmap`` reads it.

        Raises BrokenFile if the file cannot be written; an earlier file is then untouched.
        """
        above("ArmRoadmap.save")(file, self)


def read_only(roadmap: ArmRoadmap) -> ArmRoadmap:
    """Return a roadmap with read-only arrays."""
    for array in (roadmap.milestones, roadmap.edges, roadmap.turns, roadmap.weights):
        np.asarray(array).setflags(write=False)
    return roadmap


def scene_graph(milestones: Floats, edges: Ints32, turns: Ints, one: OneTurn) -> SceneGraph:
    """Return a roadmap's milestones, (n, dim), and edges, (m, 2), that lead past their second ones by turns, (m, dim).

    Nothing is known of them yet; `one` has the ranges of the joints.
    """
    joints = one.limits, 0.5 * (one.low + one.high), one.multi_turn, one.wraps & ~one.multi_turn
    return SceneGraph(
        np.ascontiguousarray(milestones, dtype=np.float64),
        np.ascontiguousarray(edges, dtype=np.int32),
        np.ascontiguousarray(turns, dtype=np.int8),
        joints,
    )
