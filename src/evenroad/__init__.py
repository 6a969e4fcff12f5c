"""evenroad: point sets that make sampling-based motion planners need fewer samples.

The public names below are loaded on first use, so that ``import evenroad`` costs milliseconds.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from evenroad import _compiled

__version__ = "0.1.0"

_compiled.provide_cache()

if TYPE_CHECKING:
    from evenroad.errors import EvenroadError as EvenroadError
    from evenroad.points import Origin as Origin
    from evenroad.points import PointSet as PointSet
    from evenroad.points import draw as draw
    from evenroad.points import load_points as load_points
    from evenroad.points import save_points as save_points
    from evenroad.roadmap import KNearest as KNearest
    from evenroad.roadmap import PlanResult as PlanResult
    from evenroad.roadmap import Radius as Radius
    from evenroad.roadmap import Status as Status
    from evenroad.roadmap.plan import plan as plan
    from evenroad.robot import ArmWorld as ArmWorld
    from evenroad.robot import load_robot as load_robot
    from evenroad.robot import load_scene as load_scene
    from evenroad.viz import save_plan_picture as save_plan_picture
    from evenroad.viz.arm import save_arm_picture as save_arm_picture
    from evenroad.world import GridMap as GridMap
    from evenroad.world import load_map as load_map

_HOMES = {
    "EvenroadError": "evenroad.errors",
    "Origin": "evenroad.points",
    "PointSet": "evenroad.points",
    "draw": "evenroad.points",
    "load_points": "evenroad.points",
    "save_points": "evenroad.points",
    "KNearest": "evenroad.roadmap",
    "PlanResult": "evenroad.roadmap",
    "Radius": "evenroad.roadmap",
    "Status": "evenroad.roadmap",
    "plan": "evenroad.roadmap",
    "ArmWorld": "evenroad.robot",
    "load_robot": "evenroad.robot",
    "load_scene": "evenroad.robot",
    "save_plan_picture": "evenroad.viz",
    "save_arm_picture": "evenroad.viz.arm",
    "GridMap": "evenroad.world",
    "load_map": "evenroad.world",
}

__all__ = ["__version__", "qmc", *_HOMES]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(importlib.import_module(_HOMES[name]), name)
    if name == "qmc":
        return importlib.import_module("evenroad.qmc")
    raise AttributeError(f"module 'evenroad' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
