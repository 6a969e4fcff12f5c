"""One network for every number of points and dimension, trained on what plans: is it ahead of Adam in the same time?

    python -m studies.benchmarks.one_network --seconds 14

Points lie on the torus.  In each of 16 steps every point hears all others.  A message is a push along the line between
two points, by a learned function of their distance in radii of a ball that holds one point, and the pull of the
discrepancy, whose weight is learned, too; both know the step, n and d.  So 384 weights fit any n and d.  What falls is
the score that chose `even`: log(E) / (2 d) + 2 log(W), with E the periodic Riesz energy, s = 2 d, and W the wrap-around
discrepancy.  Training is by evolution strategies in d = 5, 6 and 8, n = 48 to 200; the table has n and d not seen.

Success is that of roadmaps in the reported worlds ``apart``, linked as a plan links, mean over 6, 10 and 20 neighbours.
"network" is how much more its sets solve, in points, paired by world, with its standard error.
"""

from __future__ import annotations

import math
import time

import numpy as np
from studies.benchmarks.rows import parser_of

from evenroad._arrays import Floats
from evenroad.points import draw
from evenroad.points.anneal import anneal
from evenroad.points.measures import MEASURES
from evenroad.points.measures.separation import log_riesz_of_columns
from evenroad_studies.connected import connected
from evenroad_studies.problems.apart import SIZES as SIZES_OF_WORLDS
from evenroad_studies.problems.apart import Kind, Use, make
from evenroad_studies.training.objective import parse_objective

OBJECTIVE = parse_objective("riesz+2*wrap_around")
STEPS, BINS, REACH, WIDTH, INPUTS = 16, 48, 3.0, 16, 6
SHAPES = ((INPUTS, WIDTH), (WIDTH, WIDTH), (WIDTH, 2))
SIZES = [rows * columns for rows, columns in SHAPES]
FRESH = ((5, 100), (7, 100), (7, 250), (10, 100))
"""Dimensions and numbers of points of the table."""
RATES = (0.003, 0.01, 0.02, 0.03)
"""Learning rates of Adam, of which the best counts."""
STARTS = 8
KS = (6, 10, 20)
FIRST_WORLD = 40_000
"""Number of the first world of each kind; no lower one was used here."""


def score(points: Floats) -> float:
    """Return log(E) / (2 d) + 2 log(W) of points, (n, d)."""
    d = points.shape[1]
    energy = log_riesz_of_columns(np.ascontiguousarray(points.T), 2 * d, True, False)[0] / (2 * d)
    return energy + 2.0 * math.log(MEASURES["wrap_around"].rooted(points))


def functions(weights: Floats, n: int, d: int) -> Floats:
    """Return the push of each step by distance, and its pull, (STEPS, BINS + 1)."""
    parts = np.split(weights, np.cumsum(SIZES)[:-1])
    first, second, last = (part.reshape(shape) for part, shape in zip(parts, SHAPES, strict=True))
    s = (np.arange(BINS) + 0.5) * REACH / BINS
    inputs = np.ones((STEPS, BINS, INPUTS))
    inputs[..., 0], inputs[..., 1] = np.log(s), s - 1.5
    inputs[..., 2] = 2.0 * np.arange(STEPS)[:, np.newaxis] / STEPS - 1.0
    inputs[..., 3], inputs[..., 4] = 4.0 / d - 0.6, math.log(n) / 3.0 - 1.7
    out = np.tanh(np.tanh(inputs @ first) @ second) @ last
    push = 0.15 * np.exp(out[..., 0] - 2.0 * s) * (1.0 - s / REACH)
    return np.hstack([push, 0.3 * np.exp(out[..., 1].mean(axis=1, keepdims=True))])


def moved(points: Floats, table: Floats, radius: float) -> Floats:
    """Return where the steps of a table move points, (n, d), on the torus."""
    x, bins = points.copy(), table.shape[1] - 1
    for forces, scale in zip(table[:, :bins], table[:, bins], strict=True):
        gaps = x[:, np.newaxis] - x
        gaps -= np.rint(gaps)
        size = np.abs(gaps)
        factors = 1.5 - size * (1.0 - size)
        length = np.sqrt((gaps * gaps).sum(axis=-1)) + 1e-12
        at = (length / radius * (bins / REACH)).astype(int)
        force = np.append(forces, 0.0)[np.minimum(at, bins)] / length
        np.fill_diagonal(force, 0.0)
        push = (force[..., np.newaxis] * gaps).sum(axis=1)
        slopes = (1.0 - 2.0 * size) * np.sign(gaps) / factors
        pull = (factors.prod(axis=-1, keepdims=True) * slopes).sum(axis=1)
        x += radius * push + scale * radius * 0.1 / (np.sqrt((pull * pull).mean()) + 1e-12) * pull
        x -= np.floor(x)
    return x


def passed(weights: Floats, starts: Floats) -> Floats:
    """Return where the network moves points, (n, d)."""
    n, d = starts.shape
    radius = math.exp((math.lgamma(0.5 * d + 1.0) - 0.5 * d * math.log(math.pi) - math.log(n)) / d)
    return np.clip(moved(starts, functions(weights, n, d), radius), 0.0, np.nextafter(1.0, 0.0))


def trained(seconds: float) -> Floats:
    """Return the weights after so many seconds of processor time."""
    rng = np.random.default_rng(0)
    parts = [rng.standard_normal(s) * g / math.sqrt(s[0]) for s, g in zip(SHAPES, (1.0, 1.0, 0.1), strict=True)]
    weights = np.concatenate([part.ravel() for part in parts])
    first, second = np.zeros_like(weights), np.zeros_like(weights)
    began, rounds = time.process_time(), 0
    while (spent := time.process_time() - began) < seconds:
        rounds += 1
        slope = np.zeros_like(weights)
        for _ in range(4):
            d = int(rng.choice((5, 6, 8)))
            n = int(math.exp(rng.uniform(math.log(48), math.log(200))))
            starts = draw("sobol", n, d, rng=rng).points
            for noise in rng.standard_normal((4, len(weights))):
                up, down = (score(passed(weights + side * noise, starts)) for side in (0.05, -0.05))
                slope += (up - down) * noise
        rate = 0.01 * (1.0 + math.cos(math.pi * spent / seconds))
        first, second = 0.9 * first + 0.1 * slope, 0.99 * second + 0.01 * slope * slope
        weights = weights - rate * (first / (1.0 - 0.9**rounds)) / (np.sqrt(second / (1.0 - 0.99**rounds)) + 1e-12)
    print(f"{rounds} rounds of training")
    return weights


def sets_of(weights: Floats, starts: Floats, seed: int) -> tuple[dict[str, Floats], float, int]:
    """Return what becomes of starts, by how; the milliseconds of the network; steps of Adam that take as long."""
    n, d = starts.shape
    times = []
    for _ in range(3):
        began = time.process_time()
        passed(weights, starts)
        times.append(time.process_time() - began)
    began = time.process_time()
    anneal(n, d, OBJECTIVE, steps=30, start=starts)
    steps = max(1, round(30 * min(times) / (time.process_time() - began)))
    adam = [anneal(n, d, OBJECTIVE, steps=steps, start=starts, rates=(rate, 0.0)).points for rate in RATES]
    made = {
        "start": starts,
        "network": passed(weights, starts),
        "adam": min(adam, key=score),
        "annealed-as-long": anneal(n, d, OBJECTIVE, steps=steps, start=starts).points,
        "annealed-600": anneal(n, d, OBJECTIVE, steps=600, start=starts).points,
        "even": draw("even", n, d, rng=seed).points,
    }
    return made, 1e3 * min(times), steps


def compared(weights: Floats, d: int, n: int, worlds: int) -> None:
    """Print mean scores of what becomes of the starts, and the success of roadmaps of these sets beside the network's.

    World i takes the sets of start i modulo :data:`STARTS`, with the axes in an order of its own.
    """
    made = [sets_of(weights, draw("sobol", n, d, rng=seed).points, seed) for seed in range(100, 100 + STARTS)]
    names = list(made[0][0])
    scores = np.array([[score(sets[name]) for name in names] for sets, _, _ in made])
    found = np.zeros((len(Kind) * worlds, len(names), len(KS)))
    for at, (kind, i) in enumerate((kind, i) for kind in Kind for i in range(worlds)):
        problem = make(Use.REPORTING, kind, d, SIZES_OF_WORLDS[Use.REPORTING, kind, d], FIRST_WORLD + i)
        axes = np.random.default_rng([d, at]).permutation(d)
        for column, name in enumerate(names):
            found[at, column] = connected(problem, made[at % STARTS][0][name][:, axes], KS)[1]
    success = 100.0 * found.mean(axis=2)
    more = success[:, [names.index("network")]] - success
    errors = more.std(axis=0, ddof=1) / np.sqrt(len(more))
    ms, steps = (np.mean([each[of] for each in made]) for of in (1, 2))
    print(f"d={d} n={n}: {ms:.1f} ms, {steps:.0f} steps, {len(more)} worlds")
    for column, name in enumerate(names):
        solved = f"{success[:, column].mean():.1f} %, network {more[:, column].mean():+.1f} ({errors[column]:.1f})"
        gap = scores[:, names.index("network")] - scores[:, column]
        error = gap.std(ddof=1) / np.sqrt(STARTS)
        print(f"  {name}: score {scores[:, column].mean():.3f}, network {gap.mean():+.3f} ({error:.3f}); {solved}")


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--seconds", type=float, default=14.0)
    parser.add_argument("--worlds", type=int, default=60, help="of each of five kinds")
    options = parser.parse_args()
    weights = trained(options.seconds)
    for d, n in FRESH:
        compared(weights, d, n, options.worlds)


if __name__ == "__main__":
    main()
