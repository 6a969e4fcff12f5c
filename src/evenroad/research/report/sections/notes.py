"""Notes that several tables share."""

from __future__ import annotations

from collections.abc import Iterable

from evenroad.research.report.cells import Cell


def pool_notes(cells: Iterable[Cell]) -> tuple[str, ...]:
    """Return what the runs of small pools stand for where coordinates are permuted, as a sentence; or nothing."""
    samplers = dict.fromkeys(cell.sampler for cell in cells if cell.pool_given)
    if not samplers:
        return ()
    return (f"{', '.join(samplers)}: given the pool's sets; coordinates permuted anew in every run.",)
