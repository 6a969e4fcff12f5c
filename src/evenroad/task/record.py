"""Steps of a task as plain JSON values, and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import cache, reduce
from operator import and_
from typing import Any

import numpy as np

from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Pose
from evenroad.poses.constraint import Constraint
from evenroad.poses.pose_goal import PoseGoal
from evenroad.task.gripper import Close, Open
from evenroad.task.steps import Attach, Detach, MoveAlong, MoveCircular, MoveLinear, MoveTo, Wait

_STEPS = (MoveTo, MoveLinear, MoveAlong, MoveCircular, Attach, Detach, Open, Close, Wait)
_PLAIN = (str, bool, int, float)


def plain_value(value: object) -> Any:
    """Return a step, or what it holds, as plain JSON values; InvalidValue for what a file cannot hold."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if value is None or isinstance(value, _PLAIN):
        return value
    if isinstance(value, Mapping):
        return {"is": "mapping", "of": {str(key): plain_value(each) for key, each in value.items()}}
    if isinstance(value, Sequence):
        return [plain_value(each) for each in value]
    if isinstance(value, Constraint) and len(value.parts) > 1:
        return {"is": "all", "of": [plain_value(each) for each in value.parts]}
    if is_dataclass(value) and type(value).__name__ in _kinds():
        return {"is": type(value).__name__} | {
            each.name: plain_value(getattr(value, each.name)) for each in fields(value)
        }
    raise InvalidValue(f"a task's file cannot hold {shown(value)}")


def value_of_plain(plain: Any) -> Any:
    """Return what :func:`plain_value` made this of, with tuples in place of arrays and lists.

    Raises InvalidValue, TypeError or LookupError if it is no such value.
    """
    if isinstance(plain, list):
        return tuple(value_of_plain(each) for each in plain)
    if not isinstance(plain, dict):
        return plain
    kind = plain["is"]
    if kind == "mapping":
        return {key: value_of_plain(each) for key, each in plain["of"].items()}
    if kind == "all":
        return reduce(and_, [value_of_plain(each) for each in plain["of"]])
    if kind not in _kinds():
        raise InvalidValue(f"unknown kind of value {shown(kind)}")
    return _kinds()[kind](**{name: value_of_plain(each) for name, each in plain.items() if name != "is"})


@cache
def _kinds() -> dict[str, type]:
    """Return the types of values that steps have, by name."""
    import evenroad.constraints as constraints

    kept = [getattr(constraints, name) for name in dir(constraints)]
    values = [each for each in kept if isinstance(each, type) and issubclass(each, Constraint)]
    return {each.__name__: each for each in (*_STEPS, Pose, PoseGoal, *values)}
