"""Fingerprints: hashes of robots and scenes, equal only where all verdicts on configurations are the same."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from evenroad.robot.robot import Robot
from evenroad.robot.scene import Scene

_NAMES_ALONE = {Robot: ("name", "states"), Scene: ("name", "states", "limits")}
"""What decides no verdict.  A scene's limits do where a robot has taken them over; then they are the robot's."""


def fingerprint(value: Robot | Scene) -> str:
    """Return the SHA-256 (hex) of all that decides whether a configuration of a robot, or in a scene, is free.

    The same on every machine and in every process.  Names of the robot and the scene, and their named states, do not
    count; the order of obstacles and of allowed contacts does not, either.
    """
    fields = asdict(value)
    for name in _NAMES_ALONE[type(value)]:
        del fields[name]
    if isinstance(value, Scene):
        fields["obstacles"] = sorted(
            ([o.name, o.shape, o.size, o.xyz, o.rotation] for o in value.obstacles),
            key=lambda row: str(row[0]),
        )
        fields["allowed"] = sorted(value.allowed)
    text = json.dumps({type(value).__name__: _exact(fields)}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def _exact(value: Any) -> Any:
    """Return a value made of what JSON has, its numbers as texts that hold every bit."""
    if isinstance(value, Mapping):
        return {str(key): _exact(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_exact(entry) for entry in value]
    if isinstance(value, np.ndarray):
        return [value.shape, (value + 0.0).astype("<f8").tobytes().hex()]
    if isinstance(value, bool) or value is None or isinstance(value, str):
        return value
    # Zeros of both signs are one number.
    return (float(value) + 0.0).hex()
