"""A grid around all surfaces of a scene: it clears most capsules of all of them at once."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel import surface_tree as tree
from evenroad.robot.kernel.surface_grid import STEPS, frame

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Ints = npt.NDArray[np.int64]

CELLS = 100_000
"""About so many: four times as many are no quicker, and take longer to make."""

_NEVER = 1e9
"""Far more than any distance: of none of the surfaces the grid says that something touches it [m]."""

_LESS = 1.0 - 1e-5
"""What distances are multiplied by, for what single precision loses of them."""


def surface_around(arrays: Sequence[Ints]) -> Ints:
    """Return a grid around surfaces, one or more, as ``surface_tree`` lays it out, without leaves or windings.

    A byte counts how far all of a cell is from every surface, rounded down: no surface is nearer to its middle than its
    own grid says there, and no place of it farther from its middle than half its diagonal.
    """
    floats = [array.view(np.float32)[2 * tree.HEADER :] for array in arrays]
    lows = np.array([each[tree.LOW : tree.LOW + 3] for each in floats], dtype=np.float64)
    sizes = np.array([each[tree.SIZE : tree.SIZE + 3] for each in floats], dtype=np.float64)
    low, cell, counts = frame(lows.min(axis=0), (lows + sizes).max(axis=0), CELLS)
    middles = [low[axis] + (np.arange(counts[axis]) + 0.5) * cell for axis in range(3)]
    squared: Singles = np.full(counts, np.inf, dtype=np.float32)
    for array, own, corner, size in zip(arrays, floats, lows, sizes, strict=True):
        np.minimum(squared, _squared(array, own, corner, size, middles), out=squared)
    half = math.sqrt(0.75) * cell
    away = np.sqrt(squared) * np.float32(_LESS) - np.float32(half / _LESS)
    first = tree.BYTES_OF_HEADER + 4 * tree.LEAVES
    grid = np.zeros((first + away.size + 7) // 8, dtype=np.int64)
    grid[[tree.CELLS_X, tree.CELLS_Y, tree.CELLS_Z, tree.GRID]] = *counts, first
    table = grid.view(np.float32)[2 * tree.HEADER :]
    table[tree.LOW : tree.LOW + 3], table[tree.ONE_BY_CELL] = low, 1.0 / cell
    table[tree.SIZE : tree.SIZE + 3] = np.array(counts) * cell * _LESS
    table[tree.STEP], table[tree.EXCESS] = cell / STEPS * (1.0 - 1e-6), _NEVER
    table[tree.RADIUS] = max(float(each[tree.RADIUS]) for each in floats)
    steps = np.clip(away * np.float32(STEPS / cell), 0.0, 255.0)
    grid.view(np.uint8)[first : first + away.size] = steps.astype(np.uint8).ravel()
    grid.setflags(write=False)
    return grid


def _squared(array: Ints, table: Singles, low: Floats, size: Floats, coordinates: Sequence[Floats]) -> Singles:
    """Return the square of what a surface is at least away from places, (x, y, z) of them along each axis [m^2].

    Outside of its grid the nearest place inside is asked, as ``surface_contact`` does.
    """
    counts = array[[tree.CELLS_X, tree.CELLS_Y, tree.CELLS_Z]].tolist()
    outside, cells = [], []
    for axis in range(3):
        within = coordinates[axis] - low[axis]
        inside = np.clip(within, 0.0, size[axis])
        outside.append(((within - inside) ** 2).astype(np.float32))
        cells.append(np.minimum((inside * float(table[tree.ONE_BY_CELL])).astype(np.int64), counts[axis] - 1))
    first = int(array[tree.GRID])
    grid = array.view(np.uint8)[first : first + math.prod(counts)].reshape(counts)
    away = grid[np.ix_(*cells)] * table[tree.STEP]
    return away * away + outside[0][:, np.newaxis, np.newaxis] + outside[1][:, np.newaxis] + outside[2]
