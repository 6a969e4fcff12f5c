"""RobotModel: a robot and the account of how it was made from its files."""

from __future__ import annotations

from dataclasses import dataclass

from evenroad.robot.robot import Robot


@dataclass(frozen=True)
class LinkBody:
    """What became of the collision geometry of a link.

    Attributes
    ----------
    link : str
        Name of the link.
    shapes : tuple of str
        What the URDF gives, e.g. ``box``, ``mesh forearm.stl``.
    shape_volume : float
        Sum of the volumes of those shapes [m^3].
    capsules : int
        How many capsules stand for them.
    capsule_volume : float
        Volume of the union of the capsules [m^3].
    given : bool
        Whether the user gave the capsules; else they were fitted, or the URDF has capsules and spheres itself.
    """

    link: str
    shapes: tuple[str, ...]
    shape_volume: float
    capsules: int
    capsule_volume: float
    given: bool = False

    @property
    def added(self) -> float:
        """Volume that the capsules add, as a share of the shapes'; 0 where there is nothing to compare with."""
        return max(self.capsule_volume / self.shape_volume - 1.0, 0.0) if self.shape_volume > 0.0 else 0.0


@dataclass(frozen=True)
class RobotModel:
    """A robot and how it was made.

    Attributes
    ----------
    robot : Robot
        The robot.
    bodies : tuple of LinkBody
        One for each link that has a body.
    pairs_from : str
        ``SRDF`` or ``computed``: where the self pairs come from.
    dropped : tuple of (str, str, str)
        Pairs of links with bodies that are not tested, each with the reason.
    drawn_only : tuple of str
        Links that the URDF draws (``<visual>``) and that have no body: nothing is ever found to touch them.
    """

    robot: Robot
    bodies: tuple[LinkBody, ...]
    pairs_from: str
    dropped: tuple[tuple[str, str, str], ...]
    drawn_only: tuple[str, ...] = ()

    @property
    def bodiless(self) -> tuple[str, ...]:
        """Links without a body, those that are drawn among them."""
        bodied = {body.link for body in self.bodies}
        return tuple(link for link in self.robot.links if link not in bodied)
