"""Charts: success against its costs, gains in random worlds, point sets in the unit square."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

from evenroad._rng import generator
from evenroad.research.bench.samplers import draw_set, why_not
from evenroad.research.report.cells import Cell
from evenroad.research.report.fair import Pooled
from evenroad.research.report.figures.canvas import add_legend, look_of, new_figure
from evenroad.research.report.runs import Question, sampler_place

DODGE = 0.025
"""Neighbouring samplers' error bars stand apart by this power of two."""


def draw_curves(cells: Sequence[Cell], title: str) -> Figure:
    """Return three panels with the same success rates, over what they cost in three currencies.

    Parameters
    ----------
    cells : sequence of Cell
        Of one question; samplers and numbers of samples ascending.
    title : str
        Above the panels.
    """
    # A fixed layout: solving for one takes longer than drawing, and a report has many of these.
    figure = new_figure(12.5, 4.4, layout=None)
    figure.subplots_adjust(left=0.05, right=0.845, bottom=0.125, top=0.9, wspace=0.07)
    by_samples, by_edges, by_seconds = figure.subplots(1, 3, sharey=True)
    samplers = list(dict.fromkeys(cell.sampler for cell in cells))
    for place, sampler in enumerate(samplers):
        curve = [cell for cell in cells if cell.sampler == sampler]
        shift = 2.0 ** (DODGE * (place - (len(samplers) - 1) / 2))
        draw_with_intervals(by_samples, curve, shift)
        _draw_against(by_edges, curve, [cell.mean_edges for cell in curve])
        _draw_against(by_seconds, curve, [1e3 * cell.mean_seconds for cell in curve])
    counts = sorted({cell.n for cell in cells})
    by_samples.set_xscale("log", base=2)
    by_samples.set_xticks(counts, [str(n) for n in counts])
    for axes, label in (
        (by_samples, "samples N"),
        (by_edges, "mean edges checked"),
        (by_seconds, "mean time [ms]"),
    ):
        axes.set_xlabel(label)
        axes.grid(alpha=0.3)
    for axes in (by_edges, by_seconds):
        if axes.lines:
            _scale_by_logarithm(axes)
    by_samples.xaxis.set_minor_locator(NullLocator())
    by_samples.xaxis.set_minor_formatter(NullFormatter())
    by_samples.set_ylim(-3, 103)
    by_samples.set_ylabel("success [%]")
    figure.suptitle(title, fontsize=11, x=0.05, y=0.965, ha="left")
    handles, names = by_samples.get_legend_handles_labels()
    figure.legend(handles, names, loc="center left", bbox_to_anchor=(0.85, 0.5), frameon=False, fontsize=9)
    return figure


def draw_with_intervals(axes: Axes, curve: Sequence[Cell], shift: float = 1.0) -> None:
    """Draw one sampler's success against samples, with error bars; all samples times `shift`."""
    rates = np.array([100 * cell.rate for cell in curve])
    ends = np.array([[100 * cell.interval.low, 100 * cell.interval.high] for cell in curve]).T
    look = look_of(curve[0].sampler)
    axes.errorbar(
        [cell.n * shift for cell in curve],
        rates,
        # An end may miss its rate by rounding, and a negative length is refused.
        yerr=np.maximum(np.abs(ends - rates), 0.0),
        color=look.colour,
        linestyle=look.line,
        linewidth=look.width,
        marker=look.marker,
        markersize=look.size,
        elinewidth=0.8,
        capsize=1.5,
        label=curve[0].sampler,
    )


def _draw_against(axes: Axes, curve: Sequence[Cell], costs: Sequence[float]) -> None:
    known = [(cost, 100 * cell.rate) for cost, cell in zip(costs, curve, strict=True) if cost > 0]
    if known:
        look = look_of(curve[0].sampler)
        axes.plot(
            *zip(*known, strict=True),
            color=look.colour,
            linestyle=look.line,
            linewidth=look.width,
            marker=look.marker,
            markersize=look.size,
        )


def _scale_by_logarithm(axes: Axes) -> None:
    """Scale x by its logarithm, with plain numbers, few or many to a decade as there is room."""
    axes.set_xscale("log")
    low, high = axes.get_xlim()
    steps = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0) if high < 6 * low else (1.0, 2.0, 5.0)
    axes.xaxis.set_major_locator(LogLocator(subs=steps if high < 300 * low else (1.0,)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_locator(NullLocator())


MAZES = "maze-"


def maze_questions(questions: Sequence[Question]) -> tuple[Question, ...]:
    """Return the mazes under one rule and search, that of the first; empty if there are not two of them."""
    mazes = [question for question in questions if question.problem.startswith(MAZES)]
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


PANELS = ("generator", "dimension", "rule")
"""Groupings that are drawn, of those that there are."""

_SPREAD = 0.07
"""Step to the side between two samplers of a group."""


def draw_fair_gains(pooled: Mapping[str, Sequence[Pooled]]) -> Figure:
    """Return differences from uniform with their intervals, a panel a grouping.

    Parameters
    ----------
    pooled : mapping of str to sequence of Pooled
        Of :func:`~evenroad.research.report.fair.pooled`: grouping -> groups and samplers.
    """
    shown = [grouping for grouping in PANELS if grouping in pooled]
    figure = new_figure(13.5, 4.8)
    panels = figure.subplots(1, len(shown), squeeze=False)[0]
    for axes, grouping in zip(panels, shown, strict=True):
        # Mazes and rigid bodies have no dimension of their own, and are among the generators.
        found = [each for each in pooled[grouping] if grouping != "dimension" or each.group[0].isdigit()]
        _draw_panel(axes, grouping, found)
    panels[0].set_ylabel("points above uniform")
    add_legend(figure, sampler_place)
    return figure


def _draw_panel(axes: Axes, grouping: str, found: Sequence[Pooled]) -> None:
    groups = list(dict.fromkeys(each.group for each in found))
    samplers = sorted({each.sampler for each in found}, key=sampler_place)
    for place, sampler in enumerate(samplers):
        mine = [each for each in found if each.sampler == sampler]
        gains = np.array([100 * (each.rate - each.reference_rate) for each in mine])
        ends = np.array([[100 * each.interval.low, 100 * each.interval.high] for each in mine]).T
        aside = (place - 0.5 * (len(samplers) - 1)) * _SPREAD
        look = look_of(sampler)
        axes.errorbar(
            [groups.index(each.group) + aside for each in mine],
            gains,
            # An end may miss the difference by rounding, and a negative length is refused.
            yerr=np.maximum(np.abs(ends - gains), 0.0),
            color=look.colour,
            linestyle="none",
            marker=look.marker,
            markersize=look.size,
            markerfacecolor="white" if look.line == "--" else look.colour,
            elinewidth=0.9,
            label=sampler,
        )
    axes.axhline(0.0, color=look_of("uniform").colour, linewidth=1.2)
    axes.set_xticks(
        range(len(groups)), [group.replace(" symmetrised, ", "\n") for group in groups], fontsize=8
    )
    axes.set_title(f"by {grouping}", fontsize=10)
    axes.grid(axis="y", alpha=0.3)


SAMPLERS = ("uniform", "halton paper-blocks", "sobol paper-blocks", "mpmc", "even")
COUNTS = (32, 64, 128, 256)


def draw_point_sets(seed: int = 0) -> Figure:
    """Return a grid of squares: a row a number of points, a column a sampler; "no set" where there is none."""
    figure = new_figure(2.3 * len(SAMPLERS), 2.35 * len(COUNTS))
    panels = figure.subplots(len(COUNTS), len(SAMPLERS), squeeze=False)
    for row, n in zip(panels, COUNTS, strict=True):
        for axes, sampler in zip(row, SAMPLERS, strict=True):
            axes.set(xlim=(0, 1), ylim=(0, 1), xticks=(), yticks=(), aspect="equal")
            points = _first_set(sampler, n, seed)
            if points is None:
                axes.text(0.5, 0.5, "no set", ha="center", va="center", color="#777777")
            else:
                size = 300.0 / n + 2.5
                axes.scatter(*points.T, s=size, color=look_of(sampler).colour, linewidths=0)
        row[0].set_ylabel(f"N = {n}", fontsize=11)
    for axes, sampler in zip(panels[0], SAMPLERS, strict=True):
        axes.set_title(sampler, fontsize=11)
    return figure


def _first_set(sampler: str, n: int, seed: int) -> npt.NDArray[np.float64] | None:
    if why_not(sampler, n, 2):
        return None
    points, _ = draw_set(sampler, n, 2, 0, generator(seed))
    return points.points
