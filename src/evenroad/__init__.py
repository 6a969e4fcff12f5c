"""evenroad: point sets that make sampling-based motion planners need fewer samples.

The public names are those of ``__init__.pyi``, which type checkers and editors read as it is.  Here they are loaded on
first use, so that ``import evenroad`` costs milliseconds.
"""

from __future__ import annotations

import importlib
from typing import Any

__version__ = "0.1.0"


def _read_homes() -> dict[str, tuple[str, str]]:
    """Return where each public name is: module and name there, of the lines ``from MODULE import X as NAME``."""
    with open(__file__.removesuffix(".py") + ".pyi", encoding="utf-8") as stub:
        words = [line.split() for line in stub if line.startswith("from ")]
    return {name: (module, there) for _, module, _, there, _, name, *_ in words}


_HOMES = _read_homes()
__all__ = ["__version__", *_HOMES]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        from difflib import get_close_matches

        near = get_close_matches(name, _HOMES, 1)
        hint = f"; did you mean {near[0]}?" if near else ""
        raise AttributeError(f"module 'evenroad' has no attribute {name!r}{hint}")
    home, there = _HOMES[name]
    if home == "evenroad":
        return importlib.import_module(f"evenroad.{there}")
    return getattr(importlib.import_module(home), there)


def __dir__() -> list[str]:
    return sorted(__all__)
