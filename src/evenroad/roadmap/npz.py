"""Roadmaps on disk: .npz with everything that is known, checked on load."""

from __future__ import annotations

import hashlib
import json
import os
import zipfile
import zlib
from dataclasses import asdict
from typing import Any, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from evenroad._files import atomic_write
from evenroad.errors import BrokenFile, EvenroadError, InvalidValue, NotAvailable
from evenroad.points.pointset import Origin, PointSet
from evenroad.roadmap.cost import EdgeCost
from evenroad.roadmap.kept import Roadmap, WorldRoadmap
from evenroad.roadmap.rules import rule_named
from evenroad.space import Space
from evenroad.world import World

FORMAT = 1
_ROADMAP = {"format", "points", "origin", "rule", "configurations", "edges", "digest"}
_IN_WORLD = _ROADMAP | {"fingerprint", "lazy_milestones", "node_states", "edge_states"}

Path = str | os.PathLike[str]


@runtime_checkable
class Fingerprinted(Protocol):
    """A world that can say which it is."""

    def fingerprint(self) -> str:
        """Return a text that two worlds share only if they give the same verdicts."""
        ...


def save_roadmap(path: Path, roadmap: Roadmap) -> None:
    """Write a roadmap without any world, atomically: points, rule, node order and edges.

    Raises
    ------
    BrokenFile
        If the file cannot be written; whatever was at `path` is then untouched.
    """
    _write(path, _arrays(roadmap))


def save_world_roadmap(path: Path, known: WorldRoadmap) -> None:
    """Write a roadmap with all that is known of it in its world, atomically.

    Raises
    ------
    NotAvailable
        If the world has no ``fingerprint()``, so that a wrong one could not be refused later.
    BrokenFile
        If the file cannot be written; whatever was at `path` is then untouched.
    """
    node_states, edge_states = known.states
    _write(
        path,
        _arrays(known.roadmap)
        | dict(
            fingerprint=np.array(_fingerprint(known.world)),
            lazy_milestones=np.array(known.lazy_milestones),
            node_states=node_states,
            edge_states=edge_states,
        ),
    )


def load_roadmap(path: Path, space: Space) -> Roadmap:
    """Read a roadmap written by either function, leaving out what is known of a world.

    Parameters
    ----------
    path : path
        The file.
    space : Space
        That it was built for.

    Raises
    ------
    BrokenFile
        If the file is missing, is no such npz or was damaged.
    InvalidValue
        If the space maps the points to other configurations than when the roadmap was saved.
    """
    return _roadmap(path, _read(path), space)


def load_world_roadmap(path: Path, world: World, *, edge_cost: EdgeCost | None = None) -> WorldRoadmap:
    """Read a roadmap with what is known of it in a world; errors as :func:`load_roadmap`, and:

    Raises
    ------
    InvalidValue
        If it was saved in another world.
    NotAvailable
        If the file knows of no world, or the world has no ``fingerprint()``.
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


def _arrays(roadmap: Roadmap) -> dict[str, npt.NDArray[Any]]:
    return dict(
        format=np.array(FORMAT),
        points=roadmap.points.points,
        origin=np.array(json.dumps(asdict(roadmap.points.origin))),
        rule=np.array(str(roadmap.rule)),
        configurations=roadmap.configurations,
        edges=roadmap.edges,
    )


def _digest(arrays: dict[str, npt.NDArray[Any]]) -> str:
    digest = hashlib.sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        digest.update(f"{name} {array.dtype.str} {array.shape}:".encode())
        digest.update(array.tobytes())
    return digest.hexdigest()


def _write(path: Path, arrays: dict[str, npt.NDArray[Any]]) -> None:
    with atomic_write(path) as file:
        np.savez_compressed(file, allow_pickle=False, digest=np.array(_digest(arrays)), **arrays)


def _read(path: Path) -> dict[str, npt.NDArray[Any]]:
    try:
        # Opened here, not by NumPy, which leaves the handle open when the archive is broken.
        with open(path, "rb") as file:
            archive = np.load(file, allow_pickle=False)
            names = set(archive.files) if isinstance(archive, np.lib.npyio.NpzFile) else set()
            if names not in (_ROADMAP, _IN_WORLD):
                raise BrokenFile(f"{path} holds {sorted(names)}, a roadmap holds {sorted(_ROADMAP)}")
            arrays = {name: archive[name] for name in names}
    except FileNotFoundError:
        raise BrokenFile(f"no such file: {path}") from None
    except EvenroadError:
        raise
    except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile, zlib.error) as error:
        raise BrokenFile(f"{path} is not a readable roadmap: {error}") from error
    digest = str(arrays.pop("digest"))
    if _digest(arrays) != digest:
        raise BrokenFile(f"{path}: its content does not match its digest; the file was changed or damaged")
    if int(arrays["format"]) != FORMAT:
        raise BrokenFile(f"{path} has format {int(arrays['format'])}, this version reads {FORMAT}")
    return arrays


def _roadmap(path: Path, arrays: dict[str, npt.NDArray[Any]], space: Space) -> Roadmap:
    points = PointSet(arrays["points"], Origin(**json.loads(str(arrays["origin"]))))
    configurations, edges = arrays["configurations"], arrays["edges"]
    if points.d != space.cube_dim or not np.array_equal(space.from_cube(points.points), configurations):
        raise InvalidValue(f"{path} was built for another space than {space!r}")
    for array in (configurations, edges):
        array.setflags(write=False)
    return Roadmap(space, points, rule_named(str(arrays["rule"])), configurations, edges)
