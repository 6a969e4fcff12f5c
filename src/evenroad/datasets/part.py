"""One part of a data set: the bytes of a file of queries with their paths and trajectories."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from io import BytesIO
from typing import Any, Literal, TypeAlias

import numpy as np

from evenroad import __version__
from evenroad._arrays import Floats, Ints
from evenroad._checks import require_extra
from evenroad.collision.arm_world import ArmWorld
from evenroad.datasets.queries import Queries, draw_queries
from evenroad.errors import EvenroadError
from evenroad.planning.connectors import RESTART
from evenroad.planning.many import by_compiled_code
from evenroad.roadmap import Budget
from evenroad.trajectory.arm import arm_trajectory

STATES = 64
"""Number of states of a trajectory that are kept, evenly in time."""

ArrowArray: TypeAlias = Any
"""An array of pyarrow, which has no types."""
Format = Literal["parquet", "hdf5"]
Array: TypeAlias = np.ndarray[tuple[int, ...], np.dtype[np.generic]]


@dataclass(frozen=True)
class Request:
    """Request for a set; it decides about every byte of each part."""

    robot: str
    sources: tuple[str, ...]
    count: int
    seed: int = 0
    rows: int = 1000
    """Number of problems of a part."""
    of_each: int = 16
    """Number of queries in one scene."""
    format: Format = "parquet"
    motions: int = RESTART
    """Largest number of motions that trees check for one query, in place of a time limit."""

    @property
    def parts(self) -> int:
        """Number of parts."""
        return -(-self.count // self.rows)

    def name(self, part: int) -> str:
        """Return the name of the file of a part."""
        return f"part-{part:06d}.{'parquet' if self.format == 'parquet' else 'h5'}"

    def values(self) -> dict[str, object]:
        """Return the request as plain values, for the card."""
        return {**asdict(self), "sources": list(self.sources), "states": STATES, "evenroad": __version__}


def make_part(request: Request, part: int) -> bytes:
    """Return the file of a part, made in one thread."""
    rows = min(request.rows, request.count - part * request.rows)
    queries = draw_queries(request.robot, request.sources, request.seed, part, rows, request.of_each)
    terminals = np.stack([queries.starts, queries.goals], axis=1)
    of, budget = np.array(queries.scene_of), Budget(motions=request.motions)
    # er.plan_many would go on with hard queries: that takes seven times as long, for hardly a path more.
    found = by_compiled_code(list(queries.worlds), of, terminals, budget, True, 0, 1, lambda done: None)
    counts = np.zeros(rows, dtype=np.int64)
    counts[found.rows] = found.counts
    offsets, cost = np.concatenate([[0], np.cumsum(counts)]), np.full(rows, np.nan)
    cost[found.rows] = found.lengths
    durations, states = np.full(rows, np.nan), np.zeros((rows, STATES, queries.starts.shape[1]), dtype=np.float32)
    for row in found.rows.tolist():
        path = found.waypoints[offsets[row] : offsets[row + 1]]
        durations[row], states[row] = timed(queries.worlds[of[row]], path)
    columns: dict[str, Array] = {
        "solved": counts > 0,
        "cost": cost,
        "duration": durations,
        "start": queries.starts,
        "goal": queries.goals,
        "states": states,
    }
    write = _parquet if request.format == "parquet" else _hdf5
    return write(columns, found.waypoints, offsets, queries)


def timed(world: ArmWorld, path: Floats) -> tuple[float, Floats]:
    """Return the duration of a path [s], NaN where it has no times, and states at even times, (STATES, dim)."""
    if np.abs(path - path[0]).max() < 1e-9:
        return 0.0, np.repeat(path[:1], STATES, axis=0)
    try:
        trajectory = arm_trajectory(world, path)
    except EvenroadError:
        # Some corner has no proof: the path stays.
        return np.nan, np.zeros((STATES, path.shape[1]))
    at = np.linspace(0.0, trajectory.duration, STATES)
    columns = [np.interp(at, trajectory.times, column) for column in trajectory.positions.T]
    return float(trajectory.duration), np.stack(columns, axis=1)


def _parquet(columns: dict[str, Array], waypoints: Floats, offsets: Ints, queries: Queries) -> bytes:
    arrow = require_extra("pyarrow", "parquet", "a data set")
    parquet = require_extra("pyarrow.parquet", "parquet", "a data set")

    def nested(array: Array) -> ArrowArray:
        if array.ndim == 1:
            return arrow.array(array)
        return arrow.FixedSizeListArray.from_arrays(nested(array.reshape(-1, *array.shape[2:])), array.shape[1])

    table: dict[str, ArrowArray] = {name: nested(each) for name, each in columns.items()}
    table["path"] = arrow.ListArray.from_arrays(arrow.array(offsets.astype(np.int32)), nested(waypoints))
    scene_of = arrow.array(np.array(queries.scene_of, dtype=np.int32))
    table["scene"] = arrow.DictionaryArray.from_arrays(scene_of, arrow.array(queries.scenes))
    file = BytesIO()
    parquet.write_table(arrow.table(table), file, compression="zstd")
    return file.getvalue()


def _hdf5(columns: dict[str, Array], waypoints: Floats, offsets: Ints, queries: Queries) -> bytes:
    h5py = require_extra("h5py", "hdf5", "a data set in HDF5")
    file = BytesIO()
    arrays: dict[str, Array | list[str]] = {
        **columns,
        "waypoints": waypoints,
        "offsets": offsets,
        "scene_of": np.array(queries.scene_of),
        "scenes": list(queries.scenes),
    }
    with h5py.File(file, "w", track_order=True) as written:
        for name, values in arrays.items():
            kind = {"dtype": h5py.string_dtype()} if isinstance(values, list) else {}
            written.create_dataset(name, data=values, track_times=False, **kind)
    return file.getvalue()
