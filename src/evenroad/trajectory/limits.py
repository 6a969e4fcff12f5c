"""Limits: velocities, accelerations and jerks of joints, from a robot or MoveIt's joint_limits.yaml."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from evenroad._arrays import Floats
from evenroad._call import explains_calls
from evenroad._checks import as_row, require_known, require_positive
from evenroad._native import trajectory as kernel
from evenroad._shared import once_property, state_without
from evenroad.collision.prepared_robots import prepared
from evenroad.errors import InvalidValue, NotAvailable, shown
from evenroad.robots.robot import Robot
from evenroad.space.joints import SLACK
from evenroad.trajectory.dynamics import Dynamics, native_links
from evenroad.trajectory.limits_file import LimitsFile, read_limits

SECONDS_TO_FULL_SPEED = 0.5
"""Default time from rest to full speed [s]: URDF has no acceleration."""

_ANY_SPEED = 1e300
"""Square of a speed that is never reached."""
_KINDS = ("velocity", "acceleration", "jerk")
_OPTIONAL = ("jerk", "deceleration")


@dataclass(frozen=True)
class TipLimits:
    """Largest speed and acceleration of a link, measured at the origin of its frame.

    Attributes
    ----------
    robot : Robot
    link : str
    speed : float
        > 0 [m/s]; infinite: no limit.
    acceleration : float
        > 0 [m/s^2]; infinite: no limit.
    """

    robot: Robot
    link: str
    speed: float = math.inf
    acceleration: float = math.inf

    def __post_init__(self) -> None:
        for kind in ("speed", "acceleration"):
            if (most := getattr(self, kind)) != math.inf:
                require_positive(f"the tip's {kind}", most)

    @once_property
    def native(self) -> kernel.TipLimits:
        """The limits of the native kernel; InvalidValue if no joint moves the link."""
        links = prepared(self.robot).tables.tree.links
        require_known(f"link of {self.robot.name!r}:", self.link, links)
        fixed = links[self.link]
        if fixed.frame == 0:
            raise InvalidValue(f"no joint of the group, {','.join(self.robot.group)}, moves the link {self.link!r}")
        moving = native_links(self.robot)
        return kernel.TipLimits(moving, fixed.frame - 1, fixed.translation, self.speed, self.acceleration)

    def __getstate__(self) -> dict[str, object]:
        return state_without(self, ["native"])


@explains_calls
@dataclass(frozen=True)
class Limits:
    """Limits of each joint, in both directions.

    Attributes
    ----------
    velocity, acceleration : tuples of float
        > 0, one per joint [rad/s, rad/s^2; m for prismatic ones].
    jerk : tuple of float or None
        > 0, one per joint [rad/s^3]; None: no limit.
    along_path : float or None
        Largest speed of all coordinates together, such as that of a vehicle, > 0 [m/s]; None: no limit.
    tip : TipLimits or None
        Largest speed and acceleration of a link; None: no limit.  A share of full speed does not change them.
    torque : Dynamics or None
        Masses of the links and efforts of the joints; None: no limit of torque.  A share of full speed does not change
        it.
    position : tuple of pairs of float or None
        Lower and upper limit of each joint within those of the robot, infinite without a limit [rad; m for prismatic
        ones].  A path that leaves them is refused.
    deceleration : tuple of float or None
        Largest deceleration of each joint, > 0 [rad/s^2]; None: the same as the acceleration.  If jerk is limited, the
        smaller of the two applies to both.
    """

    velocity: tuple[float, ...]
    acceleration: tuple[float, ...]
    jerk: tuple[float, ...] | None = None
    along_path: float | None = None
    tip: TipLimits | None = None
    torque: Dynamics | None = None
    position: tuple[tuple[float, float], ...] | None = None
    deceleration: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        for kind in (*_KINDS, "deceleration"):
            values = getattr(self, kind)
            if kind in _OPTIONAL and values is None:
                continue
            row = as_row(kind, values, None if kind == "velocity" else len(self.velocity))
            if min(row) <= 0.0:
                raise InvalidValue(f"{kind} must be > 0 for every joint, got {values!r}")
            object.__setattr__(self, kind, row)
        if self.along_path is not None:
            require_positive("along_path", self.along_path)
        if self.position is not None:
            pairs = tuple((float(lower), float(upper)) for lower, upper in self.position)
            if len(pairs) != len(self.velocity) or not all(lower < upper for lower, upper in pairs):
                raise InvalidValue(f"position must be (lower, upper) of every joint, got {shown(self.position)}")
            object.__setattr__(self, "position", pairs)

    def require_positions(self, path: Floats, names: Sequence[str]) -> None:
        """Raise InvalidValue if a path, (p, dim), leaves the limits of positions, up to 1e-5."""
        if self.position is None:
            return
        lower, upper = np.transpose(self.position)
        beyond = np.maximum(lower - path, path - upper)
        row, joint = divmod(int(beyond.argmax()), len(self.position))
        if beyond[row, joint] > SLACK:
            raise InvalidValue(
                f"the path puts joint {names[joint]!r} at {path[row, joint]:.6g}, {beyond[row, joint]:.3g} outside its"
                f" limits of position [{lower[joint]:.6g}, {upper[joint]:.6g}]: plan with limits of a scene, or"
                " with_limits(robot, ...), within them"
            )

    def at_speed(self, speed: float) -> Limits:
        """Return the limits at a share of full speed, 0 < speed <= 1."""
        if require_positive("speed", speed) > 1.0:
            raise InvalidValue(f"speed must be at most 1, the robot's own limits, got {speed!r}")
        if speed == 1.0:
            return self

        def scaled(row: tuple[float, ...], power: int) -> tuple[float, ...]:
            return tuple(value * speed**power for value in row)

        jerk = None if self.jerk is None else scaled(self.jerk, 3)
        slower = None if self.deceleration is None else scaled(self.deceleration, 2)
        along = None if self.along_path is None else self.along_path * speed
        return replace(
            self,
            velocity=scaled(self.velocity, 1),
            acceleration=scaled(self.acceleration, 2),
            jerk=jerk,
            along_path=along,
            deceleration=slower,
        )

    def of(self, columns: Sequence[int]) -> Limits:
        """Return the limits of some joints, by their numbers, without those of torques, of a tip or along the path."""

        def chosen(row: tuple[float, ...] | None) -> tuple[float, ...]:
            return tuple(row[i] for i in columns) if row is not None else ()

        jerk, deceleration = chosen(self.jerk) or None, chosen(self.deceleration) or None
        return Limits(chosen(self.velocity), chosen(self.acceleration), jerk, deceleration=deceleration)

    @property
    def stopping(self) -> tuple[float, ...]:
        """Largest deceleration of each joint."""
        return self.acceleration if self.deceleration is None else self.deceleration

    @property
    def of_joints(self) -> kernel.JointLimits:
        """Largest velocities, accelerations and decelerations, in the form of the native kernel."""
        return kernel.JointLimits(np.array(self.velocity), np.array(self.acceleration), np.array(self.stopping))

    def symmetric(self) -> Limits:
        """Return the limits with one acceleration per joint: the smaller of acceleration and deceleration."""
        if self.deceleration is None:
            return self
        return replace(self, acceleration=tuple(map(min, self.acceleration, self.deceleration)), deceleration=None)

    @property
    def is_plain(self) -> bool:
        """Whether the only limits are those of joints and of the speed along the path."""
        return self.torque is None and self.tip is None

    @property
    def further(self) -> kernel.FurtherLimits:
        """Limits of torques and of a tip, in the form of the native kernel."""
        return kernel.FurtherLimits(
            None if self.torque is None else self.torque.native,
            None if self.tip is None else self.tip.native,
        )

    def along(self, start: float, goal: float, share: float) -> kernel.PathLimits:
        """Return limits of the motion along a path that begins and ends at these speeds, for the native kernel.

        They are the square of the largest speed, and a `share` of the limits of torques and of a tip.
        """
        highest = _ANY_SPEED if self.along_path is None else self.along_path**2
        return kernel.PathLimits(highest, start, goal, self.further, share)

    def too_heavy(self, q: Floats) -> NotAvailable:
        """Return the error for a path, (n, dim), along which torques cannot hold the robot, or can hardly."""
        assert self.torque is not None, "only torques are needed at rest"
        still = np.zeros_like(q)
        shares = np.abs(self.torque.torques(q, still, still)) / np.array(self.torque.efforts)
        row, joint = np.unravel_index(int(shares.argmax()), shares.shape)
        name, effort = self.torque.robot.group[joint], self.torque.efforts[joint]
        return NotAvailable(
            f"joint {name!r} needs {shares[row, joint] * effort:.4g} N m to hold the robot still on the path, of"
            f" {effort:.4g}: there is too little left to move"
        )

    def further_shares(self, q: Floats, velocity: Floats, acceleration: Floats) -> dict[str, float]:
        """Return the largest used shares of limits of torques and of a tip, by kind, at states, (n, dim) each."""
        return named_shares(kernel.further_shares(self.further, q, velocity, acceleration))


def named_shares(used: kernel.FurtherShares) -> dict[str, float]:
    """Return shares of torque and of a tip's speed and acceleration by their names, without those that are 0."""
    kinds = {"torque": used.torque, "tip speed": used.tip_speed, "tip acceleration": used.tip_acceleration}
    return {kind: share for kind, share in kinds.items() if share > 0.0}


def limits_of(robot: Robot, file: str | os.PathLike[str] | None = None) -> Limits:
    """Return the limits of the planned joints.

    Parameters
    ----------
    robot : Robot
        The robot. Its joints have the velocities of the URDF, and its accelerations, decelerations and jerks, if any.
    file : str or path-like, optional
        MoveIt's ``joint_limits.yaml``. Its ``max_velocity``, ``max_acceleration``, ``max_deceleration`` and
        ``max_jerk`` override the robot's.  Its factors ``default_velocity_scaling_factor`` and
        ``default_acceleration_scaling_factor`` scale all joints, and its positions are limits of the path.  A joint
        without an acceleration reaches full speed in 0.5 s.  If only other joints have a jerk, a joint without one
        reaches full acceleration at the time of the slowest of them.

    Raises
    ------
    BrokenFile, UnknownName
        If the file cannot be read, or names an unknown joint or key.
    InvalidValue
        If a limit is not > 0, or a joint has no velocity anywhere.
    """
    joints = {joint.name: joint for joint in robot.joints}
    given = LimitsFile({}, {}, {}) if file is None else read_limits(Path(file), joints)
    velocity, acceleration, deceleration, jerk = [], [], [], []
    for name in robot.group:
        joint, said = joints[name], given.rates.get(name, {})
        fastest = said.get("velocity", joint.velocity)
        if not 0.0 < fastest < math.inf:
            raise InvalidValue(
                f"joint {name!r} of {robot.name!r} has no velocity limit: give it a max_velocity > 0 in a"
                f" joint_limits.yaml, by a line such as joint_limits: {{{name}: {{max_velocity: 2.0}}}}"
            )
        velocity.append(fastest * given.scaling.get("velocity", 1.0))
        push = said.get("acceleration", joint.acceleration)
        push = push if push < math.inf else fastest / SECONDS_TO_FULL_SPEED
        slower = said.get("deceleration", joint.deceleration)
        scale = given.scaling.get("acceleration", 1.0)
        acceleration.append(push * scale)
        deceleration.append((slower if slower < math.inf else push) * scale)
        jerk.append(said.get("jerk", joint.jerk))
    positions = tuple(given.positions.get(name, (-math.inf, math.inf)) for name in robot.group)
    return Limits(
        tuple(velocity),
        tuple(acceleration),
        _jerks(jerk, acceleration),
        position=positions if np.isfinite(positions).any() else None,
        deceleration=None if deceleration == acceleration else tuple(deceleration),
    )


def _jerks(jerk: list[float], acceleration: list[float]) -> tuple[float, ...] | None:
    """Return the jerk of every joint, or None if no joint has one; the slowest joint sets the jerk of those without."""
    if min(jerk) == math.inf:
        return None
    seconds = max(push / most for push, most in zip(acceleration, jerk, strict=True))
    return tuple(most if most < math.inf else push / seconds for push, most in zip(acceleration, jerk, strict=True))
