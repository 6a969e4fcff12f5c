"""Suites by name: which tasks a benchmark has."""

from __future__ import annotations

from collections.abc import Callable

from evenroad.bench.suites.fair import fair_suite
from evenroad.bench.suites.paper import paper_suite
from evenroad.bench.suites.suite import Suite as Suite

SUITES: dict[str, Callable[..., Suite]] = {"paper": paper_suite, "fair": fair_suite}
"""Name -> how to make it from ``runs``, ``seed``, ``only`` and ``quick``."""
