"""Figures without pyplot: no global state, no display."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any, Literal

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

DPI = 110


def new_figure(
    width: float, height: float, *, layout: Literal["constrained"] | None = "constrained"
) -> Figure:
    """Return an empty figure of this size in inches."""
    figure = Figure(figsize=(width, height), dpi=DPI, layout=layout)
    FigureCanvasAgg(figure)
    return figure


def add_legend(figure: Figure, order: Callable[[str], Any]) -> None:
    """Name what any panel of the figure shows, once, at its right, sorted by `order` of the names.

    A sampler may have nothing to show in one of the panels.
    """
    handles = {
        name: handle
        for axes in figure.axes
        for handle, name in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    names = sorted(handles, key=order)
    figure.legend(
        [handles[name] for name in names], names, loc="outside right center", frameon=False, fontsize=9
    )


def as_png(figure: Figure) -> bytes:
    """Return the figure as a PNG file; the same figure gives the same bytes."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", metadata={"Software": None})
    return buffer.getvalue()
