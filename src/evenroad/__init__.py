"""evenroad: point sets that make sampling-based motion planners need fewer samples.

The public names below are loaded on first use, so that ``import evenroad`` costs milliseconds.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from evenroad.errors import EvenroadError as EvenroadError
    from evenroad.points import Origin as Origin
    from evenroad.points import PointSet as PointSet

_HOMES = {
    "EvenroadError": "evenroad.errors",
    "Origin": "evenroad.points",
    "PointSet": "evenroad.points",
}

__all__ = ["__version__", *_HOMES]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(importlib.import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'evenroad' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
