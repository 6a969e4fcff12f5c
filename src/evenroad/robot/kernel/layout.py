"""How compiled code is compiled."""

from __future__ import annotations

from evenroad._njit import njit

quick = njit(nogil=True, no_cpython_wrapper=True, no_cfunc_wrapper=True, error_model="numpy", _nrt=False)
"""Decorator of a function that only compiled code calls: it makes no arrays, does not count references to those it is
given, and does not look whether it divides by zero."""
