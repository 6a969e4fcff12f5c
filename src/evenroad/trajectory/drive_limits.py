"""DriveLimits: how fast a car or a robot on wheels drives along its path."""

from __future__ import annotations

import math
from dataclasses import dataclass

from evenroad._arrays import set_fields
from evenroad._call import explains_calls
from evenroad._checks import require_positive
from evenroad.trajectory.limits import SECONDS_TO_FULL_SPEED


@explains_calls
@dataclass(frozen=True, kw_only=True)
class DriveLimits:
    """Limits of a robot that drives along its heading, all > 0, in map units and seconds.

    Attributes
    ----------
    speed : float
        Largest speed, forwards and backwards.
    acceleration : float, optional
        Largest acceleration and deceleration along the path.  Default: full speed after half a second.
    lateral : float, optional
        Largest acceleration across the path in turns.  Default: as `acceleration`.
    curvature_rate : float, optional
        Largest change of the path's curvature in a second, which is how fast the robot steers.  Default: no limit.
    angular_speed, angular_acceleration : float, optional
        Largest speed [rad/s] and acceleration of turns.  Default: no limit while driving; on the spot those at which
        the farthest corner of the footprint keeps the limits of driving.

    Examples
    --------
    >>> from evenroad.trajectory import DriveLimits
    >>> DriveLimits(speed=2.0).push
    4.0
    """

    speed: float = 1.0
    acceleration: float | None = None
    lateral: float | None = None
    curvature_rate: float | None = None
    angular_speed: float | None = None
    angular_acceleration: float | None = None

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if value is not None or name == "speed":
                set_fields(self, **{name: require_positive(name, value)})

    @property
    def push(self) -> float:
        """Largest acceleration and deceleration along the path."""
        return self.acceleration or self.speed / SECONDS_TO_FULL_SPEED

    @property
    def across(self) -> float:
        """Largest acceleration across the path."""
        return self.lateral or self.push

    def along(self, curvature: float, change: float) -> tuple[float, float]:
        """Return the largest speed and acceleration at a curvature, >= 0, of which each unit of length changes so much.

        For turns on the spot, whose curvature is infinite, they are those of the angle.
        """
        turning, turning_push = self.angular_speed or math.inf, self.angular_acceleration or math.inf
        if math.isinf(curvature):
            return turning, turning_push
        fastest, push = self.speed, self.push
        # Where the curvature changes, half of the angular acceleration is for that.
        half = 0.5 if change > 0.0 else 1.0
        if curvature > 0.0:
            fastest = min(fastest, math.sqrt(self.across / curvature), turning / curvature)
            push = min(push, half * turning_push / curvature)
        if change > 0.0:
            fastest = min(fastest, math.sqrt(half * turning_push / change), (self.curvature_rate or math.inf) / change)
        return fastest, push
