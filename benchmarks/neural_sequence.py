"""NeuroLDS, the published neural sequence, trained again: a network from the index of a point to the point.

    python -m benchmarks.neural_sequence --out neural_star.npz   # two networks, the points of each

Van Huffel, Kirk, Chahine, Rusch and Rus (2025): waves of the index, a network of rectified layers and a sigmoid; first
it learns Sobol's points from index 128 on, then the mean over all beginnings of their L2 discrepancy is made small.
The recipe is theirs, the code is ours; what differs is in docs/sequences.md.
"""

from __future__ import annotations

import argparse
import itertools
import math
import time
from pathlib import Path

import numpy as np
import torch

from evenroad._arrays import Floats
from evenroad.points.measures.l2 import MaximumPairs
from evenroad.points.samplers import Sobol
from evenroad_studies.prefixes import PREFIXED, _squared, _weighted_slopes

POINTS, DIMENSION, BURNT = 1000, 4, 128
BANDS, WIDTH, LAYERS = 32, 256, 4
LEARNING, TUNING = 2500, 2500
"""Steps of learning Sobol's points, and of making the discrepancy small."""

RATES = (1e-3, 1e-3)
WARM_UP = 50


def waves(points: int, bands: int) -> torch.Tensor:
    """Return (points, 1 + 2 bands): t = i / points, sin(2^k pi t) and cos(2^k pi t)."""
    share = torch.arange(points, dtype=torch.float64)[:, None] / points
    # Whole turns are taken off first: high bands keep all of their digits.
    turns = (2.0 ** torch.arange(bands, dtype=torch.float64) * share) % 2.0 * math.pi
    return torch.cat([share, torch.sin(turns), torch.cos(turns)], dim=1).float()


def network(bands: int, width: int, layers: int, d: int) -> torch.nn.Sequential:
    sizes = [1 + 2 * bands] + [width] * layers
    inner = [part for a, b in itertools.pairwise(sizes) for part in (torch.nn.Linear(a, b), torch.nn.ReLU())]
    return torch.nn.Sequential(*inner, torch.nn.Linear(width, d), torch.nn.Sigmoid())


def mean_prefix(points: Floats, measure: str = "star") -> tuple[float, Floats]:
    """Return the mean L2 discrepancy of the first 2 .. n points, (n, d), and its gradient, of that shape."""
    columns = np.ascontiguousarray(points.T, dtype=np.float64)
    terms, lengths = PREFIXED[measure](columns, np.ones(len(columns))), np.arange(1, len(points) + 1)
    rooted = np.sqrt(np.maximum(_squared(columns, terms), 1e-12))
    slopes = np.where(lengths > 1, 0.5 / rooted, 0.0) / (len(points) - 1)
    of_pairs = np.cumsum((slopes / lengths**2)[::-1])[::-1].copy()
    of_points = np.cumsum((2.0 * slopes / lengths)[::-1])[::-1]
    assert isinstance(terms.pairs, MaximumPairs)
    gradient = _weighted_slopes(columns, *terms.pairs, of_pairs, 0)
    gradient -= of_points * (terms.linear.prod(axis=0) / terms.linear) * terms.linear_slope
    return float(rooted[1:].mean()), gradient.T


def train(
    seed: int,
    points: int = POINTS,
    d: int = DIMENSION,
    steps: tuple[int, int] = (LEARNING, TUNING),
    measure: str = "star",
) -> tuple[Floats, dict[str, float]]:
    """Return the points, (points, d), and the mean discrepancies of Sobol's, the learnt and the tuned points."""
    torch.set_num_threads(1)
    torch.manual_seed(seed)
    features, made = waves(points, BANDS), network(BANDS, WIDTH, LAYERS, d)
    target = torch.tensor(Sobol(scramble=False, start=BURNT).draw(points, d).points, dtype=torch.float32)
    found = {"sobol": mean_prefix(target.numpy(), measure)[0]}
    for stage, (count, rate) in enumerate(zip(steps, RATES, strict=True)):
        optimiser = torch.optim.AdamW(made.parameters(), lr=rate, weight_decay=1e-4, betas=(0.9, 0.98))
        for step in range(count):
            warm = min(1.0, (step + 1) / WARM_UP) if stage else 1.0
            fall = 0.1 + 0.45 * (1.0 + math.cos(math.pi * step / count))
            optimiser.param_groups[0]["lr"] = rate * warm * fall
            now = made(features)
            optimiser.zero_grad()
            if stage == 0:
                torch.mean((now - target) ** 2).backward()
            else:
                _, gradient = mean_prefix(now.detach().numpy(), measure)
                now.backward(torch.tensor(gradient, dtype=torch.float32))
            torch.nn.utils.clip_grad_norm_(made.parameters(), 1.0)
            optimiser.step()
        with torch.no_grad():
            now = made(features)
            found["tuned" if stage else "learnt"] = mean_prefix(now.numpy(), measure)[0]
            if stage == 0:
                found["root mean square to Sobol's"] = float(((now - target) ** 2).mean().sqrt())
    return now.numpy().astype(np.float64), found


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--networks", type=int, default=2)
    parser.add_argument("--points", type=int, default=POINTS)
    parser.add_argument("--steps", type=int, nargs=2, default=(LEARNING, TUNING))
    parser.add_argument("--measure", choices=tuple(PREFIXED), default="star")
    parser.add_argument("--out", type=Path, default=Path("neural_star.npz"))
    options = parser.parse_args()
    made = []
    for seed in range(options.networks):
        began = time.process_time()
        points, found = train(seed, options.points, DIMENSION, tuple(options.steps), options.measure)
        made.append(points)
        text = ", ".join(f"{name} {value:.3e}" for name, value in found.items())
        print(f"network {seed}, {time.process_time() - began:.0f} s: {text}", flush=True)
        np.savez_compressed(options.out, points=np.array(made))


if __name__ == "__main__":
    main()
