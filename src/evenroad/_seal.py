"""Seals of files: a digest, by which damage is detected before use, before what is cached and within JSON records."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping

from evenroad.errors import BrokenFile

_MARK = b"evenroad-kept:"
_DIGEST = "sha256"
"""Key of the digest in a record."""


def with_digest(record: Mapping[str, object]) -> dict[str, object]:
    """Return a record of plain JSON values with the digest of all of them."""
    return {**record, _DIGEST: _digest_of(record)}


def has_digest(record: Mapping[str, object], path: str | os.PathLike[str]) -> bool:
    """Return whether the record of a file has a digest; BrokenFile if that is of other values."""
    if _DIGEST not in record:
        return False
    if record[_DIGEST] != _digest_of(record):
        raise BrokenFile(f"{path} is not as it was written: its {_DIGEST} is of other values")
    return True


def _digest_of(record: Mapping[str, object]) -> str:
    values = {key: value for key, value in record.items() if key != _DIGEST}
    return hashlib.sha256(json.dumps(values, sort_keys=True).encode()).hexdigest()


def sealed(content: bytes, name: str) -> bytes:
    """Return `content` behind a digest of itself and of the `name` that it is kept by."""
    digest = hashlib.sha256(name.encode() + b"\0" + content).hexdigest()
    return _MARK + digest.encode() + b"\n" + content


def read_sealed(path: str | os.PathLike[str], name: str, what: str) -> bytes | None:
    """Return what was sealed by this `name`; None where there is none, or what there is cannot be trusted.

    Anything that is not exactly what was written is removed, and one line of the log says that `what` is made again.
    """
    try:
        with open(path, "rb") as file:
            kept = file.read()
    except OSError:
        return None
    content = kept[kept.find(b"\n") + 1 :]
    if kept == sealed(content, name):
        return content
    # Imported late: hardly any file is damaged.
    import logging

    logging.getLogger("evenroad").warning("evenroad: %s kept in %s was damaged, and is made again", what, path)
    try:
        os.unlink(path)
    except OSError:
        # Not ours to remove, or another process was quicker.
        return None
    return None
