"""What a training is asked for, and where it runs."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import torch

from evenroad._arrays import set_fields
from evenroad._checks import require_count, require_positive
from evenroad.errors import InvalidValue, NotAvailable, shown
from evenroad.points.bank.anneal import require_points_for
from evenroad.research.training.objective import parse_objective

POINTS_AT_ONCE = 4096
"""Number of points in memory together, unless a micro-batch is asked for."""


@dataclass(frozen=True)
class NetworkConfig:
    """All that decides the result of a training: on one machine's CPU equal configs give the same bits.

    Attributes
    ----------
    n, d : int
        Number of points of a set, >= 2, and dimension, >= 1.
    objective : str
        An expression (:mod:`evenroad.research.training.objective`), whose mean over the sets is made small.
    sets : int
        Trained together: they share the network, and each has its own random start.
    width, layers : int
        How many numbers describe a point inside the network; number of message-passing layers.
    k, radius : int, float or None
        The k nearest neighbours send a point messages; or, where `radius` is given, all points within it.
    steps, rate, weight_decay : int, float, float
        At most so many steps of Adam, over which the rate falls to zero along a half cosine; L2 penalty.
    micro_batch : int or None
        Sets in memory at once, which hardly changes the speed.  None: about 4096 points.
    patience : int or None
        Stop after so many steps without a new best mean.  None: never; the last, small steps usually still gain.
    seed : int
        Draws the starting points and the first weights; nothing is drawn later.

    Raises
    ------
    InvalidValue
        For a value out of range, or an objective that does not parse (UnknownName for a name in it).
    """

    n: int
    d: int
    objective: str = "hickernell"
    sets: int = 16
    width: int = 128
    layers: int = 3
    k: int = 8
    radius: float | None = None
    steps: int = 5000
    rate: float = 1e-3
    weight_decay: float = 1e-6
    micro_batch: int | None = None
    patience: int | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        # Plain ints and floats, since they go into JSON.  The instance norm of a set of one point would be zero.
        counts = {"n": 2, "d": 1, "sets": 1, "width": 1, "layers": 1, "k": 1, "steps": 1, "seed": 0}
        for name, least in counts.items():
            set_fields(self, **{name: require_count(name, getattr(self, name), at_least=least)})
        for name in ("micro_batch", "patience"):
            if getattr(self, name) is not None:
                set_fields(self, **{name: require_count(name, getattr(self, name))})
        if self.radius is not None:
            set_fields(self, radius=require_positive("radius", self.radius))
        rate = require_positive("rate", self.rate)
        decay = require_positive("weight_decay", self.weight_decay, or_zero=True)
        objective = parse_objective(self.objective)
        require_points_for(objective, self.n)
        set_fields(self, rate=rate, weight_decay=decay, objective=str(objective))

    @property
    def sets_at_once(self) -> int:
        """Sets of a micro-batch."""
        wanted = POINTS_AT_ONCE // self.n if self.micro_batch is None else self.micro_batch
        return min(max(wanted, 1), self.sets)


def choose_device(name: str) -> torch.device:
    """Return the device of a name: ``auto`` (a GPU when there is one), ``cpu``, ``cuda`` or ``cuda:1``, ...

    InvalidValue if it is no such name, NotAvailable if there is no such GPU.
    """
    if name == "auto":
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    if name == "cpu":
        return torch.device("cpu")
    parsed = re.fullmatch(r"cuda(:(?P<number>\d{1,9}))?", name, re.ASCII) if isinstance(name, str) else None
    if parsed is None:
        raise InvalidValue(f"device must be auto, cpu, cuda or cuda:NUMBER, got {shown(name)}")
    if int(parsed["number"] or 0) >= torch.cuda.device_count():
        raise NotAvailable(
            f"there is no device {shown(name)} here: torch sees {torch.cuda.device_count()} GPUs"
        )
    return torch.device(name)


@contextmanager
def same_bits(device: torch.device, threads: int) -> Iterator[None]:
    """Let torch use so many threads and, on a CPU, only algorithms with one result; afterwards as before.

    Sums in matrix products may be split by threads: the bits are the same for the same number of them.  On a
    GPU nothing is promised.
    """
    threads_before = torch.get_num_threads()
    strict_before = torch.are_deterministic_algorithms_enabled()
    fill_before = torch.utils.deterministic.fill_uninitialized_memory
    torch.set_num_threads(threads)
    torch.use_deterministic_algorithms(device.type == "cpu" or strict_before)
    # Filling memory that is about to be written anyway takes a tenth of the time and changes no result.
    torch.utils.deterministic.fill_uninitialized_memory = False
    try:
        yield
    finally:
        torch.set_num_threads(threads_before)
        torch.use_deterministic_algorithms(strict_before)
        torch.utils.deterministic.fill_uninitialized_memory = fill_before
