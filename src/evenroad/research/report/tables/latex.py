"""Tables as LaTeX, for a document that loads ``booktabs``."""

from __future__ import annotations

from evenroad.research.report.tables.table import Entry, Table

_SPECIAL = {
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
_MARKS = {
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
        rf"\caption{{{_escape(table.title)}}}",
        rf"\label{{tab:{table.name}}}",
        rf"\begin{{tabular}}{{{columns}}}",
        r"\toprule",
        _line([_escape(name) for name in table.header]),
        r"\midrule",
        *(_line([_text(entry) for entry in row]) for row in table.rows),
        r"\bottomrule",
        r"\end{tabular}",
        *(rf"\par\footnotesize {_escape(note)}" for note in table.notes),
        r"\end{table}",
    ]
    return "\n".join(lines) + "\n"


def _line(cells: list[str]) -> str:
    return " & ".join(cells) + r" \\"


def _text(entry: Entry) -> str:
    text = _escape(entry.text)
    return _MARKS[entry.mark].format(text)


def _escape(text: str) -> str:
    return "".join(_SPECIAL.get(character, character) for character in text.replace("\n", " "))
