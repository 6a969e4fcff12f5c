"""``evenroad send``: a plan or a trajectory to the controller of a UR arm; without --go a dry run."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from evenroad._checks import require_positive
from evenroad._files import read_json_file
from evenroad._terminal import print_table, progress_shown
from evenroad.cli.options import Positional
from evenroad.cli.plan_file import PlanFile, read_plan
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.trajectory import Trajectory, arm_trajectory, limits_of, load_trajectory
from evenroad.trajectory.send import checked_states, send_trajectory


@dataclass(frozen=True, kw_only=True)
class Send:
    """Send a plan or a trajectory to a UR arm, state by state; nothing moves without --go.

    Without --host there is no arm: the states are checked as they would be sent.  With --host a plan is refused if the
    arm is another model, not ready or not at the start, or if the plan is faster than allowed.  Ctrl-C stops the arm;
    so does a lost connection.

    Example: evenroad send box-reach.json --host 192.168.0.5 --model UR5 --fastest 0.5
    """

    plan: Positional[Path]
    """A plan of evenroad plan --robot, or a trajectory of its --trajectory (.json).
    A plan without times, or too fast, is timed for --fastest."""
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
        """Return the trajectory of the file, or one of its path, and where the times are from."""
        record = read_json_file(self.plan, "plan or trajectory")
        if not isinstance(record, dict) or "query" not in record:
            return load_trajectory(self.plan), "of the trajectory"
        plan = read_plan(self.plan)
        if plan.changed:
            changed = " and ".join(plan.changed)
            raise InvalidValue(f"the {changed} of {self.plan} changed since it was planned: plan again")
        if plan.trajectory is not None and bool((abs(plan.trajectory.velocities) <= self.fastest).all()):
            return plan.trajectory, "of the plan"
        return self._made(plan), f"made for at most {self.fastest:g} rad/s"

    def _made(self, plan: PlanFile) -> Trajectory:
        world, path = plan.request.world, plan.result.path
        if not hasattr(world, "robot"):
            raise NotAvailable(f"{self.plan} is the plan of a disk on a map; plans of arms are sent")
        if not plan.result.solved or path is None:
            raise NotAvailable(f"{self.plan} holds no path: {plan.result.message}")
        limits = limits_of(world.robot)
        # Positions are sent rounded to steps: a hair below what is allowed.
        slow = tuple(min(each, 0.999 * self.fastest) for each in limits.velocity)
        return arm_trajectory(world, path, replace(limits, velocity=slow))
