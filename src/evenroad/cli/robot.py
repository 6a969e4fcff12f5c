"""``evenroad robot``: what an arm is made of, how conservative its model is, and how fast it is checked."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated


@dataclass(frozen=True, kw_only=True)
class Robot:
    """Show the joints, limits, bodies and self-collision pairs of an arm, and checks per second."""

    robot: Annotated[str, "positional"]
    """A URDF file, or the name of a shipped robot (ur5, arm7)."""
    srdf: Path | None = None
    """Its SRDF, with groups, named states and pairs of links that need no test."""
    group: str | None = None
    """A group of the SRDF, or joints with commas between them; the others are held."""
    bodies: Path | None = None
    """A YAML file of capsules and spheres in place of the URDF's collision geometry."""
    scene: Path | None = None
    """Count checks per second in this scene (a file or box-reach.yaml) instead of in empty space."""

    def run(self) -> int:
        """Load, measure, print; return 0."""
        from evenroad._compiled import say_if_compiling
        from evenroad.cli.robot_tables import print_robot
        from evenroad.robot import ArmWorld, Scene, in_scene, load_model, load_scene

        model = load_model(self.robot, srdf=self.srdf, group=self.group, bodies=self.bodies)
        say_if_compiling("evenroad.robot.kernel.batch", "configurations_free", 30)
        scene = Scene("empty space", ()) if self.scene is None else load_scene(self.scene)
        world = ArmWorld(in_scene(model.robot, scene), scene)
        print_robot(model, world)
        return 0
