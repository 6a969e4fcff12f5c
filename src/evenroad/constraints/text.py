"""Constraints from texts in files and commands: ``line y within=0.001``."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from evenroad.constraints.differential_drive import DifferentialDrive
from evenroad.constraints.linked import KeepJoints, KeepOnCircle, KeepTogether
from evenroad.constraints.tip import KeepInBox, KeepInPlane, KeepOnLine, KeepOrientation, KeepUpright
from evenroad.errors import InvalidValue, UnknownName
from evenroad.poses.constraint import Constraint
from evenroad.poses.pose_goal import as_numbers

KINDS: dict[str, tuple[Callable[..., Constraint], tuple[str, ...], int, tuple[str, ...]]] = {
    "upright": (KeepUpright, ("within",), 1, ("axis", "tip")),
    "orientation": (KeepOrientation, ("within",), 0, ("tip",)),
    "plane": (KeepInPlane, ("normal",), 1, ("through", "within", "tip")),
    "line": (KeepOnLine, ("normal",), 1, ("through", "within", "tip")),
    "box": (KeepInBox, ("low", "high"), 2, ("within", "tip")),
    "circle": (KeepOnCircle, ("centre", "axis"), 1, ("within", "tip")),
    "together": (KeepTogether, ("first", "second"), 2, ("within",)),
    "differential-drive": (DifferentialDrive, (), 0, ("x", "y", "heading")),
}
"""First word -> the constraint, its positional words, how many of these it needs, and its keywords."""

_Value = str | float | tuple[float, ...]
_POINTS = ("through", "low", "high", "centre")
_NAMES = ("tip", "first", "second", "x", "y", "heading")


def constraint_of(text: str, *, degrees: bool = False) -> Constraint:
    """Return a constraint from its text: a kind, its required values, and ``name=value`` for optional ones.

    ::

        upright 0.1 axis=-z tip=tool0
        orientation 0.001
        plane z through=0,0,0.5 within=0.001
        line y
        box 0,-0.5,0.2 0.6,0.5,0.8
        circle 0.8,0.3,0 z
        together tool0 left_tool0
        differential-drive x=base/x y=base/y heading=base/theta
        joints elbow_joint=0,2.5

    Points are in metres, separated by commas; angles are in radians, or in degrees.

    Raises
    ------
    InvalidValue, UnknownName
        For an empty text, an unknown kind or name, or values that the constraint refuses.
    """
    words = text.split()
    if not words:
        raise InvalidValue("a constraint must be a text such as 'upright 0.1', got nothing")
    kind, given = words[0], words[1:]
    if kind == "joints":
        return _joints(text, given, degrees)
    if kind not in KINDS:
        raise UnknownName.among("constraint", kind, [*KINDS, "joints"])
    make, names, needed, options = KINDS[kind]
    values: dict[str, _Value] = {}
    for word in given:
        name, equals, value = word.partition("=")
        if not equals:
            name, value = (next((each for each in names if each not in values), ""), word)
        if name not in (*names, *options) or name in values:
            said = " ".join([kind, *(name.upper() for name in names)])
            raise InvalidValue(
                f"{word!r} says nothing of the constraint {text!r}: it is {said}, then {', '.join(options)}=..."
            )
        values[name] = _value(kind, name, value, degrees)
    if missing := [name for name in names[:needed] if name not in values]:
        raise InvalidValue(f"the constraint {text!r} needs {' and '.join(missing)}")
    return make(**values)


def constraints_of(texts: Sequence[str], *, degrees: bool = False) -> list[Constraint]:
    """Return the constraints of several texts; raises as :func:`constraint_of`."""
    return [constraint_of(text, degrees=degrees) for text in texts]


def _value(kind: str, name: str, text: str, degrees: bool) -> _Value:
    if name in _NAMES:
        return text
    if name in _POINTS:
        return as_numbers(f"{name} of {kind}", text, (3,))
    if name == "within":
        (within,) = as_numbers(f"within of {kind}", text, (1,))
        return math.radians(within) if degrees and kind in ("upright", "orientation") else within
    # An axis or a normal: a letter, or numbers.
    return as_numbers(f"{name} of {kind}", text, (3,)) if "," in text else text


def _joints(text: str, given: list[str], degrees: bool) -> KeepJoints:
    if degrees:
        raise InvalidValue("a constraint of joints goes without degrees: their ranges are in radians or metres")
    ranges = {}
    for word in given:
        name, _, value = word.partition("=")
        low, high = as_numbers(f"the range of {name!r}", value, (2,))
        ranges[name] = low, high
    if not ranges:
        raise InvalidValue(f"the constraint {text!r} needs a range, such as elbow_joint=0,2.5")
    return KeepJoints(ranges)
