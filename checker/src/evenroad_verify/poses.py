"""Poses of a link that are goals: no posture of a cell reaches one if the next joint is too far away, or too near."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad_verify.claim import LEAST
from evenroad_verify.errors import Bools, Floats, Ints, Pose, demand, numbers
from evenroad_verify.frames import Frames
from evenroad_verify.overlaps import Places, between
from evenroad_verify.shapes import rotation_of


@dataclass(frozen=True)
class PoseGoal:
    """All configurations that bring the origin of a link within `near` of a point [m].

    With a quaternion the link is turned from that by at most `tilt` [rad].
    """

    link: str
    point: Floats
    near: float
    xyzw: Floats | None = None
    tilt: float = 0.0


def read_poses(said: dict[str, list[str]]) -> list[PoseGoal]:
    """Return the poses of a header."""
    goals = []
    for line in said.get("position", []):
        *words, link = line.split(" ", 4)
        near, *point = numbers(words, 4)
        goals.append(PoseGoal(link, np.array(point), near))
    for line in said.get("pose", []):
        *words, link = line.split(" ", 9)
        near, tilt, *pose = numbers(words, 9)
        goals.append(PoseGoal(link, np.array(pose[:3]), near, np.array(pose[3:]), tilt))
        demand(np.linalg.norm(pose[3:]) > 1e-9, "a quaternion is zero")
    demand(all(goal.near >= 0.0 and goal.tilt >= 0.0 for goal in goals), "a pose has a tolerance below 0")
    return goals


def are_beyond(goal: PoseGoal, places: Places, frames: Frames, columns: Ints, slides: Floats) -> Bools:
    """Return in which cells no posture reaches a goal, whatever other joints than the columns' do.

    `slides` are how far joints slide at most, 0 for those that turn.
    """
    demand(goal.link in frames.place, f"the robot has no link {goal.link}")
    frame, (rotation, shift) = frames.place[goal.link]
    chain = between(frames, 0, frame)
    free = [i for i, k in enumerate(chain) if frames.column[k] not in columns]
    known, rest = (chain[: free[0]], chain[free[0] :]) if free else (chain, [])
    bars = [float(np.linalg.norm(frames.origin[k][1])) for k in rest[1:]]
    target, near = _target(goal, (rotation, shift), bars)
    most = sum(bars) + float(slides[rest].sum()) if rest else sum(bars)
    least = max([0.0, *(2.0 * bar - most for bar in bars)])
    last = known[-1] + 1 if known else 0
    local = frames.origin[rest[0]][1] if rest else shift if goal.xyzw is None else np.zeros(3)
    if not rest:
        most = least = 0.0
    rows = np.arange(len(places.origin))
    points = places.origin[:, last] + places.rotation[:, last] @ local
    away, moved = np.linalg.norm(points - target, axis=1), places.moved(points, known[::-1], rows)
    return np.asarray((away - moved > most + near + LEAST) | (away + moved < least - near - LEAST))


def _target(goal: PoseGoal, placed: Pose, bars: list[float]) -> tuple[Floats, float]:
    """Return where the last joint, or the link itself, must be, and how near; adds the last bar where it counts."""
    rotation, shift = placed
    if goal.xyzw is None:
        bars.append(float(np.linalg.norm(shift)))
        return goal.point, goal.near
    # The rotation of the link says where the origin of its frame is.
    return goal.point - rotation_of(goal.xyzw) @ rotation.T @ shift, goal.near + goal.tilt * float(
        np.linalg.norm(shift)
    )
