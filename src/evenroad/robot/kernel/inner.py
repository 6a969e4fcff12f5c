"""How functions are compiled that only compiled code calls: sooner, without what Python would call."""

from __future__ import annotations

from numba import njit

inner = njit(cache=True, nogil=True, no_cpython_wrapper=True, no_cfunc_wrapper=True)
"""Decorator of a function that is called."""

inlined = njit(cache=True, nogil=True, no_cpython_wrapper=True, no_cfunc_wrapper=True, forceinline=True)
"""Decorator of a function that is put where it is called."""

quick = njit(
    cache=True,
    nogil=True,
    no_cpython_wrapper=True,
    no_cfunc_wrapper=True,
    error_model="numpy",
    _nrt=False,
)
"""Decorator of a function that is called often: it makes no arrays, does not count references to those it is given,
which costs more than the rest, and does not look whether it divides by zero."""
