"""Adapters: other libraries' planners on our worlds and points, ours on their worlds; each needs its extra."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType


def __getattr__(name: str) -> ModuleType:
    if name not in ("klampt", "mujoco", "ompl"):
        raise AttributeError(f"module 'evenroad.adapters' has no attribute {name!r}; there are klampt, mujoco and ompl")
    return import_module(f"evenroad.adapters.{name}")
