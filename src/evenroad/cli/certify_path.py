"""``evenroad certify-path``: another planner's path, proved free, or where it first touches."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from json import dumps
from pathlib import Path

import numpy as np

from evenroad._terminal import print_table
from evenroad.certificates.certify import certify
from evenroad.certificates.certify_path import PathCheck, check_path, path_of, with_held
from evenroad.certificates.world_claim import world_claim
from evenroad.cli.options import Positional
from evenroad.cli.outputs import require_certifiable
from evenroad.cli.plan import RobotOptions
from evenroad.cli.robot import bodiless_rows, decided_by, padding_row
from evenroad.collision.arm_world import ArmWorld
from evenroad.loading.find import find_robot
from evenroad.loading.load import read_robot
from evenroad.robots.kinematics import held_values
from evenroad.scenes.robot_in_scene import in_scene
from evenroad.scenes.scan import allowed_near_ends
from evenroad.scenes.scene_file import find_scene, load_scene


@dataclass(frozen=True, kw_only=True)
class CertifyPath(RobotOptions):
    """Prove that a path of any planner is free, or say where it first touches.

    The path's motions are straight in the joints between waypoints.  The shapes of the robot's file decide, meshes by
    their triangles.  The first touch is found to 1e-6 of a motion: all before it is proved free, and two bodies
    are in contact there.  A path that comes nearer than 1e-7 m is undecided, and where is said.

    Exit code: 0 proved free, 1 touching or undecided, 2 bad input, such as a value outside of a joint's limits.

    Example: evenroad certify-path box-reach.csv --robot ur5 --scene box-reach.yaml
    """

    path: Positional[Path]
    """Waypoints: .csv or .txt (in the order of the joints, or under their names), .yaml or .mcap (a JointTrajectory),
    or the .json of a plan or a trajectory.  Radians and metres."""
    robot: str
    """The arm: a URDF, xacro or MJCF file, or a name: ur5, arm7; with the extra [robots] panda and others."""
    scene: Path | None = None
    """The scene, a name or a file; default: empty space, for contacts of the arm with itself."""
    clearance: float = 0.0
    """Distance to keep from all obstacles, 0 to 1, in metres; not from the arm itself."""
    certificate: Path | None = None
    """Write a certificate of a path that is proved here, which evenroad-verify checks without evenroad."""
    json: bool = False
    """Print JSON instead of a table."""

    def run(self) -> int:
        """Read, prove, print; return 0 if the path is proved free, else 1."""
        inputs = (self.path, *find_robot(self.robot), self.srdf, self.bodies, self.scene)
        require_certifiable(self.certificate, self.bodies, inputs)
        model = self.read_robot(self.robot)
        scene = load_scene("empty" if self.scene is None else self.scene)
        robot = in_scene(model.robot, scene)
        path, held, notes = path_of(self.path, robot)
        if scene.near_ends:
            scene = allowed_near_ends(robot, scene, path[[0, -1]])
        world = ArmWorld(with_held(robot, held), scene, clearance=self.clearance)
        given = self.bodies is not None and str(self.bodies) != "shapes"
        shapes = None if given or model.file is None else read_robot(model.file).shapes
        claim = world_claim(world, shapes)
        check = check_path(claim, path, notes)
        if check.free and self.certificate is not None:
            scene_file = None if self.scene is None else find_scene(self.scene)
            certify(world, path, self.sources(self.robot, scene_file, embed=False), self.certificate)
        if self.json:
            print(dumps({"file": str(self.path), "joints": list(robot.group), **asdict(check)}, indent=2))
            return int(not check.free)
        values = ", ".join(f"{name} at {value:.6g}" for name, value in held_values(world.robot).items())
        rows = [
            ("path", f"{self.path}: {check}"),
            *_where(check),
            ("tested", f"{len(claim.pairs)} pairs of bodies"),
        ]
        rows += [("decided by", decided_by(robot) if shapes is None else "the shapes of the file, exactly")]
        rows += [*([("held", values)] if values else []), *padding_row(robot), *bodiless_rows(model)]
        rows += [("note", note) for note in check.notes]
        if check.free and self.certificate is not None:
            rows.append(("certificate", f"{self.certificate}, which evenroad-verify checks"))
        print_table(rows)
        return int(not check.free)


def _where(check: PathCheck) -> list[tuple[str, str]]:
    """Return rows with the state in contact, and up to where all is proved."""
    if check.touch is None:
        return []
    waypoint, share = check.touch.free_until
    state = ", ".join(f"{value:.8g}" for value in np.array(check.touch.configuration).tolist())
    before = f"up to share {share:.7f} of the motion after waypoint {waypoint}" if waypoint + share else "nowhere"
    return [("proved free", before), ("state", state)]
