"""A tree of motions (RRT) whose draws are the points of a sequence, for a chain of four joints in a bent tunnel.

The chain, its start and its goal are those of OMPL's kinematic chain benchmark; the tunnel is its horn, of any width,
moved a little from problem to problem.  A motion is free if chain and walls, and links that share no joint, stay apart
by :data:`LEAST` all along: each step is as long as the clearance allows, so nothing is jumped over.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._njit import njit

JOINTS = 4
TURN = 2.0 * math.pi
LEAST = 0.001
"""Least clearance [lengths of the chain]."""


@dataclass(frozen=True)
class Setting:
    """How the tree grows and how problems differ: what the published text leaves open.

    `step` is the longest motion [rad, Euclidean in the joints], `every` the number of draws after which the goal is
    drawn once instead (0: never), `wraps` whether joints turn on beyond +-pi, `shift` and `tilt` how far the tunnel is
    moved, in half widths and radians, at most; with `turned` the whole scene is turned about the base by any angle.
    """

    step: float = 0.5
    every: int = 0
    wraps: bool = True
    shift: float = 0.25
    tilt: float = 0.15
    turned: bool = False


class Problem(NamedTuple):
    walls: Floats
    start: Floats
    goal: Floats


def tunnel(width: float) -> Floats:
    """Return the walls, columns x, y, dx, dy: (4, 6), or (4, 3) from a width of 2 / pi on: the inner wall is gone."""
    columns = []
    for side in (1.0, -1.0):
        x, y = 1.0 / JOINTS, -side * width / 2.0
        length = (1.0 + side * math.pi * width / 2.0) / JOINTS
        if length < 1e-9:
            continue
        for i in range(1, JOINTS):
            heading = i * math.pi / JOINTS
            along = length * math.cos(heading), length * math.sin(heading)
            columns.append((x, y, *along))
            x, y = x + along[0], y + along[1]
    return np.array(columns).T.copy()


def problem(width: float, number: int, stream: int, setting: Setting) -> Problem:
    """Return the problem of that number: the tunnel moved until start and goal are free."""
    rng = np.random.default_rng([stream, number, round(1000 * width)])
    start = np.array([0.0] + [math.pi / JOINTS] * (JOINTS - 1))
    goal = np.array([math.pi - 0.001] + [0.0] * (JOINTS - 1))
    ends = np.array([start, goal])
    while True:
        shift = rng.uniform(-1.0, 1.0, 2) * setting.shift * width / 2.0
        tilt = rng.uniform(-1.0, 1.0) * setting.tilt
        walls = _moved(tunnel(width), tilt, np.array([1.0 / JOINTS, 0.0]), shift)
        if min(clearance(each, walls) for each in ends) > 10.0 * LEAST:
            break
    if setting.turned:
        angle = rng.uniform(-math.pi, math.pi)
        walls = _moved(walls, angle, np.zeros(2), np.zeros(2))
        ends[:, 0] = (ends[:, 0] + angle + math.pi) % TURN - math.pi
    return Problem(walls, ends[0].copy(), ends[1].copy())


def _moved(walls: Floats, angle: float, about: Floats, shift: Floats) -> Floats:
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    at = turn @ (walls[:2] - about[:, None]) + (about + shift)[:, None]
    return np.ascontiguousarray(np.vstack([at, turn @ walls[2:]]))


class Tree(NamedTuple):
    """`draws` the points used when the goal was reached, 0 if it was not; the nodes, (m, 4), and their parents, (m,).

    Node 0 is the start; the last one is the goal if it was reached.
    """

    draws: int
    nodes: Floats
    parents: Ints

    def path(self) -> Floats:
        order = [len(self.nodes) - 1]
        while order[-1] > 0:
            order.append(int(self.parents[order[-1]]))
        return self.nodes[order[::-1]]


def grow(points: Floats, task: Problem, setting: Setting) -> Tree:
    """Return the tree of the points, (n, 4) in the unit cube, taken in their order."""
    draws, nodes, parents = _grow((points - 0.5) * TURN, *task, setting.step, setting.every, setting.wraps)
    return Tree(draws, nodes, parents)


@njit(cache=True, nogil=True)
def _grow(points, walls, start, goal, step, every, wraps):  # type: ignore[no-untyped-def]
    n, joints = points.shape
    room = 2 * n + 2
    nodes, parents = np.empty((room, joints)), np.zeros(room, np.int64)
    columns, squares = np.empty((joints, room)), np.empty(room)
    away = np.empty(joints)
    columns[:, 0] = start
    nodes[0], used, count, since = start, 0, 1, 0
    while used < n:
        since += 1
        if every > 0 and since > every:
            target, since = goal, 0
        else:
            target, used = points[used], used + 1
        squares[:count] = 0.0
        for k in range(joints):
            for i in range(count):
                turn = abs(target[k] - columns[k, i])
                turn = min(turn, TURN - turn) if wraps else turn
                squares[i] += turn * turn
        near = np.argmin(squares[:count])
        if not _goes(nodes[near], target, step, wraps, walls, away):
            continue
        for k in range(joints):
            end = nodes[near, k] + away[k]
            nodes[count, k] = end - TURN * np.rint(end / TURN) if wraps else end
        columns[:, count], parents[count] = nodes[count], near
        count += 1
        left = 0.0
        for k in range(joints):
            turn = goal[k] - nodes[count - 1, k]
            if wraps:
                turn -= TURN * np.rint(turn / TURN)
            left += turn * turn
        if left <= step * step and _goes(nodes[count - 1], goal, step, wraps, walls, away):
            nodes[count], parents[count] = goal, count - 1
            return used, nodes[: count + 1].copy(), parents[: count + 1].copy()
    return 0, nodes[:count].copy(), parents[:count].copy()


@njit(cache=True, nogil=True)
def _goes(first, target, step, wraps, walls, away):  # type: ignore[no-untyped-def]
    """Return whether the motion towards the target, at most `step` long, is free; `away` becomes its turn."""
    joints, length = len(first), 0.0
    for k in range(joints):
        away[k] = target[k] - first[k]
        if wraps:
            away[k] -= TURN * np.rint(away[k] / TURN)
        length += away[k] * away[k]
    length = math.sqrt(length)
    # No point of the chain moves further than this.
    speed = 0.0
    for k in range(joints):
        if length > step:
            away[k] *= step / length
        speed += abs(away[k]) * (joints - k) / joints
    if clearance(first + away, walls) < LEAST:
        return False
    along = 0.0
    while along < 1.0:
        apart = clearance(first + along * away, walls)
        if apart < LEAST:
            return False
        along += apart / max(speed, 1e-300)
    return True


@njit(cache=True, nogil=True)
def clearance(q, walls):  # type: ignore[no-untyped-def]
    """Return the least distance of a link to a wall, or half of that of two links without a common joint."""
    joints, heading, least = len(q), 0.0, np.inf
    x, y = np.zeros(joints + 1), np.zeros(joints + 1)
    longest = math.sqrt(np.max(walls[2] ** 2 + walls[3] ** 2))
    for k in range(joints):
        heading += q[k]
        x[k + 1], y[k + 1] = x[k] + math.cos(heading) / joints, y[k] + math.sin(heading) / joints
        for w in range(walls.shape[1]):
            cx, cy = walls[0, w], walls[1, w]
            dx, dy = cx + walls[2, w], cy + walls[3, w]
            # Of segments whose middles are far apart nothing needs to be known.
            far_x, far_y = x[k] + x[k + 1] - cx - dx, y[k] + y[k + 1] - cy - dy
            near = 2.0 * least + 1.0 / joints + longest
            if far_x * far_x + far_y * far_y < near * near:
                least = min(least, _apart(x[k], y[k], x[k + 1], y[k + 1], cx, cy, dx, dy))
        for i in range(k - 1):
            least = min(least, 0.5 * _apart(x[k], y[k], x[k + 1], y[k + 1], x[i], y[i], x[i + 1], y[i + 1]))
    return least


@njit(cache=True, nogil=True)
def _apart(ax, ay, bx, by, cx, cy, dx, dy):  # type: ignore[no-untyped-def]
    """Return the distance of the segments from a to b and from c to d; 0 where they cross."""
    side_c = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    side_d = (bx - ax) * (dy - ay) - (by - ay) * (dx - ax)
    side_a = (dx - cx) * (ay - cy) - (dy - cy) * (ax - cx)
    side_b = (dx - cx) * (by - cy) - (dy - cy) * (bx - cx)
    if side_c * side_d < 0.0 and side_a * side_b < 0.0:
        return 0.0
    least = min(_to_segment(ax, ay, cx, cy, dx, dy), _to_segment(bx, by, cx, cy, dx, dy))
    least = min(least, _to_segment(cx, cy, ax, ay, bx, by), _to_segment(dx, dy, ax, ay, bx, by))
    return math.sqrt(least)


@njit(cache=True, nogil=True)
def _to_segment(px, py, ax, ay, bx, by):  # type: ignore[no-untyped-def]
    ux, uy = bx - ax, by - ay
    share = ((px - ax) * ux + (py - ay) * uy) / max(ux * ux + uy * uy, 1e-300)
    share = min(max(share, 0.0), 1.0)
    gx, gy = ax + share * ux - px, ay + share * uy - py
    return gx * gx + gy * gy
