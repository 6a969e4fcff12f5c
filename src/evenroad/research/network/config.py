"""What a training of the network is asked for."""

from __future__ import annotations

from dataclasses import dataclass

from evenroad._arrays import set_fields
from evenroad._checks import require_count, require_known, require_positive
from evenroad.points.bank.anneal import require_points_for
from evenroad.research.training.objective import parse_objective

STARTS = ("sobol", "halton", "korobov", "uniform")
"""Samplers that the network may start from."""


@dataclass(frozen=True)
class NetworkConfig:
    """All that decides the result of a training, apart from the seed.

    Attributes
    ----------
    n, d : int
        Number of points, >= 2, and dimension, >= 1.
    objective : str
        An expression (:mod:`evenroad.research.training.objective`) that is made small.
    start : str
        The sampler that the network starts from, one of ``STARTS``: it learns by how much to move each point.
    width, layers, k : int
        How many numbers describe a point inside; message-passing layers; the k nearest starts send messages.
    steps, rate : int, float
        Steps of Adam, over which the rate falls to zero along a half cosine.
    noise : float or None
        The starts drift, by Gaussian noise that cools with the rate, as this share of an annealing's noise.
        None: by the dimension, 0 in the plane and .5 from d = 5 on.

    Raises
    ------
    InvalidValue, UnknownName
        For a value out of range, or an objective that does not parse; for a name in it or a start that is not known.
    """

    n: int
    d: int
    objective: str = "hickernell"
    start: str = "sobol"
    width: int = 32
    layers: int = 3
    k: int = 8
    steps: int = 10_000
    rate: float = 3e-3
    noise: float | None = None

    def __post_init__(self) -> None:
        # Plain ints and floats, since they go into JSON.  The instance norm of a set of one point would be zero.
        for name, least in {"n": 2, "d": 1, "width": 1, "layers": 1, "k": 1, "steps": 1}.items():
            set_fields(self, **{name: require_count(name, getattr(self, name), at_least=least)})
        require_known("start", self.start, STARTS)
        objective = parse_objective(self.objective)
        require_points_for(objective, self.n)
        if self.noise is not None:
            set_fields(self, noise=require_positive("noise", self.noise, or_zero=True))
        set_fields(self, rate=require_positive("rate", self.rate), objective=str(objective))

    @property
    def drift(self) -> float:
        """The noise, or its default: in few dimensions Sobol points are in a good basin, which noise leaves."""
        return {1: 0.0, 2: 0.0, 3: 0.1, 4: 0.3}.get(self.d, 0.5) if self.noise is None else self.noise
