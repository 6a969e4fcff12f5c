"""Samples for 90 %: one number a curve."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from evenroad._rng import generator
from evenroad.research.report.cells import Cell
from evenroad.research.report.runs import Question
from evenroad.research.statistics import FEW_UNITS, SamplesNeeded, resampled_ratios, samples_needed
from evenroad.research.statistics.resampling import DRAWS

TARGET = 0.9

Rates = npt.NDArray[np.float64]


def needed_of(cells: Sequence[Cell]) -> dict[tuple[Question, str], SamplesNeeded]:
    """Return, for every question and sampler, how many samples bring a success rate of 90 %.

    There is no interval where a cell of the curve has fewer than 10 units (runs, sets, blocks or instances).
    """
    curves: dict[Question, dict[str, list[Cell]]] = {}
    for cell in cells:
        curves.setdefault(cell.question, {}).setdefault(cell.sampler, []).append(cell)
    found = {}
    for question, of_sampler in curves.items():
        sure = [curve for curve in of_sampler.values() if _has_enough(curve)]
        resampled = iter(resampled_curves(sure))
        for sampler, curve in of_sampler.items():
            found[question, sampler] = _needed(curve, next(resampled) if _has_enough(curve) else None)
    return found


def _has_enough(curve: Sequence[Cell]) -> bool:
    return min(len(cell.units) for cell in curve) >= FEW_UNITS


def _needed(curve: Sequence[Cell], resampled: Rates | None) -> SamplesNeeded:
    rates, runs = [cell.rate for cell in curve], [cell.runs for cell in curve]
    return samples_needed([cell.n for cell in curve], rates, resampled, runs, target=TARGET)


def resampled_curves(curves: Sequence[Sequence[Cell]]) -> list[Rates]:
    """Return bootstrap resamples of the success rates of each curve, shape (draws, cells of the curve).

    Units are resampled for all numbers of samples at once: one run's generator draws its sets for all of them, and the
    first points of a larger set may be the smaller set.  Where all units of a cell say the same a bootstrap would have
    no width; there, rates are drawn from a beta distribution (Jeffreys' posterior) of as many runs as there are units.
    """
    alike: dict[bytes, list[int]] = {}
    for place, curve in enumerate(curves):
        labels = np.unique(np.concatenate([cell.units.unit for cell in curve]))
        alike.setdefault(labels.tobytes(), []).append(place)
    found: list[Rates] = [np.empty((0, 0))] * len(curves)
    for places in alike.values():
        # Curves with the same units at once, which is much faster than one by one, and the same.
        rates = _resampled([cell for place in places for cell in curves[place]])
        ends = np.cumsum([len(curves[place]) for place in places])
        for place, part in zip(places, np.split(rates, ends[:-1], axis=1), strict=True):
            found[place] = part
    return found


def _resampled(cells: Sequence[Cell]) -> Rates:
    labels, place = np.unique(np.concatenate([cell.units.unit for cell in cells]), return_inverse=True)
    column = np.repeat(np.arange(len(cells)), [len(cell.units) for cell in cells])
    solved, runs = np.zeros((2, len(labels), len(cells)))
    solved[place, column] = np.concatenate([cell.units.solved for cell in cells])
    runs[place, column] = np.concatenate([cell.units.runs for cell in cells])
    rates = resampled_ratios(solved, runs)
    for number, cell in enumerate(cells):
        shares = cell.units.solved / cell.units.runs
        if np.all(shares == shares[0]):
            units, yes = len(shares), len(shares) * float(shares[0])
            # Seeded by the number of samples, so that two cells of one curve do not go in step.
            rates[:, number] = generator(cell.n).beta(yes + 0.5, units - yes + 0.5, size=DRAWS)
    return rates
