"""What benchmarks share: their command line, the CSV of their rows, one row for each robot's file."""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any


def parser_of(doc: str | None) -> argparse.ArgumentParser:
    """Return a parser whose help is a module's docstring, printed as it stands."""
    return argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)


def given_or_table(
    parser: argparse.ArgumentParser, table: Callable[[Sequence[dict[str, str]]], str]
) -> argparse.Namespace:
    """Return the options of a benchmark of robots; with `--table`, print the table of a file's rows and end."""
    parser.add_argument("out", type=Path)
    parser.add_argument("robots", type=Path, nargs="*")
    parser.add_argument("--table", action="store_true")
    given = parser.parse_args()
    if given.table:
        with given.out.open(newline="") as stream:
            print(table(list(csv.DictReader(stream))))
        raise SystemExit
    return given


def write_rows(out: Path | None, columns: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> None:
    """Write rows to a CSV file, in place of what it holds; to none if there is none."""
    if out is not None:
        with out.open("w", newline="") as file:
            writer = csv.DictWriter(file, columns, restval="", lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)


def row_per_robot(
    columns: Sequence[str],
    pattern: str,
    measured: Callable[[Path], dict[str, Any]],
    named: Callable[[Path], str],
    paths: Sequence[Path] = (),
) -> None:
    """Append a row for each robot to a CSV as soon as it is there; folders are searched.

    Of the paths the first is the CSV; default: those of the command line.
    """
    out, *given = paths or map(Path, sys.argv[1:])
    files = [file for path in given for file in (sorted(path.rglob(pattern)) if path.is_dir() else [path])]
    with out.open("a", newline="") as stream:
        writer = csv.DictWriter(stream, columns)
        if out.stat().st_size == 0:
            writer.writeheader()
        for file in files:
            try:
                row = measured(file)
            # One robot that fails says why in its row; the others are measured.
            except Exception as error:
                row = {"robot": named(file), "note": f"{type(error).__name__}: {error}"[:200]}
            writer.writerow(row)
            stream.flush()
            print(row, flush=True)
