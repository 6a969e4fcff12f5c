"""Robot: a kinematic tree, its bodies as capsules, and the joints that are planned for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from evenroad.robot.capsule import Capsule
from evenroad.robot.joint import Joint


@dataclass(frozen=True)
class Robot:
    """A kinematic tree with bodies.  A value: readers of files and fitting of capsules are elsewhere.

    Attributes
    ----------
    name : str
        Name of the robot.
    links : tuple of str
        All links; the root first, every parent before its children.
    joints : tuple of Joint
        ``joints[i]`` is the joint whose child is ``links[i + 1]``.
    capsules : tuple of Capsule
        The bodies.
    pairs : tuple of pairs of str
        Pairs of links that are tested against each other.
    group : tuple of str
        Joints that are planned for, in the order of the configuration; revolute, continuous or prismatic, none a mimic.
    held : mapping of str to float
        Values of the movable joints that are not in the group [rad or m]; where not given: 0, or the nearest
        to it within limits.
    states : mapping of str to mapping of str to float
        Named configurations: joint -> value, of joints outside of the group, too, where they are known.
    """

    name: str
    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    capsules: tuple[Capsule, ...]
    pairs: tuple[tuple[str, str], ...]
    group: tuple[str, ...]
    held: Mapping[str, float] = field(default_factory=dict)
    states: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
