"""Files of roadmaps: .npz with a digest, checked on load."""

from __future__ import annotations

import json
from dataclasses import asdict

import numpy as np

from evenroad import __version__
from evenroad._npz import Arrays, Path, digest, read_npz, require_array, write_npz
from evenroad.errors import BrokenFile, EvenroadError
from evenroad.points.npz import points_of
from evenroad.roadmap.point_roadmap import PointRoadmap
from evenroad.roadmap.rules import rule_named

FORMAT = 4
OF_ALL: set[str] = {"format", "version", "milestones", "edges", "digest"}
_OF_POINTS = OF_ALL | {"points", "origin", "rule", "lengths"}


def save_point_roadmap(path: Path, roadmap: PointRoadmap) -> None:
    """Write a roadmap of points."""
    write_roadmap(
        path,
        dict(
            milestones=roadmap.milestones,
            edges=roadmap.edges,
            points=roadmap.points.points,
            origin=np.array(json.dumps(asdict(roadmap.points.origin))),
            rule=np.array(str(roadmap.rule)),
            lengths=roadmap.lengths,
        ),
    )


def write_roadmap(path: Path, arrays: Arrays) -> None:
    """Write the arrays of a roadmap with its format and digest, atomically.

    Raises BrokenFile if the file cannot be written; an earlier file at `path` is then untouched.
    """
    arrays = arrays | {"format": np.array(FORMAT), "version": np.array(__version__)}
    write_npz(path, arrays | {"digest": np.array(digest(arrays))}, compressed=True)


def read_roadmap(path: Path, *others: set[str]) -> Arrays:
    """Read the arrays of a roadmap of points, or of one with other names; raises BrokenFile for anything else."""
    arrays = read_npz(path, "roadmap", _OF_POINTS, *others)
    expected = str(arrays.pop("digest"))
    if digest(arrays) != expected:
        raise BrokenFile(f"{path}: its content does not match its digest; the file was changed or damaged")
    made_by = arrays["format"].tolist(), str(arrays["version"])
    if made_by != (FORMAT, __version__):
        raise BrokenFile(
            f"{path} has format {made_by[0]} of evenroad {made_by[1]}, this is format {FORMAT} of {__version__}:"
            " build the roadmap anew, since what it calls free was checked by that version"
        )
    n, m = (len(arrays[name]) if arrays[name].ndim else 0 for name in ("milestones", "edges"))
    require_array(path, "milestones", arrays["milestones"], np.float64, (n, None))
    require_array(path, "edges", arrays["edges"], np.int32, (m, 2))
    if m and not (arrays["edges"].min() >= 0 and arrays["edges"].max() < n):
        raise BrokenFile(f"{path}: edges must join milestones 0 .. {n - 1}")
    return arrays


def point_roadmap(path: Path, arrays: Arrays) -> PointRoadmap:
    """Return the roadmap of points of a file; its first world must have the space that it was built for."""
    milestones, edges, lengths = arrays["milestones"], arrays["edges"], arrays["lengths"]
    require_array(path, "points", arrays["points"], np.float64, (len(milestones), None))
    require_array(path, "lengths", lengths, np.float64, (len(edges),))
    points = points_of(path, arrays)
    try:
        rule = rule_named(str(arrays["rule"]))
    except EvenroadError as error:
        raise BrokenFile(f"{path}: {error}") from error
    for array in (milestones, edges, lengths):
        array.setflags(write=False)
    return PointRoadmap(points, rule, milestones, edges, None, lengths)
