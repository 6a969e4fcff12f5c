"""Samples for 90 %: one number a curve."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from evenroad._rng import generator
from evenroad.bench.statistics import FEW_UNITS, SamplesNeeded, resampled_ratios, samples_needed
from evenroad.bench.statistics.bootstrap import DRAWS
from evenroad.report.cells import Cell
from evenroad.report.runs import Question

TARGET = 0.9


def needed_of(cells: Sequence[Cell]) -> dict[tuple[Question, str], SamplesNeeded]:
    """Return, for every question and sampler, how many samples bring a success rate of 90 %.

    There is no interval where a cell of the curve has fewer than 10 units (runs, sets, blocks or instances).
    """
    curves: dict[tuple[Question, str], list[Cell]] = {}
    for cell in cells:
        curves.setdefault((cell.question, cell.sampler), []).append(cell)
    return {key: _needed(curve) for key, curve in curves.items()}


def _needed(curve: list[Cell]) -> SamplesNeeded:
    enough = min(len(cell.units) for cell in curve) >= FEW_UNITS
    rates = [cell.rate for cell in curve]
    resampled = resampled_curve(curve) if enough else None
    return samples_needed(
        [cell.n for cell in curve], rates, resampled, [cell.runs for cell in curve], target=TARGET
    )


def resampled_curve(curve: Sequence[Cell]) -> npt.NDArray[np.float64]:
    """Return bootstrap resamples of a curve's success rates, shape (draws, cells).

    Units are resampled for all numbers of samples at once: one run's generator draws its sets for all of them, and the
    first points of a larger set may be the smaller set.  Where all units of a cell say the same a bootstrap would have
    no width; there, rates are drawn from a beta distribution (Jeffreys' posterior) of as many runs as there are units.
    """
    labels, place = np.unique(np.concatenate([cell.units.unit for cell in curve]), return_inverse=True)
    column = np.repeat(np.arange(len(curve)), [len(cell.units) for cell in curve])
    solved, runs = np.zeros((2, len(labels), len(curve)))
    solved[place, column] = np.concatenate([cell.units.solved for cell in curve])
    runs[place, column] = np.concatenate([cell.units.runs for cell in curve])
    rates = resampled_ratios(solved, runs)
    for number, cell in enumerate(curve):
        shares = cell.units.solved / cell.units.runs
        if np.all(shares == shares[0]):
            units, yes = len(shares), len(shares) * float(shares[0])
            # Seeded by the number of samples, so that two cells of one curve do not go in step.
            rates[:, number] = generator(cell.n).beta(yes + 0.5, units - yes + 0.5, size=DRAWS)
    return rates
