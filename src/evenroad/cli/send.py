"""``evenroad send``: a plan or a trajectory to the controller of a UR arm; without --go a dry run."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from evenroad._checks import require_positive
from evenroad._files import read_json_file
from evenroad._terminal import print_table, progress_shown
from evenroad.cli.options import Positional
from evenroad.cli.plan import RobotOptions
from evenroad.cli.sent import sent_plan, sent_task, sent_trajectory
from evenroad.errors import InvalidValue
from evenroad.trajectory import Trajectory
from evenroad.trajectory.send import checked_states, send_trajectory


@dataclass(frozen=True, kw_only=True)
class Send(RobotOptions):
    """Send a plan or a trajectory to a UR arm, state by state; nothing moves without --go.

    The states are proved again: they keep limits and constraints and touch nothing, with the robot and scene that the
    file names.  A changed robot or scene and a damaged file are refused.

    Without --host there is no arm: the states are checked as they would be sent.  With --host a plan is refused if the
    arm is another model, not ready or not at the start, or if the plan is faster than allowed.  Ctrl-C stops the arm;
    so does a lost connection.

    Example: evenroad send box-reach.json --host 192.168.0.5 --model UR5 --fastest 0.5
    """

    plan: Positional[Path]
    """A plan of evenroad plan --robot, a trajectory of its --trajectory, or the saved answer to a task (.json).
    A plan without times, or too fast, is timed for --fastest."""
    robot: str | None = None
    """With a trajectory that does not say where it was planned: a URDF, xacro or MJCF file, or a name.  Goes with
    --scene."""
    scene: str | None = None
    """The scene in which such a trajectory is proved: a name or a file."""
    host: str | None = None
    """Address of the controller.  Default: no arm."""
    model: str | None = None
    """Model of the arm, as its controller names it: UR5.  Goes with --host."""
    fastest: float = 1.0
    """Largest speed of a joint, > 0, in radians per second."""
    controller_joints: str | None = None
    """All joints of the controller, in its order, separated by commas."""
    go: bool = False
    """Move the arm.  Default: a dry run."""

    def run(self) -> int:
        """Check, and move with --go; return 0."""
        if (self.host is None) != (self.model is None):
            raise InvalidValue("--host and --model go together: the arm there must be of this model")
        if self.go and self.host is None:
            raise InvalidValue("--go needs --host, the address of the controller")
        require_positive("fastest", self.fastest)
        order = None if self.controller_joints is None else [*map(str.strip, self.controller_joints.split(","))]
        trajectory, times = self._timed()
        if self.host is None:
            names, positions, cycle = checked_states(trajectory, self.fastest, order)
            done = f"nothing: a dry run; {len(positions)} states of {len(names)} joints every {cycle:g} s"
            arm = "none; --host and --model name one"
        else:
            assert self.model is not None
            with progress_shown("sending") as progress:
                sent = send_trajectory(
                    trajectory,
                    self.host,
                    model=self.model,
                    fastest=self.fastest,
                    go=self.go,
                    order=order,
                    progress=progress,
                )
            done = f"{sent.states} states sent, {sent.largest_error:.4f} rad off at most"
            done = done if self.go else "nothing: a dry run; --go moves the arm"
            arm = f"{self.model} at {self.host}, ready and at the start"
        rows = [
            ("trajectory", f"{trajectory.duration:.3f} s, {len(trajectory.times)} states, {trajectory.proof}"),
            ("times", times),
            ("arm", arm),
            ("done", done),
        ]
        print_table(rows)
        return 0

    def _timed(self) -> tuple[Trajectory, str]:
        """Return the trajectory that is sent, proved anew, and where its times are from."""
        record = read_json_file(self.plan, "plan or trajectory")
        if isinstance(record, dict) and "query" in record:
            if self.robot is not None or self.scene is not None:
                raise InvalidValue("--robot and --scene go with a trajectory; a plan names its own")
            return sent_plan(record, self.plan, self.fastest)
        if isinstance(record, dict) and str(record.get("format")).startswith("evenroad.task "):
            if self.robot is not None or self.scene is not None:
                raise InvalidValue("--robot and --scene go with a trajectory; the answer to a task has its own")
            return sent_task(record, self.plan, self.fastest)
        if (self.robot is None) != (self.scene is None):
            raise InvalidValue("--robot and --scene go together")
        given = None if self.robot is None or self.scene is None else (self.robot, self.scene, self.options())
        return sent_trajectory(record, self.plan, given), "of the trajectory"
