"""RRT-Connect for any world: two trees that check batches of motions (Kuffner and LaValle 2000).

The trees take turns.  Each step takes the next batch of an even sequence, joins every sample to its nearest node of the
tree by at most one step, and checks the whole batch at once.  The other tree then tries to reach each new node.
Trees of robots are compiled, see `arm_trees`; these are for worlds in Python.
"""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._time_limit import BudgetSpent, look_at_clock
from evenroad.constraints.constrained_world import KeptWorld
from evenroad.planning.connector import Connection
from evenroad.points.reversed_halton import cube_points, shifted_cube_points
from evenroad.world import World

BATCH = 16
"""Number of samples per step of a tree. A world in Python checks a batch in little more time than one motion."""
STEP = 0.2
"""Longest motion of a tree, as a share of the median distance between two samples."""
FIRST, MOST_SAMPLES = 1 << 10, 1 << 18
"""Number of samples that are drawn first, and largest number. It doubles when they are used up, until trees stop."""
MOST_STEPS = 64
"""Largest number of steps of a tree towards a new node of the other one."""
MOST_SHIFTS = 128
"""Number of shifts of an even sequence in one variant: those of `MOST_SAMPLES`."""
NEAR = 8
"""Number of nearest goals that walks under constraints try to reach before trees grow."""


class _Tree:
    """Nodes, (n, dim), each with the number of its parent; roots have -1."""

    def __init__(self, roots: Floats) -> None:
        self.nodes, self.parents = roots.copy(), np.full(len(roots), -1)

    def nearest(self, world: World, q: Floats) -> Ints:
        """Return the node nearest to each configuration, (n, dim) -> (n,); ties go to the earlier one."""
        pairs = np.repeat(q, len(self.nodes), axis=0), np.tile(self.nodes, (len(q), 1))
        nearest: Ints = world.space.distance(*pairs).reshape(len(q), -1).argmin(axis=1)
        return nearest

    def add(self, nodes: Floats, parents: Ints) -> None:
        """Add nodes, (n, dim), with these parents, (n,)."""
        self.nodes = np.concatenate([self.nodes, nodes])
        self.parents = np.concatenate([self.parents, parents])

    def branch(self, node: int) -> list[int]:
        """Return the numbers of the nodes from a node to its root."""
        nodes = [node]
        while self.parents[nodes[-1]] >= 0:
            nodes.append(int(self.parents[nodes[-1]]))
        return nodes


def grow_trees(world: World, start: Floats, goals: Floats, *, variant: int, most_motions: int) -> Connection:
    """Join a start, (dim,), to one of the free goals, (g, dim); each variant scrambles the sequence differently."""
    both = _Both([_Tree(start[np.newaxis]), _Tree(np.asarray(goals, dtype=np.float64))])
    path, spent = np.empty((0, len(start))), False
    try:
        path = both.joined(world, variant, most_motions)
    except BudgetSpent:
        spent = True
    goal = int(np.flatnonzero((goals == path[-1]).all(axis=1))[0]) if len(path) else -1
    return Connection(path, goal, sum(len(tree.nodes) for tree in both.trees), 0, both.motions, spent)


class _Both:
    """The tree of a start and that of its goals, and the number of motions checked for them."""

    def __init__(self, trees: list[_Tree]) -> None:
        self.trees, self.motions = trees, 0

    def joined(self, world: World, variant: int, most_motions: int) -> Floats:
        """Grow the trees until they meet; return the path, (p, dim), without waypoints if they do not."""
        trees, turn, step = self.trees, 0, np.inf
        # The straight motions to the goals come first: many queries need no trees.
        ahead, samples = trees[1].nodes.copy(), trees[0].nodes[:0]
        for first in range(-BATCH, MOST_SAMPLES, BATCH):
            look_at_clock()
            own, other = trees[turn], trees[1 - turn]
            if first >= len(samples):
                samples = _samples(world, max(FIRST, 2 * len(samples)), variant)
                if first == 0:
                    step = _step(world, samples)
            targets = ahead if first < 0 else samples[first : first + BATCH]
            fresh = self._extend(world, own, targets, np.inf if first < 0 else step)
            walks = [(turn, fresh, other.nearest(world, own.nodes[fresh]))] if len(fresh) else []
            if first < 0 and not len(fresh) and isinstance(world, KeptWorld):
                # A straight motion may violate a constraint where a walk along it succeeds, from one end or the other.
                step = _step(world, _samples(world, FIRST, variant))
                away = world.space.distance(np.broadcast_to(trees[0].nodes[:1], ahead.shape), ahead)
                near = np.argsort(away, kind="stable")[:NEAR]
                walks = [(1, near, np.zeros_like(near)), (0, np.zeros_like(near), near)]
            for of, nodes, begins in walks:
                row, reached, checked = _reach(world, trees[1 - of], trees[of].nodes[nodes], begins, step, most_motions)
                self.motions += checked
                if row >= 0:
                    return self._path(of, int(nodes[row]), reached)
            if self.motions >= most_motions:
                break
            turn = 1 - turn
        return trees[0].nodes[:0]

    def _extend(self, world: World, own: _Tree, targets: Floats, step: float) -> Ints:
        """Grow a tree towards configurations, (n, dim), by a step each; return the new nodes."""
        near = own.nearest(world, targets)
        new = _towards(world, own.nodes[near], targets, step)
        free = world.motion_valid(own.nodes[near], new)
        self.motions += len(new)
        begin = len(own.nodes)
        own.add(new[free], near[free])
        return np.arange(begin, len(own.nodes))

    def _path(self, of: int, node: int, reached: int) -> Floats:
        """Return the path through a node of one tree and the node of the other one at the same configuration."""
        branches = self.trees[of].branch(node)[::-1], self.trees[1 - of].branch(reached)
        path = np.concatenate([self.trees[of].nodes[branches[0]], self.trees[1 - of].nodes[branches[1]]])
        path = path if of == 0 else path[::-1]
        different: Floats = path[np.append(True, (path[1:] != path[:-1]).any(axis=1))]
        return different


def _samples(world: World, n: int, variant: int) -> Floats:
    """Return n configurations, (n, dim); the first of them do not depend on n."""
    if isinstance(world, KeptWorld):
        # Nodes are projected, but not samples.  Such plans are short, and importing a sampler would take longer.
        space = world.world.space
        blocks = range(MOST_SHIFTS * variant, MOST_SHIFTS * variant - (-n // len(cube_points(space.cube_dim))))
        shifted = [shifted_cube_points(space.cube_dim, block) for block in blocks]
        return space.from_cube(np.concatenate(shifted)[:n])
    from evenroad.points.samplers import make_sampler

    return world.space.from_cube(make_sampler("sobol").draw(n, world.space.cube_dim, rng=variant).points)


def _step(world: World, samples: Floats) -> float:
    """Return the longest motion of a tree."""
    return STEP * float(np.median(world.space.distance(samples[:128], samples[128:256])))


def _reach(world: World, tree: _Tree, targets: Floats, nodes: Ints, step: float, most: int) -> tuple[int, int, int]:
    """Grow a tree from nodes, (k,), towards configurations, (k, dim), all by a step in turn, until one is reached.

    Return the row of that configuration and its node, or -1 twice, and the number of checks.  Targets that a step does
    not come nearer to are dropped.
    """
    node, rows, checked = nodes.copy(), np.arange(len(targets)), 0
    for _ in range(MOST_STEPS):
        look_at_clock()
        here, there = tree.nodes[node[rows]], targets[rows]
        if (at := np.flatnonzero((here == there).all(axis=1))).size:
            return int(rows[at[0]]), int(node[rows[at[0]]]), checked
        if not len(rows) or checked >= most:
            break
        new = _towards(world, here, there, step)
        nearer = np.flatnonzero(world.space.distance(new, there) < world.space.distance(here, there))
        free = nearer[world.motion_valid(here[nearer], new[nearer])]
        checked += len(nearer)
        first = len(tree.nodes)
        tree.add(new[free], node[rows[free]])
        rows = rows[free]
        node[rows] = first + np.arange(len(rows))
    return -1, -1, checked


def _towards(world: World, a: Floats, b: Floats, step: float) -> Floats:
    """Return the configurations at most a step from rows of `a` towards those of `b`, (n, dim) each."""
    away = world.space.distance(a, b)
    share = np.minimum(1.0, step / np.maximum(away, 1e-300))
    new = world.space.interpolate(a, b, share)
    return np.where((share >= 1.0)[:, np.newaxis], b, new)
