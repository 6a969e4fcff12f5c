"""What samplers gain over uniform points in random worlds: by generator, by dimension, by connection rule."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evenroad.research.report.fair import Pooled
from evenroad.research.report.figures.canvas import add_legend, new_figure
from evenroad.research.report.palette import look_of, sampler_place

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
