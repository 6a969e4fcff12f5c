"""The loss: an objective of every set from the compiled kernels, with its gradient handed to torch.

The kernels run on the CPU in float64 wherever the network runs: 16 sets of 1024 points in d = 10 are 1.3 MB to hand
over, and every measure and energy is there without being written a second time.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from torch.autograd.function import once_differentiable

from evenroad.errors import InvalidValue
from evenroad.points.optimise.objective import Objective, objective_of_columns


def objective_of_sets(points: torch.Tensor, objective: Objective) -> torch.Tensor:
    """Return the objective of every set, differentiable once.

    Parameters
    ----------
    points : Tensor of float64, shape (sets, n, d)
        In [0, 1), on any device.
    objective : Objective
        Any that ``points.optimise`` knows.

    Returns
    -------
    Tensor of float64, shape (sets,)
        On the device of the points.

    Raises
    ------
    InvalidValue
        If a point, a value or a gradient is not finite: the training has diverged.
    """
    return _ObjectiveOfSets.apply(points, objective)


class _ObjectiveOfSets(torch.autograd.Function):
    """The bridge: the gradient comes with the value, so it is computed forward and kept for backward."""

    @staticmethod
    def forward(ctx: Any, points: torch.Tensor, objective: Objective) -> torch.Tensor:
        given = points.detach().cpu().numpy()
        _require_finite("the network's points", given)  # before the kernels: their fastmath knows no NaN
        values, gradient = np.empty(len(given)), np.empty_like(given)
        for index, each in enumerate(given):
            values[index], by_columns = objective_of_columns(objective, np.ascontiguousarray(each.T))
            gradient[index] = by_columns.T
        _require_finite(f"the objective '{objective}'", values)
        _require_finite(f"the gradient of '{objective}'", gradient)
        ctx.save_for_backward(torch.from_numpy(gradient).to(points.device))
        return torch.from_numpy(values).to(points.device)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, slope: torch.Tensor) -> tuple[torch.Tensor, None]:
        (gradient,) = ctx.saved_tensors
        return slope[:, None, None] * gradient, None


def _require_finite(what: str, values: np.ndarray) -> None:
    if not np.isfinite(values).all():
        raise InvalidValue(f"{what} became infinite or NaN: the training diverged; use a smaller rate")
