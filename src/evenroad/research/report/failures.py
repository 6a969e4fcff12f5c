"""Failures: runs that gave no answer, with what was said last."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad.research.bench.rows import Rows


@dataclass(frozen=True)
class Failure:
    """Runs of one problem, sampler and rule that failed alike."""

    problem: str
    sampler: str
    rule: str
    status: str
    message: str
    runs: int


def failures_of(rows: Rows) -> tuple[Failure, ...]:
    """Return the failures, alike ones counted together, the most frequent first."""
    counted: dict[tuple[str, str, str, str, str], int] = {}
    for row in np.flatnonzero(~rows.answered).tolist():
        last_line = (rows.error[row].strip().splitlines() or [""])[-1].strip()
        key = (rows.problem[row], rows.sampler[row], rows.rule[row], rows.status[row], last_line)
        counted[key] = counted.get(key, 0) + 1
    found = [Failure(*key, runs) for key, runs in counted.items()]
    return tuple(sorted(found, key=lambda each: (-each.runs, each.problem, each.sampler, each.message)))
