"""``evenroad plan``: a path for a disk on a map, or for an arm in a scene."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Plan a short path for a disk on a map or for an arm in a scene, write a picture and a JSON result.

    A disk (--robot-radius) moves on a bare image (.png, .pgm): unit = pixel, x right, y DOWN, origin in the top-left
    corner, dark = obstacle; or on a ROS map_server file (.yaml): unit = metre, map frame, y up.
    An arm (--robot) moves in a scene file (.yaml): metres and radians, frame of the robot's root link.
    """

    world: Annotated[Path, tyro.conf.Positional]
    """A map (.png or .pgm image, ROS map_server .yaml) or a scene (.yaml; shipped: box-reach.yaml,
    box-reach-narrow.yaml)."""
    start: tuple[str, ...]
    """Disk: x y in map units.  Arm: one number a joint with commas between them, name=value,..., or a named state."""
    goal: tuple[str, ...]
    """As start."""
    robot_radius: float | None = None
    """Plan for a disk of this radius, > 0, in map units."""
    robot: str | None = None
    """Plan for this arm: a URDF file, or the name of a shipped one (ur5, arm7)."""
    clearance: float = 0.0
    """Disk: margin to keep from every obstacle, added to the radius, >= 0."""
    unknown_is_free: bool = False
    """Disk: may pass through unknown cells of a ROS map."""
    srdf: Path | None = None
    """Arm: its SRDF, with groups, named states and pairs of links that need no test."""
    group: str | None = None
    """Arm: a group of the SRDF, or joints with commas between them; the others are held where the named states of start
    and goal have them, else at 0."""
    bodies: Path | None = None
    """Arm: a YAML file of capsules and spheres in place of the URDF's collision geometry."""
    deg: bool = False
    """Arm: angles of start and goal are in degrees."""
    resolution: float | None = None
    """Arm: largest step of a motion check, > 0, in radians (default 0.05)."""
    n: Annotated[int, tyro.conf.arg(aliases=["-n"])] = 512
    """How many points to draw."""
    k: Annotated[int | None, tyro.conf.arg(aliases=["-k"])] = None
    """Connect each milestone with its k nearest, symmetrised (default 10; 20 from six joints on)."""
    connect_radius: float | None = None
    """Connect milestones up to this distance instead, in map units or radians."""
    sampler: str = "auto"
    """even, hickernell, mpmc, korobov, lattice, halton, sobol, sukharev or uniform; auto, the default, is
    even."""
    plain: bool = False
    """halton and sobol: the plain sequence instead of the scrambled one."""
    skip: int = 0
    """halton and sobol: index of the first point of the sequence."""
    allow_fewer: bool = False
    """sukharev: take the largest grid with at most n points."""
    seed: int = 0
    """Seed of everything random; the same command gives the same path."""
    raw: bool = False
    """Leave the path as it runs along the roadmap, without shortcutting it."""
    out: Path | None = None
    """Where results go: OUT.png, OUT.json and, for an arm, OUT.csv. Default: the world's stem in the current folder,
    with -plan added where that would overwrite an input."""
    csv: bool = False
    """Disk: also write the path as OUT.csv."""

    def run(self) -> int:
        """Plan, write, report; return 0 when solved, else 1."""
        from evenroad.errors import InvalidValue

        if (self.robot_radius is None) == (self.robot is None):
            given = "neither" if self.robot is None else "both"
            raise InvalidValue(
                f"give --robot-radius (a disk) or --robot (an arm), exactly one of them, not {given}"
            )
        if self.robot is None:
            from evenroad.cli.plan_disk import plan_disk

            return plan_disk(self)
        from evenroad.cli.plan_arm import plan_arm

        return plan_arm(self)
