"""A folder of sets belongs to one request, which is written beside them: sets of two requests never mix unnoticed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from evenroad._files import atomic_write, remove_abandoned_parts
from evenroad.errors import BrokenFile, InvalidValue, shown

REQUEST_FILE = "request.json"


def set_name(index: int) -> str:
    """Return the file name of a set inside its folder."""
    return f"set-{index:04d}.npz"


def claim_folder(folder: Path, request: dict[str, Any]) -> None:
    """Write the request into `folder`, or check that the one already there is the same.

    Temporary files of trainings that were killed are removed from it.

    Raises
    ------
    InvalidValue
        If the folder belongs to another request; the text names the first difference.
    BrokenFile
        If the folder is missing or cannot be written, or its request is not readable.
    """
    path = folder / REQUEST_FILE
    remove_abandoned_parts(folder)
    if not path.exists():
        with atomic_write(path) as file:
            file.write(json.dumps(request, indent=1).encode())
        return
    try:
        found = json.loads(path.read_bytes())
    except (OSError, ValueError) as error:
        raise BrokenFile(f"{path} is not readable as JSON: {error}") from None
    for name, wanted in request.items():
        there = found.get(name) if isinstance(found, dict) else None
        if there != wanted:
            raise InvalidValue(
                f"{folder} holds sets with {name}={shown(there)}, asked for {name}={shown(wanted)};"
                " use another folder"
            )
