"""Draw the roadmap of four neighbours in space, looked at along the lattice's shortest vector: studies/docs/sheets.png.

python studies/tools/draw_sheets.py        # seconds
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from evenroad.points import draw
from evenroad.points.measures.rank_one import generating_vector, neighbour_directions
from evenroad.roadmap.neighbours import nearest
from evenroad.viz import style

OUT = Path(__file__).parents[1] / "docs" / "sheets.png"
N, K = 400, 4


def main() -> None:
    """Draw the lattice, the same with noise, and scrambled Sobol points."""
    lattice = draw("korobov", N, 3, rng=0)
    vector = generating_vector(lattice)
    directions = neighbour_directions(N, vector, K).vectors / N
    noise = 0.05 * N ** (-1 / 3) * np.random.default_rng(0).standard_normal((N, 3))
    kinds = {
        f"Korobov, {N} points": lattice.points,
        "moved by 5 % of the spacing": (lattice.points + noise) % 1.0,
        "scrambled Sobol": draw("sobol", N, 3, rng=0).points,
    }
    along = directions[0] / np.linalg.norm(directions[0])
    across = directions[1] - (directions[1] @ along) * along
    across /= np.linalg.norm(across)
    seen = np.stack([across, np.cross(along, across)], axis=1)
    figure = Figure(figsize=(10, 3.6), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    for axes, (name, points) in zip(figure.subplots(1, 3), kinds.items(), strict=True):
        neighbours = nearest(points, K)
        ends = points[np.stack([np.repeat(np.arange(N), K), neighbours.ravel()], axis=1)]
        steps = ends[:, 1] - ends[:, 0]
        # A quarter of the spacing from a vector of the lattice is on the sheet.
        off = np.abs(steps @ np.cross(along, across)) > 0.25 * N ** (-1 / 3)
        for rows, colour, width in ((~off, style.GOAL, 0.6), (off, style.RAW_PATH, 0.9)):
            axes.add_collection(LineCollection(ends[rows] @ seen, colors=colour, linewidths=width))
        axes.scatter(*(points @ seen).T, s=4, color=style.OBSTACLE, linewidths=0)
        axes.set(xticks=[], yticks=[], aspect="equal", title=name)
        axes.autoscale_view()
        print(f"{name}: {100 * off.mean():.0f} % of the motions leave the plane of the shortest vectors")
    figure.savefig(OUT, metadata={"Software": None})


if __name__ == "__main__":
    main()
