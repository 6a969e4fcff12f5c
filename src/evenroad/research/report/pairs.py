"""Pairs: the same run of two samplers."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.research.report.groups import Ints, combined
from evenroad.research.report.runs import Runs


def pair_codes(runs: Runs) -> Ints:
    """Return one code a run that the same run of another sampler has, too."""
    return combined(runs.question, runs.n, runs.instance, runs.run, runs.seed)


def differences_from(runs: Runs, pair: Ints, reference: str) -> tuple[npt.NDArray[np.bool_], Ints]:
    """Return which runs of others have a counterpart of the reference sampler, and solved minus solved there."""
    solved = runs.solved.astype(np.int64)
    if reference not in runs.samplers:
        return np.zeros(len(runs), dtype=bool), np.zeros(len(runs), dtype=np.int64)
    of_reference = runs.sampler == runs.samplers.index(reference)
    counterpart = np.full(int(pair.max()) + 1, -1)
    counterpart[pair[of_reference]] = solved[of_reference]
    theirs = counterpart[pair]
    return (theirs >= 0) & ~of_reference, solved - theirs
