"""One network for every N and every d, measured on those that it never saw: ``python -m benchmarks.one_network``.

A node of its graph is one coordinate of one point, so that its weights do not know how many there are: it hears the
same coordinate of the nearest points, and knows of itself its value, mean and mean square of the point's others, how
far it is from its rank's place, the slope of the discrepancy there, n and d.  Starts: Kronecker points in the plane,
else scrambled Sobol points, new ones in every step.  Beside one pass, in as much time: Adam on the coordinates from
the same starts, without noise, and annealing; and annealing for 5000 steps.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad.points import draw
from evenroad.points.bank.anneal import anneal, first_rate
from evenroad.points.measures import MEASURES
from evenroad.points.pointset import BELOW_ONE
from evenroad_studies.network import NetworkConfig
from evenroad_studies.network.train import INSET, Network, kronecker, moved, nearest

MEASURE = MEASURES["hickernell"]
SEEN_D, D, UNSEEN_N = (2, 3, 5), (2, 3, 4, 5, 6, 10), (50, 200)
SEEN_N = tuple(n for n in np.geomspace(16, 512, 26).round().astype(int).tolist() if n not in UNSEEN_N)
FEATURES, K, REACH, SETS = 7, 8, 0.3, 8
COLD = 0.3
"""Adam's rate without noise over an annealing's first: of six from .003 to 1 the best for 10 to 40 steps at these n."""


def begin(n: int, d: int, draws: np.random.Generator) -> Floats:
    """Return a start."""
    points = kronecker(n, draws.random(2)) if d == 2 else draw("sobol", n, d, rng=draws).points
    return np.clip(points, INSET, 1.0 - INSET)


def slope_at(points: Floats) -> tuple[float, Floats]:
    """Return the discrepancy and the slope of its logarithm, (n, d)."""
    value, columns = MEASURE.of_columns(np.ascontiguousarray(points.T))
    return value, columns.T / value


def nodes(points: Floats, slope: Floats) -> Floats:
    """Return what every coordinate of every point knows of itself, (d n, FEATURES), within about [0, 1]."""
    n, d = points.shape
    c = 2.0 * points - 1.0
    total, squares, others = c.sum(axis=1, keepdims=True), (c * c).sum(axis=1, keepdims=True), max(d - 1, 1)
    ranks = np.argsort(np.argsort(points, axis=0, kind="stable"), axis=0)
    known = [
        c,
        (total - c) / others,
        1.5 * (squares - c * c) / others - 0.5,
        ranks + 0.5 - n * points,
        slope / np.sqrt((slope * slope).mean()),
        np.full_like(c, math.log2(n) / 3.0 - 2.3),
        np.full_like(c, (d - 3) / 2.0),
    ]
    return 0.5 + 0.5 * np.stack([each.T.ravel() for each in known], axis=1)


def one_pass(network: Network, starts: Floats) -> tuple[Floats, Floats]:
    """Return the points, and by how much they follow what the network says, both (n, d)."""
    n, d = starts.shape
    neighbours = nearest(starts, K)
    graph: Ints = np.concatenate([neighbours + n * k for k in range(d)])
    said = network.moves(nodes(starts, slope_at(starts)[1]), graph)[:, 0].reshape(d, n).T
    reach = REACH / math.sqrt(n)
    # A small step as it is, a large one near a face in the logit, which cannot leave the cube.
    gain = reach / (starts * (1.0 - starts) + reach)
    points = moved(starts, said * gain)
    return points, points * (1.0 - points) * gain


def trained(steps: int, width: int, rate: float = 1e-3) -> Network:
    """Return the network.  It has as many outputs as inputs; the first one is used."""
    draws = np.random.default_rng(0)
    network = Network(NetworkConfig(2, FEATURES, width=width), draws)
    for step in range(steps):
        n, d = int(draws.choice(SEEN_N)), int(draws.choice(SEEN_D))
        points, follow = one_pass(network, begin(n, d, draws))
        told = np.zeros((n * d, FEATURES))
        told[:, 0] = (slope_at(points)[1] * follow).T.ravel()
        network.learn(told, rate * 0.5 * (1.0 + math.cos(math.pi * step / steps)))
    return network


def descend(points: Floats, steps: int, share: float = COLD) -> Floats:
    """Return the points after so many steps of Adam on their coordinates, without noise."""
    n, d = points.shape
    first, second = np.zeros_like(points), np.zeros_like(points)
    for step in range(1, steps + 1):
        slope = slope_at(points)[1]
        first, second = 0.9 * first + 0.1 * slope, 0.999 * second + 0.001 * slope * slope
        rate = share * first_rate(n, d) * 0.5 * (1.0 + math.cos(math.pi * (step - 1) / steps))
        move = first / (1.0 - 0.9**step) / (np.sqrt(second / (1.0 - 0.999**step)) + 1e-15)
        points = np.clip(points - rate * move, INSET, BELOW_ONE)
    return points


def seconds(work: Callable[[], object]) -> float:
    """Return the least processor time of five."""
    times = []
    for _ in range(5):
        began = time.process_time()
        work()
        times.append(time.process_time() - began)
    return min(times)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--steps", type=int, default=16_000)
    parser.add_argument("--width", type=int, default=32)
    options = parser.parse_args()
    began = time.process_time()
    network = trained(options.steps, options.width)
    size = network.weights.nbytes / 1e3
    print(f"trained in {time.process_time() - began:.0f} s of processor time; {size:.0f} kB of weights")
    print(
        "| d | n | start | network, one pass | ms | Adam as long | annealed as long | annealed, 5000 steps |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for d in D:
        for n in UNSEEN_N:
            starts = [begin(n, d, np.random.default_rng([n, d, seed])) for seed in range(SETS)]
            taken = seconds(lambda start=starts[0]: one_pass(network, start))  # type: ignore[misc]
            of_adam = seconds(lambda start=starts[0]: descend(start, 20)) / 20  # type: ignore[misc]
            of_annealing = seconds(lambda n=n, d=d: anneal(n, d, MEASURE, steps=20)) / 20  # type: ignore[misc]
            few, more = max(1, round(taken / of_adam)), max(1, round(taken / of_annealing))
            rows = np.array([
                [
                    MEASURE.rooted(start),
                    MEASURE.rooted(one_pass(network, start)[0]),
                    MEASURE.rooted(descend(start, few)),
                    anneal(n, d, MEASURE, steps=more, rng=seed).value,
                ]
                for seed, start in enumerate(starts)
            ])  # fmt: skip
            level = np.mean([anneal(n, d, MEASURE, rng=seed).value for seed in range(2)])
            mean, error = rows.mean(axis=0) / level, rows.std(axis=0, ddof=1) / math.sqrt(SETS) / level
            cells = [f"{m:.3f} ± {e:.3f}" for m, e in zip(mean, error, strict=True)]
            print(
                f"| {d} | {n} | {cells[0]} | {cells[1]} | {1e3 * taken:.1f} | {cells[2]} ({few}) | {cells[3]} ({more})"
                f" | {level:.5f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
