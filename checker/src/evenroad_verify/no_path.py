"""Certificates of no path: each path from the start to a goal meets a cell that is blocked."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from evenroad_verify.cells import Cells, Ranges, cells_of, reached
from evenroad_verify.certificate import FARTHEST, Certificate, count_of, head_of, read_file, tables_of
from evenroad_verify.claim import (
    Body,
    Inputs,
    bodies_of,
    may_touch,
    ranges_of,
    require_bounded,
    require_limits,
    silent,
)
from evenroad_verify.errors import Bools, Floats, Ints, demand
from evenroad_verify.frames import Frames, frames_of
from evenroad_verify.overlaps import Places, Solid, Spot, between, is_ball_inside, require_blocked, solid_of
from evenroad_verify.poses import PoseGoal, are_beyond, read_poses

MAGIC = b"evenroad certificate of no path 1\n"
_AT_ONCE = 1 << 14
_MOST = 8
"""Columns of cells: these have 2^8 corners."""


@dataclass(frozen=True)
class NoPath:
    """What a file claims.

    `terminals` holds joints, distances to keep, and start and goals as motions from the start.  `balls`, (b, 5), are
    the number of a body, a centre in its frame and a radius; `witnesses`, (w, 2), the numbers of a ball and of a solid.
    `parts` are columns and the answers of their cells.  `goals` counts those that are configurations.
    """

    terminals: Certificate
    balls: Floats
    witnesses: Ints
    parts: tuple[tuple[Ints, Ints], ...]
    goals: int
    poses: tuple[PoseGoal, ...]


@dataclass(frozen=True)
class Shown:
    """An accepted certificate of no path: pairs of bodies that block cells, joints, and how many cells are blocked."""

    certificate: NoPath
    pairs: tuple[tuple[str, str], ...]
    joints: tuple[str, ...]
    blocked: int
    least: float
    silent: tuple[str, ...]


def read_no_path(data: bytes) -> NoPath:
    """Return the certificate that some bytes are; Refused for any others."""
    # What is no number is refused below.
    with np.errstate(invalid="ignore"):
        return read_file(data, MAGIC, _no_path)


def _no_path(said: dict[str, list[str]], body: memoryview) -> NoPath:
    once = ("goals", "balls", "witnesses")
    head = head_of(said, once, ("cells", "position", "pose"))
    dim = len(head["joints"])
    goals, balls, witnesses = (count_of(said[key][0]) for key in once)
    parts = [[count_of(word) for word in line.split(" ")] for line in said.get("cells", [])]
    sizes = [8 * (1 + goals) * dim, 18 * balls, 4 * witnesses]
    for count, *columns in parts:
        demand(0 < len(columns) == len(set(columns)) <= _MOST, "cells are of no joint, of one twice, or of too many")
        demand(max(columns) < dim, "cells are of a joint that is not named")
        sizes.append(count * _bytes(len(columns), witnesses))
    poses = read_poses(said)
    demand((goals or poses) and parts, "it has no goals, or no cells")
    pieces, head["carried"] = tables_of(said, body, sizes)
    terminals = np.frombuffer(pieces[0], "<f8").reshape(-1, dim)
    demand(np.isfinite(terminals).all() and np.abs(terminals).max() <= FARTHEST, "an end is no number, or too large")
    table = np.frombuffer(pieces[1], np.dtype([("body", "<u2"), ("ball", "<f4", 4)]))
    ball = np.concatenate([table["body"][:, None], table["ball"]], axis=1, dtype=float)
    sane = np.isfinite(ball).all() and (ball[:, 4] >= 0.0).all() and not (np.abs(ball[:, 1:]) > FARTHEST).any()
    demand(sane, "a ball is no number, or too large")
    # With poses alone, the start is where its curve ends.
    goal = terminals[1:] if goals else terminals
    start = np.broadcast_to(terminals[0], goal.shape)
    curves = np.stack([start, 0.5 * (start + goal), goal], axis=1)
    answers = [
        (np.array(columns), np.frombuffer(piece, f"<u{_bytes(len(columns), witnesses)}").astype(np.int64))
        for (_, *columns), piece in zip(parts, pieces[3:], strict=True)
    ]
    return NoPath(
        Certificate(**head, curves=curves, answers=np.zeros(0, np.uint8), directions=np.zeros((0, 3))),
        ball,
        np.frombuffer(pieces[2], "<u2").reshape(-1, 2).astype(np.int64),
        tuple(answers),
        goals,
        tuple(poses),
    )


def _bytes(columns: int, witnesses: int) -> int:
    """Return how many bytes an answer takes."""
    return 1 if 1 + columns + witnesses <= 256 else 2


def verify_no_path(data: bytes, inputs: Inputs) -> Shown:
    """Return what a certificate of no path proves; Refused, with the reason, if it does not."""
    read = read_no_path(data)
    terminals = read.terminals
    demand(terminals.inputs == inputs.digest, "robot, SRDF, scene or meshes are not the files that it was written for")
    with np.errstate(all="ignore"):
        frames = frames_of(inputs.robot, terminals)
        bodies, ranges = bodies_of(inputs, frames, terminals), ranges_of(inputs, frames, terminals)
        require_limits(ranges, terminals)
        low, high = np.where(np.isinf(ranges), (-np.pi, np.pi), ranges).T
        require_bounded(inputs, frames, bodies, replace(terminals, curves=np.array([[low, low, high]])))
        table, names = _witnesses(read, inputs, bodies, may_touch(inputs, bodies))
        left, blocked, least = np.ones(read.goals + len(read.poses), bool), 0, np.inf
        most = np.abs(frames.factor * ranges.T[:, frames.column] + frames.offset).max(0)
        slides = np.where(frames.slides, most, 0.0)
        for columns, answers in read.parts:
            cells = cells_of(ranges_of_cells(frames, ranges, columns, terminals.joints), answers)
            witness, shut = cells.answer - 1 - len(columns), cells.answer > len(columns)
            demand((witness < len(table)).all(), "an unknown witness")
            for number in np.unique(witness[shut]):
                (ball, (frame, _), _) = table[number]
                moving = frames.column[between(frames, ball.frame, frame)]
                demand(np.isin(moving, columns).all(), "other joints move a witness")
            middles, half = cells.middles()
            for rows in _some(shut):
                places = Places(frames, cells.ranges, middles[rows], half[rows], len(terminals.joints))
                least = min(least, require_blocked(places, frames, witness[rows], table))
            blocked += int(shut.sum())
            inside = _inside(cells, terminals)
            for i, goal in enumerate(terminals.curves[: read.goals, 2]):
                left[i] &= (cells.holding(goal) & inside).any()
            beyond = np.ones(len(read.poses), bool)
            for rows in _some(inside) if read.poses else ():
                places = Places(frames, cells.ranges, middles[rows], half[rows], len(terminals.joints))
                beyond &= [are_beyond(pose, places, frames, columns, slides).all() for pose in read.poses]
            left[read.goals :] &= ~beyond
        demand(not left.any(), f"a goal is not shown to be out of reach: number {int(left.argmax())}")
    used = tuple(dict.fromkeys(terminals.joints[column] for columns, _ in read.parts for column in columns))
    return Shown(read, names, used, blocked, least, silent(inputs, bodies, terminals))


def _some(chosen: Bools) -> list[Ints]:
    """Return the rows of chosen cells, some at a time."""
    rows = np.flatnonzero(chosen)
    return np.array_split(rows, 1 + len(rows) // _AT_ONCE)


def _inside(cells: Cells, terminals: Certificate) -> Bools:
    """Return which cells the start reaches; Refused where it is in no open cell."""
    start = cells.holding(terminals.curves[0, 0]) & (cells.answer == 0)
    demand(start.any(), "the start is not in an open cell")
    return reached(cells, start)


def ranges_of_cells(frames: Frames, ranges: Floats, columns: Ints, names: tuple[str, ...]) -> Ranges:
    """Return the ranges of columns: as far as the joints may go, or one turn."""
    low, high = ranges[columns].T
    endless = np.isinf(low)
    for column, is_endless in zip(columns, endless, strict=True):
        turns, slides = frames.factor[frames.column == column], frames.slides[frames.column == column]
        whole = not slides.any() and (turns == np.rint(turns)).all()
        demand(whole or not is_endless, f"{names[column]} has no limits, and does not turn endlessly alone")
    demand((low < high).all(), "a joint has no range")
    return Ranges(columns, np.where(endless, -np.pi, low), np.where(endless, np.pi, high), endless)


def _witnesses(
    read: NoPath, inputs: Inputs, bodies: list[Body], touching: set[frozenset[str]]
) -> tuple[list[tuple[Spot, tuple[int, Solid | Spot], float]], tuple[tuple[str, str], ...]]:
    """Return balls, solids and what to keep between them, and the names of bodies; Refused where a pair may touch."""
    spots = []
    for number, *centre, radius in read.balls.tolist():
        demand(number < len(bodies), "a ball is in an unknown body")
        body = bodies[int(number)]
        demand(is_ball_inside(body, np.array(centre), radius), f"a ball is not inside of {body.name}")
        spots.append(Spot(body.frame, np.array(centre), radius))
    solids: list[tuple[int, Solid | Spot | None]] = [
        (i, solid_of(shape)) for i, body in enumerate(bodies) for shape in body.shapes if not shape.surface
    ]
    solids += [(int(body), spot) for (body, *_), spot in zip(read.balls.tolist(), spots, strict=True)]
    table, names = [], dict[tuple[str, str], None]()
    for first, second in read.witnesses.tolist():
        demand(first < len(spots) and second < len(solids), "an unknown ball or solid")
        number, solid = solids[second]
        one, two = bodies[int(read.balls[first, 0])], bodies[number]
        if solid is None:
            demand(False, f"{two.name} is no solid")
            continue
        demand(one.frame != two.frame, f"nothing moves {one.name} and {two.name} on each other")
        keep = 0.0
        if one.is_obstacle or two.is_obstacle:
            obstacle, link = (one.name, two.name) if one.is_obstacle else (two.name, one.name)
            demand((obstacle, link) not in inputs.scene.allowed, f"{link} may touch {obstacle}")
            keep = read.terminals.clearance + read.terminals.padding.get(link, 0.0)
        else:
            demand(frozenset((one.name, two.name)) not in touching, f"{one.name} may touch {two.name}")
        table.append((spots[first], (two.frame, solid), keep))
        names[one.name, two.name] = None
    return table, tuple(names)
