"""Roadmaps on disk: .npz with everything that is known, checked on load."""

from __future__ import annotations

import json
from dataclasses import asdict

import numpy as np

from evenroad._fingerprint import Fingerprinted
from evenroad._npz import Arrays, Path, digest, read_npz, require_array, write_npz
from evenroad.errors import BrokenFile, EvenroadError, InvalidValue, NotAvailable
from evenroad.points.npz import points_of
from evenroad.roadmap.kept import Roadmap, WorldRoadmap
from evenroad.roadmap.query import EdgeCost
from evenroad.roadmap.rules import rule_named
from evenroad.roadmap.search import BLOCKED, FREE, UNKNOWN
from evenroad.space import Space
from evenroad.world import World

FORMAT = 1
_ROADMAP = {"format", "points", "origin", "rule", "configurations", "edges", "digest"}
_IN_WORLD = _ROADMAP | {"fingerprint", "lazy_milestones", "node_states", "edge_states"}


def save_roadmap(path: Path, roadmap: Roadmap) -> None:
    """Write a roadmap without any world, atomically: points, rule, node order and edges.

    Raises BrokenFile if the file cannot be written; whatever was at `path` is then untouched.
    """
    _write(path, _arrays(roadmap))


def save_world_roadmap(path: Path, known: WorldRoadmap) -> None:
    """Write a roadmap with all that is known of it in its world, atomically; errors as :func:`save_roadmap`.

    NotAvailable if the world cannot say which it is (`Fingerprinted`): a wrong one could not be refused later.
    """
    node_states, edge_states = known.states
    in_world = dict(
        fingerprint=np.array(_fingerprint(known.world)),
        lazy_milestones=np.array(known.lazy_milestones),
        node_states=node_states,
        edge_states=edge_states,
    )
    _write(path, _arrays(known.roadmap) | in_world)


def load_roadmap(path: Path, space: Space) -> Roadmap:
    """Read a roadmap written by either function for this space, leaving out what is known of a world.

    Raises BrokenFile if the file is missing, is no such npz or was damaged; InvalidValue if the space maps the points
    to other configurations than when the roadmap was saved.
    """
    return _roadmap(path, _read(path), space)


def load_world_roadmap(path: Path, world: World, *, edge_cost: EdgeCost | None = None) -> WorldRoadmap:
    """Read a roadmap with what is known of it in a world; errors as :func:`load_roadmap`.

    InvalidValue also if it was saved in another world; NotAvailable if the file knows of no world, or the world cannot
    say which it is.
    """
    arrays = _read(path)
    if "fingerprint" not in arrays:
        raise NotAvailable(f"{path} holds a roadmap without a world: load_roadmap reads it")
    saved, here = str(arrays["fingerprint"]), _fingerprint(world)
    if saved != here:
        raise InvalidValue(
            f"{path} was saved in another world: its fingerprint is {saved[:12]}, that of this one {here[:12]}"
        )
    roadmap = _roadmap(path, arrays, world.space)
    for name, among in (("node_states", roadmap.configurations), ("edge_states", roadmap.edges)):
        require_array(path, name, arrays[name], np.int8, (len(among),))
        if not np.isin(arrays[name], (UNKNOWN, FREE, BLOCKED)).all():
            raise BrokenFile(f"{path}: {name} must be {UNKNOWN}, {FREE} or {BLOCKED}")
    require_array(path, "lazy_milestones", arrays["lazy_milestones"], np.bool_, ())
    # Nothing is asked of the world here: what the file knows is put in first.
    known = roadmap.in_world(world, lazy_milestones=True, edge_cost=edge_cost)
    known.recall(arrays["node_states"], arrays["edge_states"])
    known.lazy_milestones = bool(arrays["lazy_milestones"])
    return known


def _fingerprint(world: World) -> str:
    if not isinstance(world, Fingerprinted):
        raise NotAvailable(
            f"{type(world).__name__} has no fingerprint(), so a wrong world could not be refused;"
            " save_roadmap keeps the roadmap itself"
        )
    return world.fingerprint()


def _arrays(roadmap: Roadmap) -> Arrays:
    return dict(
        format=np.array(FORMAT),
        points=roadmap.points.points,
        origin=np.array(json.dumps(asdict(roadmap.points.origin))),
        rule=np.array(str(roadmap.rule)),
        configurations=roadmap.configurations,
        edges=roadmap.edges,
    )


def _write(path: Path, arrays: Arrays) -> None:
    write_npz(path, arrays | {"digest": np.array(digest(arrays))}, compressed=True)


def _read(path: Path) -> Arrays:
    arrays = read_npz(path, "roadmap", _ROADMAP, _IN_WORLD)
    expected = str(arrays.pop("digest"))
    if digest(arrays) != expected:
        raise BrokenFile(f"{path}: its content does not match its digest; the file was changed or damaged")
    require_array(path, "format", arrays["format"], np.int64, ())
    if int(arrays["format"]) != FORMAT:
        raise BrokenFile(f"{path} has format {int(arrays['format'])}, this version reads {FORMAT}")
    return arrays


def _roadmap(path: Path, arrays: Arrays, space: Space) -> Roadmap:
    configurations, edges = arrays["configurations"], arrays["edges"]
    n = len(arrays["points"]) if arrays["points"].ndim else 0
    require_array(path, "points", arrays["points"], np.float64, (n, None))
    require_array(path, "configurations", configurations, np.float64, (n, None))
    require_array(path, "edges", edges, np.int32, (None, 2))
    if edges.size and (edges.min() < 0 or edges.max() >= n):
        low, high = edges.min(), edges.max()
        raise BrokenFile(f"{path}: edges must join milestones 0 .. {n - 1}, got {low} .. {high}")
    points = points_of(path, arrays)
    try:
        rule = rule_named(str(arrays["rule"]))
    except EvenroadError as error:
        raise BrokenFile(f"{path}: {error}") from error
    if points.d != space.cube_dim or not np.array_equal(space.from_cube(points.points), configurations):
        raise InvalidValue(f"{path} was built for another space than {space!r}")
    for array in (configurations, edges):
        array.setflags(write=False)
    return Roadmap(space, points, rule, configurations, edges)
