"""Tables: one value, written as HTML, Markdown or LaTeX; and how numbers are written in them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import NamedTuple

from evenroad.errors import InvalidValue
from evenroad_studies.statistics.rates import Interval


class Entry(NamedTuple):
    """One entry of a table: plain text, which each format escapes, and a mark.

    ``better``, ``worse`` or ``differs``: what a test has found.  ``faint``: there is no result.
    """

    text: str
    mark: str = ""


Row = tuple[Entry, ...]


@dataclass(frozen=True)
class Table:
    """A table: its first columns, as many as `labels`, name the row and are set left, the others right.

    `name` is unique in a report, links and labels are made of it; `title` is the line above, `notes` are sentences
    below.
    """

    name: str
    title: str
    header: Sequence[str]
    rows: Sequence[Row]
    labels: int = 1
    notes: Sequence[str] = ()

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.header):
                raise InvalidValue(f"{self.name}: a row of {len(row)} under a header of {len(self.header)}")


NOTHING = Entry("–", "faint")
"""Where there is no number."""


def row(*parts: Entry | str | int) -> Row:
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


def _ends(interval: Interval) -> str:
    return f"[{100 * interval.low:.0f}, {100 * interval.high:.0f}]"


def number(value: float) -> str:
    """Write a number with one digit, or a dash where there is none."""
    return "–" if math.isnan(value) else f"{value:.1f}"


def count_range(counts: Sequence[int]) -> str:
    """Write the smallest and the largest of some counts: ``400`` or ``64–400``."""
    low, high = min(counts), max(counts)
    return str(low) if low == high else f"{low}–{high}"


def as_html(table: Table) -> str:
    """Return a ``<figure>`` with caption, table and notes; marks become classes."""
    head = _html_row("th", [Entry(name) for name in table.header], table.labels)
    rows = "\n".join(_html_row("td", row, table.labels) for row in table.rows)
    notes = "".join(f"<p class='note'>{escape(note)}</p>" for note in table.notes)
    return (
        f"<figure id='{escape(table.name, quote=True)}'><figcaption>{escape(table.title)}</figcaption>\n"
        f"<div class='wide'><table>\n<thead>{head}</thead>\n<tbody>\n{rows}\n</tbody></table></div>"
        f"{notes}</figure>\n"
    )


def _html_row(tag: str, row: Sequence[Entry], labels: int) -> str:
    cells = []
    for place, (text, mark) in enumerate(row):
        classes = " ".join(filter(None, ("label" if place < labels else "", mark)))
        attribute = f" class='{classes}'" if classes else ""
        cells.append(f"<{tag}{attribute}>{escape(text)}</{tag}>")
    return f"<tr>{''.join(cells)}</tr>"


_MARKDOWN_MARKS = {"": "", "faint": "", "better": " ▲", "worse": " ▼", "differs": " ≠"}
"""What stands for a mark where there are no colours."""


def as_markdown(table: Table) -> str:
    """Return a heading, a pipe table and the notes."""
    rule = [":--" if place < table.labels else "--:" for place in range(len(table.header))]
    rows = [[_markdown(text) + _MARKDOWN_MARKS[mark] for text, mark in row] for row in table.rows]
    lines = [f"| {' | '.join(cells)} |" for cells in ([*map(_markdown, table.header)], rule, *rows)]
    notes = [f"\n{_markdown(note)}" for note in table.notes]
    return "\n".join([f"### {_markdown(table.title)}\n", *lines, *notes]) + "\n"


def _markdown(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


_LATEX_TEXT = str.maketrans({
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": r"$<$", ">": r"$>$", "|": r"$|$", "≤": r"$\leq$",
    "±": r"$\pm$", "−": r"$-$", "–": "--", "≠": r"$\neq$", "×": r"$\times$", "\n": " ",
})  # fmt: skip
_LATEX_MARKS = {
    "": "{}",
    "faint": "{}",
    "better": r"\textbf{{{}}}",
    "worse": r"\emph{{{}}}",
    "differs": r"\underline{{{}}}",
}


def _latex(text: str) -> str:
    return text.translate(_LATEX_TEXT)


def as_latex(table: Table) -> str:
    """Return a ``table`` environment: better is bold, worse is emphasised, what differs is underlined."""
    columns = "l" * table.labels + "r" * (len(table.header) - table.labels)
    marked = [[_LATEX_MARKS[mark].format(_latex(text)) for text, mark in row] for row in table.rows]
    header, *body = (" & ".join(cells) + r" \\" for cells in (map(_latex, table.header), *marked))
    lines = [
        r"\begin{table}",
        rf"\caption{{{_latex(table.title)}}}",
        rf"\label{{tab:{table.name}}}",
        rf"\begin{{tabular}}{{{columns}}}",
        *(r"\toprule", header, r"\midrule", *body, r"\bottomrule", r"\end{tabular}"),
        *(rf"\par\footnotesize {_latex(note)}" for note in table.notes),
        r"\end{table}",
    ]
    return "\n".join(lines) + "\n"
