"""The picture of any value that has one, and what a trajectory shows: a plan in its world."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from PIL import Image

from evenroad._load import load
from evenroad.collision.arm_world import ArmWorld
from evenroad.driving.car_world import CarWorld
from evenroad.driving.polygon_map import PolygonMap
from evenroad.errors import InvalidValue, shown
from evenroad.flight.flight_trajectory import FlightTrajectory
from evenroad.flight.flight_world import FlightWorld
from evenroad.loading.find import list_robots
from evenroad.loading.load import load_robot
from evenroad.planning.make_result import make_result
from evenroad.planning.problem import Problem
from evenroad.planning.result import PlanResult, Status
from evenroad.points.pointset import PointSet
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Scene
from evenroad.task.motion import Motion
from evenroad.task.result import TaskResult
from evenroad.trajectory.car_states import CarTrajectory
from evenroad.trajectory.trajectory import Trajectory
from evenroad.viz.flight import draw_flight
from evenroad.viz.posture import draw_arm_world, draw_scene
from evenroad.viz.result import plot_parts
from evenroad.world.gridmap import DiskWorld, GridMap

_ROBOTS = (".urdf", ".xacro", ".xml")


def picture_of(what: object, q: object = None) -> Image.Image:
    """Return the picture of a value, of a robot at a configuration `q`; InvalidValue if there is none."""
    if (moving := plan_shown(what)) is not None:
        return moving.plot()
    draw = next((each for kind, each in _pictures(q) if isinstance(what, kind)), None)
    if draw is None:
        kinds = "a trajectory, a task, a robot, a scene, points, a world of these, or a file of one"
        raise InvalidValue(f"a plan or a map can be shown, {kinds}, got {shown(what)}")
    return draw(what)


def opened(source: str | os.PathLike[str]) -> object:
    """Return what a file holds, as `evenroad.load` does, or a robot by its name or file."""
    is_robot = Path(source).suffix.lower() in _ROBOTS or os.fspath(source) in list_robots()
    return load_robot(source) if is_robot else load(source)


def plan_shown(what: object) -> PlanResult | None:
    """Return a plan, or a trajectory as a plan in its world; None of what is neither."""
    if isinstance(what, PlanResult):
        return what
    if not isinstance(what, Trajectory | CarTrajectory):
        return None
    if what.world is None:
        raise InvalidValue(
            "this trajectory does not know its world, without which it cannot be shown;"
            " of a task, show the answer itself"
        )
    rows = what.waypoints if isinstance(what, Trajectory) else what.positions
    problem = Problem(what.world, what.positions[0].copy(), what.positions[-1:].copy())
    return make_result(
        problem, Status.SOLVED, f"trajectory of {what.duration:.4g} s", path=rows, goal_index=0, proof=what.proof
    )


def _pictures(q: object) -> list[tuple[type | tuple[type, ...], Callable[..., Image.Image]]]:
    """Return what draws a value of each type."""
    return [
        (ArmWorld, lambda world: draw_arm_world(world, q)),
        (Robot, lambda robot: draw_arm_world(ArmWorld(robot), q)),
        (Scene, draw_scene),
        (FlightWorld, lambda world: draw_scene(world.scene)),
        (FlightTrajectory, draw_flight),
        ((GridMap, PointSet, TaskResult), lambda what: what.plot()),
        ((DiskWorld, CarWorld, PolygonMap), lambda what: what.grid.plot()),
        (Motion, lambda motion: plot_parts(motion.parts)),
    ]
