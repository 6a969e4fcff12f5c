"""Speed of the measures, and what annealing reaches.

    python -m benchmarks.measures_speed                      # milliseconds of value + gradient, and ratios
    python -m benchmarks.measures_speed --anneal 128 256     # D_H in d = 10 after 20000 steps, 8 sets each

Medians of several repeats on one thread.  The first column of ratios is against scipy's value (scipy has no
gradient); the second against PyTorch's autograd on the same formula, where torch is installed.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from types import ModuleType

import numpy as np
import numpy.typing as npt
from scipy.stats import qmc

from evenroad.points.bank.anneal import anneal
from evenroad.points.measures import MEASURES
from evenroad_studies.training.objective import parse_objective

COUNTS = (128, 512, 1024, 2048)
D = 10
REPEATS = 15
SCIPY_METHODS = {"centred": "CD", "wrap_around": "WD", "mixture": "MD", "star": "L2-star"}


def milliseconds(function: Callable[[], object], repeats: int = REPEATS) -> float:
    """Return the median time of a call, after one call that compiles."""
    function()
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        function()
        times.append(time.perf_counter() - began)
    return 1e3 * statistics.median(times)


def torch_or_none() -> ModuleType | None:
    try:
        import torch
    except ImportError:
        return None
    torch.set_num_threads(1)
    return torch


def autograd_hickernell(torch: ModuleType, points: npt.NDArray[np.float64]) -> tuple[float, object]:
    """Return rooted Hickernell and its gradient the usual way: all pairs at once, then backward."""
    x = torch.tensor(points, requires_grad=True)
    n, d = x.shape
    single = ((3 - x**2) / 2).prod(dim=1).sum()
    double = (2 - torch.maximum(x[:, None], x[None])).prod(dim=2).sum()
    root = ((4 / 3) ** d - 2 / n * single + double / n**2).sqrt()
    root.backward()
    return root.item(), x.grad


def speed_table() -> None:
    torch = torch_or_none()
    if torch is None:
        print("torch is not installed: no ratio to autograd")
    print(f"d = {D}, milliseconds; one thread")
    print(
        f"{'measure':16} {'n':>5} {'value':>9} {'+gradient':>10} {'scipy/value':>12} {'autograd/+gradient':>19}"
    )
    riesz = parse_objective("riesz")
    for n in COUNTS:
        points = np.random.default_rng(0).random((n, D))
        for name, measure in MEASURES.items():
            value = milliseconds(lambda m=measure, x=points: m.rooted(x))
            both = milliseconds(lambda m=measure, x=points: m.rooted_with_gradient(x))
            scipy_ratio = autograd_ratio = "-"
            if name in SCIPY_METHODS:
                method = SCIPY_METHODS[name]
                scipy_time = milliseconds(lambda m=method, x=points: qmc.discrepancy(x, method=m), repeats=3)
                scipy_ratio = f"{scipy_time / value:.1f}"
            if torch is not None and name == "hickernell":
                assert np.isclose(autograd_hickernell(torch, points)[0], measure.rooted(points))
                slow = milliseconds(lambda x=points: autograd_hickernell(torch, x), repeats=5)
                autograd_ratio = f"{slow / both:.0f}"
            print(f"{name:16} {n:5} {value:9.3f} {both:10.3f} {scipy_ratio:>12} {autograd_ratio:>19}")
        both = milliseconds(lambda x=points: riesz.with_gradient(x))
        print(f"{'riesz, s = 2d':16} {n:5} {'':9} {both:10.3f}")


def annealing_table(counts: list[int], d: int, objective: str, steps: int, sets: int) -> None:
    print(f"d = {d}, {objective}, {steps} steps, seeds 0 .. {sets - 1}, one thread")
    target = parse_objective(objective)
    anneal(2, 2, target, steps=1)  # compiles
    for n in counts:
        began = time.perf_counter()
        results = [anneal(n, d, target, steps=steps, rng=seed) for seed in range(sets)]
        seconds = (time.perf_counter() - began) / sets
        values = [result.value for result in results]
        print(
            f"n = {n:5}: mean {statistics.mean(values):.5f}, best {min(values):.5f}"
            f" (seed {int(np.argmin(values))}), {seconds:.1f} s a set",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--anneal", nargs="+", type=int, metavar="N", help="anneal sets of N points instead")
    parser.add_argument("--d", type=int, default=D)
    parser.add_argument("--objective", default="hickernell")
    parser.add_argument("--steps", type=int, default=20000)
    parser.add_argument("--sets", type=int, default=8)
    options = parser.parse_args()
    if options.anneal:
        annealing_table(options.anneal, options.d, options.objective, options.steps, options.sets)
    else:
        speed_table()


if __name__ == "__main__":
    main()
