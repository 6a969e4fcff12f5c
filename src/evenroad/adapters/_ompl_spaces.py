"""Our spaces as OMPL's, and OMPL's as ours."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_extra
from evenroad.adapters._ompl_states import Ompl, format_of
from evenroad.errors import InvalidValue
from evenroad.space import SO3, BoxSpace, Circle, JointSpace, Product, Rectangle, Space

ob = require_extra("ompl.base", "ompl", "evenroad.adapters.ompl")


def ompl_space(space: Space) -> Ompl:
    """Return OMPL's state space of one of ours.

    ``SE2`` and ``SE3`` become OMPL's own.  Joints that wrap become circles, other joints real vectors.  A map's
    rectangle becomes the box around it.

    Parameters
    ----------
    space : BoxSpace, Circle, JointSpace, Rectangle, SO3 or Product
        Weights of a Product are kept, those within a BoxSpace or JointSpace are not.

    Raises
    ------
    InvalidValue
        For another space, or a joint that wraps after anything but one turn.
    """
    if isinstance(space, Product):
        named = {(BoxSpace, Circle): (2, ob.SE2StateSpace), (BoxSpace, SO3): (3, ob.SE3StateSpace)}.get(
            tuple(type(part) for part in space.parts)  # type: ignore[arg-type]
        )
        if named is not None and space.parts[0].dim == named[0]:
            pose = named[1]()
            pose.setBounds(_bounds(space.parts[0].low, space.parts[0].high))  # type: ignore[attr-defined]
            for i, weight in enumerate(space.weights):
                pose.setSubspaceWeight(i, weight)
            return pose
        return _compound([ompl_space(part) for part in space.parts], space.weights)
    if isinstance(space, SO3):
        return ob.SO3StateSpace()
    if isinstance(space, Rectangle):
        corners = space.from_cube(np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]))
        return _real(corners.min(axis=0), corners.max(axis=0))
    if isinstance(space, Circle):
        return ob.SO2StateSpace()
    if isinstance(space, BoxSpace | JointSpace):
        wrapping = space.flat.wrapping
        if not np.allclose(space.flat.period[wrapping], 2.0 * math.pi, rtol=1e-12):
            raise InvalidValue("OMPL's circles have one turn of 2 pi: a joint of this space wraps after another")
        low, high = np.array(space.low), np.array(space.high)
        runs = [(wraps, [*run]) for wraps, run in groupby(range(space.dim), lambda k: bool(wrapping[k]))]
        parts = []
        for wraps, run in runs:
            parts += [ob.SO2StateSpace() for _ in run] if wraps else [_real(low[run], high[run])]
        return parts[0] if len(parts) == 1 else _compound(parts, [1.0] * len(parts))
    raise InvalidValue(
        f"OMPL has no counterpart of {type(space).__name__}: build one of BoxSpace, Circle, SO3 and Product"
    )


def space_of(space: Ompl) -> Space:
    """Return our space of one of OMPL's: real vectors, SO2, SO3, SE2, SE3, or a compound of these.

    The metric is OMPL's.  Raises InvalidValue for another, or for real vectors without bounds.
    """
    if type(space) is ob.SO2StateSpace:
        return Circle()
    if type(space) is ob.SO3StateSpace:
        return SO3()
    if type(space) is ob.RealVectorStateSpace:
        bounds = space.getBounds()
        return BoxSpace(tuple(bounds.low), tuple(bounds.high))
    format_of(space)
    parts = [space_of(space.getSubspace(i)) for i in range(space.getSubspaceCount())]
    return Product(parts, tuple(space.getSubspaceWeights()), "sum")


def _compound(parts: Sequence[Ompl], weights: Sequence[float]) -> Ompl:
    space = ob.CompoundStateSpace()
    for part, weight in zip(parts, weights, strict=True):
        space.addSubspace(part, weight)
    return space


def _real(low: npt.ArrayLike, high: npt.ArrayLike) -> Ompl:
    space = ob.RealVectorStateSpace(len(np.asarray(low)))
    space.setBounds(_bounds(low, high))
    return space


def _bounds(low: npt.ArrayLike, high: npt.ArrayLike) -> Ompl:
    rows = np.array([low, high], dtype=np.float64)
    bounds = ob.RealVectorBounds(rows.shape[1])
    for k, (least, most) in enumerate(rows.T.tolist()):
        bounds.setLow(k, least)
        bounds.setHigh(k, most)
    return bounds
