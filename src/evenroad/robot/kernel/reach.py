"""How far the joints can carry the capsules: bounds that hold in every configuration."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.tree import MovingFrame, MovingTree
from evenroad.robot.robot import Robot


class Segment(Protocol):
    """The part of a placed capsule that counts here; the radius does not, since balls turn into themselves."""

    @property
    def frame(self) -> int:
        """Number of the frame that it is fixed to."""
        ...

    @property
    def centre(self) -> npt.NDArray[np.float64]:
        """Its middle (3,)."""
        ...

    @property
    def half(self) -> npt.NDArray[np.float64]:
        """From there to one end (3,)."""
        ...

    @property
    def radius(self) -> float:
        """Of the capsule around it [m]."""
        ...


def joint_arms(tree: MovingTree, segments: Sequence[Segment], robot: Robot) -> npt.NDArray[np.float64]:
    """Return how fast each frame moves each segment at most, shape (segments, frames) [m/rad or m/m].

    A frame that turns by dq moves a point by at most |dq| times the point's distance from the z axis; for
    points of the frame itself that is known, for those of frames further out it is at most the way to the
    next frame's origin, seen along z, and from there on straight through all origins.  A frame that slides
    moves every point by |dq|.  Column f is for frame f + 1 and the change of its coordinate (a mimic's
    multiplier is included); 0 where the frame does not carry the segment.
    """
    arms = np.zeros((len(segments), len(tree.frames)))
    for row, segment in zip(arms, segments, strict=True):
        ends = np.stack([segment.centre - segment.half, segment.centre + segment.half])
        aside = float(np.hypot(ends[:, 0], ends[:, 1]).max())
        straight = float(np.linalg.norm(ends, axis=1).max())
        number = segment.frame
        while number > 0:
            frame = tree.frames[number - 1]
            row[number - 1] = abs(frame.multiplier) * (1.0 if frame.slides else aside)
            straight += _longest_slide(frame, robot)
            aside = straight + float(np.hypot(frame.translation[0], frame.translation[1]))
            straight += float(np.linalg.norm(frame.translation))
            number = frame.parent
    return arms


def speed_bounds(
    tree: MovingTree, segments: Sequence[Segment], pairs: Sequence[tuple[int, int]], robot: Robot
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return how fast each coordinate moves segments, and those of a pair against each other, at most [m/rad].

    Parameters
    ----------
    tree, segments, robot : MovingTree, sequence of Segment, Robot
        As for `joint_arms`.
    pairs : sequence of (int, int)
        Numbers of two segments.  Frames that carry both move them as one body.

    Returns
    -------
    speeds, pair_speeds : float64 arrays, shapes (segments, dim) and (pairs, dim)
    """
    by_frame = joint_arms(tree, segments, robot)
    first, second = (by_frame[[pair[end] for pair in pairs]].reshape(-1, by_frame.shape[1]) for end in (0, 1))
    carriers = [_carriers(tree, segment.frame) for segment in segments]
    common = np.zeros(first.shape, dtype=np.bool_)
    for row, (i, k) in zip(common, pairs, strict=True):
        row[[number - 1 for number in carriers[i] & carriers[k]]] = True
    to_coordinate = np.zeros((by_frame.shape[1], len(robot.group)))
    for column, frame in enumerate(tree.frames):
        to_coordinate[column, frame.coordinate] = 1.0
    return by_frame @ to_coordinate, np.where(common, 0.0, first + second) @ to_coordinate


def _carriers(tree: MovingTree, number: int) -> set[int]:
    """Return the numbers of the frames that carry what is fixed to a frame, itself included."""
    carriers = set()
    while number > 0:
        carriers.add(number)
        number = tree.frames[number - 1].parent
    return carriers


def farthest(tree: MovingTree, segments: Sequence[Segment], robot: Robot) -> float:
    """Return a distance from the root's origin beyond which no capsule ever reaches [m]."""
    most = 0.0
    for segment in segments:
        ends = np.stack([segment.centre - segment.half, segment.centre + segment.half])
        straight = float(np.linalg.norm(ends, axis=1).max()) + 1.2 * segment.radius
        number = segment.frame
        while number > 0:
            frame = tree.frames[number - 1]
            straight += _longest_slide(frame, robot) + float(np.linalg.norm(frame.translation))
            number = frame.parent
        most = max(most, straight)
    return most


def largest_value(frame: MovingFrame, robot: Robot) -> float:
    """Return the largest size of a frame's value within the limits of the joint that moves it [rad or m]."""
    joint = next(joint for joint in robot.joints if joint.name == robot.group[frame.coordinate])
    ends = (-math.pi, math.pi) if joint.kind == "continuous" else (joint.lower, joint.upper)
    return max(abs(frame.multiplier * value + frame.offset) for value in ends)


def _longest_slide(frame: MovingFrame, robot: Robot) -> float:
    """Return how far a frame's origin can slide from where it is at value 0; nothing where it turns."""
    return largest_value(frame, robot) if frame.slides else 0.0
