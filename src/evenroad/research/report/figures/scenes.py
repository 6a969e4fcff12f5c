"""Scenes of problems, each with a path that was found: which problems have one, and who draws it."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from evenroad.errors import NotAvailable
from evenroad.research.bench.task import Problem
from evenroad.research.problems import PROBLEMS
from evenroad.research.report.figures.canvas import new_figure
from evenroad.research.report.figures.chain_scene import draw_chain
from evenroad.research.report.figures.found_path import find_path
from evenroad.research.report.figures.solid_scene import draw_solids
from evenroad.research.worlds.chain import ChainWorld
from evenroad.robot import ArmWorld
from evenroad.viz import draw_plan
from evenroad.viz.arm import draw_arm_plan
from evenroad.world.gridmap.disk import DiskWorld
from evenroad.world.solids import SolidWorld

SCENES = ("maze-1", "maze-2", "maze-3", "chain-10d", "cubicles", "twistycool", "ur5-c", "ur5-a")
"""Problems that have a picture; another protocol in the same scene has that of the first."""
_SAME_SCENE = {"cubicles-6d": "cubicles", "twistycool-6d": "twistycool"}


def scenes_among(problems: Sequence[str]) -> tuple[str, ...]:
    """Return which pictures of scenes the problems call for, in our order."""
    wanted = {_SAME_SCENE.get(problem, problem) for problem in problems}
    return tuple(scene for scene in SCENES if scene in wanted and scene in PROBLEMS)


def draw_scene(name: str) -> Figure:
    """Return the picture of a problem's world with a found path.

    Raises
    ------
    NotAvailable
        If there is no picture of such a world.
    """
    problem = PROBLEMS[name].make(0)
    match problem.world:
        case DiskWorld():
            return _draw_maze(problem, problem.world)
        case ChainWorld():
            return draw_chain(problem, problem.world, name)
        case SolidWorld():
            return draw_solids(problem, problem.world, name)
        case ArmWorld():
            return draw_arm_plan(find_path(problem), problem.world)
    raise NotAvailable(f"there is no picture of the scene of {name}")


def _draw_maze(problem: Problem, world: DiskWorld) -> Figure:
    figure = new_figure(8.4, 7.4)
    draw_plan(figure.add_subplot(), find_path(problem), world)
    return figure
