"""Files of roadmaps: .npz with a digest, checked on load."""

from __future__ import annotations

import json
from dataclasses import asdict

import numpy as np

from evenroad import __version__
from evenroad._npz import Arrays, Path, digest, read_npz, require_array, write_npz
from evenroad.errors import BrokenFile, EvenroadError
from evenroad.points.npz import points_of
from evenroad.roadmap.roadmap import Roadmap
from evenroad.roadmap.rules import rule_named

FORMAT = 4
_OF_ALL = {"format", "version", "milestones", "edges", "digest"}
_NAMES = _OF_ALL | {"points", "origin", "rule", "lengths"}
_OF_ONE_ARM = _OF_ALL | {
    *("robot", "scene", "settings", "turns", "weights"),
    *("surface_points", "surface_triangles"),
}
"""Arrays in files of roadmaps that earlier versions made for one arm."""


def save_roadmap(path: Path, roadmap: Roadmap) -> None:
    """Write a roadmap with its format and digest, atomically.

    Raises BrokenFile if the file cannot be written; an earlier file at `path` is then untouched.
    """
    arrays: Arrays = dict(
        milestones=roadmap.milestones,
        edges=roadmap.edges,
        points=roadmap.points.points,
        origin=np.array(json.dumps(asdict(roadmap.points.origin))),
        rule=np.array(str(roadmap.rule)),
        lengths=roadmap.lengths,
        format=np.array(FORMAT),
        version=np.array(__version__),
    )
    write_npz(path, arrays | {"digest": np.array(digest(arrays))}, compressed=True)


def load_roadmap(file: Path) -> Roadmap:
    """Read a roadmap that ``roadmap.save(file)`` wrote.

    Parameters
    ----------
    file : path-like
        A file of ``roadmap.save``.

    Returns
    -------
    Roadmap
        ``roadmap.within(world)`` refuses a world of another space than it was built for.

    Raises
    ------
    BrokenFile
        If the file is missing, is no such npz or was damaged, or comes from another version of evenroad.

    Examples
    --------
    >>> import evenroad as er
    >>> er.build_roadmap(er.ArmWorld("ur5"), 32).save("ur5.roadmap")
    >>> er.load_roadmap("ur5.roadmap")
    Roadmap(32 milestones, 369 edges, k=20 symmetrised)
    """
    arrays = read_npz(file, "roadmap", _NAMES, _OF_ONE_ARM)
    if "robot" in arrays:
        raise BrokenFile(
            f"{file} is a roadmap made for one arm, which evenroad no longer reads: er.plan_many and er.Replanner take"
            " many queries, and er.build_roadmap builds a roadmap of even points"
        )
    _require_whole(file, arrays)
    points = points_of(file, arrays)
    try:
        rule = rule_named(str(arrays["rule"]))
    except EvenroadError as error:
        raise BrokenFile(f"{file}: {error}") from error
    milestones, edges, lengths = arrays["milestones"], arrays["edges"], arrays["lengths"]
    for array in (milestones, edges, lengths):
        array.setflags(write=False)
    return Roadmap(points, rule, milestones, edges, None, lengths)


def _require_whole(path: Path, arrays: Arrays) -> None:
    """Raise BrokenFile unless the arrays are those that this version wrote, of shapes that belong together."""
    expected = str(arrays.pop("digest"))
    if digest(arrays) != expected:
        raise BrokenFile(f"{path}: its content does not match its digest; the file was changed or damaged")
    made_by = arrays["format"].tolist(), str(arrays["version"])
    if made_by != (FORMAT, __version__):
        raise BrokenFile(
            f"{path} has format {made_by[0]} of evenroad {made_by[1]}, this is format {FORMAT} of {__version__}:"
            " build the roadmap anew"
        )
    n, m = (len(arrays[name]) if arrays[name].ndim else 0 for name in ("milestones", "edges"))
    require_array(path, "milestones", arrays["milestones"], np.float64, (n, None))
    require_array(path, "edges", arrays["edges"], np.int32, (m, 2))
    if m and not (arrays["edges"].min() >= 0 and arrays["edges"].max() < n):
        raise BrokenFile(f"{path}: edges must join milestones 0 .. {n - 1}")
    require_array(path, "points", arrays["points"], np.float64, (n, None))
    require_array(path, "lengths", arrays["lengths"], np.float64, (m,))
