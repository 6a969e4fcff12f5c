"""Tables as Markdown."""

from __future__ import annotations

from evenroad.research.report.tables.table import Entry, Table

MARKS = {"": "", "faint": "", "better": " ▲", "worse": " ▼", "differs": " ≠"}
"""What stands for a mark where there are no colours."""


def as_markdown(table: Table) -> str:
    """Return a heading, a pipe table and the notes."""
    header = _line([_escape(name) for name in table.header])
    rule = _line([":--" if place < table.labels else "--:" for place in range(len(table.header))])
    rows = [_line([_text(entry) for entry in row]) for row in table.rows]
    notes = [f"\n{_escape(note)}" for note in table.notes]
    return "\n".join([f"### {_escape(table.title)}\n", header, rule, *rows, *notes]) + "\n"


def _line(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _text(entry: Entry) -> str:
    return _escape(entry.text) + MARKS[entry.mark]


def _escape(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")
