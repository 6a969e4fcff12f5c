"""RobotModel: a robot, and how it was made from its files."""

from __future__ import annotations

from dataclasses import dataclass, field

from evenroad.loading.robot_file import RobotFile
from evenroad.robots.robot import Robot


@dataclass(frozen=True)
class LinkBody:
    """The capsules of a link's collision geometry.

    `shapes` are the file's, e.g. ``box`` or ``mesh forearm.stl``, with the sum of their volumes [m^3]; `capsules` is
    the number that stands for them, with the volume of their union [m^3]; `given` says whether the user gave them.
    """

    link: str
    shapes: tuple[str, ...]
    shape_volume: float
    capsules: int
    capsule_volume: float
    given: bool = False

    @property
    def added(self) -> float:
        """Volume that the capsules add, as a share of the shapes'; 0 where the shapes have none."""
        return max(self.capsule_volume / self.shape_volume - 1.0, 0.0) if self.shape_volume > 0.0 else 0.0


@dataclass(frozen=True)
class RobotModel:
    """A robot and how it was made."""

    robot: Robot
    bodies: tuple[LinkBody, ...]
    """One for each link that has a body."""
    pairs_from: str
    """``SRDF`` or ``computed``."""
    dropped: tuple[tuple[str, str, str], ...]
    """Pairs of links with bodies that are not tested, each with the reason."""
    drawn_only: tuple[str, ...] = ()
    """Links with visuals and no body: nothing ever touches them."""
    always_touching: tuple[tuple[str, str], ...] = ()
    """Pairs that the SRDF does not disable and that touch in every sampled configuration."""
    never_free: str = ""
    """If no sampled configuration is free of self-collision: a text with the pair that blocks most, and what to do."""
    notes: tuple[str, ...] = ()
    """Notes on all that was read otherwise than it stands in the file."""
    file: RobotFile | None = field(default=None, compare=False)
    """The file of the robot and its options."""

    @property
    def bodiless(self) -> tuple[str, ...]:
        """Links without a body, including those with visuals."""
        bodied = {body.link for body in self.bodies}
        return tuple(link for link in self.robot.links if link not in bodied)
