"""Checks that take one configuration or many, with one answer or as many."""

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
        # A property for real would be taken for the default of a dataclass's field.
        @property
        def space(self) -> Space: ...  # noqa: D102

    @property
    def dim(self) -> int:
        """How many numbers a configuration has."""
        return self.space.dim

    def _row(self, q: Any) -> Floats:
        """Return one configuration as numbers, (dim,)."""
        try:
            return np.asarray(q, dtype=np.float64)
        except (TypeError, ValueError):
            raise InvalidValue(f"a configuration must be {self.dim} finite numbers, got {shown(q)}") from None


def one_or_many(check: Check) -> Check:
    """Return a check that answers one bool or number for one configuration, (dim,), or one motion between two."""
    check = explains_calls(check)

    @wraps(check)
    def checked(self: OneOrMany, *q: Any, **named: Any) -> Any:
        if not (q and all(map(_is_one, q))):
            return check(self, *q, **named)
        rows = [self._row(each)[np.newaxis] for each in q]
        return check(self, *rows, **named)[0].item()

    return checked  # type: ignore[return-value]


def _is_one(q: Any) -> bool:
    if isinstance(q, np.ndarray):
        return q.ndim == 1
    if isinstance(q, list | tuple):
        return len(q) > 0 and all(isinstance(each, int | float | np.number) for each in q)
    return isinstance(q, str | Mapping)
