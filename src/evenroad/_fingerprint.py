"""Fingerprints: one text for all equal values, by which a file identifies its robot, scene or world."""

from __future__ import annotations

import enum
import hashlib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from evenroad.errors import NotAvailable


@runtime_checkable
class Fingerprinted(Protocol):
    """A value with a fingerprint of its own."""

    def fingerprint(self) -> str:
        """Return a text that two values share only if they are equal: two worlds with the same results.

        Raises NotAvailable if that is unknown, as for a world of a function without a name.
        """


def fingerprint_of(*values: object) -> str:
    """Return the SHA-256 (hex) of values, equal for equal values on any machine.

    Values are numbers, texts, None, enumerations, arrays, sequences, sets and mappings, values with ``fingerprint()``,
    and dataclasses by their compared fields.  Raises NotAvailable for any other, such as a function.
    """
    return hashlib.sha256(b"".join(map(_canonical, values))).hexdigest()


def _canonical(value: object) -> bytes:
    """Return an unambiguous text of a value."""
    if isinstance(value, enum.Enum):
        return _tagged("enum", type(value).__name__.encode(), value.name.encode())
    if value is None or isinstance(value, bool | int | float | str | bytes | np.bool_ | np.number):
        plain = value.item() if isinstance(value, np.generic) else value
        return _tagged(type(plain).__name__, repr(plain).encode())
    if isinstance(value, np.ndarray) and value.dtype != object:
        head = f"{value.dtype.str} {value.shape}".encode()
        return _tagged("array", head, np.ascontiguousarray(value).tobytes())
    if isinstance(value, Fingerprinted) and not isinstance(value, type):
        return _tagged("fingerprint", value.fingerprint().encode())
    if is_dataclass(value) and not isinstance(value, type):
        own = [field.name for field in fields(value) if field.compare and field.init]
        parts = [_tagged(name, _canonical(getattr(value, name))) for name in own]
        return _tagged("dataclass", type(value).__name__.encode(), *parts)
    if isinstance(value, tuple | list):
        return _tagged("sequence", *map(_canonical, value))
    if isinstance(value, set | frozenset):
        return _tagged("set", *sorted(map(_canonical, value)))
    if isinstance(value, Mapping):
        return _tagged("mapping", *sorted(_canonical(item) for item in value.items()))
    kind = type(value).__name__
    raise NotAvailable(f"a {kind} has no fingerprint, so a file could not know it again: {value!r}")


def _tagged(tag: str, *parts: bytes) -> bytes:
    return b"(" + tag.encode() + b"".join(b" %d:" % len(part) + part for part in parts) + b")"
