"""Adapters: other libraries' planners on our worlds and points, ours on their worlds; each needs its extra."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

KNOWN = ("klampt", "mplib", "mujoco", "ompl", "simulated")


def __getattr__(name: str) -> ModuleType:
    if name not in KNOWN:
        raise AttributeError(f"module 'evenroad.adapters' has no attribute {name!r}; there are {', '.join(KNOWN)}")
    return import_module(f"evenroad.adapters.{name}")
