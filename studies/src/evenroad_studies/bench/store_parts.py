"""A store as a folder, NAME.parts, of Parquet files that any number of processes write at once.

Each writer has files of its own, so nobody waits for anybody: those of several machines are one store when they lie in
one folder.  A file is written whole or not at all.  Its name ends with a digest of its bytes, which is checked when it
is read.  A file that is gone is not noticed.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from evenroad._checks import require_extra
from evenroad._files import atomic_write
from evenroad.errors import BrokenFile
from evenroad_studies.bench.rows import Labels, Rows, Session, joined
from evenroad_studies.bench.store_file import COLUMNS, NAMED, damaged, row_of
from evenroad_studies.bench.task import PROTOCOL, Outcome, Task, key_of

SUFFIX = ".parts"
"""End of the name of a folder that is a store."""
COMMIT_SECONDS = 5.0
"""Rows are written this often, in a file each time: what a kill can lose at most."""
ROWS_OF_A_GROUP = 16_384
"""Rows that a file holds together: those of one problem are read without most others."""
DIGITS = 32
"""Hexadecimal digits of a digest."""

_TEXTS = (*NAMED, "finished")
_FLOATS = ("length", "seconds")
_KEPT = COLUMNS[1:]
_SCHEMA, _REPLACES, _SESSION = b"evenroad.rows", b"evenroad.replaces", b"evenroad.session"
_VERSION = b"1"


def is_parts(path: str | os.PathLike[str]) -> bool:
    """Say whether a path is, or will be, a store of parts, by its name."""
    return Path(path).suffix == SUFFIX


def write_part(folder: Path, columns: dict[str, Any], session: Session, replaces: Sequence[str] = ()) -> Path:
    """Write rows, columns by name without the key, as one file, sorted by problem; return where it is.

    Files named in `replaces` count no more, whether they are still there or not.
    """
    pa, pq = _arrow()
    table = pa.table({name: _array(name, columns[name]) for name in _KEPT})
    table = table.take(np.argsort(_labels(table["problem"]).codes, kind="stable"))
    about = {
        _SCHEMA: _VERSION,
        _SESSION: json.dumps(session._asdict()).encode(),
        _REPLACES: json.dumps(list(replaces)).encode(),
    }
    sink = io.BytesIO()
    pq.write_table(table.replace_schema_metadata(about), sink, compression="zstd", row_group_size=ROWS_OF_A_GROUP)
    content = sink.getvalue()
    path = folder / f"part-{time.time_ns():016x}-{os.getpid()}-{hashlib.sha256(content).hexdigest()[:DIGITS]}.parquet"
    with atomic_write(path) as file:
        file.write(content)
    return path


class PartsStore:
    """A store of parts that is open for writing, as :class:`~evenroad_studies.bench.store.Store` is."""

    def __init__(self, folder: Path, session: Session) -> None:
        self.path, self._session = folder, session
        self._waiting: list[tuple[Any, ...]] = []
        self._own: list[Path] = []
        self._last_commit = time.monotonic()
        folder.mkdir(exist_ok=True)

    def finished(self) -> dict[str, bool]:
        """Return the keys of the tasks that have a row, and whether it is an answer, not a failure of the run."""
        rows = read_parts(self.path)
        columns = [getattr(rows, name) for name in Task.__annotations__]
        values = [
            list(map(each.__getitem__, range(len(each)))) if isinstance(each, Labels) else each.tolist()
            for each in columns
        ]
        keys = (key_of(PROTOCOL, *fields) for fields in zip(*values, strict=True))
        return dict(zip(keys, rows.answered.tolist(), strict=True))

    def add(self, suite: str, task: Task, outcome: Outcome, worker: str) -> None:
        """Take the row of a finished task for the next commit."""
        self._waiting.append(row_of(suite, task, outcome, worker)[1:])

    def commit_if_due(self) -> None:
        """Commit, if the last time was long enough ago."""
        if time.monotonic() - self._last_commit >= COMMIT_SECONDS:
            self.commit()

    def commit(self) -> None:
        """Write what was added."""
        if self._waiting:
            columns = dict(zip(_KEPT, map(list, zip(*self._waiting, strict=True)), strict=True))
            self._own.append(write_part(self.path, columns, self._session))
            self._waiting.clear()
        self._last_commit = time.monotonic()

    def close(self) -> None:
        """Commit, and make one file of those that this writer wrote."""
        self.commit()
        if len(self._own) < 2:
            return
        pa, _ = _arrow()
        tables = [_table(path) for path in self._own]
        table = pa.concat_tables(tables, promote_options="permissive").unify_dictionaries()
        names = [path.name for path in self._own]
        write_part(self.path, {name: table[name] for name in _KEPT}, self._session, names)
        for path in self._own:
            path.unlink(missing_ok=True)


def parts_of(folder: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield the files of a store that count, each checked; BrokenFile if one is not as it was written."""
    _, pq = _arrow()
    paths = sorted(Path(folder).glob("part-*.parquet"))
    replaced: set[str] = set()
    for path in paths:
        try:
            about = pq.read_schema(path).metadata or {}
        except Exception as error:
            raise damaged(path, error) from error
        if about.get(_SCHEMA) != _VERSION:
            raise BrokenFile(f"{path} is no file of a store of benchmark results that this evenroad reads")
        replaced.update(json.loads(about[_REPLACES]))
    for path in paths:
        if path.name in replaced:
            continue
        try:
            with path.open("rb") as file:
                digest = hashlib.file_digest(file, "sha256").hexdigest()[:DIGITS]
        except FileNotFoundError:
            raise _replaced(path) from None
        if digest != path.stem.rsplit("-", 1)[-1]:
            raise damaged(path, "its bytes are not those that were written")
        yield path


def read_parts(folder: str | os.PathLike[str], *, problems: Sequence[str] | None = None) -> Rows:
    """Read finished rows of today's protocol, in the order of the tasks' fields, of all problems or of some.

    Of rows of one task an answer counts before a failure of a run, and then the first file's.
    """
    require_folder(folder)
    parts = [rows_of_part(part, problems) for part in parts_of(folder)]
    return joined(parts or [_rows_of(_empty())])


def rows_of_part(part: Path, problems: Sequence[str] | None = None) -> Rows:
    """Return the rows of a file, of today's protocol, in its order."""
    return _rows_of(_table(part, problems))


def problems_of(part: Path) -> tuple[str, ...]:
    """Return the problems of a file, in alphabetical order."""
    _, pq = _arrow()
    column = pq.read_table(part, columns=["problem"], partitioning=None)["problem"]
    return tuple(sorted(column.unique().to_pylist()))


def sessions_of_parts(folder: str | os.PathLike[str]) -> tuple[Session, ...]:
    """Return the sessions that wrote a store, the first one first."""
    _, pq = _arrow()
    require_folder(folder)
    found = {Session(**json.loads(pq.read_schema(part).metadata[_SESSION])): None for part in parts_of(folder)}
    return tuple(sorted(found))


def require_folder(folder: str | os.PathLike[str]) -> None:
    """Raise BrokenFile unless this is a folder."""
    if not os.path.isdir(folder):
        raise BrokenFile(f"no such store: {os.fspath(folder)}")


def _table(part: Path, problems: Sequence[str] | None = None) -> Any:
    pa, pq = _arrow()
    chosen = [("protocol", "=", PROTOCOL)]
    if problems is not None:
        chosen.append(("problem", "in", list(problems)))  # type: ignore[arg-type]
    try:
        return pq.read_table(part, filters=chosen, partitioning=None)
    except FileNotFoundError:
        raise _replaced(part) from None
    except pa.ArrowException as error:
        raise damaged(part, error) from error


def _replaced(part: Path) -> BrokenFile:
    return BrokenFile(f"{part} was put into a larger file while the store was read: read it again")


def _rows_of(table: Any) -> Rows:
    columns: dict[str, Any] = {}
    for name in Rows.__annotations__:
        column = table[name]
        if name in NAMED:
            columns[name] = _labels(column)
        elif name in _FLOATS:
            columns[name] = column.fill_null(np.nan).to_numpy()
        else:
            columns[name] = column.fill_null(-1).to_numpy()
    return Rows(**columns)


def _labels(column: Any) -> Labels:
    """Return a column of texts; chunks of a file have dictionaries of their own."""
    pa, _ = _arrow()
    texts = column.unify_dictionaries().combine_chunks()
    if isinstance(texts, pa.ChunkedArray):
        texts = texts.chunk(0) if texts.num_chunks else pa.array([], pa.dictionary(pa.int32(), pa.string()))
    names = texts.dictionary.to_pylist()
    order = sorted(range(len(names)), key=names.__getitem__)
    rank = np.empty(len(names), dtype=np.int32)
    rank[order] = np.arange(len(names), dtype=np.int32)
    codes = rank[texts.indices.to_numpy()] if len(names) else np.empty(0, dtype=np.int32)
    return Labels(codes, tuple(names[place] for place in order))


def _array(name: str, values: Any) -> Any:
    pa, _ = _arrow()
    if isinstance(values, (pa.Array, pa.ChunkedArray)):
        return values
    if name in _TEXTS:
        return pa.array(values, pa.string()).dictionary_encode()
    return pa.array(values, pa.float64() if name in _FLOATS else pa.int64())


def _empty() -> Any:
    pa, _ = _arrow()
    return pa.table({name: _array(name, []) for name in _KEPT})


def _arrow() -> tuple[Any, Any]:
    what = "a store of parts"
    return require_extra("pyarrow", "parquet", what), require_extra("pyarrow.parquet", "parquet", what)
