"""Joint: how a link moves on its parent."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Kind = Literal["revolute", "continuous", "prismatic", "fixed"]


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another: ``value = multiplier * other + offset``."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Joint:
    """How a link moves on its parent, as URDF has it.

    Attributes
    ----------
    name : str
        Name of the joint.
    kind : {"revolute", "continuous", "prismatic", "fixed"}
        Turns about, or slides along, its axis; or neither.
    parent, child : str
        Names of the links it joins.
    xyz : tuple of 3 floats
        Origin of the joint's frame in the parent link's [m].
    rotation : tuple of 9 floats
        Rotation from the joint's frame to the parent link's, row by row.  The child's frame is the joint's at value 0.
    axis : tuple of 3 floats
        Unit vector in the joint's frame; of no meaning where fixed.
    lower, upper : float
        Limits [rad or m]; -inf and inf for a continuous joint.
    velocity : float
        Largest speed [rad/s or m/s]; inf where not given.
    mimic : Mimic or None
        The joint that this one follows.
    """

    name: str
    kind: Kind
    parent: str
    child: str
    xyz: tuple[float, float, float]
    rotation: tuple[float, ...]
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    lower: float = 0.0
    upper: float = 0.0
    velocity: float = float("inf")
    mimic: Mimic | None = None

    @property
    def neutral(self) -> float:
        """0, or the nearest to it within limits."""
        return float(min(max(0.0, self.lower), self.upper))
