"""What a training of the network is asked for."""

from __future__ import annotations

import math
from dataclasses import dataclass

from evenroad._arrays import set_fields
from evenroad._checks import require_count, require_known, require_positive
from evenroad.errors import InvalidValue
from evenroad.points.anneal import require_points_for
from evenroad_studies.training.objective import parse_objective

STARTS = ("sobol", "kronecker", "halton", "korobov", "uniform")
"""What the network may start from: samplers, and multiples of irrational numbers modulo 1."""

JUDGES = ("objective", "star")
"""What may decide which points of a training are the best."""


@dataclass(frozen=True)
class NetworkConfig:
    """All that decides the result of a training, apart from the seed.

    Attributes
    ----------
    n, d : int
        Number of points, >= 2, and dimension, >= 1.
    objective : str
        An expression (:mod:`evenroad_studies.training.objective`) that is made small.
    start : str or None
        What the network starts from, one of ``STARTS``: it learns by how much to move each point.  None: ``kronecker``
        in the plane, but for prefixes, else ``sobol``.
    width : int or None
        How many numbers describe a point inside; None: 32, from d = 8 on 64.
    layers, k : int
        Message-passing layers; the k nearest starts send a point messages.
    steps, rate : int, float
        Steps of Adam, over which the rate falls to zero along a half cosine.
    noise : float or None
        The starts drift, by Gaussian noise that cools with the rate, as this share of an annealing's noise.
        None: 0 in the plane and 0.5 in d = 10.
    judge : str
        What decides which step made the best points: the ``objective``, or in the plane their exact ``star``
        discrepancy.

    Raises
    ------
    InvalidValue, UnknownName
        For a value out of range, or an objective that does not parse; for a name in it, a start or a judge that is
        not known.
    """

    n: int
    d: int
    objective: str = "hickernell"
    start: str | None = None
    width: int | None = None
    layers: int = 3
    k: int = 8
    steps: int = 10_000
    rate: float = 3e-3
    noise: float | None = None
    judge: str = "objective"

    def __post_init__(self) -> None:
        # Plain ints and floats, since they go into JSON.  The instance norm of a set of one point would be zero.
        for name, least in {"n": 2, "d": 1, "layers": 1, "k": 1, "steps": 1}.items():
            set_fields(self, **{name: require_count(name, getattr(self, name), at_least=least)})
        if self.width is not None:
            set_fields(self, width=require_count("width", self.width))
        objective = parse_objective(self.objective)
        if self.start is None:
            # The first points of a Kronecker set are all on one side: no start for a set used from its beginning.
            prefixes = any(term.prefixes for term in objective.terms)
            set_fields(self, start="kronecker" if self.d == 2 and not prefixes else "sobol")
        require_known("start", self.start, STARTS)
        require_known("judge", self.judge, JUDGES)
        if self.judge == "star" and self.d != 2:
            raise InvalidValue(f"the exact star discrepancy judges sets in d = 2 alone, not in d = {self.d}")
        require_points_for(objective, self.n)
        if self.noise is not None:
            set_fields(self, noise=require_positive("noise", self.noise, or_zero=True))
        set_fields(self, rate=require_positive("rate", self.rate), objective=str(objective))

    @property
    def channels(self) -> int:
        """The width, or its default: 64 gains 4 % over 32 in d = 10, n = 512, and nothing in d <= 5."""
        return (64 if self.d >= 8 else 32) if self.width is None else self.width

    @property
    def drift(self) -> float:
        """The noise, or its default: in few dimensions the starts are in a good basin, which noise leaves."""
        if self.noise is not None:
            return self.noise
        if self.d >= 8:
            return 0.5
        share = {1: 0.0, 2: 0.0, 3: 0.1, 4: 0.3}.get(self.d, 0.5)
        return share if self.d <= 3 else share * min(1.0, math.sqrt(128 / self.n))
