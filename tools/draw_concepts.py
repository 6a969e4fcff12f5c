"""Draw the pictures of the concepts' pages, and print the figures that they quote: docs/concepts/*.png.

python tools/draw_concepts.py        # half a minute
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle
from scipy.spatial import cKDTree

import evenroad as er
from evenroad.points.measures import dispersion_bounds
from evenroad.roadmap import KNearest
from evenroad.viz import style
from evenroad.world.gridmap.load import Maze, load_maze
from evenroad_studies.statistics.rates import wilson

OUT = Path(__file__).parents[1] / "docs" / "concepts"
SAMPLERS = {"uniform": "uniform", "sobol": "scrambled Sobol", "even": "even"}
RUNS = 400


def sheet(columns: int, height: float, rows: int = 1) -> tuple[Figure, list[Axes]]:
    """Return a figure with panels side by side, none of which has ticks."""
    figure = Figure(figsize=(10, height), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    panels = list(np.ravel(figure.subplots(rows, columns)))
    for axes in panels:
        axes.set(xticks=[], yticks=[], aspect="equal")
    return figure, panels


def draw_even_points() -> None:
    """Draw 128 points of three samplers with the largest hole, and the closest pair."""
    figure, panels = sheet(3, 3.7)
    side = (np.arange(1000) + 0.5) / 1000
    places = np.stack([each.ravel() for each in np.meshgrid(side, side)], axis=1)
    for axes, (sampler, name) in zip(panels, SAMPLERS.items(), strict=True):
        points = er.draw(sampler, 128, 2, rng=0).points
        away, _ = cKDTree(points).query(places)
        apart, nearest = cKDTree(points).query(points, k=2)
        pair = int(np.argmin(apart[:, 1]))
        axes.add_patch(Circle(tuple(places[np.argmax(away)]), float(away.max()), color=style.RAW_PATH, alpha=0.45))
        axes.plot(*points.T, "o", ms=3, color=style.MILESTONE)
        axes.plot(*points[nearest[pair]].T, "o-", ms=4, lw=1.5, color=style.PATH)
        axes.set(xlim=(0, 1), ylim=(0, 1), title=name)
        axes.set_xlabel(f"largest hole {away.max():.3f}, closest pair {apart[pair, 1]:.3f}")
    figure.savefig(OUT / "even-points.png", bbox_inches="tight", pil_kwargs={"optimize": True})
    for sampler, name in SAMPLERS.items():
        sets = [er.draw(sampler, 128, 2, rng=run).points for run in range(100)]
        holes = [dispersion_bounds(each).upper for each in sets]
        pairs = [cKDTree(each).query(each, k=2)[0][:, 1].min() for each in sets]
        text = "; ".join(
            f"{of} {np.mean(values):.4f} (standard error {np.std(values, ddof=1) / 10:.4f})"
            for of, values in (("largest hole", holes), ("closest pair", pairs))
        )
        print(f"{name}, means of 100 sets: {text}")


def show_maze(axes: Axes, maze: Maze) -> None:
    """Show the walls of a maze."""
    occupied = er.load_map(maze.path).occupied
    rows, columns = occupied.shape
    grey = np.where(occupied, 60, 255)
    axes.imshow(grey, cmap="gray", vmin=0, vmax=255, extent=(0, columns, rows, 0))


def draw_roadmaps() -> None:
    """Draw how a roadmap comes to be: points, milestones, free motions, and the path."""
    maze = load_maze(2)
    world, points = maze.world(), er.draw("even", 256, 2)
    result = er.plan(world, maze.start, maze.goal, er.PRM(points, search="full", k=10))
    assert result.roadmap is not None, result.message
    assert result.path is not None, result.message
    places = world.space.from_cube(points.points)
    free, known = world.valid(places), result.roadmap
    edges = known.configurations[known.edges]
    figure, panels = sheet(2, 7.6, rows=2)
    for number, (axes, title) in enumerate(zip(panels, ("points", "milestones", "free motions", "path"), strict=True)):
        show_maze(axes, maze)
        axes.set_title(f"{number + 1}. {title}")
        if number >= 2:
            axes.add_collection(LineCollection(list(edges), colors=style.EDGE, linewidths=0.6))
        if number == 0:
            axes.plot(*places[~free].T, "x", ms=4, color=style.COLLISION)
        axes.plot(*places[free].T, "o", ms=2.5, color=style.MILESTONE)
        if number == 3 and result.milestone_path is not None:
            axes.plot(*result.milestone_path.T, color=style.RAW_PATH, lw=1.2)
            axes.plot(*result.path.T, color=style.PATH, lw=1.6)
        axes.plot(*maze.start, "o", ms=5, color=style.START)
        axes.plot(*maze.goal, "o", ms=5, color=style.GOAL)
    figure.savefig(OUT / "roadmaps.png", bbox_inches="tight", pil_kwargs={"optimize": True})
    print(f"{int(free.sum())} milestones of 256 points, {len(edges)} free motions, {result.message}")


def draw_ends() -> None:
    """Draw a start in a narrow place: whom it reaches of its 10 nearest milestones, and of all."""
    boxes = [(0.3, 0.465, 0.3, 0.02), (0.3, 0.515, 0.3, 0.02), (0.3, 0.465, 0.02, 0.07)]

    def valid(q: np.ndarray) -> np.ndarray:
        inside = [(q[:, 0] >= x) & (q[:, 0] <= x + w) & (q[:, 1] >= y) & (q[:, 1] <= y + h) for x, y, w, h in boxes]
        return ~np.any(inside, axis=0)

    start, steps = np.array([0.36, 0.5]), np.linspace(0.0, 1.0, 400)[:, None]

    def around(sampler: str, seed: int) -> tuple[np.ndarray, np.ndarray]:
        milestones = er.draw(sampler, 128, 2, rng=seed).points
        milestones = milestones[valid(milestones)]
        milestones = milestones[np.argsort(np.linalg.norm(milestones - start, axis=1))]
        return milestones, np.array([valid(start + steps * (each - start)).all() for each in milestones])

    milestones, sees = next(
        (places, sees) for places, sees in (around("even", seed) for seed in range(RUNS)) if not sees[:10].any()
    )
    figure, panels = sheet(2, 5.0)
    for axes, links in zip(panels, (10, 100), strict=True):
        for x, y, w, h in boxes:
            axes.add_patch(Rectangle((x, y), w, h, color=style.OBSTACLE))
        axes.plot(*milestones.T, "o", ms=3, color=style.MILESTONE)
        for milestone, free in zip(milestones[:links], sees, strict=False):
            colour, width = (style.START, 1.8) if free else (style.COLLISION, 0.4)
            axes.plot(*np.stack([start, milestone]).T, color=colour, lw=width, zorder=1 + free)
        axes.plot(*start, "o", ms=8, color=style.START)
        axes.set(xlim=(0, 1), ylim=(0, 1), title=f"the {links} nearest: {sees[:links].sum()} seen")
    figure.savefig(OUT / "ends.png", bbox_inches="tight", pil_kwargs={"optimize": True})
    for sampler, name in SAMPLERS.items():
        seen = [around(sampler, seed)[1] for seed in range(RUNS)]
        for links in (10, 100):
            print(f"{name}: one of the {links} nearest is seen {share(sum(each[:links].any() for each in seen))}")
    maze = load_maze(3)
    world, rule = maze.world(), KNearest(10)
    for links in (None, 100):
        sets = (er.draw("even", 256, 2, rng=run) for run in range(RUNS))
        solved = [
            er.plan(world, maze.start, maze.goal, er.PRM(each, rule=rule, links=links), smooth=False).solved
            for each in sets
        ]
        print(f"maze 3, 256 even points, links={links}: {share(sum(solved))} solved")


def share(count: int) -> str:
    """Return so many of the runs in percent, with their 95 % interval."""
    low, high = wilson(count, RUNS)
    return f"{100 * count / RUNS:.0f} % [{100 * low:.0f}, {100 * high:.0f}]"


def draw_guarantees() -> None:
    """Draw why a path with room is found: places along it, each with a milestone within the largest hole."""
    points = er.draw("cover", 150, 2).points
    beta = dispersion_bounds(points).upper
    t = np.linspace(0.0, 1.0, 2000)
    path = np.stack([0.08 + 0.84 * t, 0.5 + 0.26 * np.sin(2 * np.pi * t)], axis=1)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    delta = 2 * beta
    step = 2 * np.sqrt(delta**2 - beta**2) * 0.8
    places = path[np.searchsorted(along, np.linspace(0.0, along[-1], int(np.ceil(along[-1] / step)) + 1)).clip(0, 1999)]
    nearest = points[cKDTree(points).query(places[1:-1])[1]]
    chain = np.concatenate([places[:1], nearest, places[-1:]])
    figure, (axes,) = sheet(1, 5.2)
    for place in path[::10]:
        axes.add_patch(Circle(tuple(place), delta, color="#e8eef5", zorder=0))
    axes.plot(*points.T, "o", ms=3, color=style.MILESTONE)
    axes.plot(*path.T, "--", color=style.OBSTACLE, lw=1.4)
    for place in places[1:-1]:
        axes.add_patch(Circle(tuple(place), beta, fill=False, ec=style.RAW_PATH, lw=1.2))
    axes.plot(*chain.T, "o-", color=style.PATH, ms=5, lw=1.8)
    axes.set(xlim=(-0.02, 1.02), ylim=(0.05, 0.95))
    figure.savefig(OUT / "guarantees.png", bbox_inches="tight", pil_kwargs={"optimize": True})
    print(f"largest hole of 150 points of cover: {beta:.4f}")


def main() -> None:
    """Draw all."""
    OUT.mkdir(exist_ok=True)
    draw_even_points()
    draw_roadmaps()
    draw_ends()
    draw_guarantees()


if __name__ == "__main__":
    main()
