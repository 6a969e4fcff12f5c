"""Checks of arguments and of installed packages."""

from __future__ import annotations

import math
import os
from collections.abc import Collection, Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue, NotAvailable, UnknownName, shown

LARGEST_COUNT = 2**31 - 1
"""Largest count: nodes of a roadmap are numbered by int32."""

# Made once: a union takes as long as the rest of a check.
_WHOLE, _REAL = (int, np.integer), (int, float, np.integer, np.floating)

LONGEST_NAME = 4096
"""Largest length of a file's name, as Linux has it."""

FARTHEST = 1e9
"""Largest length and coordinate of bodies [m]: squares and cubes stay finite in single precision."""


def counted(number: int, thing: str) -> str:
    """Return a number of things in words."""
    return f"{number} {thing}{'' if number == 1 else 's'}"


def require_count(name: str, value: object, at_least: int = 1) -> int:
    """Return `value` as an int >= `at_least`, or raise InvalidValue naming it (`n`, `d`, `k`, ...)."""
    if isinstance(value, bool) or not isinstance(value, _WHOLE) or value < at_least:
        raise InvalidValue(f"{name} must be an integer >= {at_least}, got {shown(value)}")
    if value > LARGEST_COUNT:
        raise InvalidValue(
            f"{name} must be at most {LARGEST_COUNT}, got an integer of {math.floor(math.log10(value)) + 1} digits"
        )
    return int(value)


def require_positive(name: str, value: object, *, or_zero: bool = False, at_most: float = math.inf) -> float:
    """Return `value` as a finite float > 0 (or >= 0) and <= `at_most`, or raise InvalidValue naming it."""
    if type(value) is float and 0.0 < value <= at_most and value < math.inf:
        return value
    allowed = "a finite number >= 0" if or_zero else "a finite number > 0"
    if isinstance(value, bool) or not isinstance(value, _REAL):
        raise InvalidValue(f"{name} must be {allowed}, got {shown(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number) or number < 0 or (number == 0 and not or_zero):
        raise InvalidValue(f"{name} must be {allowed}, got {shown(value)}")
    if number > at_most:
        raise InvalidValue(f"{name} must be at most {at_most:g}, got {shown(value)}")
    return number


def require_known(what: str, name: object, known: Collection[object]) -> None:
    """Raise UnknownName, which lists the known ones, unless this is a known name of something (`sampler`, ...)."""
    if name not in known:
        raise UnknownName.among(what, name, known)


def as_row(
    name: str, values: Sequence[float], length: int | None = None, *, within: float = math.inf
) -> tuple[float, ...]:
    """Return `values` as a tuple of finite floats from -`within` to `within`, `length` of them or else at least one."""
    try:
        row = tuple(map(float, values))
    except (TypeError, ValueError):
        row = ()
    # The sum of finite numbers is finite, unless they are very large.
    usual = row and len(row) == (length or len(row)) and math.isfinite(sum(row))
    if usual and (within == math.inf or (min(row) >= -within and max(row) <= within)):
        return row
    wanted = "one finite number or more" if length is None else f"{length} finite number(s)"
    if len(row) == 0 or (length is not None and len(row) != length) or not all(map(math.isfinite, row)):
        raise InvalidValue(f"{name} must be {wanted}, got {shown(values)}")
    if max(map(abs, row)) > within:
        raise InvalidValue(f"{name} must lie between -{within:g} and {within:g}, got {shown(values)}")
    return row


def as_times(t: object, duration: float) -> Floats:
    """Return times of a motion as an array of their shape [s]; InvalidValue unless all are from 0 to `duration`."""
    try:
        times = np.asarray(t, dtype=np.float64)
    except (TypeError, ValueError):
        times = np.array(np.nan)
    if not np.all((times >= 0.0) & (times <= duration)):
        raise InvalidValue(f"t must be from 0 to {duration:.9g} s, got {shown(t)}")
    return times


def as_file(what: str, path: object, instead: str = "") -> Path:
    """Return the name of a file as a Path, or raise InvalidValue; `instead` says what to do with other values."""
    if not isinstance(path, str | os.PathLike):
        hint = f"; {instead}" if instead else ""
        raise InvalidValue(f"{what} must be the name of a file, a text or a Path, got {shown(path)}{hint}")
    name = os.fspath(path)
    if len(name) > LONGEST_NAME or "\n" in name or "\0" in name or name.lstrip()[:1] == "<":
        raise InvalidValue(f"{what} must be the name of a file, not what stands in it, got {shown(path)}")
    return Path(path)


def require_extra(module: str, extra: str, what: str) -> ModuleType:
    """Return an optional module, e.g. ``coal`` of the extra ``mesh``, or raise NotAvailable: `what` needs it."""
    try:
        return import_module(module)
    except ImportError as error:
        # Pip takes the evenroad that is installed, wherever it came from, and adds what is missing.
        raise NotAvailable(f"{what} needs the extra: pip install 'evenroad[{extra}]' ({error})") from error


def as_batch(name: str, values: object, dim: int) -> Floats:
    """Return `values` as a read-only C-contiguous float64 array, (n, dim), of finite entries, or raise InvalidValue."""
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidValue(f"{name} must be an (n, {dim}) array of numbers: {error}") from None
    if array.ndim != 2 or array.shape[1] != dim:
        one = f"; one configuration is a batch, too: [{array.tolist()}]" if array.shape == (dim,) else ""
        raise InvalidValue(f"{name} must have shape (n, {dim}), got {array.shape}{one}")
    batch = np.ascontiguousarray(array).view()
    batch.setflags(write=False)
    finite = np.isfinite(batch)
    # Counted: `all` takes longer than the rest.
    if np.count_nonzero(finite) != finite.size:
        i, k = np.argwhere(~finite)[0]
        raise InvalidValue(f"{name} must be finite: entry [{i}, {k}] is {float(batch[i, k])!r}")
    return batch
