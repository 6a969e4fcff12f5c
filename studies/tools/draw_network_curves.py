"""Draw how the network's discrepancy falls with the steps, beside annealing's: studies/docs/network_curves.png.

python studies/tools/draw_network_curves.py        # half a minute
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from evenroad.points.bank import Bank
from evenroad.points.bank.anneal import anneal
from evenroad.points.measures import MEASURES
from evenroad_studies.network import NetworkConfig, train

OUT = Path(__file__).parents[1] / "docs" / "network_curves.png"
STEPS, N, SETS = 10_000, 128, 2


def curve(run: Callable[[int, Callable[[int, int, float], object]], object]) -> np.ndarray:
    """Return the best value after every step, the mean over the seeds."""
    seen: list[list[float]] = []
    for seed in range(SETS):
        seen.append([])
        run(seed, lambda step, steps, best: seen[-1].append(best))
    return np.mean(seen, axis=0)


def main() -> None:
    """Draw studies/docs/network_curves.png."""
    measure = MEASURES["hickernell"]
    figure = Figure(figsize=(10, 3.8), dpi=130, layout="constrained")
    FigureCanvasAgg(figure)
    for axes, d in zip(figure.subplots(1, 2), (2, 10), strict=True):
        level = np.mean(Bank().cell("hickernell", N, d).measures["hickernell_rooted"])
        looks = {
            "network": ({}, "#d1343b", "-"),
            "Sobol starts, no drift": ({"start": "sobol", "noise": 0.0}, "#d1343b", ":"),
            "random starts": ({"start": "uniform", "noise": 0.0}, "#6b7680", "-"),
            "Kronecker starts": ({"start": "kronecker", "noise": 0.0}, "#2a9d4a", "--"),
        }
        for name, (options, colour, style) in looks.items():
            config = NetworkConfig(N, d, steps=STEPS, **options)  # type: ignore[arg-type]
            values = curve(lambda seed, report, config=config: train(config, rng=seed, callback=report))  # type: ignore[misc]
            axes.plot(np.arange(1, STEPS + 1), values / level, color=colour, linestyle=style, label=name)
        values = curve(
            lambda seed, report, d=d: anneal(N, d, measure, steps=STEPS, rng=seed, callback=report)  # type: ignore[misc]
        )
        axes.plot(np.arange(1, STEPS + 1), values / level, color="#2f5fd0", label="annealing")
        axes.set(xscale="log", xlim=(10, STEPS), ylim=(0.9, 2.2), xlabel="steps", title=f"d = {d}, n = {N}")
        axes.axhline(1.0, color="black", linewidth=0.6)
        axes.grid(alpha=0.3)
    figure.axes[0].set_ylabel("best so far, over the annealed pool")
    figure.axes[0].legend()
    figure.savefig(OUT)


if __name__ == "__main__":
    main()
