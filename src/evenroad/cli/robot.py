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
    write_srdf: Path | None = None
    """Write an SRDF to start from: groups, named states, and the pairs of links that are not tested, with reasons."""
    json: bool = False
    """Print all that is known as JSON in place of tables."""

    def run(self) -> int:
        """Load, measure, print; return 0."""
        from json import dumps

        from evenroad._compiled import say_if_compiling
        from evenroad._files import atomic_write, require_writable_folder
        from evenroad.cli.robot_tables import print_robot, robot_record
        from evenroad.robot import ArmWorld, Scene, in_scene, load_model, load_scene
        from evenroad.robot.srdf_writer import srdf_text

        if self.write_srdf is not None:
            require_writable_folder(self.write_srdf)
        model = load_model(self.robot, **self.options())
        say_if_compiling("evenroad.robot.kernel.batch", "configurations_free", 30)
        scene = Scene("empty space", ()) if self.scene is None else load_scene(self.scene)
        world = ArmWorld(in_scene(model.robot, scene), scene)
        if self.write_srdf is not None:
            with atomic_write(self.write_srdf) as file:
                file.write(srdf_text(model).encode())
        if self.json:
            print(dumps(robot_record(model, world), indent=2, allow_nan=False))
        else:
            print_robot(model, world)
        return 0
