"""Many tests at once: Holm's correction."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue


def holm(p_values: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return p-values corrected so that all of a family may be read at one level.

    The i-th smallest of m (from 0) is multiplied by m - i; none falls below a smaller one's, none exceeds 1.

    Parameters
    ----------
    p_values : array_like, shape (m,)
        In [0, 1]; m may be 0.

    Raises
    ------
    InvalidValue
        If a value is not in [0, 1] (NaN included).

    References
    ----------
    S. Holm (1979), A simple sequentially rejective multiple test procedure, Scand. J. Stat. 6, 65-70.
    """
    values = np.asarray(p_values, dtype=np.float64)
    if values.ndim != 1 or not np.all((values >= 0) & (values <= 1)):
        raise InvalidValue(f"p-values must be a list of numbers in [0, 1], got {p_values!r}")
    order = np.argsort(values, kind="stable")
    steps = values[order] * np.arange(len(values), 0, -1)
    corrected = np.empty_like(values)
    corrected[order] = np.minimum(1.0, np.maximum.accumulate(steps))
    return corrected
