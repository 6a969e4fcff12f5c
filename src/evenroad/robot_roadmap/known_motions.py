"""What a robot's roadmap knows: milestones and motions that are free of the robot itself and of its fixed cell."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from evenroad._arrays import Floats, Ints, Ints32
from evenroad.robot import ArmWorld, Robot, Scene, in_scene
from evenroad.robot.known_robots import prepared
from evenroad.robot_roadmap.cell import day_and_all, require_same_robot
from evenroad.robot_roadmap.known_graph import KnownGraph
from evenroad.robot_roadmap.turns import OneTurn, one_turn, whole_turns


@dataclass(frozen=True, eq=False)
class KnownMotions:
    """Milestones and motions of a robot in its cell: the fields of a RobotRoadmap, which documents them."""

    robot: Robot
    cell: Scene
    resolution: float
    milestones: Floats
    edges: Ints32
    turns: Ints
    weights: Floats
    gamma: float
    ends: int = 0

    @cached_property
    def world(self) -> ArmWorld:
        """The robot in its cell alone."""
        return ArmWorld(self.robot, self.cell, resolution=self.resolution)

    @cached_property
    def bare(self) -> Robot:
        """The robot without the pairs of its own that are tested: what the roadmap knows."""
        return replace(self.robot, pairs=())

    @cached_property
    def one_turn(self) -> OneTurn:
        """The ranges that the milestones are in."""
        # Of the robot alone: for the world something has to be compiled.
        return one_turn(prepared(self.robot)[0], whole_turns(self.robot))

    @cached_property
    def graph(self) -> KnownGraph:
        """The roadmap by node, for the compiled search."""
        return KnownGraph(self.milestones, self.edges, self.turns, self.one_turn)


def world_of(roadmap: KnownMotions, scene: Scene, robot: Robot | None = None) -> tuple[ArmWorld, Scene]:
    """Return the robot in its cell among the obstacles of a day, and these alone; raises as ``SceneRoadmap``."""
    day, everything = day_and_all(roadmap.cell, scene)
    robot = in_scene(roadmap.robot if robot is None else robot, everything)
    require_same_robot(roadmap.robot, roadmap.cell, robot.empty_handed())
    return ArmWorld(robot, everything, resolution=roadmap.resolution), day
