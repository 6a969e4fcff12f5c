"""FunctionWorld: a world made from a user's function."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, cast

import numpy as np

from evenroad._arrays import Bools, Floats, Ints, set_fields
from evenroad._call import explains_calls
from evenroad._checks import as_row, counted, require_positive
from evenroad._fingerprint import fingerprint_of
from evenroad._time_limit import Pace, in_time, look_at_clock
from evenroad.errors import InvalidValue, NotAvailable, shown
from evenroad.space import BoxSpace, Product, Space
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.space.protocol import all_distances, wrapped
from evenroad.world.bisection import MOST_SEGMENTS, between_endpoints, require_few_segments
from evenroad.world.one_or_many import OneOrMany, one_or_many

OUTSIDE = "it lies outside the bounds of the space"
"""Reason given for a configuration outside the space."""
ONE_BY_ONE = "called with one configuration at a time: from (n, dim) to (n,) it would be called once per batch"
"""Note on a function that takes one configuration."""
SHARE_OF_EXTENT = 0.01
"""Default resolution, as a share of the extent of the space."""
FINER = 20
"""Factor by which `FunctionWorld.validate` checks states more densely."""


@explains_calls
@dataclass(frozen=True, eq=False, repr=False)
class FunctionWorld(OneOrMany):
    """A world of a user's function that says which configurations are free; motions are tested at close states.

    A motion is divided into ``n = ceil(distance / resolution)`` equal segments, and is free if all n + 1 states are:
    those of OMPL's DiscreteMotionValidator, and the first.  Nothing between two states is checked, so choose a
    resolution that is small compared with the thinnest obstacle.  Endpoints come first, then halves, quarters and so on
    (van der Corput's order), for all motions of a batch together.  A vectorised function is thus called few times, with
    many states.  The final path is checked at more states (`validate`), because shortcutting would find the gaps.

    Parameters
    ----------
    space : Space, or a sequence of (low, high)
        The space of the configurations.  Outside it nothing is free, and the function is not called.  Bounds, one pair
        per coordinate, mean a BoxSpace.
    is_valid : callable
        A function from configurations, a read-only float64 (n, dim) array, to a bool array (n,); or from one
        configuration (dim,) to a bool, which costs one call each.  Equal configurations must get equal answers.
    resolution : float, or a sequence of floats for a Product, optional
        The largest distance between neighbouring states, > 0, in the space's metric.  Several numbers are one for each
        part in the part's own metric; n is then the largest of all parts.  Default: a hundredth of the space's extent,
        which is the largest distance between 65 configurations spread over the space.
    vectorised : bool, optional
        Whether `is_valid` takes many configurations at once.  Default: it is called with many first, and one by one if
        that fails.
    name : str, optional
        Name for the world's fingerprint. It must include everything that the function's results depend on, such as
        ``"cell 7, tool v2"``.

    Raises
    ------
    InvalidValue
        If `is_valid` cannot be called, or `resolution` is not of that kind.

    Examples
    --------
    >>> import numpy as np
    >>> import evenroad as er
    >>> def free(q):
    ...     return np.hypot(q[..., 0], q[..., 1]) > 0.5
    >>> er.FunctionWorld([(-2, 2), (-2, 2)], free, resolution=0.02).valid((1, 1))
    True
    """

    proof: ClassVar[str] = "resolution"
    """The kind of proof of a motion: a function says nothing about configurations between two states."""

    space: Space
    is_valid: Callable[[Floats], object]
    resolution: float | Sequence[float] | None = None
    vectorised: bool | None = None
    name: str | None = None
    _pace: Pace = field(default_factory=Pace, init=False, repr=False)

    def __post_init__(self) -> None:
        if not callable(self.is_valid):
            raise InvalidValue(f"is_valid must be a function, got {self.is_valid!r}")
        set_fields(self, space=_as_space(self.space))
        set_fields(self, resolution=_as_resolution(self.resolution, self.space))

    def __repr__(self) -> str:
        slow = "" if self.vectorised is not False else f"; {ONE_BY_ONE}"
        what = f"{self._name}, {counted(self.dim, 'coordinate')}, resolution {self.resolution}"
        return f"FunctionWorld({what}{slow})"

    @one_or_many
    def valid(self, q: Floats) -> Bools:
        """Return which configurations, (n, dim), the space contains and the function calls free: (n,).

        For one configuration, (dim,), it is a bool; likewise for `motion_valid`.  Raises InvalidValue if `q` is no such
        batch, or the function's answer is not of the kind described above.
        """
        batch = wrapped(self.space, as_batch("q", q, self.space.dim))
        free = self.space.contains(batch)
        inside = np.flatnonzero(free)
        self._clear_blocked(free, inside, batch[inside])
        return free

    @one_or_many
    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return which motions, from each row of `a` to that of `b`, two (m, dim) arrays, are free: (m,).

        Raises the errors of `valid`, and InvalidValue if the two differ in length, or a motion has over 2^30 states.
        """
        return self._motions_free(*as_batch_pair(a, b, self.space.dim), finer=1)

    def validate(self, path: Floats) -> Bools:
        """Return which motions of a path, (p, dim), are free at a twentieth of the resolution: (p - 1,)."""
        waypoints = as_batch("path", path, self.space.dim)
        return self._motions_free(waypoints[:-1], waypoints[1:], finer=FINER)

    def _motions_free(self, first: Floats, second: Floats, finer: int) -> Bools:
        """Return which motions are free at states `finer` times as dense as the resolution."""
        # A function need not handle angles of more than one turn.
        first, second = wrapped(self.space, first), wrapped(self.space, second)
        free = self.valid(first)
        free[free] = self.valid(second[free])
        segments = np.zeros(len(free), dtype=np.int64)
        segments[free] = np.minimum(finer * self._segments(first[free], second[free]), MOST_SEGMENTS)
        start, end = _in_fixed_order(first, second)
        for motion, state in between_endpoints(segments, free):
            fraction = state / segments[motion]
            states = self.space.interpolate(start[motion], end[motion], fraction)
            self._clear_blocked(free, motion, states)
        return free

    def fingerprint(self) -> str:
        """Return a text that is equal for worlds of the same space, resolution and name.

        Raises
        ------
        NotAvailable
            If the world has no name, or its space no fingerprint.
        """
        if self.name is None:
            raise NotAvailable("a FunctionWorld has a fingerprint only with a name, such as name='cell 7'")
        return fingerprint_of("function", self.name, self.space, self.resolution)

    def explain(self, q: Floats) -> str:
        """Return in words why one configuration, (dim,), is not free."""
        if not self.space.contains(self._row(q)[np.newaxis])[0]:
            return OUTSIDE
        slow = "" if self.vectorised is not False else f" ({ONE_BY_ONE})"
        return f"{self._name} does not call it free{slow}"

    @property
    def _name(self) -> str:
        return getattr(self.is_valid, "__name__", repr(self.is_valid))

    def _segments(self, a: Floats, b: Floats) -> Ints:
        if isinstance(self.resolution, float):
            segments = np.ceil(self.space.distance(a, b) / self.resolution)
        else:
            assert isinstance(self.space, Product)  # as __post_init__ has seen to
            lengths = np.column_stack(self.space.part_distances(a, b))
            segments = np.ceil(lengths / np.array(self.resolution)).max(axis=1)
        require_few_segments(self.resolution, segments.max(initial=0.0))
        return segments.astype(np.int64)

    def _clear_blocked(self, free: Bools, owner: Ints, states: Floats) -> None:
        """Set ``free[owner[i]]`` to False for every state i that the function does not call free."""
        if len(states) == 0:
            return
        states = states.view()
        states.setflags(write=False)
        if self.vectorised is None:
            set_fields(self, vectorised=self._takes_many(states))
        if self.vectorised:
            for rows in in_time(np.arange(len(states)), self._pace):
                some = slice(rows[0], rows[-1] + 1)
                free[owner[some][~self._evaluate(states[some])]] = False
            return
        for i, state in zip(owner, states, strict=True):
            if free[i]:
                look_at_clock()
                free[i] = self._evaluate_one(state)

    def _takes_many(self, states: Floats) -> bool:
        """Return whether the function takes many configurations at once; True if it fails either way."""
        # With as many rows as columns, a function of one row that compares columns would look right.
        rows = np.repeat(states[:1], self.space.dim + 1, axis=0)
        rows.setflags(write=False)
        try:
            answer = np.asarray(self.is_valid(rows))
            if answer.shape == (len(rows),) and answer.dtype == np.bool_:
                return True
        except Exception:
            pass
        look_at_clock()
        try:
            return not isinstance(self.is_valid(states[0]), bool | np.bool_)
        except Exception:
            return True

    def _evaluate(self, states: Floats) -> Bools:
        answer = np.asarray(self.is_valid(states))
        if answer.shape != (len(states),) or answer.dtype != np.bool_:
            raise InvalidValue(
                f"{self._name} must return a bool array of shape ({len(states)},) for"
                f" configurations of shape {states.shape}, got {answer.dtype} of shape {answer.shape};"
                " pass vectorised=False if it takes one configuration at a time"
            )
        return answer

    def _evaluate_one(self, state: Floats) -> bool:
        answer = self.is_valid(state)
        if not isinstance(answer, bool | np.bool_):
            raise InvalidValue(f"{self._name} must return a bool for one configuration, got {answer!r}")
        return bool(answer)


class TestedAtStates(OneOrMany):
    """Base of worlds that test motions as :class:`FunctionWorld` does; a subclass sets `_states`."""

    _states: FunctionWorld

    @one_or_many
    def valid(self, q: Floats) -> Bools:
        """Return which configurations, (n, dim), lie in the space and are free: (n,)."""
        return self._states.valid(q)

    @one_or_many
    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return which motions, two (m, dim) arrays, are free at all states: (m,)."""
        return self._states.motion_valid(a, b)


def _as_space(space: object) -> Space:
    """Return a space, or the box of bounds (low, high), one pair a coordinate."""
    if hasattr(space, "from_cube"):
        return cast(Space, space)
    try:
        low, high = np.asarray(space, dtype=np.float64).reshape(-1, 2).T.tolist()
    except (TypeError, ValueError):
        raise InvalidValue(
            f"space must be a Space, such as BoxSpace(low, high), or a list of (low, high), got {shown(space)}"
        ) from None
    return BoxSpace(low, high)


def _as_resolution(resolution: object, space: Space) -> float | tuple[float, ...]:
    if resolution is None:
        return SHARE_OF_EXTENT * _extent(space)
    if not isinstance(resolution, Sequence | np.ndarray) or isinstance(resolution, str):
        return require_positive("resolution", resolution)
    if not isinstance(space, Product):
        raise InvalidValue(f"resolution must be one number unless the space is a Product, got {resolution!r}")
    row = as_row("resolution", list(np.atleast_1d(resolution)), len(space.parts))
    for value in row:
        require_positive("resolution", value)
    return row


def _extent(space: Space) -> float:
    """Return the largest distance between configurations that are spread over a space, including its corners."""
    steps = 2.0 ** (np.arange(1, space.cube_dim + 1) / (space.cube_dim + 1))
    last = np.full((1, space.cube_dim), np.nextafter(1.0, 0.0))
    q = space.from_cube(np.vstack([np.arange(64)[:, np.newaxis] * steps % 1.0, last]))
    return float(all_distances(space, q, q).max())


def _in_fixed_order(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Return the endpoints with the smaller (in dictionary order) first.

    States are rounded, so without a fixed order a motion and its reverse could differ.
    """
    first_difference = (a != b).argmax(axis=1)[:, np.newaxis]
    swap = np.take_along_axis(a, first_difference, axis=1) > np.take_along_axis(b, first_difference, axis=1)
    return np.where(swap, b, a), np.where(swap, a, b)
