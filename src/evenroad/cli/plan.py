"""``evenroad plan``: a path for a disk on a map, or for an arm in a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from evenroad.cli.options import HELP, option_names
from evenroad.cli.plan_options import ArmOptions, DiskOptions
from evenroad.errors import InvalidValue


@dataclass(frozen=True, kw_only=True)
class PlanDisk(DiskOptions):
    """Plan a short path for a disk on a map, write a JSON result and a picture.

    A disk (--robot-radius) moves on a bare image (.png, .pgm): unit = pixel, x right, y DOWN, origin in the top-left
    corner, dark = obstacle; or on a ROS map_server file (.yaml): unit = metre, map frame, y up.

    For an arm in a scene give --robot instead; its options: evenroad plan --robot ur5 --help
    """

    def run(self) -> int:
        """Plan, write, report; return 0 when solved, else 1."""
        from evenroad.cli.plan_disk import plan_disk

        return plan_disk(self)


@dataclass(frozen=True, kw_only=True)
class PlanArm(ArmOptions):
    """Plan a short path for an arm in a scene, write a JSON result, the path as CSV and a picture.

    An arm (--robot) moves in a scene file (.yaml): metres and radians, frame of the robot's root link.

    For a disk on a map give --robot-radius instead; its options: evenroad plan --help
    """

    def run(self) -> int:
        """Plan, write, report; return 0 when solved, else 1."""
        from evenroad.cli.plan_arm import plan_arm

        return plan_arm(self)


def plan_type(words: Sequence[str]) -> type[PlanDisk] | type[PlanArm]:
    """Return which of the two the words of a command line ask for, by the robot that is given.

    Raises
    ------
    InvalidValue
        If no robot or two are given, or an option that only the other kind has.
    """
    given = {word.partition("=")[0].replace("_", "-") for word in words if word.startswith("--")}
    chosen: type[PlanDisk] | type[PlanArm] = PlanArm if "--robot" in given else PlanDisk
    if not HELP.isdisjoint(words):
        return chosen
    if len(given & {"--robot", "--robot-radius"}) != 1:
        many = "both" if "--robot" in given else "neither"
        raise InvalidValue(
            f"give --robot-radius (a disk) or --robot (an arm), exactly one of them, not {many}"
        )
    other, needs = (PlanDisk, "--robot-radius") if chosen is PlanArm else (PlanArm, "--robot")
    for option in sorted(given & (option_names(other) - option_names(chosen))):
        raise InvalidValue(f"{option} goes with {needs} only")
    return chosen
