"""Speed and memory of training the MPMC network, and what a short training reaches.

    python -m benchmarks.network_speed                          # seconds a step, peak memory, share of the loss
    python -m benchmarks.network_speed --train 64 2 --steps 1500  # best and mean of the objective, then refined
    python -m benchmarks.network_speed --device cuda            # the network on a GPU

Every size runs in a process of its own, so that its peak memory is its own, with one thread of torch; steps are
medians after two warm ones.  The peak is that of the whole process: Python, torch and the compiled kernels alone take
about 300 MB of it.
"""

from __future__ import annotations

import argparse
import multiprocessing
import resource
import statistics
import time

import numpy as np

from evenroad.points.measures import MEASURES
from evenroad.points.pointset import PointSet
from evenroad.research.network import NetworkConfig, refine, train

COUNTS = (128, 512, 1024)
D = 10
SETS = 16
WARM_STEPS = 2
REPEATS = 5


def time_steps(n: int, micro_batch: int | None, device: str) -> tuple[float, float, float, float]:
    """Return the seconds of a step, of the slowest one, of the objective of all sets in it, and the peak in MB."""
    config = NetworkConfig(n, D, sets=SETS, steps=WARM_STEPS + REPEATS, micro_batch=micro_batch)
    ends: list[float] = []
    sets = train(config, device=device, callback=lambda step, steps, best: ends.append(time.perf_counter()))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    seconds = np.diff(ends)[WARM_STEPS - 1 :]
    losses = []
    for _ in range(REPEATS):
        began = time.perf_counter()
        for each in sets:
            MEASURES["hickernell"].rooted_with_gradient(each)
        losses.append(time.perf_counter() - began)
    return float(np.median(seconds)), float(seconds.max()), statistics.median(losses), peak


def print_speed(micro_batch: int | None, device: str) -> None:
    print(f"d={D}, {SETS} sets, width 128, 3 layers, k=8, device {device}")
    print("    n   s/step  slowest   of which loss   peak MB")
    context = multiprocessing.get_context("spawn")
    for n in COUNTS:
        with context.Pool(1) as pool:
            step, slowest, loss, peak = pool.apply(time_steps, (n, micro_batch, device))
        print(f"{n:5d}  {step:7.3f}  {slowest:7.3f}  {loss:14.3f}  {peak:8.0f}", flush=True)


def print_training(n: int, d: int, sets: int, steps: int, refine_steps: int, device: str) -> None:
    began = time.perf_counter()
    trained = train(NetworkConfig(n, d, sets=sets, steps=steps), device=device)
    print(f"n={n} d={d}, {sets} sets: {steps} steps on {device} in {time.perf_counter() - began:.0f} s")
    print_values("network", trained)
    if refine_steps:
        began = time.perf_counter()
        refined = refine(trained, steps=refine_steps)
        print(f"{refine_steps} steps of annealing of each set: {time.perf_counter() - began:.0f} s")
        print_values("network+annealed", refined)


def print_values(title: str, sets: tuple[PointSet, ...]) -> None:
    values = [MEASURES["hickernell"].rooted(each) for each in sets]
    print(f"{title}: Hickernell best {min(values):.5f}, mean {np.mean(values):.5f}, worst {max(values):.5f}")


def main() -> None:
    parser = argparse.ArgumentParser(description="Speed of the MPMC network.")
    parser.add_argument("--train", nargs=2, type=int, metavar=("N", "D"), help="train instead of timing")
    parser.add_argument("--sets", type=int, default=SETS)
    parser.add_argument("--steps", type=int, default=1500)
    parser.add_argument("--refine", type=int, default=5000, help="annealing steps afterwards, 0 for none")
    parser.add_argument("--micro-batch", type=int)
    parser.add_argument("--device", default="cpu")
    options = parser.parse_args()
    if options.train is None:
        print_speed(options.micro_batch, options.device)
    else:
        print_training(*options.train, options.sets, options.steps, options.refine, options.device)


if __name__ == "__main__":
    main()
