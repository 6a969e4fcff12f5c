"""``evenroad roadmap``: a roadmap of an arm's joints, which ``evenroad plan --roadmap`` reads."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from evenroad._checks import counted, require_count
from evenroad._terminal import print_table
from evenroad.cli.options import Positional
from evenroad.cli.outputs import require_output
from evenroad.cli.plan import RobotOptions
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue
from evenroad.loading.find import find_robot
from evenroad.roadmap import KNearest, build_roadmap
from evenroad.scenes.scene import Scene
from evenroad.scenes.scene_file import find_scene, load_scene


@dataclass(frozen=True, kw_only=True)
class MakeRoadmap(RobotOptions):
    """Make a roadmap of an arm's joints: even points, each joined to its nearest.

    It is checked where you plan along it: evenroad plan SCENE --robot ROBOT --roadmap FILE.
    For many queries evenroad.plan_many, in Python, is faster.
    """

    robot: Positional[str]
    """A URDF, xacro or MJCF file, or a name: ur5, arm7; with the extra [robots] panda and others."""
    cell: Path | None = None
    """A scene (.yaml) to plan in, whose limits of joints count.  Default: the robot's own limits."""
    n: Annotated[int, "-n"] = 1024
    """Number of milestones."""
    k: Annotated[int, "-k"] = 20
    """Number of nearest milestones that each is joined to."""
    out: Annotated[Path | None, "-o"] = None
    """The file to write.  Default: the robot's name in the current folder, with .roadmap."""

    def run(self) -> int:
        """Load, make, write, report; return 0."""
        # Wrong input is refused before any work.
        require_count("n", self.n)
        rule = KNearest(self.k)
        inputs = [*find_robot(self.robot), self.srdf, self.bodies]
        inputs += [] if self.cell is None else [find_scene(self.cell)]
        out = Path(f"{Path(self.robot).stem}.roadmap") if self.out is None else self.out
        if not out.name:
            raise InvalidValue(f"--out must end with a file name, got {str(out)!r}")
        require_output("--out", out, inputs)
        cell = Scene() if self.cell is None else load_scene(self.cell)
        robot = self.read_robot(self.robot).robot
        roadmap = build_roadmap(ArmWorld(robot, cell), self.n, rule=rule)
        roadmap.save(out)
        n, m = len(roadmap.milestones), len(roadmap.edges)
        rows = [
            ("roadmap", f"{counted(n, 'milestone')} and {counted(m, 'edge')} of {robot.name!r}"),
            ("joints", ", ".join(robot.group)),
            ("file", f"{out}, {out.stat().st_size / 1000:.0f} kB"),
        ]
        print_table(rows)
        return 0
