"""Checks that take one configuration or many."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import wraps
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from evenroad._arrays import Floats
from evenroad._call import explains_calls
from evenroad.errors import InvalidValue, shown
from evenroad.space import Space

Check = TypeVar("Check", bound=Callable[..., Any])


class OneOrMany:
    """Base of worlds whose checks, marked by `one_or_many`, take one configuration, too."""

    if TYPE_CHECKING:
        # A real property would become the default of a dataclass's field.
        @property
        def space(self) -> Space: ...  # noqa: D102

    @property
    def dim(self) -> int:
        """Number of values in a configuration."""
        return self.space.dim

    def valid(self, q: Any) -> Any:
        """Return which configurations are free.

        Parameters
        ----------
        q : array_like, shape (n, dim) or (dim,)
            Configurations in the units of the space; for an arm one may also be a mapping or the name of a state.

        Returns
        -------
        bool ndarray, shape (n,), or bool

        Raises
        ------
        InvalidValue
            If `q` is not of that kind, or not finite.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(radius=2)
        >>> world.valid([(1, 1), (5, 5)]).tolist()
        [False, True]
        """
        raise NotImplementedError

    def in_collision(self, q: Any) -> Any:
        """Return which configurations are not free: the opposite of :meth:`valid`, so also those outside of limits.

        Parameters
        ----------
        q : array_like, shape (n, dim) or (dim,)
            As for :meth:`valid`.

        Returns
        -------
        bool ndarray, shape (n,), or bool

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(radius=2)
        >>> world.in_collision((1, 1))
        True
        """
        free = self.valid(q)
        return ~free if isinstance(free, np.ndarray) else not free

    def motion_valid(self, a: Any, b: Any) -> Any:
        """Return which motions are free: shortest interpolations from each row of `a` to that of `b`.

        Parameters
        ----------
        a, b : array_like, shape (m, dim) or (dim,)
            As for :meth:`valid`.

        Returns
        -------
        bool ndarray, shape (m,), or bool

        Raises
        ------
        InvalidValue
            If `a` or `b` is not of that kind, or they differ in length.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(radius=2)
        >>> world.motion_valid((5, 5), (25, 15))
        True
        """
        raise NotImplementedError

    def explain(self, q: Any) -> str:
        """Return in words why a configuration is not free.

        Parameters
        ----------
        q : array_like, shape (dim,)
            As for :meth:`valid`.

        Returns
        -------
        str

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(radius=2)
        >>> world.explain((1, 5))
        'the obstacle at (0, 5) is 1 away, the disk needs 2; the nearest free position is (2, 5)'
        """
        raise NotImplementedError

    def _row(self, q: object) -> Floats:
        """Return one configuration as numbers, (dim,)."""
        try:
            return np.asarray(q, dtype=np.float64)
        except (TypeError, ValueError):
            raise InvalidValue(f"a configuration must be {self.dim} finite numbers, got {shown(q)}") from None


def one_or_many(check: Check) -> Check:
    """Return a check that gives one bool or number for one configuration, (dim,), or for one motion between two."""
    check = explains_calls(check)

    @wraps(check)
    def checked(self: OneOrMany, *q: object, **named: object) -> object:
        if not (q and all(map(is_one, q))):
            return check(self, *q, **named)
        rows = [self._row(each)[np.newaxis] for each in q]
        return check(self, *rows, **named)[0].item()

    return checked  # type: ignore[return-value]


def is_one(q: object) -> bool:
    """Return whether this is one configuration, and not many."""
    if isinstance(q, np.ndarray):
        return q.ndim == 1
    if isinstance(q, list | tuple):
        return len(q) > 0 and all(isinstance(each, int | float | np.number) for each in q)
    return isinstance(q, str | Mapping)
