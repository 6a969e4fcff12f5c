"""The user's cache of sets that were annealed on demand."""

from __future__ import annotations

import hashlib
from pathlib import Path

from evenroad import __version__
from evenroad._files import cache_folder, require_writable_folder
from evenroad.errors import BrokenFile
from evenroad.points.bank.bank import SEED
from evenroad.points.npz import load_points, save_points
from evenroad.points.pointset import PointSet


def require_cache() -> None:
    """Raise BrokenFile unless a set could be kept now: before the minutes that annealing it may take."""
    folder = _sets_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BrokenFile(
            f"cannot make the cache folder {folder}: {error.strerror or error} (EVENROAD_CACHE names another)"
        ) from error
    require_writable_folder(folder / "set.npz")


def cached(family: str, objective: str, steps: int, n: int, d: int, replica: int) -> PointSet | None:
    """Return the set from the cache; None when it is not there, damaged or another one, and to be made again."""
    try:
        points = load_points(_file(family, objective, steps, n, d, replica))
    except BrokenFile:
        return None
    origin = points.origin
    found = (origin.family, origin.objective, origin.steps, points.n, points.d, origin.replica)
    return points if found == (family, objective, steps, n, d, replica) else None


def keep(family: str, objective: str, steps: int, n: int, d: int, replica: int, points: PointSet) -> None:
    """Put a set into the cache.

    The same set is made bit for bit by whoever makes it, and a file appears in one step: two processes that
    anneal it at once write the same content, whichever comes last.
    """
    require_cache()
    save_points(_file(family, objective, steps, n, d, replica), points)


def _file(family: str, objective: str, steps: int, n: int, d: int, replica: int) -> Path:
    # All that decides the bits is part of the name: sets of an earlier recipe are not mistaken for today's.
    recipe = hashlib.sha256(f"{objective}|{steps}|{SEED}|{__version__}".encode()).hexdigest()[:8]
    return _sets_folder() / f"{family}-{recipe}-d{d:02d}-n{n:05d}-{replica:03d}.npz"


def _sets_folder() -> Path:
    return cache_folder() / "sets"
