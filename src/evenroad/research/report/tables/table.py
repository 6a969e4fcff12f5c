"""Table: a title, a header and rows of text, before anyone knows how it will be written."""

from __future__ import annotations

from dataclasses import dataclass

from evenroad.errors import InvalidValue


@dataclass(frozen=True)
class Entry:
    """One entry of a table.

    Attributes
    ----------
    text : str
        Plain text: each format escapes what it must.
    mark : str
        ``""``; ``better``, ``worse`` or ``differs`` for what a test has found; ``faint`` for what is beside the point.
    """

    text: str
    mark: str = ""


@dataclass(frozen=True)
class Table:
    """A table.

    Attributes
    ----------
    name : str
        Unique in a report; also what links and labels are made of.
    title : str
        One line above it.
    header : tuple of str
    rows : tuple of tuple of Entry
        Each as long as the header.
    labels : int
        So many first columns name the row and are set left; the others are numbers.
    notes : tuple of str
        Sentences below it: what was tested and how.
    """

    name: str
    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[Entry, ...], ...]
    labels: int = 1
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.header):
                raise InvalidValue(f"{self.name}: a row of {len(row)} under a header of {len(self.header)}")
