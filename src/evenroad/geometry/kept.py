"""A cache on disk of capsules fitted to meshes: the same file serves many robots, SRDFs and groups."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

import numpy as np

from evenroad._arrays import Floats
from evenroad._files import atomic_write, cache_folder
from evenroad._seal import read_sealed, sealed
from evenroad.geometry.mesh import TriangleMesh

Fitted = tuple[Floats, Floats, float]
"""End points a and b, each (3,), and radius of a capsule."""
_FORMAT = 2
"""Version of the cache's contents. It increases when the same mesh gets other capsules."""
_FEW = 300
"""Number of triangles up to which fitting is faster than reading the cache."""


def fitted_once(what: str, mesh: TriangleMesh, fit: Callable[[TriangleMesh], list[Fitted]]) -> list[Fitted]:
    """Return the capsules that `fit` fits to a mesh, from the user's cache if it has them; `what` names them there."""
    if len(mesh.triangles) <= _FEW:
        return fit(mesh)
    key, file = _key_and_file(what, mesh)
    content = read_sealed(file, key, f"what was fitted to {mesh.name}")
    if content is not None:
        return [(np.array(a), np.array(b), radius) for a, b, radius in json.loads(content)]
    found = fit(mesh)
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(file) as stream:
            said = [(a.tolist(), b.tolist(), radius) for a, b, radius in found]
            stream.write(sealed(json.dumps(said).encode(), key))
    return found


def is_new(what: str, mesh: TriangleMesh) -> bool:
    """Return whether a mesh must be fitted, because the cache does not have it."""
    return len(mesh.triangles) <= _FEW or not _key_and_file(what, mesh)[1].exists()


def _key_and_file(what: str, mesh: TriangleMesh) -> tuple[str, Path]:
    key = sha256(f"{what}|{_FORMAT}|{mesh.digest}".encode()).hexdigest()
    return key, cache_folder() / "meshes" / f"{key[:32]}.json"
