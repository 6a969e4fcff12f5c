"""A world whose check of motions has gaps, and whose strict check has none."""

import numpy as np

from evenroad.space import BoxSpace


class GappyWorld:
    """A point among thin walls in the unit square: motions are tested at states `step` apart, walls are thinner.

    The strict check is exact: a segment is free if it meets no wall, each a segment parallel to an axis.
    """

    space = BoxSpace((0.0, 0.0), (1.0, 1.0))
    proof = "resolution"

    def __init__(self, walls, step=0.1, thickness=1e-3):
        self.walls, self.step, self.thickness = walls, step, thickness
        self.asked_motions = self.rechecked = 0

    def valid(self, q):
        free = np.ones(len(q), dtype=bool)
        for axis, at, low, high in self.walls:
            across, along = q[:, axis], q[:, 1 - axis]
            free &= ~((np.abs(across - at) <= self.thickness) & (along >= low) & (along <= high))
        return free

    def motion_valid(self, a, b):
        self.asked_motions += len(a)
        steps = np.maximum(1, np.ceil(np.linalg.norm(b - a, axis=1) / self.step)).astype(int)
        free = np.ones(len(a), dtype=bool)
        for n in np.unique(steps):
            t, of = np.linspace(0.0, 1.0, n + 1)[:, np.newaxis, np.newaxis], steps == n
            states = (1 - t) * a[of] + t * b[of]
            free[of] = self.valid(states.reshape(-1, 2)).reshape(n + 1, -1).all(axis=0)
        return free

    def validate(self, path):
        self.rechecked += len(path) - 1
        return self.truly_free(path[:-1], path[1:])

    def truly_free(self, a, b):
        free = np.ones(len(a), dtype=bool)
        for axis, at, low, high in self.walls:
            gap = b[:, axis] - a[:, axis]
            with np.errstate(divide="ignore", invalid="ignore"):
                t = np.where(gap == 0.0, np.nan, (at - a[:, axis]) / gap)
                along = a[:, 1 - axis] + t * (b[:, 1 - axis] - a[:, 1 - axis])
            meets = (t >= 0.0) & (t <= 1.0) & (along >= low) & (along <= high)
            free &= ~(meets | ~self.valid(a) | ~self.valid(b))
        return free
