"""Reading YAML files with unique keys; errors name what is wrong, and where.

``_understood.py`` refuses keys that a reader does not know.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from evenroad._files import not_a, read_known
from evenroad._understood import Kind, require_understood
from evenroad._yaml_values import values_of
from evenroad.errors import BrokenFile, InvalidValue, shown


def read_mapping(path: Path, what: str) -> dict[str, Any]:
    """Return the mapping of a YAML file of the kind `what`, its keys as text.

    Raises BrokenFile if the file is missing, no YAML or no mapping, or any mapping in it has a key twice (``1`` and
    ``'1'`` are the same).
    """
    document = read_yaml(path, what)
    if not isinstance(document, dict):
        raise not_a(f"a {what}", path, "it must consist of 'key: value' lines")
    return {str(key): value for key, value in document.items()}


def read_yaml(path: Path, what: str, *, tags: Mapping[str, Callable[[str, str], object]] | None = None) -> object:
    """Return the content of a YAML file; `tags` of scalars are read by functions of the tag and the text.

    Raises BrokenFile as `read_mapping`.
    """
    try:
        return values_of(read_known(path, what).decode(), path, tags or {})
    except BrokenFile:
        raise
    except (yaml.YAMLError, ValueError, LookupError, AttributeError, RecursionError) as error:
        raise not_a(f"YAML, as a {what} is", path, _why(error)) from error


def _why(error: Exception) -> str:
    """Return the message of a YAML error, with its position, in one line."""
    mark = getattr(error, "problem_mark", None)
    if mark is None:
        return " ".join(str(error).split())
    return f"line {mark.line + 1}, column {mark.column + 1}: {error.problem}"  # type: ignore[attr-defined]


def require_keys(keys: Iterable[str], required: Collection[str], optional: Iterable[str], where: str) -> None:
    """Raise UnknownName for a key that is neither required nor optional, BrokenFile for one that is missing.

    It is the guard of :mod:`evenroad._understood` for a mapping whose entries are read where it is.
    """
    known = (*required, *optional)
    if not all(key in known for key in keys):
        require_understood(dict.fromkeys(keys), Kind(known), where)
    missing = [key for key in required if key not in keys]
    if missing:
        raise BrokenFile(f"{where} lacks {', '.join(missing)}; it needs {', '.join(required)}")


def numbers(value: object, count: int, what: str) -> tuple[float, ...]:
    """Return `value` as a tuple of `count` finite floats, or raise InvalidValue naming it."""
    value = value.tolist() if isinstance(value, np.ndarray) else value
    entries = list(value) if isinstance(value, list | tuple) else [value]
    plain = [entry for entry in entries if isinstance(entry, int | float) and not isinstance(entry, bool)]
    with suppress(OverflowError):
        row = tuple(map(float, plain))
        if len(entries) == count == len(row) and all(map(math.isfinite, row)):
            return row
    allowed = "a finite number" if count == 1 else f"a list of {count} finite numbers"
    given = entries[0] if count == 1 and len(entries) == 1 else value
    hint = ""
    if any(isinstance(entry, str) for entry in entries):
        hint = " (text; YAML reads an exponent only after a decimal point: 1.0e-2, not 1e-2)"
    raise InvalidValue(f"{what} must be {allowed}, got {shown(given)}{hint}")
