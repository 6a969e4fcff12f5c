"""The numbers of a configuration in OMPL's states, which have a type for each kind of space."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from evenroad._checks import require_extra
from evenroad.errors import InvalidValue

ob = require_extra("ompl.base", "ompl", "evenroad.adapters.ompl")

Ompl: TypeAlias = Any
"""A value of OMPL, whose bindings have no types."""
Numbers: TypeAlias = Sequence[float]


@dataclass(frozen=True)
class StateFormat:
    """Dimension of a state of one OMPL space, and functions that read and write its numbers in our order."""

    dim: int
    read: Callable[[Ompl], list[float]]
    write: Callable[[Ompl, Numbers], None]


def format_of(space: Ompl) -> StateFormat:
    """Return the format of states of an OMPL space, or raise InvalidValue for an unknown one."""
    make = _FORMATS.get(type(space).__name__)
    if make is None:
        known = ", ".join(sorted(_FORMATS))
        raise InvalidValue(f"OMPL's {type(space).__name__} has no counterpart here; known: {known}")
    return make(space)


def _real_vector(space: Ompl) -> StateFormat:
    dim = space.getDimension()

    def write(state: Ompl, q: Numbers) -> None:
        state[0:dim] = q

    return StateFormat(dim, lambda state: list(state[0:dim]), write)


def _circle(space: Ompl) -> StateFormat:
    def write(state: Ompl, q: Numbers) -> None:
        state.value = _turned(q[0])

    return StateFormat(1, lambda state: [state.value], write)


def _rotation(space: Ompl) -> StateFormat:
    def write(state: Ompl, q: Numbers) -> None:
        state.w, state.x, state.y, state.z = q

    return StateFormat(4, lambda state: [state.w, state.x, state.y, state.z], write)


def _plane_pose(space: Ompl) -> StateFormat:
    def write(state: Ompl, q: Numbers) -> None:
        state.setXY(q[0], q[1])
        state.setYaw(_turned(q[2]))

    return StateFormat(3, lambda state: [state.getX(), state.getY(), state.getYaw()], write)


def _pose(space: Ompl) -> StateFormat:
    rotation = _rotation(space)

    def read(state: Ompl) -> list[float]:
        return [state.getX(), state.getY(), state.getZ(), *rotation.read(state.rotation())]

    def write(state: Ompl, q: Numbers) -> None:
        state.setXYZ(*q[:3])
        rotation.write(state.rotation(), q[3:])

    return StateFormat(7, read, write)


def _compound(space: Ompl) -> StateFormat:
    parts = [format_of(space.getSubspace(i)) for i in range(space.getSubspaceCount())]

    def read(state: Ompl) -> list[float]:
        return [number for i, part in enumerate(parts) for number in part.read(state[i])]

    def write(state: Ompl, q: Numbers) -> None:
        at = 0
        for i, part in enumerate(parts):
            part.write(state[i], q[at : at + part.dim])
            at += part.dim

    return StateFormat(sum(part.dim for part in parts), read, write)


_FORMATS: dict[str, Callable[[Ompl], StateFormat]] = {
    "RealVectorStateSpace": _real_vector,
    "SO2StateSpace": _circle,
    "SO3StateSpace": _rotation,
    "SE2StateSpace": _plane_pose,
    "SE3StateSpace": _pose,
    "CompoundStateSpace": _compound,
}


def _turned(angle: float) -> float:
    """Return an angle in [-pi, pi), OMPL's range; angles in it are not rounded."""
    if -math.pi <= angle < math.pi:
        return angle
    turned = (angle + math.pi) % (2.0 * math.pi) - math.pi
    return turned if turned < math.pi else -math.pi
