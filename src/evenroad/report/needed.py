"""Samples for 90 %: one number a curve."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from evenroad.bench.statistics import SamplesNeeded, samples_needed
from evenroad.report.cells import Cell
from evenroad.report.runs import Question

TARGET = 0.9


def needed_of(cells: Sequence[Cell]) -> dict[tuple[Question, str], SamplesNeeded]:
    """Return, for every question and sampler, how many samples bring a success rate of 90 %."""
    curves: dict[tuple[Question, str], list[Cell]] = {}
    for cell in cells:
        curves.setdefault((cell.question, cell.sampler), []).append(cell)
    return {key: _needed(curve) for key, curve in curves.items()}


def _needed(curve: list[Cell]) -> SamplesNeeded:
    resampled = np.stack([cell.resampled_rates() for cell in curve], axis=1)
    rates = [cell.rate for cell in curve]
    return samples_needed(
        [cell.n for cell in curve], rates, resampled, [cell.runs for cell in curve], target=TARGET
    )
