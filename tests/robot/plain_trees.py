"""An oracle: the trees of ``evenroad.planning.arm_trees``, the same steps one after the other in Python."""

from __future__ import annotations

import math
import time
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from evenroad.roadmap.connector import Connection
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.tree_sequences import ball_points

Floats = npt.NDArray[np.float64]

EXTENSIONS, STEPS_AT_ONCE = 3, 8
LONGEST_STEP, STEP_SHARE = 1.5, 1.0 / 5.8
LARGEST_BALL, BALL_SHARE = 2.0, 1.5
"""As in ``_native/cpp/planning/tree_steps.cpp``."""

TOLERANCE = 1e-6
"""Of proofs [m]."""


@dataclass(eq=False)
class _Tree:
    nodes: list[Floats]
    parents: list[int]
    tried: list[int] = field(init=False)

    def __post_init__(self) -> None:
        self.tried = [0] * len(self.nodes)

    def add(self, q: Floats, parent: int) -> int:
        self.nodes.append(q)
        self.parents.append(parent)
        self.tried.append(0)
        return len(self.nodes) - 1

    def to_root(self, node: int) -> list[int]:
        way = [node]
        while self.parents[way[-1]] >= 0:
            way.append(self.parents[way[-1]])
        return way


class _Spent(Exception):
    """The budget is spent."""


class _Growth:
    """Two trees and what their motions cost."""

    def __init__(self, world: ArmWorld, trees: tuple[_Tree, _Tree], most: int, seconds: float) -> None:
        self.world, self.trees, self.most = world, trees, most
        # Compiled, or loaded, before the clock runs.
        nothing = np.empty((0, world.space.dim))
        world.motion_certified(nothing, nothing, TOLERANCE)
        self.deadline = time.perf_counter() + seconds
        self.configurations = self.motions = 0
        spread = np.array(world.space.high) - np.array(world.space.low)
        self.step = min(LONGEST_STEP, STEP_SHARE * float(np.sqrt(np.mean(spread**2))))
        self.radii = np.minimum(min(LARGEST_BALL, BALL_SHARE * self.step), 0.5 * spread)

    def free(self, a: Floats, b: Floats) -> bool:
        if self.motions >= self.most or time.perf_counter() >= self.deadline:
            raise _Spent
        self.motions += 1
        self.configurations += 1 + math.ceil(self.distance(a, b) / self.world.resolution)
        # Proved at once: the compiled trees prove no more than what becomes a path.
        return bool(self.world.motion_certified(a[np.newaxis], b[np.newaxis], TOLERANCE)[0])

    def distance(self, a: Floats, b: Floats) -> float:
        return float(self.world.space.distance(a[np.newaxis], b[np.newaxis])[0])

    def between(self, a: Floats, b: Floats, share: float) -> Floats:
        return self.world.space.interpolate(a[np.newaxis], b[np.newaxis], share)[0]

    def nearest(self, tree: _Tree, q: Floats) -> int:
        nodes = np.array(tree.nodes)
        return int(np.argmin(self.world.space.distance(nodes, np.broadcast_to(q, nodes.shape))))

    def reach(self, tree: int, found: int, other: int) -> int:
        """Go from a node towards one of the other tree in equal steps; return the last node where it was reached."""
        here, there = self.trees[tree].nodes[found], self.trees[1 - tree].nodes[other]
        steps = max(1, math.ceil(self.distance(here, there) / self.step))
        for number in range(1, steps + 1):
            target = self.between(here, there, number / steps)
            if not self.free(self.trees[tree].nodes[found], target):
                return -1
            if number < steps:
                found = self.trees[tree].add(target, found)
        return found

    def candidates(self, tree: _Tree, sample: Floats, ball: Floats) -> list[tuple[int, Floats]]:
        """Return where a tree may go next, and from which nodes: one extension, or ball steps."""
        closest = self.nearest(tree, sample)
        here = tree.nodes[closest]
        if tree.tried[closest] < EXTENSIONS:
            tree.tried[closest] += 1
            share = min(1.0, self.step / max(self.distance(here, sample), 1e-300))
            return [(closest, self.between(here, sample, share))]
        steps = []
        for number, point in enumerate(ball):
            origin = closest if number % 2 else int(np.argmin(tree.tried))
            tree.tried[origin] += 1
            target = tree.nodes[origin] + self.radii * point
            steps.append((origin, self._within(target)))
        ends = np.array([target for _, target in steps])
        begins = np.array([tree.nodes[origin] for origin, _ in steps])
        free = self.world.valid(ends) & self.world.valid(self.world.space.interpolate(begins, ends, 0.5))
        self.motions += int((~free).sum())
        self.configurations += 2 * len(steps)
        return [step for step, open_ in zip(steps, free, strict=True) if open_]

    def _within(self, q: Floats) -> Floats:
        space = self.world.space
        return np.where(space.flat.wrapping, self.between(q, q, 0.0), np.clip(q, space.low, space.high))


def grown(world: ArmWorld, ends: Floats, samples: Floats, most: int, seconds: float) -> Connection:
    """Join a start, the first of `ends`, to one of the goals, the others; see `arm_trees.connect`."""
    space, dim = world.space, world.space.dim
    roots, free = space.interpolate(ends, ends, 0.0), world.valid(ends)
    order = np.argsort(
        space.distance(np.broadcast_to(roots[0], (len(ends) - 1, dim)), roots[1:]), kind="stable"
    )
    goals = [int(goal) for goal in order if free[1 + goal]]
    empty = np.empty((0, dim))
    if not (free[0] and goals):
        return Connection(empty, -1, 0, len(ends), 0)
    trees = _Tree([roots[0]], [-1]), _Tree([roots[1 + goal] for goal in goals], [-1] * len(goals))
    growth = _Growth(world, trees, most, seconds)
    path, root = empty, -1
    with suppress(_Spent):
        path, root = _met(growth, len(goals), samples)
    nodes = len(trees[0].nodes) + len(trees[1].nodes)
    goal = goals[root] if root >= 0 else -1
    return Connection(path, goal, nodes, growth.configurations + len(ends), growth.motions)


def _met(growth: _Growth, goals: int, samples: Floats) -> tuple[Floats, int]:
    """Grow the trees until they meet; return the path and the number of its goal's root."""
    space = growth.world.space
    ball, steps, growing = ball_points(space.dim), 0, 0
    for other in range(min(goals, 16)):
        met = growth.reach(0, 0, other)
        if met >= 0:
            return _path(growth, met, other)
    for number in range(2**60):
        if len(growth.trees[growing].nodes) > len(growth.trees[1 - growing].nodes):
            growing = 1 - growing
        shift = number // len(samples) * np.arange(1, space.dim + 1) * 0.6180339887498949
        sample = space.from_cube(((samples[number % len(samples)] + shift) % 1.0)[np.newaxis])[0]
        rows = np.arange(steps, steps + STEPS_AT_ONCE) % len(ball)
        candidates = growth.candidates(growth.trees[growing], sample, ball[rows])
        steps += STEPS_AT_ONCE
        for origin, target in candidates:
            tree = growth.trees[growing]
            if not growth.free(tree.nodes[origin], target):
                continue
            found = tree.add(target, origin)
            other = growth.nearest(growth.trees[1 - growing], target)
            met = growth.reach(growing, found, other)
            if met >= 0:
                return _path(growth, *((met, other) if growing == 0 else (other, met)))
    raise AssertionError("numbers came to an end")


def _path(growth: _Growth, first: int, second: int) -> tuple[Floats, int]:
    """Return the path through a node of either tree, and the root that it ends at."""
    before, behind = growth.trees[0].to_root(first)[::-1], growth.trees[1].to_root(second)
    nodes = [growth.trees[0].nodes[i] for i in before] + [growth.trees[1].nodes[i] for i in behind]
    return np.array(nodes), behind[-1]
