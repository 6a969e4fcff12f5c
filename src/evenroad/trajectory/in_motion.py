"""Paths that begin or end in motion: a moving robot continues straight before it turns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._checks import as_row
from evenroad.errors import InvalidValue
from evenroad.trajectory.limits import Limits

FARTHER = (1.1, 2.5, 6.0, 15.0)
"""Lengths of the straight piece to try, as multiples of the stopping distance by limits of the joints; limits of
torques and of a tip may need more.
"""
_ALONG = 1e-9
"""Largest sine of an angle between a velocity and a path that begins along it."""


@dataclass(frozen=True, eq=False)
class InMotion:
    """A path, and velocities of the joints at its start and goal.

    If the path does not begin along the velocity, its trajectory first continues straight for the stopping distance.
    Likewise, it approaches the goal straight if the path does not end along the velocity.

    Attributes
    ----------
    path : array_like, shape (p, dim)
        Waypoints joined by straight motions.
    start, goal : array_like, shape (dim,), or None
        Velocities [rad/s or m/s]; None: at rest.
    """

    path: npt.ArrayLike
    start: npt.ArrayLike | None = None
    goal: npt.ArrayLike | None = None

    def led(self, waypoints: Floats, limits: Limits, farther: float = FARTHER[0]) -> tuple[Floats, tuple[float, float]]:
        """Return waypoints, (p, dim), with straight pieces at both ends, and the speeds along the path there.

        Raises InvalidValue for velocities that are no such rows, or over the limits.
        """
        speeds = []
        for name, given, sign in (("start", self.start, 1.0), ("goal", self.goal, -1.0)):
            velocity = _velocity(name, given, limits)
            speed = float(np.linalg.norm(velocity))
            speeds.append(speed)
            if speed == 0.0:
                continue
            direction = velocity / speed
            path = waypoints if sign > 0.0 else waypoints[::-1]
            first = path[1] - path[0]
            off = first / np.linalg.norm(first) - sign * direction
            if np.linalg.norm(off) > _ALONG:
                # At the start the robot must be able to stop, and at the goal to reach its velocity.
                pushes = limits.stopping if sign > 0.0 else limits.acceleration
                push = np.min(np.array(pushes) / np.maximum(np.abs(direction), 1e-12))
                turning = path[0] + sign * direction * (farther * speed**2 / (2.0 * push))
                path = np.concatenate([path[:1], turning[np.newaxis], path[1:]])
            waypoints = path if sign > 0.0 else path[::-1]
        return np.ascontiguousarray(waypoints), (speeds[0], speeds[1])


def _velocity(name: str, given: npt.ArrayLike | None, limits: Limits) -> Floats:
    """Return a velocity within limits, zero for None."""
    dim = len(limits.velocity)
    # `as_row` refuses values that are not a row of numbers.
    row = (
        np.zeros(dim)
        if given is None
        else np.array(as_row(f"the velocity at the {name}", cast("Sequence[float]", given), dim))
    )
    shares = np.abs(row) / np.array(limits.velocity)
    if shares.max() > 1.0:
        joint = int(shares.argmax())
        most = limits.velocity[joint]
        raise InvalidValue(
            f"the velocity at the {name} of joint {joint} must be up to {most:.4g}, got {row[joint]:.4g}"
        )
    if limits.jerk is not None and row.any():
        raise InvalidValue(f"with limits of jerk the robot must be at rest at the {name}, got the velocity {row!r}")
    return row
