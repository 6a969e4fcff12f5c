"""What all figures share: how a sampler looks, and figures without pyplot (no global state, no display)."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any, Literal, NamedTuple

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure


class Look(NamedTuple):
    """How a sampler is drawn: the colour, marker and line that it has in every figure."""

    colour: str
    marker: str
    line: str = "-"
    width: float = 1.4
    size: float = 5.0

    def as_line(self) -> dict[str, Any]:
        """Return the look as arguments of matplotlib's `plot` and `errorbar`."""
        line = {"color": self.colour, "linestyle": self.line, "linewidth": self.width}
        return line | {"marker": self.marker, "markersize": self.size}


DPI = 110

# Protocols of one sequence share a colour and differ in the line; the default sampler is red and thick.
LOOKS: dict[str, Look] = {
    "uniform": Look("#555555", "o", width=2.0),
    "halton paper-blocks": Look("#1b9e5a", "s", "--"),
    "halton scrambled": Look("#1b9e5a", "s"),
    "sobol paper-blocks": Look("#2f5fd0", "^", "--"),
    "sobol scrambled": Look("#2f5fd0", "^"),
    "lattice": Look("#e6a23c", "v"),
    "sukharev": Look("#12a5b5", "X", ":"),
    "mpmc": Look("#e05fa8", "D"),
    "hickernell": Look("#8e5bd0", "p"),
    "even": Look("#d1343b", "*", width=2.4, size=9.0),
}
OTHER = Look("#000000", ".", ":")
"""For a sampler that this version does not know."""


def look_of(sampler: str) -> Look:
    """Return how a sampler is drawn."""
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
