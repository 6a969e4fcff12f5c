"""RobotSetup: what a scene says of the robot in it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import TypedDict

from evenroad.robots.held import HeldObject


class Said(TypedDict, total=False):
    """Keywords of a scene that say something of its robot; see :class:`evenroad.Scene`."""

    states: Mapping[str, Mapping[str, float]]
    limits: Mapping[str, tuple[float, float]]
    attached: tuple[HeldObject, ...]
    padding: Mapping[str, float]


@dataclass(frozen=True)
class LinkFrames:
    """Obstacles and attached objects whose poses are in the frames of links, until a robot is known.

    Attributes
    ----------
    links : mapping of str to str
        Obstacle or attached object -> the link; ``""`` is the root link.
    joints : mapping of str to float
        Where the robot stands, joint -> value [rad or m]; other joints are where the robot holds them, else at 0 or,
        where that is beyond their limits, in the middle of these.
    are_links : bool
        Whether all frames must be links.  Else a single one that is none is taken as the root link.
    """

    links: Mapping[str, str]
    joints: Mapping[str, float] = field(default_factory=dict)
    are_links: bool = True

    def without(self, names: Collection[str]) -> LinkFrames | None:
        """Return the frames of the other objects, None where there are none."""
        left = {name: link for name, link in self.links.items() if name not in names}
        return replace(self, links=left) if left else None


@dataclass(frozen=True)
class RobotSetup:
    """What a scene says of its robot: named states, ranges to plan in, what is attached, padding, frames of links."""

    states: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    attached: tuple[HeldObject, ...] = ()
    padding: Mapping[str, float] = field(default_factory=dict)
    frames: LinkFrames | None = None


NO_SETUP = RobotSetup()
"""A scene that says nothing of its robot."""
