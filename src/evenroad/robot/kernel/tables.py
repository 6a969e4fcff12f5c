"""ArmTables: a model packed into the few arrays that compiled code takes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel import layout
from evenroad.robot.kernel.model import ArmModel, PlacedCapsule, clipped, is_straight
from evenroad.robot.scene import Obstacle

LANES = layout.LANES

PADDING = 2e-6
"""Single precision makes places uncertain by less than this share of the robot's reach (of 1 m at least)."""

OBSTACLE_PADDING = 2.5e-7
"""The same as a share of how far an obstacle's farthest point is from the origin."""

_NEVER_HIT = -1e30
"""Half extent that fills unused places of a block of obstacles."""


@dataclass(frozen=True, eq=False)
class ArmTables:
    """What the compiled code reads; the order is that of ``layout.py``.

    Attributes
    ----------
    ints : int64 ndarray
        Header and integers.
    floats : float64 ndarray
        The model as it is.
    lanes : int64 ndarray
        For the lanes, in one piece: the integers, and behind them, as float32, the model with larger radii, so that
        rounding never makes it optimistic.
    margin : float
        A capsule and an obstacle nearer to each other than this may touch by `lanes` [m].
    pair_margins : float64 ndarray, shape (capsule pairs,)
        The same of the capsules of each pair [m].
    capsule_pairs : tuple of pairs of int
        The capsules of each pair, in the order of the tables.
    """

    ints: npt.NDArray[np.int64]
    floats: npt.NDArray[np.float64]
    lanes: npt.NDArray[np.int64]
    margin: float
    pair_margins: npt.NDArray[np.float64]
    capsule_pairs: tuple[tuple[int, int], ...]


def pack(model: ArmModel) -> ArmTables:
    """Return the tables of `model`."""
    padding = PADDING * max(1.0, model.reach)
    ints, floats, capsule_pairs = _pack(model, 0.0, 0.0)
    _, padded, _ = _pack(model, padding, OBSTACLE_PADDING)
    added = padded - floats
    # Once for what is added, once more for what rounding may add to that.
    of_obstacles = _column(
        added, ints[layout.OBSTACLE_FLOATS], layout.OBSTACLE_FLOAT_ROW, 15, len(model.obstacles)
    )
    margin = 2.0 * (padding + float(of_obstacles.max(initial=0.0)))
    pair_margins = 2.0 * _column(
        added, ints[layout.PAIR_FLOATS], layout.PAIR_FLOAT_ROW, 1, len(capsule_pairs)
    )
    # An even number of float32 fills whole places of an int64 array.
    singles = np.append(padded, [0.0] * (len(padded) % 2)).astype(np.float32)
    lanes = np.concatenate([ints, singles.view(np.int64)])
    for array in (ints, floats, lanes, pair_margins):
        array.setflags(write=False)
    return ArmTables(ints, floats, lanes, margin, pair_margins, capsule_pairs)


def _column(
    table: npt.NDArray[np.float64], first: int, row: int, entry: int, count: int
) -> npt.NDArray[np.float64]:
    """Return one entry of each of `count` rows that begin at `first`."""
    return table[first : first + count * row].reshape(count, row)[:, entry]


class _Rows:
    """Integers and floats as they are appended, section by section."""

    def __init__(self) -> None:
        self.header = [0] * layout.HEADER
        self.ints: list[int] = []
        self.floats: list[float] = []

    def begin(self, int_section: int | None, float_section: int | None) -> None:
        if int_section is not None:
            self.header[int_section] = layout.HEADER + len(self.ints)
        if float_section is not None:
            self.header[float_section] = len(self.floats)


def _pack(
    model: ArmModel, padding: float, obstacle_padding: float
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.float64], tuple[tuple[int, int], ...]]:
    rows = _Rows()
    counts = {
        layout.FRAMES: len(model.tree.frames),
        layout.CAPSULES: len(model.capsules),
        layout.STANDING: model.standing,
        layout.OBSTACLES: len(model.obstacles),
        layout.BLOCKS: -(-len(model.obstacles) // LANES),
    }
    for place, count in counts.items():
        rows.header[place] = count
    _pack_frames(rows, model)
    _pack_capsules(rows, model, padding)
    capsule_pairs = _pack_pairs(rows, model, padding)
    _pack_obstacles(rows, model, obstacle_padding)
    rows.header[layout.INTEGERS] = layout.HEADER + len(rows.ints)
    ints = np.array([*rows.header, *rows.ints], dtype=np.int64)
    return ints, np.array(rows.floats, dtype=np.float64), capsule_pairs


def _pack_frames(rows: _Rows, model: ArmModel) -> None:
    rows.begin(layout.FRAME_INTS, layout.FRAME_FLOATS)
    for frame in model.tree.frames:
        rows.ints += [frame.parent, frame.coordinate, int(frame.slides)]
        rows.floats += [*frame.rotation.ravel(), *frame.translation, frame.multiplier, frame.offset]
        rows.floats += [number - float(np.float32(number)) for number in (frame.multiplier, frame.offset)]


def _pack_capsules(rows: _Rows, model: ArmModel, padding: float) -> None:
    rows.begin(layout.CAPSULE_INTS, layout.CAPSULE_FLOATS)
    first = 0
    for capsule in model.capsules:
        end = first + len(capsule.cover.places)
        rows.ints += [capsule.frame, first, end]
        rows.floats += [*capsule.centre, *capsule.half, capsule.cover.radius + padding]
        first = end
    rows.begin(None, layout.SAMPLES)
    for capsule in model.capsules:
        rows.floats += capsule.cover.places


def _pack_pairs(rows: _Rows, model: ArmModel, padding: float) -> tuple[tuple[int, int], ...]:
    """Append bodies, pairs of bodies and pairs of capsules; return the last."""
    bodies = [link for link in model.links if any(link in pair for pair in model.pairs)]
    balls = [_ball([capsule for capsule in model.capsules if capsule.link == link]) for link in bodies]
    frames = [model.tree.links[link].frame for link in bodies]
    rows.header[layout.BODIES] = len(bodies)
    rows.header[layout.STANDING_BODIES] = frames.count(0)
    rows.begin(layout.BODY_INTS, layout.BODY_FLOATS)
    for frame, (centre, radius) in zip(frames, balls, strict=True):
        rows.ints.append(frame)
        rows.floats += [*centre, radius + padding]
    capsule_pairs: list[tuple[int, int]] = []
    rows.header[layout.BODY_PAIRS] = len(model.pairs)
    rows.begin(layout.BODY_PAIR_INTS, layout.BODY_PAIR_FLOATS)
    for a, b in model.pairs:
        first = len(capsule_pairs)
        for i, capsule in enumerate(model.capsules):
            if capsule.link == a:
                capsule_pairs += [(i, k) for k, other in enumerate(model.capsules) if other.link == b]
        rows.ints += [bodies.index(a), bodies.index(b), first, len(capsule_pairs)]
        rows.floats.append(balls[bodies.index(a)][1] + balls[bodies.index(b)][1] + 2.0 * padding)
    rows.begin(layout.PAIR_INTS, layout.PAIR_FLOATS)
    for i, k in capsule_pairs:
        rows.ints += [i, k]
        rows.floats += _pair_row(model.capsules[i], model.capsules[k], padding)
    return tuple(capsule_pairs)


def _ball(capsules: list[PlacedCapsule]) -> tuple[npt.NDArray[np.float64], float]:
    """Return centre and radius of a ball that holds capsules of one frame: around the middle of their box."""
    ends = [(end, c.radius) for c in capsules for end in (c.centre - c.half, c.centre + c.half)]
    low = np.min([end - radius for end, radius in ends], axis=0)
    high = np.max([end + radius for end, radius in ends], axis=0)
    centre = 0.5 * (low + high)
    return centre, max(float(np.linalg.norm(end - centre)) + radius for end, radius in ends)


def _pair_row(first: PlacedCapsule, second: PlacedCapsule, padding: float) -> list[float]:
    radii = first.radius + second.radius + 2.0 * padding
    a, b = first.half_length**2, second.half_length**2
    return [
        radii + first.half_length + second.half_length,
        radii,
        1.0 / a if a > 0.0 else 0.0,
        1.0 / b if b > 0.0 else 0.0,
    ]


def _pack_obstacles(rows: _Rows, model: ArmModel, relative_padding: float) -> None:
    rows.begin(layout.OBSTACLE_INTS, layout.OBSTACLE_FLOATS)
    boxes = []
    for whole in model.obstacles:
        obstacle = clipped(whole, model.reach)
        kind, half, rotation, rounding = _as_rounded_box(obstacle)
        centre = np.array(obstacle.xyz)
        bounds = np.abs(rotation) @ half + rounding
        if kind == layout.CYLINDER:
            upright = np.abs(rotation[:, 2])
            bounds = upright * half[2] + np.sqrt(np.maximum(1.0 - upright**2, 0.0)) * half[0]
        padding = relative_padding * float(np.linalg.norm(np.abs(centre) + bounds))
        rows.ints.append(kind)
        rows.floats += [*centre, *half, *rotation.ravel(), rounding + padding]
        boxes.append((centre, bounds + padding))
    rows.begin(None, layout.BLOCK_FLOATS)
    for first in range(0, len(boxes), LANES):
        block = boxes[first : first + LANES]
        for part in (0, 1):
            for axis in range(3):
                row = [float(box[part][axis]) for box in block]
                rows.floats += row + [_NEVER_HIT if part else 0.0] * (LANES - len(block))
    rows.begin(layout.TESTED, None)
    for i in range(len(model.capsules)):
        for first in range(0, len(boxes), LANES):
            wanted = model.tested[i, first : first + LANES]
            rows.ints.append(sum(1 << lane for lane in np.flatnonzero(wanted).tolist()))


def _as_rounded_box(
    obstacle: Obstacle,
) -> tuple[int, npt.NDArray[np.float64], npt.NDArray[np.float64], float]:
    """Return kind, half extents, rotation and rounding: all points within `rounding` of a box."""
    rotation = np.array(obstacle.rotation, dtype=np.float64).reshape(3, 3)
    if obstacle.shape == "sphere":
        return layout.ALIGNED, np.zeros(3), np.eye(3), obstacle.size[0]
    if obstacle.shape == "cylinder":
        radius, length = obstacle.size
        return layout.CYLINDER, np.array([radius, radius, 0.5 * length]), rotation, 0.0
    if obstacle.shape == "capsule":
        half, rounding = np.array([0.0, 0.0, 0.5 * obstacle.size[1]]), obstacle.size[0]
    else:
        half, rounding = 0.5 * np.array(obstacle.size, dtype=np.float64), 0.0
    if is_straight(rotation):
        return layout.ALIGNED, np.abs(np.rint(rotation)) @ half, np.eye(3), rounding
    return layout.TURNED, half, rotation, rounding
