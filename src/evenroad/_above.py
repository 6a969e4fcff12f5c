"""Functions that methods of values call by name: they import much more than the value, and are loaded on first use."""

from __future__ import annotations

from importlib import import_module
from typing import Any

FUNCTIONS = {
    "ArmRoadmap.within": "evenroad.robot_roadmap.world_roadmap:ArmWorldRoadmap",
    "ArmRoadmap.save": "evenroad.robot_roadmap.file:save_arm_roadmap",
    "plan.planner": "evenroad.robot_roadmap.file:load_roadmap",
}
"""Method -> its function, ``module:name``."""


def above(method: str) -> Any:
    module, _, name = FUNCTIONS[method].partition(":")
    return getattr(import_module(module), name)
