"""Outcome: what one task gave."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Outcome:
    """What one task gave; a task that failed has an outcome, too.

    Attributes
    ----------
    status : str
        ``solved``, ``not_connected``, ``start_invalid``, ``goal_invalid``; or ``failed`` (an exception),
        ``timeout``, ``lost`` (the worker died).  The last three are failures of the run, not answers.
    valid : int
        Valid milestones among all n points, start and goal not counted.
    valid_at_solution : int or None
        Valid milestones that had been added when start and goal were first connected (search ``stock``).
    edges_checked : int
        Motions asked of the world.
    length : float
        Length of the path in the space's metric; NaN where none was looked for or found.
    seconds : float
        Wall time of the run, without the making of the problem and of the set.
    set_id : str
        Which set of a pool it was, by which statistics cluster; ``grid`` for the only set that there is; empty for sets
        drawn afresh.
    error : str
        Traceback of a failure, else empty.
    """

    status: str
    valid: int = 0
    valid_at_solution: int | None = None
    edges_checked: int = 0
    length: float = math.nan
    seconds: float = math.nan
    set_id: str = ""
    error: str = ""

    @property
    def solved(self) -> bool:
        """Whether there was a path."""
        return self.status == "solved"
