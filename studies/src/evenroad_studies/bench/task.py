"""The values of a benchmark: a problem, a task (one run of it), and the outcome of the task."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from evenroad._arrays import Floats
from evenroad.points.pointset import PointSet
from evenroad.world import World

PROTOCOL = 10
"""Counted up when the same task would give another row: rows of another protocol are not taken for done."""


@dataclass(frozen=True, eq=False)
class Problem:
    """A world with a start and a goal, (dim,) each.

    `set_dim` is the dimension of the point sets.  Where it is smaller than the space's `cube_dim`, as for the paper's
    SE(3) puzzles, the sets give the first coordinates of the cube and the others are drawn uniformly.
    """

    world: World
    start: Floats
    goal: Floats
    set_dim: int

    def configurations(self, points: PointSet, rng: np.random.Generator) -> Floats:
        """Return the set's configurations, (n, dim); `rng` draws the coordinates that the set does not give."""
        missing = self.world.space.cube_dim - self.set_dim
        cube = points.points
        if missing:
            cube = np.concatenate([cube, rng.random((points.n, missing))], axis=1)
        return self.world.space.from_cube(cube)


@dataclass(frozen=True)
class ProblemSource:
    """A named problem, such as ``maze-3``, or a named stream of random problems.

    `make` gives the problem of a number >= 0, of which a fixed problem takes no notice: the same one in every process.
    `random` says whether instances differ; `set_dim` is known without making one; `about` is one line for lists and
    tables.
    """

    name: str
    set_dim: int
    make: Callable[[int], Problem]
    random: bool = False
    about: str = ""


@dataclass(frozen=True)
class Task:
    """All that decides the outcome of one run.

    `instance` is that of a random problem, 0 of a fixed one; `n` does not count start and goal; `rule` is one of
    :mod:`evenroad_studies.rules`, by name.  `search` is ``connect`` (is there a path; no shortest one), ``stock``
    (the same, adding milestones in order and noting after how many valid ones there is a path: OMPL's early stop),
    ``full`` or ``lazy`` (shortest path).  `run` is the draw of the sampler, from 0: run i of a block protocol takes the
    points i N + 1 .. (i + 1) N.  `seed` is the whole suite's; the run's generator is ``SeedSequence(seed,
    spawn_key=(run,))``, of which ``paper-blocks`` draw nothing: with another seed they are the same sets.
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
        return key_of(PROTOCOL, *vars(self).values())


def key_of(protocol: int, *fields: Any) -> str:
    """Return the key of a task of some protocol: SHA-256 of its fields as JSON with sorted names, in hexadecimal."""
    problem, instance, sampler, n, rule, search, run, seed = fields
    # Not json.dumps, which takes three times as long: a store has a million rows whose keys are checked.
    record = (
        f'{{"instance": {instance}, "n": {n}, "problem": {_quoted(problem)}, "protocol": {protocol},'
        f' "rule": {_quoted(rule)}, "run": {run}, "sampler": {_quoted(sampler)}, "search": {_quoted(search)},'
        f' "seed": {seed}}}'
    )
    return hashlib.sha256(record.encode()).hexdigest()


_quoted = json.encoder.encode_basestring_ascii


@dataclass(frozen=True)
class Outcome:
    """What one task gave; a task that failed has an outcome, too.

    `status` is ``solved``, ``not_connected``, ``start_invalid``, ``goal_invalid``; or a failure of the run, which is no
    answer: ``failed`` (an exception, whose traceback is `error`), ``timeout``, ``lost`` (the worker died).  `valid`
    counts milestones among all n points, `valid_at_solution` those that had been added when start and goal were first
    connected (search ``stock``), `edges_checked` the motions asked of the world.  `length` is the path's in the space's
    metric, `seconds` the wall time without the making of problem and set.  `set_id` says which set of a pool it was, by
    which statistics cluster; ``grid`` for the only set that there is; empty for sets drawn afresh.
    """

    status: str
    valid: int = 0
    valid_at_solution: int | None = None
    edges_checked: int = 0
    length: float = math.nan
    seconds: float = math.nan
    set_id: str = ""
    error: str = ""

    @property
    def solved(self) -> bool:
        """Whether there was a path."""
        return self.status == "solved"
