"""Checks of a trajectory, by its states alone and in a world, because the claim of a file is no proof."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad.collision.arm_world import ArmWorld
from evenroad.constraints.differential_drive import DifferentialDrive
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.poses.constraint import Constraint, part_of
from evenroad.robots.kinematics import held_values
from evenroad.robots.robot import Robot
from evenroad.trajectory.corners import drivable
from evenroad.trajectory.tip_constraints import constrained_world
from evenroad.trajectory.trajectory import Trajectory
from evenroad.world import World
from evenroad.world.protocol import Explains

_OVER = 1.001
"""Share of a limit that is allowed, for rounding."""
_ROUNDING = 1e-12
"""Largest error of a position by rounding, relative to the largest one."""
_SAME = 1e-9
"""Largest difference between a held joint's values in trajectory and robot [rad or m]."""
_SIDEWAYS = 1e-6
"""Largest movement of a base across its heading between two states [m]."""


def require_within_limits(trajectory: Trajectory) -> None:
    """Raise InvalidValue if states violate the trajectory's limits, or are inconsistent in sequence.

    A controller takes only the positions, so speeds and accelerations between them count, too, and the velocities must
    agree with them.
    """
    dt, limits = trajectory.step, trajectory.limits
    q, v, a = trajectory.positions, trajectory.velocities, trajectory.accelerations
    fastest, push, slower = (np.array(row) for row in (limits.velocity, limits.acceleration, limits.stopping))
    # The limit for changes of velocity between states is that of slowing down.
    slows = a * v < 0.0
    push, faster = np.maximum(push, slower), push
    off = 4.0 * _ROUNDING * (1.0 + float(np.abs(q).max()))
    moved, middle = np.diff(q, axis=0), 0.5 * dt * (v[1:] + v[:-1])
    used = [
        ("velocity", v, fastest),
        ("velocity", moved / dt, fastest + off / dt),
        ("acceleration", np.where(slows | (v == 0.0), 0.0, a), faster),
        ("deceleration", np.where(slows, a, 0.0), slower),
        ("acceleration", a, push),
        ("acceleration", np.diff(v, axis=0) / dt, push + off / dt),
        ("acceleration", np.diff(moved, axis=0) / dt**2, push + off / dt**2),
        ("difference of velocity and motion", (moved - middle) / dt, 0.25 * push * dt + off / dt),
    ]
    if limits.jerk is not None:
        used.append(("jerk", np.diff(a, axis=0) / dt, np.array(limits.jerk) + off / dt))
    for kind, rows, most in used:
        shares = np.abs(rows) / most
        if shares.size and shares.max() > _OVER:
            row, joint = np.unravel_index(int(shares.argmax()), shares.shape)
            raise InvalidValue(
                f"the {kind} of joint {trajectory.names[joint]!r} is {abs(rows[row, joint]):.4g} at"
                f" {trajectory.times[row]:.3f} s, more than {most[joint]:.4g}"
            )


def proved_in(trajectory: Trajectory, world: World, constraints: Constraint | None = None) -> Trajectory:
    """Return a trajectory, such as one from a file, with the proof that it is free in a world.

    The checks are these: the states keep the limits of the trajectory, are consistent in sequence, and are within the
    limits of the joints.  All motions from state to state are free, by the strict check of the world if it has one.

    Parameters
    ----------
    trajectory : Trajectory
    world : World
        An arm's world must plan for the joints of the trajectory, and have its held joints at the same values.
    constraints : Constraint, optional
        Constraints of the plan, which the trajectory must keep, too.

    Returns
    -------
    Trajectory
        The same states, with the world's `proof`.

    Raises
    ------
    InvalidValue
        If a limit is violated, or the joints are others.
    NotAvailable
        If it is not proved free, or violates the constraints.

    Examples
    --------
    >>> import numpy as np
    >>> import evenroad as er
    >>> from evenroad.trajectory import Limits, make_trajectory, proved_in
    >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
    >>> trajectory = make_trajectory([(3, 3), (27, 17)], Limits((5, 5), (10, 10)))
    >>> trajectory.proof, proved_in(trajectory, world).proof
    ('unchecked', 'exact')
    """
    require_within_limits(trajectory)
    positions, checked = trajectory.positions, world
    if positions.shape[1] != world.space.dim:
        raise InvalidValue(f"the trajectory has {positions.shape[1]} joints, its world {world.space.dim}")
    if isinstance(world, ArmWorld):
        _require_joints(trajectory, world.robot)
        checked = constrained_world(world, positions, constraints)
    free, proof = drivable(checked, positions)
    if (drive := part_of(constraints, DifferentialDrive)) is not None and isinstance(world, ArmWorld):
        free &= _straight_ahead(positions, drive.numbers(world.robot))
    if not free.all():
        row = int(np.argmin(free))
        raise NotAvailable(
            f"the trajectory is not proved free at {trajectory.times[row]:.3f} s{_why(world, positions)}"
        )
    return replace(trajectory, proof=proof)


def _require_joints(trajectory: Trajectory, robot: Robot) -> None:
    """Raise InvalidValue if a trajectory has other joints than those that a robot plans for."""
    if trajectory.names != robot.group:
        there, here = ", ".join(trajectory.names), ", ".join(robot.group)
        raise InvalidValue(f"the trajectory is of the joints {there}, the robot {robot.name!r} plans for {here}")
    held = held_values(robot)
    for name, value in trajectory.held.items():
        if abs(value - held.get(name, np.inf)) > _SAME:
            raise InvalidValue(f"the trajectory holds {name!r} at {value:.6g}, the robot {robot.name!r} does not")


def _straight_ahead(positions: Floats, base: tuple[int, int, int]) -> Bools:
    """Return which motions from state to state move a base along its heading: (n - 1,)."""
    moved = np.diff(positions[:, base[:2]], axis=0)
    heading = 0.5 * (positions[1:, base[2]] + positions[:-1, base[2]])
    across: Floats = np.cos(heading) * moved[:, 1] - np.sin(heading) * moved[:, 0]
    return np.abs(across) <= _SIDEWAYS


def _why(world: World, positions: Floats) -> str:
    """Return in words the contact of the first state that is not free; an empty text if all are free."""
    bad = positions[~world.valid(positions)]
    return f": {world.explain(bad[0])}" if len(bad) and isinstance(world, Explains) else ""
