"""Where the network runs, and torch set up so that a CPU gives the same bits again."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

import torch

from evenroad.errors import InvalidValue, NotAvailable, shown


def choose_device(name: str) -> torch.device:
    """Return the device of a name: ``auto`` (a GPU when there is one), ``cpu``, ``cuda`` or ``cuda:1``, ...

    Raises
    ------
    InvalidValue
        If it is no such name.
    NotAvailable
        If there is no such GPU.
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
