"""Modules that come with an extra of this package, imported where they are needed."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from evenroad.errors import NotAvailable


def require_extra(module: str, extra: str, what: str) -> Any:
    """Return an optional module, e.g. ``coal`` of the extra ``mesh``, or raise NotAvailable: `what` needs it."""
    try:
        return import_module(module)
    except ImportError as error:
        raise NotAvailable(f"{what} needs the extra: pip install 'evenroad[{extra}]' ({error})") from error
