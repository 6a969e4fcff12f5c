"""``evenroad robot``: what an arm is made of, how conservative its model is, and how fast it is checked."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from evenroad.cli.plan_options import RobotOptions


@dataclass(frozen=True, kw_only=True)
class Robot(RobotOptions):
    """Show the joints, limits, bodies and self-collision pairs of an arm, and checks per second."""

    robot: Annotated[str, "positional"]
    """A URDF, xacro or MJCF file, or the name of a shipped robot (ur5, arm7)."""
    scene: Path | None = None
    """Count checks per second in this scene (a file or box-reach.yaml) instead of in empty space."""

    def run(self) -> int:
        """Load, measure, print; return 0."""
        from evenroad._compiled import say_if_compiling
        from evenroad.cli.robot_tables import print_robot
        from evenroad.robot import ArmWorld, Scene, in_scene, load_model, load_scene

        model = load_model(self.robot, **self.options())
        say_if_compiling("evenroad.robot.kernel.batch", "configurations_free", 30)
        scene = Scene("empty space", ()) if self.scene is None else load_scene(self.scene)
        world = ArmWorld(in_scene(model.robot, scene), scene)
        print_robot(model, world)
        return 0
