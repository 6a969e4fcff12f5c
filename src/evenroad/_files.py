"""Atomic writes, by which a reader sees the old content or the whole new one; and recognition of file types."""

from __future__ import annotations

import errno
import json
import os
import stat
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any, TypeAlias

from evenroad.errors import BrokenFile

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

Json: TypeAlias = Any
"""A value of JSON, which is checked as it is read."""
_umask_lock = threading.Lock()
_PREFIX, _SUFFIX = ".evenroad-", ".part"
"""Beginning and end of the names of temporary files."""
_BEGINNINGS = {
    b"\x93NUMPY": "a .npy array",
    b"PK": "a .npz or other archive",
    b"\x89PNG": "a PNG image",
    b"P5": "a PGM image",
    b"BM": "a BMP image",
    b"\xff\xd8\xff": "a JPEG image",
    b"GIF8": "a GIF image",
    b"SQLite format 3": "a SQLite file",
    b"%PDF": "a PDF",
    b"<": "XML",
}
"""First bytes of a file -> its type."""


@contextmanager
def atomic_write(path: str | os.PathLike[str]) -> Iterator[IO[bytes]]:
    """Open a temporary file beside `path`; on success it replaces `path`, on any error it is removed.

    A process that is killed leaves its temporary file behind; see :func:`remove_abandoned_parts`.  Raises BrokenFile if
    the folder does not exist, cannot be written, or the disk is full.
    """
    target = Path(path)
    require_writable_folder(target)
    try:
        handle, lock, name = _new_part(target.parent)
    except OSError as error:
        raise _cannot_write(target, error) from error
    try:
        with os.fdopen(handle, "wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        os.chmod(name, 0o666 & ~_umask())
        os.replace(name, target)
    except BaseException as error:
        with suppress(FileNotFoundError):
            os.unlink(name)
        if isinstance(error, OSError) and not isinstance(error, BrokenFile):
            raise _cannot_write(target, error) from error
        raise
    finally:
        if lock is not None:
            os.close(lock)


def remove_abandoned_parts(folder: str | os.PathLike[str]) -> None:
    """Remove the temporary files of :func:`atomic_write` whose processes were killed.

    Every writer holds a lock on its file, which ends with the process.  Without ``flock`` all files stay.
    """
    if fcntl is None:
        return
    for part in Path(folder).glob(f"{_PREFIX}*{_SUFFIX}"):
        with suppress(OSError), open(part, "rb") as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            part.unlink()


def _new_part(folder: Path) -> tuple[int, int | None, str]:
    """Make a temporary file; return its handle, a second handle that holds its lock (or None), and its name."""
    while True:
        handle, name = _created(folder)
        if fcntl is None:
            return handle, None, name
        with suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_EX)
        if os.fstat(handle).st_nlink:
            # The lock is shared by both handles, and outlives the first, which is closed before the file is moved.
            return handle, os.dup(handle), name
        # Between the two steps another process removed it as abandoned.
        os.close(handle)


def _created(folder: Path) -> tuple[int, str]:
    """Make a file that nobody else reads; return its handle and its name.  The module `tempfile` loads much."""
    # A short name of its own: the target's may already be as long as the file system takes.
    name = os.path.abspath(folder / f"{_PREFIX}{os.urandom(8).hex()}{_SUFFIX}")
    return os.open(name, os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o600), name


def not_a(wanted: str, path: str | os.PathLike[str], why: str = "") -> BrokenFile:
    """Return the error of a file that was read as `wanted`: its type or, for a text, the reason."""
    found = looks_like(path)
    if found == "text" and why:
        return BrokenFile(f"{path} is not {wanted}: {why}")
    return BrokenFile(f"{path} is {found}, not {wanted}")


def require_file(path: str | os.PathLike[str]) -> None:
    """Raise OSError for what is there and no file: a pipe would be waited for, and some devices never end."""
    if "\0" in os.fspath(path):
        raise OSError(errno.EINVAL, "no name of a file has a zero byte", os.fspath(path))
    mode = os.stat(path).st_mode
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):
        raise OSError(errno.ESPIPE, "it is a device or a pipe, not a file", os.fspath(path))


def open_file(path: str | os.PathLike[str]) -> IO[bytes]:
    """Open a file to read its bytes; OSError if it cannot be read, or is a device or a pipe."""
    require_file(path)
    return open(path, "rb")


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """Return the content of a file; OSError if it cannot be read, or is a device or a pipe."""
    with open_file(path) as file:
        return file.read()


def read_known(path: str | os.PathLike[str], what: str) -> bytes:
    """Return the content of a file of the kind `what`; BrokenFile if it cannot be read."""
    try:
        return read_bytes(path)
    except OSError as error:
        raise BrokenFile(f"cannot read the {what} {path}: {error.strerror or error}") from error


def looks_like(path: str | os.PathLike[str]) -> str:
    """Return the type of a readable file by its content."""
    with open_file(path) as file:
        begin = file.read(4096).lstrip()
    if not begin:
        return "empty"
    for known, what in _BEGINNINGS.items():
        if begin.startswith(known):
            return what
    # A character may be cut in two by the end of what was read.
    is_text = b"\0" not in begin and "\ufffd" not in begin.decode(errors="replace")[:-1]
    return "text" if is_text else "no text"


def read_json_file(path: str | os.PathLike[str], what: str) -> Json:
    """Return the content of a JSON file of the kind `what`; BrokenFile if it cannot be read."""
    try:
        return json.loads(read_known(path, what).decode())
    except json.JSONDecodeError as error:
        raise not_a(f"JSON, as a {what} is", path, f"line {error.lineno}, column {error.colno}: {error.msg}") from error
    except (ValueError, RecursionError) as error:
        raise not_a(f"JSON, as a {what} is", path, str(error)) from error


def cache_folder() -> Path:
    """Return the folder of cached files: ``$EVENROAD_CACHE``, or the platform's cache folder."""
    if own := os.environ.get("EVENROAD_CACHE"):
        return Path(own)
    if sys.platform == "darwin":
        return Path("~/Library/Caches/evenroad").expanduser()
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", os.path.expanduser("~")), "evenroad", "Cache")
    return Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "evenroad")


def require_writable_folder(path: str | os.PathLike[str]) -> None:
    """Raise BrokenFile unless a file at `path` could be created now."""
    target = Path(path)
    folder = target.parent
    if not folder.is_dir():
        raise BrokenFile(f"cannot write {target}: the folder {folder} does not exist")
    try:
        mode = target.stat().st_mode
    except FileNotFoundError:
        mode = stat.S_IFREG
    except OSError as error:
        raise _cannot_write(target, error) from error
    if stat.S_ISDIR(mode):
        raise BrokenFile(f"cannot write {target}: it is a folder")
    # A file moved onto a device would replace it for everybody.
    if not stat.S_ISREG(mode):
        raise BrokenFile(f"cannot write {target}: it is a device or a pipe, not a file")
    try:
        handle, name = _created(folder)
        os.close(handle)
        # Another process may just have removed it as abandoned.
        with suppress(FileNotFoundError):
            os.unlink(name)
    except OSError as error:
        raise BrokenFile(f"cannot write into the folder {folder}: {error.strerror or error}") from error


def _cannot_write(target: Path, error: OSError) -> BrokenFile:
    return BrokenFile(f"cannot write {target}: {error.strerror or error}")


def _umask() -> int:
    # Of two threads at once the second would read, and then keep, the mask of the first.
    with _umask_lock:
        mask = os.umask(0)
        os.umask(mask)
    return mask
