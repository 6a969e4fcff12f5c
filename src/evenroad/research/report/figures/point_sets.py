"""The paper's picture of point sets in the unit square, with ours beside them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from evenroad._rng import generator
from evenroad.research.bench.samplers import draw_set, why_not
from evenroad.research.report.figures.canvas import new_figure
from evenroad.research.report.palette import look_of

SAMPLERS = ("uniform", "halton paper-blocks", "sobol paper-blocks", "mpmc", "even")
COUNTS = (32, 64, 128, 256)


def draw_point_sets(seed: int = 0) -> Figure:
    """Return a grid of squares: a row a number of points, a column a sampler; "no set" where there is none."""
    figure = new_figure(2.3 * len(SAMPLERS), 2.35 * len(COUNTS))
    panels = figure.subplots(len(COUNTS), len(SAMPLERS), squeeze=False)
    for row, n in zip(panels, COUNTS, strict=True):
        for axes, sampler in zip(row, SAMPLERS, strict=True):
            axes.set(xlim=(0, 1), ylim=(0, 1), xticks=(), yticks=(), aspect="equal")
            points = _points(sampler, n, seed)
            if points is None:
                axes.text(0.5, 0.5, "no set", ha="center", va="center", color="#777777")
            else:
                size = 300.0 / n + 2.5
                axes.scatter(*points.T, s=size, color=look_of(sampler).colour, linewidths=0)
        row[0].set_ylabel(f"N = {n}", fontsize=11)
    for axes, sampler in zip(panels[0], SAMPLERS, strict=True):
        axes.set_title(sampler, fontsize=11)
    return figure


def _points(sampler: str, n: int, seed: int) -> npt.NDArray[np.float64] | None:
    if why_not(sampler, n, 2):
        return None
    points, _ = draw_set(sampler, n, 2, 0, generator(seed))
    return points.points
