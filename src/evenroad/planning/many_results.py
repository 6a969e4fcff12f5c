"""PlanResults: the answers to many queries, as columns."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, Ints
from evenroad._call import explains_calls
from evenroad._checks import counted, require_extra
from evenroad._files import atomic_write
from evenroad._native.planning import Answer
from evenroad._threads import in_order
from evenroad.errors import InvalidValue
from evenroad.planning.result import PlanResult, Status
from evenroad.world import MeasuresPaths, World


@explains_calls
@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class PlanResults:
    """The answers to m queries, one row each.

    Attributes
    ----------
    status : ndarray, shape (m,)
        Of :class:`evenroad.Status`, which equal their texts: ``results.status == "solved"``.
    cost : float64 ndarray, shape (m,)
        Lengths of the paths in the metric of the space; NaN without a path.
    waypoints : float64 ndarray, shape (k, dim)
        Waypoints of all paths, in the order of queries.
    offsets : int64 ndarray, shape (m + 1,)
        Path i has the waypoints from row ``offsets[i]`` to below ``offsets[i + 1]``.
    seconds : float64 ndarray, shape (m,)
        Wall time of each query [s].
    messages : mapping of int to str
        Row -> why there is no path, and what to try.
    pieces : mapping of int to ndarray, shape (k, 2)
        Row -> the pieces that a car drives, as :attr:`PlanResult.pieces`.
    worlds : tuple of World
        The different worlds.
    world_of : int64 ndarray, shape (m,)
        Number of the world of each query.

    Examples
    --------
    >>> import evenroad as er
    >>> world = er.ArmWorld("ur5", "box-reach")
    >>> home = world.robot.configuration("home")
    >>> results = er.plan_many(world, [home], [(0.5, -1.57, 0, -1.57, 0, 0)])
    >>> results.cost.round(2), results.path(0).shape
    (array([0.5]), (2, 6))
    """

    status: npt.NDArray[np.object_]
    cost: Floats
    waypoints: Floats
    offsets: Ints
    seconds: Floats
    messages: Mapping[int, str] = field(default_factory=dict)
    pieces: Mapping[int, Floats] = field(default_factory=dict)
    worlds: tuple[World, ...] = ()
    world_of: Ints

    def __len__(self) -> int:
        return len(self.status)

    def __repr__(self) -> str:
        each = ", ".join(f"{number} {status}" for status, number in Counter(self.status.tolist()).most_common())
        return f"PlanResults({counted(len(self), 'query').replace('querys', 'queries')}{each and ': '}{each})"

    @property
    def solved(self) -> Bools:
        """Which queries have a path, (m,)."""
        return np.diff(self.offsets) > 0

    def path(self, row: int) -> Floats | None:
        """Return the path of a query.

        Parameters
        ----------
        row : int
            Row of the query; a negative one counts from the end.

        Returns
        -------
        ndarray, shape (p, dim), or None

        Raises
        ------
        InvalidValue
            If there is no such row.

        Examples
        --------
        >>> import evenroad as er
        >>> world = er.ArmWorld("ur5", "box-reach")
        >>> home = world.robot.configuration("home")
        >>> er.plan_many(world, [home], [home]).path(0).shape
        (2, 6)
        """
        if not -len(self) <= row < len(self):
            raise InvalidValue(f"row must be one of {counted(len(self), 'query')}, got {row!r}")
        begin, end = self.offsets[row % len(self)], self.offsets[row % len(self) + 1]
        return self.waypoints[begin:end] if end > begin else None

    @cached_property
    def clearance(self) -> Floats:
        """Lower bound of each path's distance from all obstacles, (m,), as :attr:`PlanResult.clearance`; else NaN.

        It is computed on first use, on all processors; for arms this takes some milliseconds per path.
        """
        clearance = np.full(len(self), np.nan)

        def measured(row: int) -> float | None:
            world, path = self.worlds[self.world_of[row]], self.path(row)
            return world.path_clearance(path) if isinstance(world, MeasuresPaths) and path is not None else None

        rows = np.flatnonzero(self.solved).tolist()
        for row, found in zip(rows, in_order(measured, ((row,) for row in rows)), strict=True):
            clearance[row] = np.nan if found is None else found
        clearance.setflags(write=False)
        return clearance

    def to_parquet(self, file: str | os.PathLike[str]) -> None:
        """Write one row per query: ``status``, ``cost``, ``seconds``, ``message``, and ``path``, a list of lists.

        Parameters
        ----------
        file : str or path-like

        Raises
        ------
        NotAvailable
            Without the extra ``parquet``.
        BrokenFile
            If the file cannot be written.

        Examples
        --------
        >>> import evenroad as er
        >>> world = er.ArmWorld("ur5", "box-reach")
        >>> home = world.robot.configuration("home")
        >>> er.plan_many(world, [home], [home]).to_parquet("plans.parquet")  # doctest: +SKIP
        """
        arrow = require_extra("pyarrow", "parquet", "to_parquet")
        parquet = require_extra("pyarrow.parquet", "parquet", "to_parquet")
        waypoints = arrow.FixedSizeListArray.from_arrays(arrow.array(self.waypoints.ravel()), self.waypoints.shape[1])
        columns: dict[str, object] = {
            "status": [str(status) for status in self.status],
            "cost": self.cost,
            "seconds": self.seconds,
            "message": [self.messages.get(row, "") for row in range(len(self))],
            "path": arrow.LargeListArray.from_arrays(self.offsets, waypoints),
        }
        with atomic_write(file) as stream:
            parquet.write_table(arrow.table(columns), stream)


class Part(NamedTuple):
    """Queries with paths: their rows, the number of waypoints of each path, the waypoints, lengths and times.

    `pathless`, row -> answer, are queries without a path, for which planning continues.
    """

    rows: Ints
    counts: Ints
    waypoints: Floats
    lengths: Floats
    seconds: Floats
    pathless: dict[int, Answer]


def joined(
    worlds: tuple[World, ...], of: Ints, dim: int, part: Part, rest: Ints, results: list[PlanResult]
) -> PlanResults:
    """Return the answers of a part, and the results of the rest, as columns."""
    count = len(part.rows) + len(rest)
    status = np.full(count, Status.SOLVED, dtype=object)
    cost, seconds, counts = np.full(count, np.nan), np.zeros(count), np.zeros(count, dtype=np.int64)
    cost[part.rows], seconds[part.rows], counts[part.rows] = part.lengths, part.seconds, part.counts
    paths = [np.empty((0, dim)) if result.path is None else result.path for result in results]
    for row, result, path in zip(rest.tolist(), results, paths, strict=True):
        status[row], seconds[row], counts[row] = result.status, result.seconds, len(path)
        cost[row] = np.nan if result.cost is None else result.cost
    is_rest = np.zeros(count, dtype=bool)
    is_rest[rest] = True
    of_rest = np.repeat(is_rest, counts)
    waypoints = np.empty((len(of_rest), dim))
    waypoints[~of_rest] = part.waypoints
    waypoints[of_rest] = np.concatenate([np.empty((0, dim)), *paths])
    offsets = np.concatenate([[0], np.cumsum(counts)])
    for column in (status, cost, waypoints, offsets, seconds, of):
        column.setflags(write=False)
    why = {row: result.message for row, result in zip(rest.tolist(), results, strict=True) if result.path is None}
    return PlanResults(
        status=status,
        cost=cost,
        waypoints=waypoints,
        offsets=offsets,
        seconds=seconds,
        messages=why,
        pieces={row: each.pieces for row, each in zip(rest.tolist(), results, strict=True) if each.pieces is not None},
        worlds=worlds,
        world_of=of,
    )
