"""Draw the schematic of the MPMC network, after figure 1 of Chahine et al. (2025), from real points.

    python studies/tools/draw_network.py        # studies/docs/network.png

Left: the Kronecker points that a training starts from, with the graph of nearest neighbours that stays fixed.
Right: the points that the trained network makes of them.
"""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from evenroad.roadmap import KNearest
from evenroad_studies.network import NetworkConfig, train
from evenroad_studies.network.train import kronecker

N = 64
OUT = Path(__file__).parents[1] / "docs" / "network.png"
BLUE, RED, GREY = "#2f5fd0", "#d1343b", "#b9c6d3"


def scatter(axes: Axes, points: np.ndarray, title: str, colour: str, graph: bool) -> None:
    """Draw one set in the unit square, with its graph if asked for."""
    if graph:
        pairs = points[KNearest(4).edges(points)]
        axes.add_collection(LineCollection(list(pairs), colors=GREY, linewidths=0.8, zorder=1))
    axes.scatter(*points.T, s=14, color=colour, zorder=2)
    axes.set(xlim=(0, 1), ylim=(0, 1), xticks=[], yticks=[], aspect="equal")
    axes.set_title(title, fontsize=10)


def boxes(axes: Axes) -> None:
    """Draw encoder, message-passing layers and decoder as a row of boxes."""
    axes.set(xlim=(0, 10), ylim=(0, 4))
    axes.axis("off")
    stages = [
        (0.3, 1.3, "encoder", "linear\nd → 32", "#e8edf3"),
        (2.2, 1.7, "layer 1", "", "#d5e1f5"),
        (4.3, 1.7, "layer 2", "", "#d5e1f5"),
        (6.4, 1.7, "layer 3", "", "#d5e1f5"),
        (8.5, 1.3, "decoder", "linear\n32 → d,\nmoves", "#e8edf3"),
    ]
    for x, width, name, text, colour in stages:
        box = FancyBboxPatch(
            (x, 1.2), width, 1.7, boxstyle="round,pad=0.05", facecolor=colour, edgecolor="#6b7680"
        )
        axes.add_patch(box)
        axes.text(x + width / 2, 2.62, name, ha="center", va="center", fontsize=9, weight="bold")
        layer = "messages\nMLP$(x_i, x_j)$\nsum, update\nReLU, norm"
        axes.text(x + width / 2, 1.88, text or layer, ha="center", va="center", fontsize=7.5)
    for left, right in itertools.pairwise(stages):
        axes.annotate(
            "", (right[0] - 0.03, 2.05), (left[0] + left[1] + 0.05, 2.05), arrowprops={"arrowstyle": "->"}
        )
    axes.annotate("", (0.25, 2.05), (-0.4, 2.05), arrowprops={"arrowstyle": "->"}, annotation_clip=False)
    axes.annotate("", (10.5, 2.05), (9.9, 2.05), arrowprops={"arrowstyle": "->"}, annotation_clip=False)
    for x in (3.05, 5.15, 7.25):
        axes.annotate("", (x, 1.12), (x, 0.62), arrowprops={"arrowstyle": "->", "color": "#6b7680"})
    axes.plot([0.0, 7.25], [0.62, 0.62], color="#6b7680", linewidth=1)
    axes.text(0.0, 0.22, "graph of nearest neighbours of the starts, fixed", fontsize=8, color="#4a535c")
    axes.text(
        5.0,
        3.55,
        "loss: the discrepancy of the moved points, exact gradient",
        ha="center",
        fontsize=9,
        color=RED,
    )


def main() -> None:
    """Draw studies/docs/network.png."""
    figure = Figure(figsize=(12.5, 3.3), dpi=130)
    FigureCanvasAgg(figure)
    scatter(
        figure.add_axes((0.01, 0.08, 0.22, 0.78)),
        kronecker(N, np.random.default_rng(3).random(2)),
        "Kronecker points",
        BLUE,
        True,
    )
    boxes(figure.add_axes((0.26, 0.05, 0.48, 0.9)))
    even = train(NetworkConfig(N, 2), rng=3).points
    scatter(figure.add_axes((0.775, 0.08, 0.22, 0.78)), even, "points of low discrepancy", RED, False)
    figure.savefig(OUT)


if __name__ == "__main__":
    main()
