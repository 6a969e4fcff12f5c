"""The lock of a store: one process writes it at a time."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from evenroad.errors import BrokenFile


@contextmanager
def only_writer(store: Path) -> Iterator[None]:
    """Hold the lock of a store; the lock goes with the process, and its file, STORE.lock, with the block.

    A lock of SQLite's own would keep readers out, too.

    Raises
    ------
    BrokenFile
        If another process holds it.
    """
    try:
        import fcntl
    except ImportError:
        # Windows: two writers wait for each other at each commit, and may do the same work twice.
        yield
        return
    lock = store.with_name(f"{store.name}.lock")
    with open(lock, "w", encoding="utf-8") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # The writer before may have removed the file that was opened here: such a lock would be nobody's.
            ours = os.path.samestat(os.stat(lock), os.fstat(file.fileno()))
        except OSError:
            ours = False
        if not ours:
            raise BrokenFile(
                f"cannot write {store}: another benchmark is writing it; wait for it, or give another store"
            )
        try:
            yield
        finally:
            lock.unlink(missing_ok=True)
