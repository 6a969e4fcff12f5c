"""Functions that methods of values call by name: they import much more than the value, and are loaded on first use."""

from __future__ import annotations

from importlib import import_module
from typing import Any

FUNCTIONS = {
    "Scene": "evenroad.robot.scene_file:scene_of",
    "ArmWorld.robot": "evenroad.robot.load:load_robot",
    "ArmWorld.scene": "evenroad.robot.scene_file:load_scene",
    "GridMap.plot": "evenroad.viz.result:plot_map",
    "PointRoadmap.within": "evenroad.roadmap.point_world_roadmap:PointWorldRoadmap",
    "PointRoadmap.save": "evenroad.roadmap.npz:save_point_roadmap",
    "ArmRoadmap.within": "evenroad.robot_roadmap.world_roadmap:ArmWorldRoadmap",
    "ArmRoadmap.save": "evenroad.robot_roadmap.file:save_arm_roadmap",
    "PlanResult.plot": "evenroad.viz.result:plot_result",
    "plan.planner": "evenroad.robot_roadmap.file:load_roadmap",
    "PlanResult.load": "evenroad.io:load_plan",
    "PlanResult.save": "evenroad.io:save_result",
    "PlanResult.trajectory": "evenroad.trajectory.arm:trajectory_of",
    "Trajectory.save": "evenroad.trajectory.files:save_trajectory",
    "PointSet.discrepancy": "scipy.stats.qmc:discrepancy",
    "PointSet.save": "evenroad.points.npz:write_points",
    "Task.plan": "evenroad.task.solve:plan_task",
}
"""Method -> its function, ``module:name``."""


def above(method: str) -> Any:
    """Return the function of a method."""
    module, _, name = FUNCTIONS[method].partition(":")
    return getattr(import_module(module), name)
