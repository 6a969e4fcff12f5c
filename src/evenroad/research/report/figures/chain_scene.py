"""The kinematic chain on its way out of the horn."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from matplotlib import colormaps
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from evenroad.research.bench.task import Problem
from evenroad.research.report.figures.canvas import new_figure
from evenroad.research.report.figures.found_path import find_path, poses_along
from evenroad.research.worlds.chain import ChainWorld
from evenroad.viz import style

POSES = 25


def draw_chain(problem: Problem, world: ChainWorld, title: str) -> Figure:
    """Return the horn with the chain at start, goal and, from light to dark, along a path."""
    figure = new_figure(8.0, 5.2)
    axes = figure.add_subplot()
    x, y, dx, dy = world.walls
    walls = np.stack([np.stack([x, y], axis=1), np.stack([x + dx, y + dy], axis=1)], axis=1)
    axes.add_collection(
        LineCollection(list(walls), colors=style.OBSTACLE, linewidths=2.6, label="horn", zorder=4)
    )
    result = find_path(problem)
    if result.path is not None:
        shades = colormaps["Blues"](np.linspace(0.25, 0.75, POSES))
        for pose, shade in zip(poses_along(world.space, result.path, POSES), shades, strict=True):
            axes.plot(*_joints(pose).T, color=shade, linewidth=1.0, zorder=2)
    for pose, colour, name in ((problem.start, style.START, "start"), (problem.goal, style.GOAL, "goal")):
        axes.plot(*_joints(pose).T, "o-", color=colour, linewidth=2.2, markersize=3.5, zorder=5, label=name)
    axes.plot(0.0, 0.0, "o", color=style.OBSTACLE, markersize=7, zorder=6)
    axes.set_aspect("equal")
    axes.set_xlabel("x")
    axes.set_ylabel("y")
    axes.set_title(f"{title}: {result.message}\n{result.origin}, {result.rule}", fontsize=9, wrap=True)
    axes.legend(fontsize=9, frameon=False, loc="upper left")
    return figure


def _joints(pose: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return base, joints and tip in the plane, (links + 1, 2)."""
    headings = np.cumsum(pose)
    steps = np.stack([np.cos(headings), np.sin(headings)], axis=1) / len(pose)
    return np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
