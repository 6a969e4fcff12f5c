"""``evenroad roadmap``: a roadmap for one arm in its cell, which ``evenroad plan --roadmap`` reads."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated

from evenroad._checks import counted, require_positive
from evenroad._files import require_writable_folder
from evenroad._terminal import print_table, progress_shown
from evenroad.cli.options import Positional
from evenroad.cli.plan import PlanArm, RobotOptions, wants_points
from evenroad.cli.sampler import require_seed
from evenroad.errors import InvalidValue
from evenroad.robot import ArmWorld, Scene, find_robot, find_scene, load_scene
from evenroad.robot_roadmap.arm_roadmap import ArmRoadmap
from evenroad.robot_roadmap.build import arm_roadmap, require_size
from evenroad.robot_roadmap.file import load_roadmap
from evenroad.robot_roadmap.static_scene import require_same_robot


@dataclass(frozen=True, kw_only=True)
class MakeRoadmap(RobotOptions):
    """Make a roadmap for an arm in its cell: milestones and motions that touch neither the arm itself nor the cell.

    It is made once, in some seconds, and serves every scene of that cell: evenroad plan scene.yaml --roadmap FILE.
    """

    robot: Positional[str]
    """A URDF, xacro or MJCF file, or a name: ur5, arm7; with the extra [robots] panda and others."""
    cell: Path | None = None
    """A scene (.yaml) of all that never moves: mount, fence, walls; and the ranges to plan in.  Default: nothing."""
    n: Annotated[int, "-n"] = 1024
    """Number of milestones."""
    k: Annotated[int, "-k"] = 16
    """Number of nearest milestones that each is joined to by free motions."""
    resolution: float = 0.05
    """Largest step of a motion check, > 0, in radians."""
    clearance: float = 0.0
    """Distance that the arm keeps from the cell, in metres; plans may keep it from other obstacles, too."""
    seed: int = 0
    """Seed of everything random; the same command gives the same roadmap."""
    out: Annotated[Path | None, "-o"] = None
    """The file to write.  Default: the robot's name in the current folder, with .roadmap."""

    def run(self) -> int:
        """Load, make, write, report; return 0."""
        # Wrong input is refused before any work.
        require_seed(self.seed)
        require_size(self.n, self.k)
        require_positive("resolution", self.resolution)
        inputs = [*find_robot(self.robot), self.srdf, self.bodies]
        inputs += [] if self.cell is None else [find_scene(self.cell)]
        out = Path(f"{Path(self.robot).stem}.roadmap") if self.out is None else self.out
        if not out.name:
            raise InvalidValue(f"--out must end with a file name, got {str(out)!r}")
        if out.resolve() in {path.resolve() for path in inputs if path is not None}:
            raise InvalidValue(f"--out {out} would overwrite one of the files that it is made from")
        require_writable_folder(out)
        cell = Scene(name="nothing") if self.cell is None else load_scene(self.cell)
        model = self.read_robot(self.robot)
        began = time.perf_counter()
        with progress_shown("roadmap") as shown:
            world = ArmWorld(model.robot, cell, resolution=self.resolution, clearance=self.clearance)
            roadmap = arm_roadmap(world, self.n, self.k, rng=self.seed, progress=_progress(shown))
        seconds = time.perf_counter() - began
        roadmap.save(out)
        n, m = len(roadmap.milestones), len(roadmap.edges)
        robot = roadmap.robot
        wraps = [name for name, multi_turn in zip(robot.group, roadmap.one_turn.multi_turn, strict=True) if multi_turn]
        size = f"{counted(n, 'milestone')} and {counted(m, 'motion')}"
        rows = [
            ("roadmap", f"{size}, free of {robot.name!r} and its cell {cell.name!r}"),
            ("joints", ", ".join(robot.group)),
            *([("turn on", ", ".join(wraps))] if wraps else []),
            ("time", f"{seconds:.1f} s"),
            ("file", f"{out}, {out.stat().st_size / 1000:.0f} kB"),
        ]
        print_table(rows)
        return 0


_UNTIL = {
    "drawing configurations": 0.03,
    "random scenes": 0.2,
    "narrow passages": 0.95,
    "choosing and joining milestones": 1.0,
}
"""Stage, in order -> share of the time at its end, about."""


def _progress(shown: Callable[..., None]) -> Callable[[str, float], None]:
    """Return a callback that turns the share of a stage into that of all."""
    since = dict(zip(_UNTIL, (0.0, *_UNTIL.values()), strict=False))

    def progress(what: str, share: float) -> None:
        shown(int(1000 * (since[what] + share * (_UNTIL[what] - since[what]))), 1000)

    return progress


def load_arm_roadmap(file: Path | str) -> ArmRoadmap:
    """Read the roadmap of an arm."""
    roadmap = load_roadmap(file)
    if not isinstance(roadmap, ArmRoadmap):
        raise InvalidValue(f"{file} is no roadmap of an arm, but {roadmap!r}")
    return roadmap


def kept_roadmap(plan: PlanArm) -> ArmRoadmap:
    """Return the roadmap of a plan's options; InvalidValue for options that do not go with one."""
    assert plan.roadmap is not None
    if wants_points(plan) or plan.improve:
        raise InvalidValue("--roadmap goes without points and without --improve: it has milestones of its own")
    if plan.robot is None:
        for option in fields(RobotOptions):
            if getattr(plan, option.name) != option.default:
                raise InvalidValue(f"--{option.name.replace('_', '-')} goes with --robot; the roadmap knows its arm")
    roadmap = load_arm_roadmap(plan.roadmap)
    if plan.robot is not None:
        require_same_robot(roadmap.robot, roadmap.scene, plan.read_robot(plan.robot).robot)
    return roadmap
