"""``evenroad run``: a task of several steps from its file, as one trajectory."""

from __future__ import annotations

import json
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from evenroad._checks import require_positive
from evenroad._files import Json
from evenroad._terminal import print_table
from evenroad.cli.options import Option, Positional, options_of
from evenroad.cli.outputs import require_certifiable, require_output
from evenroad.cli.plan import RobotOptions
from evenroad.collision.arm_world import ArmWorld
from evenroad.collision.coerce import as_scene
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.scenes.robot_in_scene import in_scene
from evenroad.scenes.scene import Scene

if TYPE_CHECKING:
    from evenroad.task import TaskResult
    from evenroad.trajectory import Trajectory


_WRITTEN = ("out", "certificate", "embed")
"""Options about files that are written: no part of the record of a task."""


@dataclass(frozen=True, kw_only=True)
class RunTask(RobotOptions):
    """Plan a task: motions, and what a gripper does between them; write one trajectory.

    The file names the robot, the scene, a start and the steps: move_to, move_linear, attach, detach and others.
    All are described at evenroad.task.load_task.

    Example: evenroad run task.yaml --robot ur5 -o task.json
    """

    task: Positional[Path]
    """The file of the task, a .yaml."""
    robot: str | None = None
    """A URDF, xacro or MJCF file, or a name, in place of the one that the task names."""
    scene: str | None = None
    """A scene's file or name, in place of that of the task."""
    out: Annotated[tuple[Path, ...], "-o"] = ()
    """Files for the trajectory: .json, .csv, .yaml (ROS 2), .mcap (a bag), .script or .movej.script (URScript)."""
    certificate: Path | None = None
    """Write a certificate of each motion that evenroad-verify checks: FILE.cert becomes FILE.1.cert and so on; each
    carries what the robot holds and what is around it then."""
    embed: bool = False
    """The certificates carry the robot, too."""
    speed: float = 1.0
    """Share of the velocity limits, > 0 and at most 1."""
    limits: Path | None = None
    """A MoveIt joint_limits.yaml.  Default: velocities of the URDF, full speed after 0.5 s."""
    time: float | None = None
    """Time limit of the whole task in seconds, > 0 (default 5)."""
    seed: int = 0
    """Seed of everything random; the same command gives the same motions."""
    json: bool = False
    """Print JSON instead of a table."""

    def run(self) -> int:
        """Plan, write, report; return 0 if all steps can be done, else 1."""
        from evenroad.trajectory.formats import format_of

        require_positive("speed", self.speed, at_most=1.0)
        inputs = (self.task, self.limits, self.srdf, self.bodies)
        for file in self.out:
            format_of(file)
            require_output("--out", file, inputs)
        require_certifiable(self.certificate, self.bodies, inputs, embed=self.embed)
        done = self.planned()
        for file in self.out:
            # The trajectory of an earlier run must not pass for this one.
            file.unlink(missing_ok=True)
        rows = [("status", f"{done.status}: {done.message}"), ("time", f"{1e3 * done.timings['task']:.0f} ms")]
        if done.solved:
            trajectory = self.timed(done)
            rows += self._saved(replace(trajectory, source={"task": self._record()}), done.fingers)
            rows.append(
                ("trajectory", f"{trajectory.duration:.3f} s, {len(trajectory.times)} states, {trajectory.proof}")
            )
            rows += self._certified(done)
        if self.json:
            print(json.dumps({"step": done.step, "cost": done.cost, **dict(rows)}, indent=2))
        else:
            print_table(rows)
        return 0 if done.solved else 1

    def _saved(self, trajectory: Trajectory, fingers: tuple[str, ...]) -> list[tuple[str, str]]:
        """Write the trajectory to all files, a program of the arm without its fingers; return their row."""
        from evenroad.trajectory.formats import save_trajectories

        programs = [file for file in self.out if fingers and file.suffix.lower() == ".script"]
        if programs:
            # The controller of an arm has no fingers: the arm waits while they move.
            arm = trajectory.only([name for name in trajectory.names if name not in fingers])
            save_trajectories(programs, arm)
        save_trajectories([file for file in self.out if file not in programs], trajectory)
        alone = f"; without {', '.join(fingers)}: {', '.join(map(str, programs))}" if programs else ""
        return [("files", ", ".join(map(str, self.out)) + alone)] if self.out else []

    def _certified(self, done: TaskResult) -> list[tuple[str, str]]:
        """Write the certificates of a task, if they are wanted; return their row for the table."""
        if self.certificate is None:
            return []
        # Imported late: most tasks are run without them.
        from evenroad.certificates.certify import certify
        from evenroad.task.result import timed_parts

        sources, file = self.sources(self._robot(), None, self.embed), self.certificate
        parts = timed_parts(done, self._timing())
        files = [file.with_suffix(f".{number}{file.suffix}") for number in range(1, len(parts) + 1)]
        for (part, trajectory), each in zip(parts, files, strict=True):
            assert part.path is not None, "only of a motion that was found"
            certify(part.world, part.path, sources, each, trajectory=trajectory)
        named = f"{files[0]} to {files[-1]}" if len(files) > 1 else str(files[0])
        return [("certificates", f"{named} of the trajectory's motions, which evenroad-verify checks")]

    def planned(self) -> TaskResult:
        """Return the plan of the task: the same for the same options."""
        from evenroad.task.task_file import load_task

        said, source = load_task(self.task), self._robot()
        scene = as_scene(said.scene if self.scene is None else self.scene) if said.scene or self.scene else Scene()
        world = ArmWorld(in_scene(self.read_robot(source).robot, scene), scene)
        return said.task.plan(world, said.start, seconds=self.time, rng=self.seed)

    def _robot(self) -> str:
        """Return the file or name of the robot."""
        from evenroad.task.task_file import load_task

        source = load_task(self.task).robot if self.robot is None else self.robot
        if source is None:
            raise InvalidValue(f"{self.task} names no robot: give --robot")
        return source

    def timed(self, done: TaskResult) -> Trajectory:
        """Return the trajectory of a task that is solved."""
        return done.trajectory(**self._timing())

    def _timing(self) -> dict[str, Any]:
        """Return the options of trajectories."""
        return {"speed": self.speed, "limits": self.limits}

    def _record(self) -> dict[str, object]:
        """Return the options as plain values, of which `run_task_of` makes them again."""
        values = {each.name: getattr(self, each.name) for each in fields(self) if each.name not in _WRITTEN}
        return {name: str(value) if isinstance(value, Path) else value for name, value in values.items()}


def run_task_of(record: Json, file: Path) -> RunTask:
    """Return the options of the record in a trajectory's file; BrokenFile where they are none."""
    options = {each.field: each for each in options_of(RunTask) if each.field not in _WRITTEN}
    # Files of earlier versions have no such option.
    record = {"upright_meshes": False, **record} if isinstance(record, dict) else {}
    if record.keys() != options.keys() or not all(_is_value(record[name], options[name]) for name in options):
        raise BrokenFile(f"{file} is a damaged trajectory: of the task that it was made for")
    texts = {name: tuple(map(str, record[name])) for name, each in options.items() if each.default == ()}
    paths = {name: Path(record[name]) for name, each in options.items() if each.kind is Path and record[name]}
    return RunTask(**{**record, **paths, **texts})


def _is_value(value: object, option: Option) -> bool:
    """Return whether a value of JSON is one of an option."""
    if option.default == ():
        return isinstance(value, list)
    kinds = {Path: (str,), float: (float, int)}.get(option.kind, (option.kind,))
    return (value is None and option.default is None) or isinstance(value, kinds)
