"""Seals of cached files: a digest before the content, by which damage is detected before use."""

from __future__ import annotations

import hashlib
import logging
import os

_MARK = b"evenroad-kept:"


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
    logging.getLogger("evenroad").warning("evenroad: %s kept in %s was damaged, and is made again", what, path)
    try:
        os.unlink(path)
    except OSError:
        # Not ours to remove, or another process was quicker.
        return None
    return None
