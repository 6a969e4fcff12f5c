"""The folder of a data set: its parts with their digests, and a card that says what the set is and how it was made."""

from __future__ import annotations

import hashlib
import json
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from pathlib import Path

from evenroad._files import atomic_write, remove_abandoned_parts
from evenroad.datasets.part import Request, make_part
from evenroad.datasets.workers import Workers
from evenroad.errors import BrokenFile, InvalidValue, shown

REQUEST, CARD = "_request.json", "_card.json"
"""Names of files; readers of folders of Parquet files ignore those that begin with an underscore."""


def make_parts(
    request: Request, folder: Path, shard: tuple[int, int], workers: Workers, report: Callable[[int, int], None]
) -> int:
    """Make the parts of a shard, i of n, that a folder lacks or that are damaged; return how many those are."""
    claim_folder(folder, request.values(), REQUEST)
    mine = range(shard[0], request.parts, shard[1])
    missing = deque(part for part in mine if digest_of(folder / request.name(part)) is None)
    count, made = len(mine), len(mine) - len(missing)
    todo, begun = len(missing), deque[tuple[int, Future[bytes]]]()
    executor = workers.make()
    try:
        while missing or begun:
            while missing and len(begun) < 2 * workers.count(executor):
                part = missing.popleft()
                begun.append((part, executor.submit(make_part, request, part)))
            part, future = begun.popleft()
            write_part(folder / request.name(part), future.result())
            made += 1
            report(made, count)
    except BaseException:
        executor.shutdown(wait=False, cancel_futures=True)
        raise
    executor.shutdown()
    return todo


def claim_folder(folder: Path, request: dict[str, object], name: str) -> None:
    """Write the request into the file `name` of `folder`; if it is there, check that it is the same.

    Temporary files that killed processes left in the folder are removed.  Raises InvalidValue, with the first
    difference, if the folder belongs to another request; BrokenFile if it is missing or cannot be written, or the
    request not read.
    """
    path = folder / name
    remove_abandoned_parts(folder)
    if not path.exists():
        with atomic_write(path) as file:
            file.write(json.dumps(request, indent=1).encode())
        return
    try:
        found = json.loads(path.read_bytes())
    except (OSError, ValueError) as error:
        raise BrokenFile(f"{path} is not readable as JSON: {error}") from None
    for key, wanted in request.items():
        there = found.get(key) if isinstance(found, dict) else None
        if there != wanted:
            raise InvalidValue(
                f"{folder} holds sets with {key}={shown(there)}, asked for {key}={shown(wanted)};"
                f" use another folder (what there is: {name})"
            )


def merge(shards: Sequence[Path], folder: Path) -> Request:
    """Copy the parts of shards into a folder; return their request.

    Raises InvalidValue for shards of different requests; BrokenFile for a folder that is none of a set, or a damaged
    part.
    """
    requests = [request_of(shard) for shard in shards]
    for shard, request in zip(shards, requests, strict=True):
        if request != requests[0]:
            raise InvalidValue(f"{shard} is of another request than {shards[0]}: compare their {REQUEST}")
    claim_folder(folder, requests[0].values(), REQUEST)
    for shard in shards:
        for part in range(requests[0].parts):
            file = shard / requests[0].name(part)
            if not file.exists() or digest_of(folder / file.name) is not None:
                continue
            if digest_of(file) is None:
                raise BrokenFile(f"{file} is not what was made: give the command that made {shard} again")
            write_part(folder / file.name, file.read_bytes())
    return requests[0]


def request_of(folder: Path) -> Request:
    """Return the request of a folder; BrokenFile if it has none."""
    try:
        values = json.loads((folder / REQUEST).read_bytes())
        fields = {name: values[name] for name in Request.__dataclass_fields__}
    except (OSError, ValueError, KeyError) as error:
        raise BrokenFile(f"{folder} is no folder of a data set: {error}") from None
    return Request(**{**fields, "sources": tuple(fields["sources"])})


def write_card(request: Request, folder: Path) -> int:
    """Write the card of a set whose parts are all there; return how many are, undamaged."""
    files = [folder / request.name(part) for part in range(request.parts)]
    hashes = {file.name: digest for file in files if (digest := digest_of(file)) is not None}
    if len(hashes) < len(files):
        return len(hashes)
    card = {
        "about": f"{request.count} problems of {request.robot}, with paths proved free and timed",
        "made by": "evenroad generate; the same request has the same bytes with the same versions",
        "request": request.values(),
        "columns": COLUMNS,
        "sha256": hashes,
    }
    write(folder / CARD, json.dumps(card, indent=1).encode())
    return len(hashes)


def write_part(file: Path, content: bytes) -> None:
    """Write a part, and before it the digest of what was made, as the file may be damaged later."""
    digest = hashlib.sha256(content).hexdigest()
    # As `sha256sum --check` reads it.
    write(_digest_file(file), f"{digest}  {file.name}\n".encode())
    write(file, content)


def digest_of(file: Path) -> str | None:
    """Return the digest of a part; None if it is missing or damaged."""
    try:
        said = _digest_file(file).read_bytes()
        with file.open("rb") as opened:
            digest = hashlib.file_digest(opened, "sha256").hexdigest()
    except OSError:
        return None
    return digest if said == f"{digest}  {file.name}\n".encode() else None


def _digest_file(file: Path) -> Path:
    return file.with_name(f"_{file.name}.sha256")


def write(path: Path, content: bytes) -> None:
    """Write a file whole, or not at all."""
    with atomic_write(path) as file:
        file.write(content)


COLUMNS = {
    "solved": "whether there is a path; else trees found none within the request's motions",
    "cost": "length of the path in joint space [rad, m]; NaN without one",
    "duration": "of the trajectory within the robot's limits [s]; NaN without one",
    "start, goal": "configurations, in the order of the robot's joints [rad, m]",
    "states": "64 states of the trajectory, evenly in time; zeros without one",
    "path": "waypoints; straight motions between them are proved free (HDF5: waypoints, offsets)",
    "scene": "obstacles in the robot's base frame as JSON, or the scene's file (HDF5: scenes, scene_of)",
}
"""Name of a column, and what it holds."""
