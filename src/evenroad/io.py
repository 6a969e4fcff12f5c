"""Plans on disk: JSON of query, result and versions; and paths as CSV."""

from __future__ import annotations

import json
import math
import os
import platform
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import numpy.typing as npt

from evenroad import __version__
from evenroad._arrays import Floats, set_fields
from evenroad._checks import as_file, require_known
from evenroad._files import Json, atomic_write, read_json_file
from evenroad._seal import has_digest, with_digest
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.planning.result import PlanResult, Status
from evenroad.points import Origin
from evenroad.world import World


def plan_record(result: PlanResult, query: Mapping[str, object]) -> dict[str, object]:
    """Return a plan as plain JSON values, in the units of its space.

    Parameters
    ----------
    result : PlanResult
    query : dict
        Options of the query (map, radius, seed, ...), stored under ``query`` with start and goals.  Where they are
        empty, the record has the world itself.

    Returns
    -------
    dict

    Examples
    --------
    >>> import numpy as np
    >>> import evenroad as er
    >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
    >>> result = er.plan(world, (3, 3), (27, 17))
    >>> er.io.plan_record(result, {"radius": 2.0})["status"]
    'solved'
    """
    terminals = {name: getattr(result, name).tolist() for name in ("start", "goal", "goals")}
    paths = {name: getattr(result, name) for name in ("path", "milestone_path")}
    same = [
        "cost",
        "length",
        "milestone_cost",
        "proof",
        "bodies",
        "clearance",
        "nearest",
        "goal_index",
        "planner",
        "rule",
        "links",
        "counts",
        "deviation",
        "notes",
    ]
    return {
        "status": str(result.status),
        "message": result.message,
        "query": {**terminals, **query},
        **{name: None if path is None else path.tolist() for name, path in paths.items()},
        **({} if result.pieces is None else {"pieces": _as_texts(result.pieces)}),
        **{name: getattr(result, name) for name in same},
        "seconds": round(result.seconds, 6),
        "timings": {phase: round(value, 6) for phase, value in result.timings.items()},
        "stages": [asdict(stage) for stage in result.stages],
        "origin": asdict(result.origin),
        **({} if query else {"world": _value_of(result.world)}),
        "versions": versions(),
    }


def save_result(result: PlanResult, path: str | os.PathLike[str]) -> None:
    """See :meth:`PlanResult.save`.

    Parameters
    ----------
    result : PlanResult
    path : str or path-like
        A ``.json``, ``.csv`` or ``.png``.

    Raises
    ------
    UnknownName
        For another suffix.
    InvalidValue
        For a ``.csv`` without a path.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> import evenroad as er
    >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
    >>> result = er.plan(world, (3, 3), (27, 17))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     er.io.save_result(result, f"{folder}/plan.csv")
    """
    suffix = as_file("what a plan is saved to", path).suffix.lower()
    require_known(f"kind of file for a plan, {os.fspath(path)!r}: suffix", suffix, (".json", ".csv", ".png"))
    if suffix == ".png":
        result.plot(path)
    elif suffix == ".json":
        save_json(path, with_digest(plan_record(result, {})))
    elif result.path is None:
        raise InvalidValue(f"there is no path that could be saved: {result.message}")
    else:
        count = result.path.shape[1]
        robot = getattr(result.world, "robot", None)
        poses = count == 2 or result.pieces is not None
        names = ("x", "y", "angle")[:count] if poses else tuple(f"q{i}" for i in range(count))
        save_path_csv(path, result.path, names if robot is None else robot.joint_names)


def load_plan(path: str | os.PathLike[str]) -> tuple[PlanResult, dict[str, Json]]:
    """Return a plan from its file, without its origin and searched graph, and the options of its query.

    Parameters
    ----------
    path : str or path-like
        A ``.json`` of :meth:`PlanResult.save` or ``evenroad plan``.

    Returns
    -------
    tuple of PlanResult and dict

    Raises
    ------
    BrokenFile
        If the file is missing, is no such record, or has the digest of another one.

    Notes
    -----
    Its proof holds in the world in which it was planned; nothing is proved anew.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> import evenroad as er
    >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
    >>> result = er.plan(world, (3, 3), (27, 17))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     result.save(f"{folder}/plan.json")
    ...     er.io.load_plan(f"{folder}/plan.json")[0].solved
    True
    """
    return plan_of(read_json_file(as_file("a plan", path), "plan"), path)


def plan_of(record: object, path: str | os.PathLike[str]) -> tuple[PlanResult, dict[str, Json]]:
    """Return a plan from the record of its file, as :func:`load_plan` does.

    Parameters
    ----------
    record : object
        What the JSON of the file holds.
    path : str or path-like
        The file, for errors.

    Returns
    -------
    tuple of PlanResult and dict

    Raises
    ------
    BrokenFile
        As :func:`load_plan`.

    Examples
    --------
    >>> import json
    >>> import numpy as np
    >>> import evenroad as er
    >>> result = er.plan(er.GridMap(np.zeros((20, 30), dtype=bool)).world(2), (3, 3), (27, 17))
    >>> record = json.loads(json.dumps(er.io.plan_record(result, {"seed": 0})))
    >>> er.io.plan_of(record, "plan.json")[1]["seed"]
    0
    """
    if not isinstance(record, dict) or not {"status", "query", "path"} <= set(record):
        raise BrokenFile(f"{path} is not a plan of evenroad: it must have status, query, path and more")
    has_digest(record, path)
    try:
        query = dict(record["query"])
        start, goals = (np.array(query[name], dtype=np.float64) for name in ("start", "goals"))
        waypoints = None if record["path"] is None else np.array(record["path"], dtype=np.float64)
        if goals.shape != (len(goals), *start.shape) or (waypoints is not None and waypoints.shape[1:] != start.shape):
            raise ValueError("start, goals and path must have the same joints")
        if not all(np.isfinite(each).all() for each in (start, goals, *([] if waypoints is None else [waypoints]))):
            raise ValueError("configurations must be finite")
        index = record["goal_index"]
        if index is not None and (type(index) is not int or not 0 <= index < len(goals)):
            raise ValueError(f"goal_index must be the number of a goal, got {index!r}")
        result = PlanResult(
            status=Status(record["status"]),
            message=str(record["message"]),
            start=start,
            goals=goals,
            path=waypoints,
            pieces=np.array(record["pieces"], dtype=np.float64) if "pieces" in record else None,
            origin=Origin(family="none", method="read from a file"),
            rule=str(record["rule"]),
            goal_index=index,
            proof=record["proof"],
            cost=record["cost"],
            planner=str(record["planner"]),
            timings={str(phase): float(value) for phase, value in record["timings"].items()},
        )
        # A file has no world that could measure them.
        pair = record.get("nearest")
        set_fields(result, nearest=None if pair is None else (str(pair[0]), str(pair[1])))
        set_fields(result, **{name: record.get(name) for name in ("clearance", "length", "bodies")})
        if record.get("world") is not None:
            # Imported late, as below: plans of `evenroad plan` name their files instead.
            from evenroad.saved.world_value import world_of

            set_fields(result, world=world_of(record["world"], path))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        why = f"it lacks {error}" if isinstance(error, KeyError) else str(error)
        raise BrokenFile(f"{path} is not a plan of evenroad: {why}") from error
    return result, query


def _value_of(world: World | None) -> dict[str, Json] | None:
    from evenroad.saved.world_value import value_of

    return value_of(world)


def _as_texts(pieces: Floats) -> list[list[float | str]]:
    """Return the pieces of a car as JSON has them: an infinite curvature is the text "inf" or "-inf"."""
    return [[each if math.isfinite(each) else str(each) for each in row] for row in pieces.tolist()]


def versions() -> dict[str, str]:
    """Return the versions of evenroad, Python and the numerical libraries."""
    python = platform.python_version()
    return {"evenroad": __version__, "python": python, "numpy": np.__version__, "scipy": _version_of_scipy()}


def _version_of_scipy() -> str:
    """Return SciPy's version, by the folder that says what is installed: a plan of an arm loads no SciPy."""
    found = find_spec("scipy")
    if "scipy" not in sys.modules and found is not None and found.origin is not None:
        said = list(Path(found.origin).parent.parent.glob("scipy-*.dist-info"))
        if len(said) == 1:
            return said[0].stem.partition("-")[2]
    import scipy

    version: str = scipy.__version__
    return version


def save_json(path: str | os.PathLike[str], record: Mapping[str, object]) -> None:
    """Write a record as indented UTF-8 JSON, atomically; NaN and infinity are refused.

    Parameters
    ----------
    path : str or path-like
    record : dict
        Of plain JSON values.

    Raises
    ------
    BrokenFile
        If the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> import evenroad as er
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     er.io.save_json(f"{folder}/versions.json", er.io.versions())
    """
    text = json.dumps(record, indent=2, allow_nan=False) + "\n"
    with atomic_write(path) as file:
        file.write(text.encode())


def save_path_csv(path: str | os.PathLike[str], waypoints: npt.ArrayLike, names: Sequence[str]) -> None:
    """Write waypoints under a header of column names, atomically; floats round-trip.

    Parameters
    ----------
    path : str or path-like
    waypoints : array_like, shape (p, dim)
    names : sequence of dim str

    Raises
    ------
    BrokenFile
        If the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> import evenroad as er
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     er.io.save_path_csv(f"{folder}/path.csv", [(0, 0), (1, 2)], ("x", "y"))
    """
    rows = [names, *(map(repr, row) for row in np.asarray(waypoints, dtype=float).tolist())]
    with atomic_write(path) as file:
        file.write("".join(",".join(row) + "\n" for row in rows).encode())
