"""The network's pools beside the annealed ones, from the bank's index: ``python -m benchmarks.pools``."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from evenroad.points.bank import Bank
from evenroad_studies.training.bank import DATA, MPMC_CELLS


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=DATA, help="the bank of the network's pools")
    bank, annealed = Bank(parser.parse_args().folder), Bank()
    print(
        "| d | n | sets | steps | network, mean D_H | annealed | network / annealed | spacing: network | annealed |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for d, n in sorted(MPMC_CELLS):
        if not bank.has("mpmc", n, d):
            continue
        cell, other = bank.cell("mpmc", n, d), annealed.cell("hickernell", n, d)
        ours, theirs = (np.array(each.measures["hickernell_rooted"]) for each in (cell, other))
        error = ours.std(ddof=1) / np.sqrt(len(ours)) / theirs.mean()
        spacing = [np.mean(each.measures["separation_periodic"]) for each in (cell, other)]
        print(
            f"| {d} | {n} | {cell.sets} | {cell.steps} | {ours.mean():.5f} | {theirs.mean():.5f}"
            f" | {ours.mean() / theirs.mean():.3f} ± {error:.3f} | {spacing[0]:.4f} | {spacing[1]:.4f} |"
        )


if __name__ == "__main__":
    main()
