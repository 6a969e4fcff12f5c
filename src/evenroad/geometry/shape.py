"""Shape: the base of all shapes, with a pose, the link it is fixed to, and a name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar, TypedDict

from evenroad._arrays import set_fields
from evenroad._checks import FARTHEST, require_positive
from evenroad._hints import keyword_hint
from evenroad.errors import InvalidValue, UnknownName, shown
from evenroad.geometry.pose import IDENTITY, Pose

WORLD = ""
"""The `link` of a shape that is fixed to no link."""


class Placed(TypedDict, total=False):
    """Keywords of all shapes: pose and name."""

    xyz: Sequence[float]
    """Its origin [m]."""
    rpy: Sequence[float]
    """Roll, pitch and yaw [rad]."""
    xyzw: Sequence[float]
    """A quaternion in place of `rpy`."""
    pose: Pose
    """A pose in place of the three."""
    link: str
    """The link that it is fixed to; default: the world."""
    name: str
    """Its name in a scene; default: its kind with a number, as ``box 0``."""


_KEYWORDS = frozenset(Placed.__annotations__)


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Shape:
    """Base of all shapes: a pose in the frame of the link `link`, or of the world (`WORLD`), and a name.

    Comparisons ignore names.
    """

    kind: ClassVar[str]
    """Name of the shape in files."""
    dimensions: ClassVar[tuple[tuple[str, int], ...]] = ()
    """Names of its dimensions in files, and how many numbers each has."""

    pose: Pose
    link: str
    name: str = field(compare=False)

    @cached_property
    def size(self) -> tuple[float, ...]:
        """Its dimensions in a row, in the order of `dimensions` [m]."""
        return tuple(getattr(self, name) for name, _ in self.dimensions)

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        raise NotImplementedError

    def __str__(self) -> str:
        return self.kind

    def __repr__(self) -> str:
        parts = [self._written(), "" if self.pose == IDENTITY else f"pose={self.pose!r}"]
        parts += [f"{key}={value!r}" for key, value in (("link", self.link), ("name", self.name)) if value]
        return f"{type(self).__name__}({', '.join(filter(None, parts))})"

    def _written(self) -> str:
        """Return the dimensions for the repr."""
        return ", ".join(f"{key}={getattr(self, key)!r}" for key, _ in self.dimensions)

    def _set_pose(self, placed: Placed) -> None:
        """Set pose, link and name; UnknownName for another keyword, InvalidValue for two poses."""
        if not placed:
            set_fields(self, pose=IDENTITY, link=WORLD, name="")
            return
        if strange := sorted(placed.keys() - _KEYWORDS):
            # All are listed, because a hint by spelling misleads: `pos` is nearly `pose`, but means `xyz`.
            known = ", ".join(sorted(Placed.__annotations__))
            hint = keyword_hint(strange[0], _KEYWORDS)
            said = f"unknown keyword of a {self.kind}: {shown(strange[0])}"
            raise UnknownName(f"{said}; {hint}{hint and '; '}known: {known}")
        turned = {key: placed[key] for key in ("xyz", "rpy", "xyzw") if key in placed}
        pose = placed.get("pose", IDENTITY)
        if not isinstance(pose, Pose):
            raise InvalidValue(f"the pose of a {self.kind} must be a Pose, got {shown(pose)}")
        if turned and "pose" in placed:
            raise InvalidValue(f"a {self.kind} must have one of pose and {', '.join(turned)}, got both")
        for key in ("name", "link"):
            if not isinstance(placed.get(key, ""), str):
                raise InvalidValue(f"the {key} of a {self.kind} must be a text, got {shown(placed[key])}")
        pose = Pose(**turned) if turned else pose
        set_fields(self, pose=pose, link=placed.get("link", WORLD), name=placed.get("name", ""))

    def _lengths(self, **dimensions: object) -> None:
        """Set dimensions as floats; InvalidValue unless they are finite and > 0 [m]."""
        for name, value in dimensions.items():
            if type(value) is not float or not 0.0 < value <= FARTHEST:
                value = require_positive(f"the {name} of a {self.kind}", value, at_most=FARTHEST)
            object.__setattr__(self, name, value)
