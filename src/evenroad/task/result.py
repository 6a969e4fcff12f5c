"""TaskResult: the motions of a task, or which step cannot be done and why."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from evenroad._arrays import Floats
from evenroad._call import explains_calls
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.planning.result import PlanResult, Status
from evenroad.task.joined import joined
from evenroad.task.motion import Motion
from evenroad.task.steps import Move, Step, Wait
from evenroad.trajectory.limits import Limits, TipLimits, limits_of
from evenroad.trajectory.trajectory import Trajectory

if TYPE_CHECKING:
    from PIL.Image import Image

CURVE_DEVIATION = 5e-5
"""Default of a trajectory's largest distance from its path along a curve [rad or m], to keep the tip near the curve."""


@explains_calls
@dataclass(frozen=True, eq=False, repr=False)
class TaskResult:
    """The answer to a task.

    Attributes
    ----------
    steps : tuple
        The steps of the task.
    status : Status
        Status of the step that failed, else ``solved``.
    message : str
        One sentence: what happened, or which step cannot be done and why.
    motions : tuple of Motion
        The motions. The `parts` of each are plans of lines, curves, and the path between them, each in its own world.
        A held object is a body of the robot there.
    step : int or None
        Number of the step that failed, from 0.
    timings : dict of str to float
        Wall time [s].
    tried : int
        Number of choices for motions that were tried, including dropped ones.

    Examples
    --------
    >>> import evenroad as er
    >>> from evenroad.task import MoveTo, Task
    >>> Task([MoveTo("inside"), MoveTo("home")]).plan(er.ArmWorld("ur5", "box-reach"), "home").cost > 0
    True
    """

    steps: tuple[Step, ...]
    status: Status
    message: str
    motions: tuple[Motion, ...] = ()
    step: int | None = None
    timings: Mapping[str, float] = field(default_factory=dict)
    tried: int = 0

    @property
    def solved(self) -> bool:
        """Whether all steps can be done."""
        return self.status is Status.SOLVED

    @property
    def parts(self) -> tuple[PlanResult, ...]:
        """The plans of all motions, in their order."""
        return tuple(part for motion in self.motions for part in motion.parts)

    @property
    def cost(self) -> float | None:
        """Sum of the costs of the motions; None unless solved."""
        return sum(each.cost or 0.0 for each in self.parts) if self.solved else None

    @property
    def fingers(self) -> tuple[str, ...]:
        """Names of the finger joints that it moves."""
        return tuple(dict.fromkeys(name for motion in self.motions for name in motion.fingers))

    @property
    def path(self) -> Floats | None:
        """Waypoints of the arm in all motions, (p, dim); None unless solved, or if only fingers move."""
        parts = [part for motion in self.motions if not motion.fingers for part in motion.parts]
        paths = [each.path for each in parts if each.path is not None]
        if not self.solved or not paths:
            return None
        return np.concatenate([paths[0][:1], *(path[1:] for path in paths)])

    def __repr__(self) -> str:
        if not self.solved:
            return f"TaskResult({self.status}, step {self.step})"
        return f"TaskResult(solved, {len(self.steps)} steps, cost {self.cost:.4g})"

    def plot(self, path: str | os.PathLike[str] | None = None) -> Image:
        """Return a picture of the motions, one below the other, as a PIL image; save it if a file is named.

        Parameters
        ----------
        path : str or path-like, optional
            A ``.png``.

        Returns
        -------
        PIL.Image.Image

        Raises
        ------
        NotAvailable
            If nothing moves.
        BrokenFile
            If the file cannot be written.

        Examples
        --------
        >>> import evenroad as er
        >>> from evenroad.task import MoveTo, Task
        >>> Task([MoveTo("inside")]).plan(er.ArmWorld("ur5", "box-reach"), "home").plot().mode
        'RGB'
        """
        if not any(part.cost or not part.solved for part in self.parts):
            raise NotAvailable(f"there is nothing to draw: {self.message if not self.solved else 'nothing moves'}")
        from evenroad.viz.result import plot_parts

        return plot_parts(self.parts, path)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the answer to a file, atomically.

        Parameters
        ----------
        path : str or path-like
            ``.json``: the plans of all motions, each with its world; ``.csv``: the waypoints; ``.png``: a picture.

        Raises
        ------
        UnknownName
            For another suffix.
        InvalidValue
            For a ``.csv`` of a task that is not solved.
        BrokenFile
            If the file cannot be written.

        Examples
        --------
        >>> import tempfile
        >>> import evenroad as er
        >>> from evenroad.task import MoveTo, Task
        >>> done = Task([MoveTo("inside")]).plan(er.ArmWorld("ur5", "box-reach"), "home")
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     done.save(f"{folder}/task.json")
        """
        from evenroad.task.save import save_task

        save_task(self, path)

    def trajectory(self, **options: Any) -> Trajectory:
        """Return one trajectory through all steps. It stops where the gripper acts, and where a line ends.

        It is of the planned joints, and then of the finger joints that Open and Close move.  Controllers of the arm and
        the gripper each take their part, as by ``trajectory.only(robot.group)``.

        Parameters
        ----------
        **options
            Options of :meth:`evenroad.PlanResult.trajectory`.  Each motion is checked in its own world, and keeps the
            constraints of its step unless others are given.  Fingers have the limits of the robot, or those of a file.

        Returns
        -------
        Trajectory

        Raises
        ------
        InvalidValue, NotAvailable
            Errors of that method; InvalidValue also if the task is not solved.

        Examples
        --------
        >>> import evenroad as er
        >>> from evenroad.task import MoveTo, Task, Wait
        >>> task = Task([MoveTo("inside"), Wait(0.5), MoveTo("home")])
        >>> task.plan(er.ArmWorld("ur5", "box-reach"), "home").trajectory(speed=0.5).names[0]
        'shoulder_pan_joint'
        """
        if not self.solved:
            raise InvalidValue(f"there is no trajectory: {self.message}")
        return joined([each for _, each in timed_parts(self, options)], pauses_of(self), self.fingers)


def pauses_of(done: TaskResult) -> list[float]:
    """Return how long a task waits before each part in which something moves, and at its end [s]."""
    pauses: list[float] = []
    pause, parts = 0.0, iter(done.motions)
    for step in done.steps:
        if isinstance(step, Wait):
            pause += step.seconds
        elif isinstance(step, Move):
            moving = [part for part in next(parts).parts if part.cost]
            pauses += [pause, *[0.0] * (len(moving) - 1)] if moving else []
            pause = 0.0 if moving else pause
    return [*pauses, pause] if pauses else [0.0, pause]


def timed_parts(done: TaskResult, options: dict[str, Any]) -> list[tuple[PlanResult, Trajectory]]:
    """Return the plans of a task that is solved and in which something moves, each with its trajectory."""
    # A motion to where the arm is takes no time.
    every = [(motion, part) for motion in done.motions for part in motion.parts]
    moving = [each for each in every if each[1].cost] or every[:1]
    return [(part, part.trajectory(**_kept(motion, part, options))) for motion, part in moving]


def _kept(motion: Motion, part: PlanResult, options: dict[str, Any]) -> dict[str, Any]:
    """Return the options of a part's trajectory, with its motion's constraints unless others are given."""
    if motion.fingers:
        of_arm = {"constraints", "rounded_by_controller"} | (
            {"limits"} if isinstance(options.get("limits"), Limits) else set()
        )
        return {name: value for name, value in options.items() if name not in of_arm}
    kept: dict[str, Any] = {} if motion.constraints is None else {"constraints": motion.constraints}
    if part.planner == "curve":
        kept["deviation"] = CURVE_DEVIATION
    if motion.speed is not None:
        robot, given = cast(ArmWorld, part.world).robot, options.get("limits")
        limits = given if isinstance(given, Limits) else limits_of(robot, given)
        push = math.inf if limits.tip is None else limits.tip.acceleration
        options = options | {"limits": replace(limits, tip=TipLimits(robot, motion.tip, motion.speed, push))}
    return kept | options
