"""What a joint can be put at."""

from __future__ import annotations

import math

from evenroad.errors import InvalidValue
from evenroad.robot.joint import Joint


def require_within(joint: Joint, value: float, what: str) -> None:
    """Raise InvalidValue unless a joint can have a value [rad or m]; `what` is said to have put it there."""
    if not math.isfinite(value):
        raise InvalidValue(f"{what} puts joint {joint.name!r} at {value!r}; it must be a finite number")
    if joint.lower <= value <= joint.upper:
        return
    unit = "m" if joint.kind == "prismatic" else "rad"
    beyond = max(joint.lower - value, value - joint.upper)
    raise InvalidValue(
        f"{what} puts joint {joint.name!r} at {value:.6g} {unit}, {beyond:.3g} {unit} outside its limits"
        f" [{joint.lower:.6g}, {joint.upper:.6g}]"
    )
