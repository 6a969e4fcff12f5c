"""Charts: success against its costs, gains in random worlds, point sets; and what all figures share."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

from evenroad._rng import generator
from evenroad_studies.bench.samplers import draw_set, why_not
from evenroad_studies.report.cells import Cell
from evenroad_studies.report.fair import Pooled
from evenroad_studies.report.runs import Setting, sampler_place
from evenroad_studies.statistics.rates import Interval


def _look(colour: str, marker: str, line: str = "-", width: float = 1.4, size: float = 5.0) -> dict[str, Any]:
    """Return arguments of matplotlib's `plot` and `errorbar`."""
    return dict(color=colour, linestyle=line, linewidth=width, marker=marker, markersize=size)


DPI = 110

# Protocols of one sequence share a colour and differ in the line; the default sampler is red and thick.
LOOKS: dict[str, dict[str, Any]] = {
    "uniform": _look("#555555", "o", width=2.0),
    "halton paper-blocks": _look("#1b9e5a", "s", "--"),
    "halton scrambled": _look("#1b9e5a", "s"),
    "sobol paper-blocks": _look("#2f5fd0", "^", "--"),
    "sobol scrambled": _look("#2f5fd0", "^"),
    "lattice": _look("#e6a23c", "v"),
    "sukharev": _look("#12a5b5", "X", ":"),
    "mpmc": _look("#e05fa8", "D"),
    "hickernell": _look("#8e5bd0", "p"),
    "even": _look("#d1343b", "*", width=2.4, size=9.0),
}
OTHER = _look("#000000", ".", ":")
"""For a sampler that this version does not know."""


def look_of(sampler: str) -> dict[str, Any]:
    """Return how a sampler is drawn: the colour, marker and line that it has in every figure."""
    return LOOKS.get(sampler, OTHER)


def new_figure(width: float, height: float, layout: Literal["constrained"] | None = "constrained") -> Figure:
    """Return an empty figure of this size in inches."""
    figure = Figure(figsize=(width, height), dpi=DPI, layout=layout)
    FigureCanvasAgg(figure)
    return figure


def add_legend(figure: Figure, order: Callable[[str], Any]) -> None:
    """Put one legend at the right of the figure; it names what any panel shows, in the order of `order`."""
    shown = [zip(*axes.get_legend_handles_labels(), strict=True) for axes in figure.axes]
    handles = {name: handle for panel in shown for handle, name in panel}
    names = sorted(handles, key=order)
    lines = [handles[name] for name in names]
    figure.legend(lines, names, loc="outside right center", frameon=False, fontsize=9)


def as_png(figure: Figure) -> bytes:
    """Return the figure as a PNG file; the same figure gives the same bytes."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", metadata={"Software": None})
    return buffer.getvalue()


DODGE = 0.025
"""On an axis of log2 N, the distance between the error bars of two samplers at the same N."""
MAZES = "maze-"
"""Begin of the names of the paper's mazes."""
GROUPINGS_DRAWN = ("generator", "dimension", "rule")
"""Groupings of the fair suite that have a panel."""
GROUP_DODGE = 0.07
"""Distance between two samplers of a group; groups are 1 apart."""
SETS_DRAWN = ("uniform", "halton paper-blocks", "sobol paper-blocks", "mpmc", "even")
COUNTS_DRAWN = (32, 64, 128, 256)
"""Samplers and numbers of points in the picture of point sets."""


def draw_curves(cells: Sequence[Cell], title: str) -> Figure:
    """Return three panels of the success rates of one setting's cells, over samples, checked edges and seconds."""
    # A fixed layout: solving for one takes longer than drawing, and a report has many of these.
    figure = new_figure(12.5, 4.4, layout=None)
    figure.subplots_adjust(left=0.05, right=0.845, bottom=0.125, top=0.9, wspace=0.07)
    by_samples, by_edges, by_seconds = figure.subplots(1, 3, sharey=True)
    _draw_by_samples(by_samples, cells, _samplers(cells))
    _draw_against(by_edges, cells, [cell.mean_edges for cell in cells], "mean edges checked")
    _draw_against(by_seconds, cells, [1e3 * cell.mean_seconds for cell in cells], "mean time [ms]")
    by_samples.set_ylabel("success [%]")
    figure.suptitle(title, fontsize=11, x=0.05, y=0.965, ha="left")
    handles, names = by_samples.get_legend_handles_labels()
    figure.legend(handles, names, loc="center left", bbox_to_anchor=(0.85, 0.5), frameon=False, fontsize=9)
    return figure


def maze_settings(settings: Sequence[Setting]) -> tuple[Setting, ...]:
    """Return the mazes with the rule and search of the first maze; empty if they are fewer than two."""
    mazes = [setting for setting in settings if setting.problem.startswith(MAZES)]
    alike = [each for each in mazes if (each.rule, each.search) == (mazes[0].rule, mazes[0].search)]
    return tuple(alike) if len(alike) > 1 else ()


def draw_maze_success(cells: Sequence[Cell]) -> Figure:
    """Return the paper's figure of success against samples, with a panel for each of the :func:`maze_settings`."""
    settings = list(dict.fromkeys(cell.setting for cell in cells))
    figure = new_figure(12.5, 4.6)
    panels = figure.subplots(1, len(settings), sharey=True, squeeze=False)[0]
    for axes, setting in zip(panels, settings, strict=True):
        _draw_by_samples(axes, [cell for cell in cells if cell.setting == setting], _samplers(cells))
        axes.set_title(f"{setting.problem}, {setting.rule}", fontsize=10)
    panels[0].set_ylabel("success [%]")
    add_legend(figure, _samplers(cells).index)
    return figure


def draw_fair_gains(pooled: Mapping[str, Sequence[Pooled]]) -> Figure:
    """Return differences from uniform in random worlds, with a panel for each grouping of the pooled suite."""
    shown = [grouping for grouping in GROUPINGS_DRAWN if grouping in pooled]
    figure = new_figure(13.5, 4.8)
    panels = figure.subplots(1, len(shown), squeeze=False)[0]
    for axes, grouping in zip(panels, shown, strict=True):
        # Mazes and rigid bodies have no dimension of their own, and are among the generators.
        found = [each for each in pooled[grouping] if grouping != "dimension" or each.group[0].isdigit()]
        _draw_gains(axes, found)
        axes.set_title(f"by {grouping}", fontsize=10)
    panels[0].set_ylabel("points above uniform")
    add_legend(figure, sampler_place)
    return figure


def draw_point_sets(seed: int = 0) -> Figure:
    """Return a grid of squares: a row a number of points, a column a sampler; "no set" where there is none."""
    figure = new_figure(2.3 * len(SETS_DRAWN), 2.35 * len(COUNTS_DRAWN))
    panels = figure.subplots(len(COUNTS_DRAWN), len(SETS_DRAWN), squeeze=False)
    for row, n in zip(panels, COUNTS_DRAWN, strict=True):
        for axes, sampler in zip(row, SETS_DRAWN, strict=True):
            axes.set(xlim=(0, 1), ylim=(0, 1), xticks=(), yticks=(), aspect="equal")
            if why_not(sampler, n, 2):
                axes.text(0.5, 0.5, "no set", ha="center", va="center", color="#777777")
            else:
                points, _ = draw_set(sampler, n, 2, 0, generator(seed))
                size = 300.0 / n + 2.5
                axes.scatter(*points.points.T, s=size, color=look_of(sampler)["color"], linewidths=0)
        row[0].set_ylabel(f"N = {n}", fontsize=11)
    for axes, sampler in zip(panels[0], SETS_DRAWN, strict=True):
        axes.set_title(sampler, fontsize=11)
    return figure


def _samplers(cells: Sequence[Cell]) -> list[str]:
    return list(dict.fromkeys(cell.sampler for cell in cells))


def _draw_by_samples(axes: Axes, cells: Sequence[Cell], samplers: Sequence[str]) -> None:
    """Draw the success of one setting against samples; every sampler's error bars have a place of their own."""
    for place, sampler in enumerate(samplers):
        curve = [cell for cell in cells if cell.sampler == sampler]
        if curve:
            shift = 2.0 ** (DODGE * (place - (len(samplers) - 1) / 2))
            style = look_of(sampler) | {"elinewidth": 0.8, "capsize": 1.5, "label": sampler}
            shares, intervals = [cell.rate for cell in curve], [cell.interval for cell in curve]
            _draw_intervals(axes, [cell.n * shift for cell in curve], shares, intervals, style)
    counts = sorted({cell.n for cell in cells})
    axes.set_xscale("log", base=2)
    axes.set_xticks(counts, [str(n) for n in counts])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set(xlabel="samples N", ylim=(-3, 103))
    axes.grid(alpha=0.3)


def _draw_gains(axes: Axes, found: Sequence[Pooled]) -> None:
    """Draw the differences from uniform of one grouping; a place on x is a group."""
    groups = list(dict.fromkeys(each.group for each in found))
    samplers = sorted({each.sampler for each in found}, key=sampler_place)
    for place, sampler in enumerate(samplers):
        mine = [each for each in found if each.sampler == sampler]
        aside = (place - 0.5 * (len(samplers) - 1)) * GROUP_DODGE
        look = look_of(sampler)
        style = look | {"linestyle": "none", "elinewidth": 0.9, "label": sampler}
        style["markerfacecolor"] = "white" if look["linestyle"] == "--" else look["color"]
        places = [groups.index(each.group) + aside for each in mine]
        shares, intervals = [each.difference for each in mine], [each.interval for each in mine]
        _draw_intervals(axes, places, shares, intervals, style)
    axes.axhline(0.0, color=look_of("uniform")["color"], linewidth=1.2)
    names = [group.replace(" symmetrised, ", "\n") for group in groups]
    axes.set_xticks(range(len(groups)), names, fontsize=8)
    axes.grid(axis="y", alpha=0.3)


def _draw_intervals(
    axes: Axes,
    x: Sequence[float],
    shares: Sequence[float],
    intervals: Sequence[Interval],
    style: dict[str, Any],
) -> None:
    """Draw shares in percent with their intervals."""
    values = 100.0 * np.array(shares)
    ends = 100.0 * np.array([[each.low, each.high] for each in intervals]).T
    axes.errorbar(x, values, yerr=np.abs(ends - values), **style)


def _draw_against(axes: Axes, cells: Sequence[Cell], costs: Sequence[float], label: str) -> None:
    """Draw success against a cost, of those cells that have one, with plain numbers as there is room for them."""
    for sampler in _samplers(cells):
        known = [
            (cost, 100 * cell.rate)
            for cost, cell in zip(costs, cells, strict=True)
            if cell.sampler == sampler and cost > 0
        ]
        if known:
            axes.plot(*np.array(known).T, **look_of(sampler))
    axes.set_xlabel(label)
    axes.grid(alpha=0.3)
    if not axes.lines:
        return
    axes.set_xscale("log")
    low, high = axes.get_xlim()
    steps = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0) if high < 6 * low else (1.0, 2.0, 5.0)
    axes.xaxis.set_major_locator(LogLocator(subs=steps if high < 300 * low else (1.0,)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_locator(NullLocator())
