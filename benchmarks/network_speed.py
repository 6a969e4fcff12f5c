"""Milliseconds of a step of the network, and how much of it is the loss: ``python -m benchmarks.network_speed``.

Processor time of one thread, the best of five runs of 20 steps; Hickernell discrepancy, width 32, three layers, k = 8.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial

import numpy as np

from evenroad.points.measures import MEASURES
from evenroad_studies.network import NetworkConfig, train

CELLS = ((2, 128), (5, 128), (10, 128), (2, 512), (10, 512), (10, 1024))
STEPS, REPEATS = 20, 5


def milliseconds(run: Callable[[], object]) -> float:
    run()
    times = []
    for _ in range(REPEATS):
        began = time.process_time()
        run()
        times.append(time.process_time() - began)
    return 1e3 * min(times) / STEPS


def main() -> None:
    print(" d     n  ms a step  of which the loss")
    for d, n in CELLS:
        columns = np.random.default_rng(0).random((d, n))

        def losses(columns: np.ndarray = columns) -> None:
            for _ in range(STEPS):
                MEASURES["hickernell"].of_columns(columns)

        config = NetworkConfig(n, d, width=32, steps=STEPS)
        step = milliseconds(partial(train, config))
        print(f"{d:2d}  {n:4d}  {step:9.2f}  {milliseconds(losses):17.2f}", flush=True)


if __name__ == "__main__":
    main()
