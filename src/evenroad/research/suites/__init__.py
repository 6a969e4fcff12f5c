"""Suites by name: which tasks a benchmark has."""

from __future__ import annotations

from collections.abc import Callable

from evenroad.research.suites.fair import fair_suite
from evenroad.research.suites.paper import paper_suite
from evenroad.research.suites.suite import Suite as Suite

SUITES: dict[str, Callable[..., Suite]] = {"paper": paper_suite, "fair": fair_suite}
"""Name -> how to make it from ``runs``, ``seed``, ``only`` and ``quick``."""
