"""Start and goal: reading them, and saying why they will not do."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue
from evenroad.points.pointset import PointSet
from evenroad.roadmap.result import Status
from evenroad.space import Space
from evenroad.world import Explains, World


def read_ends(start: npt.ArrayLike, goal: npt.ArrayLike, dim: int) -> npt.NDArray[np.float64]:
    """Return start and goal as two rows, or raise InvalidValue unless each is `dim` finite numbers."""
    rows = []
    for name, value in (("start", start), ("goal", goal)):
        try:
            row = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            row = np.empty(0)
        if row.shape != (dim,) or not np.isfinite(row).all():
            raise InvalidValue(f"{name} must be {dim} finite numbers, got {value!r}")
        rows.append(row)
    return np.stack(rows)


def require_fitting(points: PointSet, space: Space) -> None:
    """Raise InvalidValue unless the points have the dimension of the space's cube."""
    if points.d != space.cube_dim:
        raise InvalidValue(f"the points have d={points.d}, the space has {space.cube_dim} dimensions")


def end_in_collision(
    free: npt.NDArray[np.bool_], ends: npt.NDArray[np.float64], world: World
) -> dict[str, Any]:
    """Return status and message for two ends of which at least one is not free."""
    end, name, status = (1, "goal", Status.GOAL_INVALID) if free[0] else (0, "start", Status.START_INVALID)
    reason = f": {world.explain(ends[end])}" if isinstance(world, Explains) else ""
    return {"status": status, "message": f"the {name} is in collision{reason}"}
