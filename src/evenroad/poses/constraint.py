"""Constraints of an arm's tip as values: ``line & upright`` holds both."""

from __future__ import annotations

from dataclasses import replace
from functools import reduce
from operator import and_
from typing import TypeVar

from evenroad.errors import InvalidValue, shown

Kind = TypeVar("Kind", bound="Constraint")


class Constraint:
    """Base of the constraints of an arm's tip."""

    @property
    def parts(self) -> tuple[Constraint, ...]:
        """The single constraints, at most one of each kind for one tip."""
        return (self,)

    @property
    def key(self) -> tuple[object, ...]:
        """Kind and tip, in which constraints that go together must differ."""
        return type(self), getattr(self, "tip", "")

    def __and__(self, other: Constraint) -> Constraint:
        """Return a constraint that holds both."""
        if not isinstance(other, Constraint):
            raise InvalidValue(f"a constraint goes with another constraint, got {shown(other)}")
        return _Both((*self.parts, *other.parts))


class _Both(Constraint):
    parts: tuple[Constraint, ...] = ()

    def __init__(self, parts: tuple[Constraint, ...]) -> None:
        if len({each.key for each in parts}) < len(parts):
            raise InvalidValue(f"constraints of one kind must be of different tips, got {shown(parts)}")
        self.parts = parts

    def __repr__(self) -> str:
        return " & ".join(map(repr, self.parts))


def part_of(constraints: Constraint | None, kind: type[Kind]) -> Kind | None:
    """Return the constraint of a kind, or None; InvalidValue for what is no constraint."""
    if constraints is not None and not isinstance(constraints, Constraint):
        raise InvalidValue(f"constraints must be a constraint, such as er.CartesianLine(0.1), got {shown(constraints)}")
    return next((each for each in constraints.parts if isinstance(each, kind)), None) if constraints else None


def with_tip(constraints: Constraint | None, tip: str) -> Constraint | None:
    """Return the constraints, those without a tip for this link."""
    given = constraints.parts if constraints else ()
    parts = [replace(each, tip=each.tip or tip) if hasattr(each, "tip") else each for each in given]  # type: ignore
    return reduce(and_, parts) if parts else None
