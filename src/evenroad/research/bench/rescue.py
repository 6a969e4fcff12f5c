"""Rescue: rows that a store could not take are left in a file beside it, for the next one who opens the store."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path

from evenroad._files import atomic_write
from evenroad.errors import BrokenFile

Row = tuple[str | int | float | None, ...]


def rescue_file(store: Path) -> Path:
    """Return where the rows of a store wait: STORE.rescue."""
    return store.with_name(f"{store.name}.rescue")


def leave_rows(store: Path, columns: Sequence[str], rows: Sequence[Row]) -> str:
    """Write rows into the rescue file, one JSON object a line; or, if its disk is full, into the temporary folder.

    Returns
    -------
    str
        Where they are, as the end of a sentence for the user.
    """
    text = "".join(json.dumps(dict(zip(columns, row, strict=True))) + "\n" for row in rows).encode()
    beside = rescue_file(store)
    elsewhere = Path(tempfile.gettempdir()) / f"{store.name}.{os.getpid()}.rescue"
    how_many = f"{len(rows)} finished row{'s' if len(rows) > 1 else ''}"
    if _is_written(beside, text):
        return f"{how_many} left in {beside}: the next run with this store takes them in"
    if _is_written(elsewhere, text):
        return f"{how_many} left in {elsewhere}: move it to {beside}, and the next run takes them in"
    return f"{how_many} could not be left in {beside} either: the next run computes them again"


def waiting_rows(store: Path, columns: Sequence[str]) -> list[Row]:
    """Return the rows in the rescue file of a store; none where there is no such file.

    Raises
    ------
    BrokenFile
        If the file is something else.
    """
    path = rescue_file(store)
    try:
        records = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
        return [tuple(record[column] for column in columns) for record in records]
    except FileNotFoundError:
        return []
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise BrokenFile(
            f"{path} does not hold rows of a store ({error!r}): move it away to go on without them"
        ) from error


def _is_written(path: Path, text: bytes) -> bool:
    try:
        with atomic_write(path) as file:
            file.write(text)
    except BrokenFile:
        return False
    return True
