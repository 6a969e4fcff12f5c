"""Where the nodes of trees of hulls lie in packed tables, and how compiled code is compiled."""

from __future__ import annotations

from evenroad._njit import njit

NODE_INTS, NODE_FLOATS, HEADER = range(3)
"""Header of the integers: where nodes begin in the integers, and in the floats; its length."""

NODE_INT_ROW = 4
"""Two children, or -1 twice; of a leaf, where its points begin and end in the floats, in steps of three."""

NODE_FLOAT_ROW = 8
"""Centre (3) and half extents (3) of a box around all below, in the body's frame; radius of a ball about the same
centre around all below; by how much a leaf's hull is widened."""

quick = njit(nogil=True, no_cpython_wrapper=True, no_cfunc_wrapper=True, error_model="numpy", _nrt=False)
"""Decorator of a function that only compiled code calls: it makes no arrays, does not count references to those it is
given, and does not look whether it divides by zero."""
