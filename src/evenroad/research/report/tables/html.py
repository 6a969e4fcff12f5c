"""Tables as HTML."""

from __future__ import annotations

from html import escape

from evenroad.research.report.tables.table import Entry, Table


def as_html(table: Table) -> str:
    """Return a ``<figure>`` with caption, table and notes; marks become classes."""
    head = "".join(f"<th>{escape(name)}</th>" for name in table.header)
    rows = "\n".join(
        "<tr>" + "".join(_cell(entry, place < table.labels) for place, entry in enumerate(row)) + "</tr>"
        for row in table.rows
    )
    notes = "".join(f"<p class='note'>{escape(note)}</p>" for note in table.notes)
    return (
        f"<figure id='{escape(table.name, quote=True)}'><figcaption>{escape(table.title)}</figcaption>\n"
        f"<div class='wide'><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}\n</tbody></table></div>"
        f"{notes}</figure>\n"
    )


def _cell(entry: Entry, is_label: bool) -> str:
    classes = " ".join(filter(None, ("label" if is_label else "", entry.mark)))
    attribute = f" class='{classes}'" if classes else ""
    return f"<td{attribute}>{escape(entry.text)}</td>"
