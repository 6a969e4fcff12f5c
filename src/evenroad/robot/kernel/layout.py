"""Where things lie in the packed tables: floats, and integers with a header of offsets.

A compiled function takes some 0.1 microseconds an array to be called with: one or two arrays instead of twenty
keep a call for one configuration cheap.  The constants below are compiled in; ``robot_tables.py`` and
``scene_tables.py`` write what they say, the obstacles' rows last, and the kernels read it.

Header of the integers: how many of each thing, and where its rows begin in either array.
"""

from __future__ import annotations

from typing import TypeAlias

from evenroad._njit import njit

LANES = 16
"""How many configurations, or how many obstacles, are looked at together."""

FRAMES, CAPSULES, FIXED_CAPSULES, BODIES, FIXED_BODIES, BODY_PAIRS, OBSTACLES, BLOCKS = range(8)
"""Header: counts.  Frames without the root's; what is fixed moves with no joint; bodies are links with capsules; blocks
hold 16 obstacles each."""

FRAME_INTS, CAPSULE_INTS, BODY_INTS, BODY_PAIR_INTS, PAIR_INTS, OBSTACLE_INTS, TESTED = range(8, 15)
"""Header: where rows of integers begin."""

FRAME_FLOATS, CAPSULE_FLOATS, SAMPLES, BODY_FLOATS, BODY_PAIR_FLOATS, PAIR_FLOATS = range(15, 21)
"""Header: where rows of floats begin."""

OBSTACLE_FLOATS, BLOCK_FLOATS = range(21, 23)
"""Header: where rows of floats begin."""

INTEGERS, COORDINATES, PAIRS, SCRATCH = range(23, 27)
"""Header: how many integers there are, header included; where lanes read, single-precision floats follow them.  How
many coordinates a configuration has, how many pairs there are, of capsules and of bodies by hulls, how many floats
lanes need for places."""

HULL_PAIRS = 27
"""Header: how many pairs of bodies, the last ones, are decided by their hulls where capsules touch."""

NODE_INTS, NODE_FLOATS, HULL_MARGINS = range(28, 31)
"""Header: where nodes of trees of hulls begin, and the margins of pairs that are decided by hulls."""

SURFACES, SURFACE_CHECK = range(31, 33)
"""Header, where a program is called: addresses of the desk of surfaces (points and meshes), 0 where there are none, and
of the check against them."""

HEADER = 33
"""Length of the header."""

FRAME_INT_ROW = 3
"""Parent frame, coordinate, 1 where it slides."""

CAPSULE_INT_ROW = 3
"""Frame, first sample, end of samples."""

BODY_INT_ROW = 4
"""Frame, first capsule, end of capsules, root of its tree of hulls."""

BODY_PAIR_INT_ROW = 4
"""Two bodies, first capsule pair, end of capsule pairs."""

PAIR_INT_ROW = 2
"""Two capsules."""

NODE_INT_ROW = 4
"""Two children, or -1 twice; of a leaf, where its points begin and end in the floats, in steps of three."""

NODE_FLOAT_ROW = 8
"""Centre (3) and half extents (3) of a box around all below, in the body's frame; radius of a ball about the same
centre around all below; by how much a leaf's hull is widened."""

ALIGNED, ROTATED, CYLINDER = range(3)
"""Kinds of obstacles, an integer each: a box along the axes with its edges rounded (also a sphere), the same turned, a
cylinder."""

FRAME_FLOAT_ROW = 16
"""Rotation (9) and translation (3) in the parent frame, multiplier, offset, and what single precision cuts off
these two."""

CAPSULE_FLOAT_ROW = 7
"""Centre (3), half of the segment (3), radius of the covering spheres."""

BODY_FLOAT_ROW = 7
"""Centre (3) and radius of a ball around the capsules; half extents (3), in the frame, of a box about the same centre
around their covering spheres."""

PAIR_FLOAT_ROW = 4
"""Distance of centres from which on they cannot touch; sum of radii; one over the squared half lengths (0 for
points)."""

FEW = 3
"""Of bodies with at most so many capsules no box is tested before those of the capsules: it would cost more."""

FRAME = 12 * LANES
"""Places in lanes, of a frame: rotation row by row, origin."""

PLACED = 12 * LANES
"""Of a body or a capsule: its centre; half extents of the box around a body, half the segment of a capsule; centre and
half extents of the box around it in all lanes, where that is asked for more than once."""

HALF, BOX = 3 * LANES, 6 * LANES
"""Where the second three are, and the last six."""

MOST_WAITING = 640
"""Stretches of a motion that may wait for a proof: 16 more at most for each halving, of which single precision bears
some thirty."""

WORKSPACE = 16
"""Length of the desk at the beginning of the memory, see ``motion_checks.checks_of``."""

LEAST_SQUARE = 1e-30
"""What a squared length is taken for at least where one divides by it [m^2]; the kernels' own, in no row."""

OBSTACLE_FLOAT_ROW = 16
"""Centre (3), half extents (3), rotation (9) to the root's frame, rounding of the edges.

A cylinder has its radius in the first two half extents."""

BLOCK_FLOAT_ROW = 6 * LANES
"""Bounding boxes of 16 obstacles: centres x, y, z, half extents x, y, z, 16 numbers each."""

Pair: TypeAlias = tuple[int, int]
Given: TypeAlias = tuple[int, float, int, int, int, int]
"""What a program takes beside numbers: an array by its address and length; and ``LaneWorld.arguments``.
``_njit`` knows them by these names."""

MEMORY = 5
"""Where in ``LaneWorld.arguments`` the address of the memory stands that was asked for."""

inner = njit(nogil=True, no_cpython_wrapper=True, no_cfunc_wrapper=True)
"""Decorator of a function that only compiled code calls: kept with its callers, and without what Python would call."""

inlined = njit(nogil=True, no_cpython_wrapper=True, no_cfunc_wrapper=True, forceinline=True)
"""Decorator of such a function that is put where it is called."""

quick = njit(nogil=True, no_cpython_wrapper=True, no_cfunc_wrapper=True, error_model="numpy", _nrt=False)
"""Decorator of such a function that makes no arrays, does not count references to those it is given, which costs more
than the rest, and does not look whether it divides by zero."""

quick_inlined = njit(
    nogil=True,
    no_cpython_wrapper=True,
    no_cfunc_wrapper=True,
    error_model="numpy",
    _nrt=False,
    forceinline=True,
)
"""Decorator of such a function that is put where it is called: one that is given many arrays, which are handed over
number by number."""

program = njit(cache=True, nogil=True, no_cfunc_wrapper=True, error_model="numpy", _nrt=False)
"""Decorator of what Python calls: it takes numbers alone, and arrays by their addresses, which is soon compiled, soon
called, and never compiled anew for other kinds of arrays."""
