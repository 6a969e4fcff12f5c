"""Tables: one value, written as HTML, Markdown or LaTeX; and how numbers are written in them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from html import escape

from evenroad.errors import InvalidValue
from evenroad.research.statistics import Interval


@dataclass(frozen=True)
class Entry:
    """One entry of a table: plain text, which each format escapes, and a mark.

    ``better``, ``worse`` or ``differs``: what a test has found.  ``faint``: there is no result.
    """

    text: str
    mark: str = ""


@dataclass(frozen=True)
class Table:
    """A table: its first columns, as many as `labels`, name the row and are set left, the others right.

    `name` is unique in a report, links and labels are made of it; `title` is the line above, `notes` are sentences
    below.
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


NOTHING = Entry("–", "faint")
"""Where there is no number."""


def row(*parts: Entry | str | int) -> tuple[Entry, ...]:
    """Return a row; texts and numbers become entries without a mark."""
    return tuple(part if isinstance(part, Entry) else Entry(str(part)) for part in parts)


def change_entry(change: float, interval: Interval, significant: bool, after: str = "") -> Entry:
    """Return the entry of a difference of success rates, marked if a test found it."""
    mark = ("better" if change > 0 else "worse") if significant else ""
    return Entry(difference(change, interval) + after, mark)


def percent(share: float) -> str:
    """Write a share as a percentage with one digit: ``52.8``."""
    return f"{100 * share:.1f}"


def with_interval(share: float, interval: Interval) -> str:
    """Write a share and its interval: ``52.8 [50, 56]``."""
    return f"{percent(share)} {_ends(interval)}"


def difference(share: float, interval: Interval) -> str:
    """Write a difference in points and its interval: ``+7.5 [2, 13]``."""
    return f"{100 * share:+.1f} {_ends(interval)}"


def number(value: float, digits: int = 1) -> str:
    """Write a number, or a dash where there is none."""
    return "–" if math.isnan(value) else f"{value:.{digits}f}"


def count_range(counts: tuple[int, ...]) -> str:
    """Write the smallest and the largest of some counts: ``400`` or ``64–400``."""
    low, high = min(counts), max(counts)
    return str(low) if low == high else f"{low}–{high}"


def _ends(interval: Interval) -> str:
    return f"[{100 * interval.low:.0f}, {100 * interval.high:.0f}]"


def as_html(table: Table) -> str:
    """Return a ``<figure>`` with caption, table and notes; marks become classes."""
    head = "".join(
        f"<th class='label'>{escape(name)}</th>" if place < table.labels else f"<th>{escape(name)}</th>"
        for place, name in enumerate(table.header)
    )
    rows = "\n".join(
        "<tr>" + "".join(_html_cell(entry, place < table.labels) for place, entry in enumerate(row)) + "</tr>"
        for row in table.rows
    )
    notes = "".join(f"<p class='note'>{escape(note)}</p>" for note in table.notes)
    return (
        f"<figure id='{escape(table.name, quote=True)}'><figcaption>{escape(table.title)}</figcaption>\n"
        f"<div class='wide'><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}\n</tbody></table></div>"
        f"{notes}</figure>\n"
    )


def _html_cell(entry: Entry, is_label: bool) -> str:
    classes = " ".join(filter(None, ("label" if is_label else "", entry.mark)))
    attribute = f" class='{classes}'" if classes else ""
    return f"<td{attribute}>{escape(entry.text)}</td>"


MARKDOWN_MARKS = {"": "", "faint": "", "better": " ▲", "worse": " ▼", "differs": " ≠"}
"""What stands for a mark where there are no colours."""


def as_markdown(table: Table) -> str:
    """Return a heading, a pipe table and the notes."""
    header = _markdown_line([_markdown_escape(name) for name in table.header])
    rule = _markdown_line([":--" if place < table.labels else "--:" for place in range(len(table.header))])
    rows = [_markdown_line([_markdown_text(entry) for entry in row]) for row in table.rows]
    notes = [f"\n{_markdown_escape(note)}" for note in table.notes]
    return "\n".join([f"### {_markdown_escape(table.title)}\n", header, rule, *rows, *notes]) + "\n"


def _markdown_line(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _markdown_text(entry: Entry) -> str:
    return _markdown_escape(entry.text) + MARKDOWN_MARKS[entry.mark]


def _markdown_escape(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


_LATEX_SPECIAL = {
    "\\": r"\textbackslash{}",
    "&": r"\&",
    "%": r"\%",
    "$": r"\$",
    "#": r"\#",
    "_": r"\_",
    "{": r"\{",
    "}": r"\}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"$<$",
    ">": r"$>$",
    "|": r"$|$",
    "≤": r"$\leq$",
    "±": r"$\pm$",
    "−": r"$-$",
    "–": "--",
    "≠": r"$\neq$",
    "×": r"$\times$",
}
_LATEX_MARKS = {
    "": "{}",
    "faint": "{}",
    "better": r"\textbf{{{}}}",
    "worse": r"\emph{{{}}}",
    "differs": r"\underline{{{}}}",
}


def as_latex(table: Table) -> str:
    """Return a ``table`` environment: better is bold, worse is emphasised, what differs is underlined."""
    columns = "l" * table.labels + "r" * (len(table.header) - table.labels)
    lines = [
        r"\begin{table}",
        rf"\caption{{{_latex_escape(table.title)}}}",
        rf"\label{{tab:{table.name}}}",
        rf"\begin{{tabular}}{{{columns}}}",
        r"\toprule",
        _latex_line([_latex_escape(name) for name in table.header]),
        r"\midrule",
        *(_latex_line([_latex_text(entry) for entry in row]) for row in table.rows),
        r"\bottomrule",
        r"\end{tabular}",
        *(rf"\par\footnotesize {_latex_escape(note)}" for note in table.notes),
        r"\end{table}",
    ]
    return "\n".join(lines) + "\n"


def _latex_line(cells: list[str]) -> str:
    return " & ".join(cells) + r" \\"


def _latex_text(entry: Entry) -> str:
    text = _latex_escape(entry.text)
    return _LATEX_MARKS[entry.mark].format(text)


def _latex_escape(text: str) -> str:
    return "".join(_LATEX_SPECIAL.get(character, character) for character in text.replace("\n", " "))
