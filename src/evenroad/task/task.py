"""Task: a sequence of steps of an arm."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from evenroad._arrays import set_fields
from evenroad._call import explains_calls
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue, shown
from evenroad.planning.reading import Reading
from evenroad.task.result import TaskResult
from evenroad.task.steps import Move, Step

MOST_MOTIONS = 500
"""Largest number of motions of a task, which is the depth of the search."""


@explains_calls
@dataclass(frozen=True)
class Task:
    """A sequence of steps.

    Parameters
    ----------
    steps : sequence of MoveTo, MoveLinear, MoveAlong, MoveCircular, Attach, Detach, Open, Close and Wait
        The steps, with 1 to 500 motions, those of fingers included.

    Raises
    ------
    InvalidValue
        If there is no motion, there are too many, or something else is among them.

    Examples
    --------
    >>> import evenroad as er
    >>> from evenroad.task import MoveTo, Task
    >>> task = Task([MoveTo("inside"), MoveTo("home")])
    >>> task.plan(er.ArmWorld("ur5", "box-reach"), "home").solved
    True
    """

    steps: tuple[Step, ...]

    def __init__(self, steps: Sequence[Step]) -> None:
        given = tuple(steps) if isinstance(steps, list | tuple) else (steps,)
        for number, step in enumerate(given):
            if not isinstance(step, Step):
                known = "a motion, such as MoveTo, Attach, Detach, Open, Close or Wait"
                raise InvalidValue(f"step {number} of a task must be {known}, got {shown(step)}")
        motions = sum(isinstance(step, Move) for step in given)
        if not 0 < motions <= MOST_MOTIONS:
            raise InvalidValue(f"a task must have one motion or more, up to {MOST_MOTIONS}, got {motions}")
        set_fields(self, steps=given)

    def plan(
        self, world: ArmWorld, start: Any, *, tip: str = "", frame: str = "", degrees: bool = False, **options: Any
    ) -> TaskResult:
        """Plan all motions; the chosen goals allow all steps, and are the cheapest of those tried.

        Parameters
        ----------
        world : ArmWorld
            The world at the beginning.  An attached obstacle becomes a body of the robot.
        start : configuration or str
            As for :func:`evenroad.plan`.
        tip, frame, degrees
            Options for reading poses and texts, as there.
        **options
            ``seconds`` for the whole task, by default 5; ``limits`` of each motion, ``smooth``, ``rng``, as there.

        Returns
        -------
        TaskResult
            A failure is a result, too, and says which step cannot be done, and why.

        Raises
        ------
        InvalidValue, UnknownName
            If an argument is none of these, a step attaches an unknown obstacle, or detaches one that is not held.

        Examples
        --------
        >>> import evenroad as er
        >>> from evenroad.task import MoveTo, Task, Wait
        >>> Task([MoveTo("inside"), Wait(0.5)]).plan(er.ArmWorld("ur5", "box-reach"), "home").solved
        True
        """
        from evenroad.task.solve import plan_task

        return plan_task(self.steps, world, start, Reading(degrees, tip, frame), **options)
