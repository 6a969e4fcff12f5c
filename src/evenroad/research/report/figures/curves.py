"""Success against samples, edge checks and seconds: one picture a question."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

from evenroad.research.report.cells import Cell
from evenroad.research.report.figures.canvas import new_figure
from evenroad.research.report.palette import look_of

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
