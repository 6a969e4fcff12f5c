"""The paper's figure of success on the three mazes, a panel a level."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from evenroad.research.report.cells import Cell
from evenroad.research.report.figures.canvas import add_legend, new_figure
from evenroad.research.report.figures.curves import draw_with_intervals
from evenroad.research.report.runs import Question

PREFIX = "maze-"


def maze_questions(questions: Sequence[Question]) -> tuple[Question, ...]:
    """Return the mazes under one rule and search, that of the first; empty if there are not two of them."""
    mazes = [question for question in questions if question.problem.startswith(PREFIX)]
    alike = [each for each in mazes if (each.rule, each.search) == (mazes[0].rule, mazes[0].search)]
    return tuple(alike) if len(alike) > 1 else ()


def draw_maze_success(cells: Sequence[Cell]) -> Figure:
    """Return success against samples, a panel a maze.

    Parameters
    ----------
    cells : sequence of Cell
        Of :func:`maze_questions`.
    """
    questions = list(dict.fromkeys(cell.question for cell in cells))
    samplers = list(dict.fromkeys(cell.sampler for cell in cells))
    figure = new_figure(12.5, 4.6)
    panels = figure.subplots(1, len(questions), sharey=True, squeeze=False)[0]
    for axes, question in zip(panels, questions, strict=True):
        mine = [cell for cell in cells if cell.question == question]
        for sampler in samplers:
            curve = [cell for cell in mine if cell.sampler == sampler]
            if curve:
                draw_with_intervals(axes, curve)
        counts = sorted({cell.n for cell in mine})
        axes.set_xscale("log", base=2)
        axes.set_xticks(counts, [str(n) for n in counts])
        axes.xaxis.set_minor_locator(NullLocator())
        axes.set_xlabel("samples N")
        axes.set_title(f"{question.problem}, {question.rule}", fontsize=10)
        axes.grid(alpha=0.3)
    panels[0].set_ylim(-3, 103)
    panels[0].set_ylabel("success [%]")
    add_legend(figure, samplers.index)
    return figure
