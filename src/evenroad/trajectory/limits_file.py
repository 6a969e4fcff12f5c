"""MoveIt's joint_limits.yaml: limits of joints, also those of Pilz's planner, and factors of all of them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

from evenroad._checks import require_known, require_positive
from evenroad._understood import Kind, require_understood
from evenroad._yaml import numbers, read_mapping
from evenroad.errors import BrokenFile, InvalidValue

RATES = ("velocity", "acceleration", "deceleration", "jerk")
"""Kinds of limits that are one number >= 0."""
_SCALING = {kind: f"default_{kind}_scaling_factor" for kind in ("velocity", "acceleration")}
_POSITION = (("min_position", "soft_lower_limit"), ("max_position", "soft_upper_limit"))
_JOINT = Kind(
    (
        *(f"has_{kind}_limits" for kind in (*RATES, "position", "soft")),
        *(f"max_{kind}" for kind in RATES),
        *(name for names in _POSITION for name in names),
    ),
    # Torques and continuous joints come from the robot's own file.
    harmless={"has_effort_limits", "max_effort", "angle_wraparound", "k_position", "k_velocity"},
)
_FILE = Kind(
    tuple(_SCALING.values()),
    {"joint_limits": Kind(each=_JOINT)},
    refused={
        "cartesian_limits": "those of a link are replace(limits, tip=TipLimits(robot, link, speed, acceleration)), or"
        " --tip-speed and --tip-acceleration"
    },
)


@dataclass(frozen=True)
class LimitsFile:
    """Limits of joints in a file, without those that it switches off.

    `rates` are joint -> kind -> value, and `positions` joint -> (lower, upper), infinite if not given.  `scaling` has
    the factors of all velocities and accelerations, 0 < factor <= 1.
    """

    rates: Mapping[str, Mapping[str, float]]
    positions: Mapping[str, tuple[float, float]]
    scaling: Mapping[str, float]


def read_limits(path: Path, joints: Collection[str]) -> LimitsFile:
    """Read a file about a robot of these joints.

    Raises BrokenFile if it cannot be read; UnknownName for another joint or key; InvalidValue for a limit that is not
    > 0, a factor that is not in (0, 1], or positions in the wrong order.
    """
    document = read_mapping(path, "joint_limits file")
    require_understood(document, _FILE, str(path))
    table = document.get("joint_limits", {})
    if not isinstance(table, dict) or not (table or any(name in document for name in _SCALING.values())):
        raise BrokenFile(f"{path} must have a mapping 'joint_limits', joint -> limits")
    rates, positions = {}, {}
    for name, row in table.items():
        require_known(f"joint in {path}:", name, joints)
        if not isinstance(row, dict):
            raise BrokenFile(f"joint_limits of {name!r} in {path} must be a mapping, got {row!r}")
        where = f"{name} in {path}"
        rates[str(name)] = {kind: _rate(kind, row, where) for kind in RATES if _is_limited(kind, row, where)}
        positions[str(name)] = _positions(row, where)
    scaling = {kind: _factor(name, document.get(name, 1.0), path) for kind, name in _SCALING.items()}
    return LimitsFile(rates, positions, scaling)


def _is_limited(kind: str, row: dict[str, object], where: str) -> bool:
    switch = row.get(f"has_{kind}_limits", True)
    if not isinstance(switch, bool):
        raise InvalidValue(f"has_{kind}_limits of {where} must be true or false, got {switch!r}")
    return switch and f"max_{kind}" in row


def _rate(kind: str, row: dict[str, object], where: str) -> float:
    value = row[f"max_{kind}"]
    # Pilz's planner writes decelerations as negative numbers.
    if kind == "deceleration" and isinstance(value, int | float) and not isinstance(value, bool):
        value = abs(value)
    return require_positive(f"max_{kind} of {where}", value)


def _positions(row: dict[str, object], where: str) -> tuple[float, float]:
    pair = [-float("inf"), float("inf")]
    for kind, switch in enumerate(("position", "soft")):
        for end, names in enumerate(_POSITION):
            if names[kind] in row and row.get(f"has_{switch}_limits", True):
                (value,) = numbers(row[names[kind]], 1, f"{names[kind]} of {where}")
                pair[end] = min(pair[end], value) if end else max(pair[end], value)
    if not pair[0] < pair[1]:
        raise InvalidValue(f"positions of {where} must satisfy min < max, got {pair[0]:g}, {pair[1]:g}")
    return pair[0], pair[1]


def _factor(name: str, value: object, path: Path) -> float:
    return require_positive(f"{name} of {path}", value, at_most=1.0)
