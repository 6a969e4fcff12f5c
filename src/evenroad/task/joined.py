"""Trajectories of motions in sequence, as one: of the arm's joints, and of the fingers that move between them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue
from evenroad.trajectory.corners import MOST_STATES
from evenroad.trajectory.limits import Limits
from evenroad.trajectory.trajectory import Trajectory


def joined(parts: list[Trajectory], pauses: list[float], fingers: Sequence[str] = ()) -> Trajectory:
    """Return trajectories in sequence, each after its pause, and a last pause; the `fingers` are the last joints."""
    if not parts:
        raise InvalidValue("there is no trajectory: the arm stays where it is")
    parts, step = of_same_joints(parts, fingers), parts[0].step
    if (seconds := sum(pauses)) > MOST_STATES * step:
        raise InvalidValue(f"the arm would stand still for {seconds:g} s, more than {MOST_STATES} steps of {step:g} s")
    rows: list[Floats] = []
    at = parts[0].positions[0]
    for part, pause in zip([*parts, None], pauses, strict=True):
        still = np.zeros((math.ceil(pause / step - 1e-9), 3, len(at)))
        still[:, 0] = at
        rows.append(still)
        if part is not None:
            states = np.stack([part.positions, part.velocities, part.accelerations], axis=1)
            rows.append(states[1 if len(rows) > 1 else 0 :])
            at = part.positions[-1]
    positions, velocities, accelerations = np.ascontiguousarray(np.concatenate(rows).transpose(1, 0, 2))
    order = ("resolution", "certified", "exact")
    return replace(
        parts[0],
        # Its parts have worlds of their own, in which other things are held.
        world=None,
        times=np.arange(len(positions), dtype=np.float64) * step,
        positions=positions,
        velocities=velocities,
        accelerations=accelerations,
        waypoints=np.concatenate([parts[0].waypoints[:1], *(part.waypoints[1:] for part in parts)]),
        deviation=max(part.deviation for part in parts),
        stops=sum(part.stops for part in parts) + len(parts) - 1,
        highest={name: max(part.highest.get(name, 0.0) for part in parts) for name in parts[0].highest},
        proof=min((part.proof for part in parts), key=order.index),
        radii=(),
    )


def of_same_joints(parts: list[Trajectory], fingers: Sequence[str]) -> list[Trajectory]:
    """Return trajectories in sequence with all of their joints, which stay where they are while others move.

    Joints of an arm come first, then those of its fingers, which its controller gets, too.
    """
    arm = next((part for part in parts if part.names[0] not in fingers), parts[0])
    names = tuple(dict.fromkeys([*arm.names, *fingers]))
    if all(part.names == names for part in parts):
        return parts
    at: dict[str, float] = {}
    for part in parts:
        at = dict(zip(part.names, part.positions[0].tolist(), strict=True)) | at
    of_all = _limits(parts, names)
    held = {name: value for name, value in arm.held.items() if name not in names}
    controller = tuple(dict.fromkeys([*arm.controller, *names])) if arm.controller else ()
    made = []
    for part in parts:
        rows = {name: _placed(part, getattr(part, name), names, at) for name in ("positions", "waypoints")}
        still = dict.fromkeys(names, 0.0)
        rows |= {name: _placed(part, getattr(part, name), names, still) for name in ("velocities", "accelerations")}
        made.append(replace(part, names=names, limits=of_all, held=held, controller=controller, **rows))  # type: ignore[arg-type]
        at |= dict(zip(part.names, part.positions[-1].tolist(), strict=True))
    return made


def _placed(part: Trajectory, rows: Floats, names: Sequence[str], others: Mapping[str, float]) -> Floats:
    """Return the rows of a part's joints in the columns of all `names`; the other joints are at constant values."""
    placed = np.tile([others[name] for name in names], (len(rows), 1))
    placed[:, [names.index(name) for name in part.names]] = rows
    return placed


def _limits(parts: list[Trajectory], names: Sequence[str]) -> Limits:
    """Return the limits of all joints, each as in the first part that it moves in; without those of torques or a tip.

    Without a jerk in one of the parts, there is none.
    """
    found: dict[str, tuple[float, float, float, float | None]] = {}
    for part in parts:
        limits = part.limits
        jerks = limits.jerk or [None] * len(part.names)
        rows = zip(limits.velocity, limits.acceleration, limits.stopping, jerks, strict=True)
        found = dict(zip(part.names, rows, strict=True)) | found
    velocity, acceleration, deceleration, jerk = zip(*(found[name] for name in names), strict=True)
    return Limits(
        velocity,
        acceleration,
        None if None in jerk else jerk,
        deceleration=None if deceleration == acceleration else deceleration,
    )
