"""Limits of a URDF's joints: of positions, hard and soft ones, and of speeds, accelerations and jerks."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from xml.etree.ElementTree import Element

from evenroad.errors import BrokenFile, InvalidValue, listed
from evenroad.loading.urdf_kinds import LIMITS, SOFT
from evenroad.robots.joint import Joint

_RATES = ("velocity", "acceleration", "deceleration", "jerk")


def with_limits_of(element: Element, joint: Joint, where: str, notes: list[str]) -> Joint:
    """Return a joint with the limits of its checked element.

    A joint that turns without end has limits where soft ones give it some.  A rate of 0 in a URDF means that nobody
    knew it.
    """
    kind, limit = joint.kind, element.find("limit")
    given = _numbers(limit, LIMITS)
    # The word for the same in Drake's dialect.
    for value in _numbers(limit, ("drake:acceleration",)).values():
        given["acceleration"] = min(value, given.get("acceleration") or value)
    rates = [given.get(rate) or math.inf for rate in _RATES]
    for rate, most in zip(_RATES, rates, strict=True):
        if most < 0.0:
            raise InvalidValue(f"the {rate} limit of {where} must be >= 0, got {most:g}")
    lower, upper = hard = _hard(given if limit is not None else None, kind, where, notes)
    safety = _numbers(element.find("safety_controller"), SOFT)
    # Files that have no use for soft limits leave them at 0, their default.
    turns_on = kind == "continuous" and len(safety) < len(SOFT)
    if kind != "fixed" and any(safety.values()) and not turns_on:
        lower, upper = max(lower, safety.get(SOFT[0], -math.inf)), min(upper, safety.get(SOFT[1], math.inf))
        if not lower < upper:
            notes.append(f"the soft limits of {where.partition(' in ')[0]} leave it no range: they are left out")
            lower, upper = hard
    velocity, acceleration, deceleration, jerk = rates
    joint = replace(joint, lower=lower, upper=upper, velocity=velocity)
    joint = replace(joint, acceleration=acceleration, deceleration=deceleration, jerk=jerk)
    if (lower, upper) == hard:
        return joint
    return replace(joint, kind="revolute" if kind == "continuous" else kind, hard=hard)


def soft_notes(joints: Iterable[Joint]) -> list[str]:
    """Return a note about the joints that have soft limits within their hard ones, if there are any."""
    names = listed(joint.name for joint in joints if joint.hard is not None)
    text = "planned within the soft limits of safety_controller, also from a start beyond them"
    return [f"{text}: {names}"] if names else []


def _numbers(element: Element | None, names: Iterable[str]) -> dict[str, float]:
    return {} if element is None else {name: float(element.attrib[name]) for name in names if name in element.attrib}


def _hard(given: dict[str, float] | None, kind: str, where: str, notes: list[str]) -> tuple[float, float]:
    """Return lower and upper; `given` is None where there is no ``<limit>``."""
    if kind == "fixed":
        return 0.0, 0.0
    if kind == "continuous":
        return -math.inf, math.inf
    if given is None:
        raise BrokenFile(
            f"{where} has no limits: a {kind} joint needs <limit lower=... upper=...>; one that rotates without limits"
            " is of type continuous"
        )
    missing = " and ".join(end for end in ("lower", "upper") if end not in given)
    lower, upper = given.get("lower", 0.0), given.get("upper", 0.0)
    if missing:
        note = f"{where.partition(' in ')[0]} has no {missing} limit: 0 by the specification"
        locked = ", so that it cannot move; one that turns without limits is of type continuous"
        notes.append(note + (locked if lower == upper else ""))
    if lower > upper:
        absent = f" ({missing} is not given: 0 by the specification)" if missing else ""
        got = f"got {lower:g}, {upper:g}{absent}"
        raise InvalidValue(f"the limits of {where} must satisfy lower <= upper, {got}")
    return lower, upper
