"""``evenroad send``: a trajectory to the controller of a UR arm; without --go a dry run."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import tyro

from evenroad._terminal import print_table, progress_shown
from evenroad.trajectory import load_trajectory
from evenroad.trajectory.send import send_trajectory


@dataclass(frozen=True, kw_only=True)
class Send:
    """Send a trajectory to a UR arm, state by state; nothing moves without --go.

    It is refused if the arm is another model, not ready or not at the start, or the trajectory faster than allowed.
    Ctrl-C stops the arm; so does a lost connection.
    """

    trajectory: tyro.conf.Positional[Path]
    """A .json of evenroad plan --trajectory."""
    host: str
    """Address of the controller."""
    model: str
    """Model of the arm, as its controller names it: UR5."""
    fastest: float = 1.0
    """Largest speed of a joint, > 0, in radians per second."""
    controller_joints: str | None = None
    """All joints of the controller, in its order, separated by commas."""
    go: bool = False
    """Move the arm.  Default: a dry run."""

    def run(self) -> int:
        """Check, and move with --go; return 0."""
        trajectory = load_trajectory(self.trajectory)
        order = None if self.controller_joints is None else [*map(str.strip, self.controller_joints.split(","))]
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
        rows = [
            ("trajectory", f"{trajectory.duration:.3f} s, {len(trajectory.times)} states, {trajectory.proof}"),
            ("arm", f"{self.model} at {self.host}, ready and at the start"),
            ("done", done if self.go else "nothing: a dry run; --go moves the arm"),
        ]
        print_table(rows)
        return 0
