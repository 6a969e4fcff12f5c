"""Checking what was read from YAML, with errors that say what is wrong, and where."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from evenroad.errors import BrokenFile, InvalidValue, UnknownName


def require_keys(
    entry: Mapping[str, object], required: Iterable[str], optional: Iterable[str], where: str
) -> None:
    """Raise UnknownName for a key that is neither required nor optional, BrokenFile for one that is missing."""
    required = tuple(required)
    for key in entry:
        if key not in (*required, *optional):
            raise UnknownName.among(f"key of {where}:", key, (*required, *optional))
    missing = [key for key in required if key not in entry]
    if missing:
        raise BrokenFile(f"{where} lacks {', '.join(missing)}")


def numbers(value: object, count: int, what: str) -> tuple[float, ...]:
    """Return `value` as a tuple of `count` finite floats, or raise InvalidValue naming it."""
    entries = value if isinstance(value, list) else [value]
    plain = [entry for entry in entries if isinstance(entry, int | float) and not isinstance(entry, bool)]
    row = tuple(map(_as_float, plain))
    if len(entries) == count == len(row) and all(map(math.isfinite, row)):
        return row
    allowed = "a finite number" if count == 1 else f"a list of {count} finite numbers"
    shown = entries[0] if count == 1 and len(entries) == 1 else value
    hint = ""
    if any(isinstance(entry, str) for entry in entries):
        hint = " (text; YAML reads an exponent only after a decimal point: 1.0e-2, not 1e-2)"
    raise InvalidValue(f"{what} must be {allowed}, got {shown!r}{hint}")


def _as_float(number: float) -> float:
    try:
        return float(number)
    except OverflowError:
        return math.inf
