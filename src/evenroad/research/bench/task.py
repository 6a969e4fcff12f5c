"""Task: one run of a benchmark, and the key under which its row is kept."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass

PROTOCOL = 3
"""Counted up when the same task would give another row: rows of another protocol are not taken for done."""


@dataclass(frozen=True)
class Task:
    """All that decides the outcome of one run.

    Attributes
    ----------
    problem : str
        Name in :data:`evenroad.research.problems.PROBLEMS`.
    instance : int
        Which of a stream of random problems; 0 for a fixed one.
    sampler : str
        Name in :data:`evenroad.research.bench.samplers.SAMPLERS`, e.g. ``halton paper-blocks``.
    n : int
        Points of the set, start and goal not counted.
    rule : str
        Connection rule, as :func:`evenroad.roadmap.rule_named` reads it.
    search : str
        ``connect`` (is there a path; no shortest one), ``stock`` (the same, adding milestones in order and noting
        after how many valid ones there is a path: OMPL's early stop), ``full`` or ``lazy`` (shortest path).
    run : int
        Which draw of the sampler, from 0: run i of a block protocol takes the points i N + 1 .. (i + 1) N.
    seed : int
        Seed of the whole suite; the run's generator is ``SeedSequence(seed, spawn_key=(run,))``.  ``paper-blocks``
        draw no random numbers: with another seed they are the same sets.
    """

    problem: str
    instance: int
    sampler: str
    n: int
    rule: str
    search: str
    run: int
    seed: int

    @property
    def key(self) -> str:
        """SHA-256 of the fields and the protocol's number, in hexadecimal."""
        # Not asdict, which copies: a suite asks for a million keys.
        record = json.dumps({"protocol": PROTOCOL, **vars(self)}, sort_keys=True)
        return hashlib.sha256(record.encode()).hexdigest()
