"""The help of a verb: what tyro lists, in groups, each option in one paragraph beside its name."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from textwrap import wrap

from evenroad._terminal import table_width

_INDENT = 23
"""Column at which the texts of options begin, in a terminal that is wide enough."""


def regrouped(text: str, groups: Mapping[str, Iterable[str]]) -> str:
    """Return tyro's help with its options in groups, title -> names of fields; the rest comes last."""
    # Written to a text, tyro's boxes are titles above rules.
    head, *boxes = re.split(r"\n [\w ]+\n -+ *\n", text)
    entries = {_field(name): (name, about) for rows in boxes for name, about in _entries(rows)}
    lines = [head.rstrip()]
    named = [(title, [each for each in names if each in entries]) for title, names in groups.items()]
    listed = {each for _, names in named for each in names}
    for title, names in [*named, ("more" if groups else "options", [each for each in entries if each not in listed])]:
        if names:
            lines += ["", f"{title}:"]
        for each in names:
            lines += _paragraph(*entries[each])
    return "\n".join(lines) + "\n"


def _entries(rows: str) -> list[tuple[str, str]]:
    """Return the names and texts of options, of the rows below a title."""
    found: list[list[str]] = []
    for row in rows.splitlines():
        if re.match("  [^ ]", row):
            name, _, about = row.strip().partition("  ")
            found.append([name, about.strip()])
        elif found:
            found[-1][1] += " " + row.strip()
    return [(name, about.strip()) for name, about in found]


def _field(name: str) -> str:
    """Return the field of an option by its long name, or of a word by its own."""
    long = re.findall(r"--([a-z][\w-]*)", name)
    return long[-1].replace("-", "_") if long else name.split()[0].lower()


def _paragraph(name: str, about: str) -> list[str]:
    width = table_width()
    indent = min(_INDENT, width // 3)
    # A repeated word: `[STR [STR ...]]` says no more than `STR ...`.
    name = "  " + re.sub(r"\[(\w+) \[\1 \.\.\.\]\]", r"\1 ...", name)
    if "several" in about:
        about = about.removesuffix("(repeatable)").rstrip()
    texts = wrap(about, max(width - indent, 20)) or [""]
    first = [name.ljust(indent) + texts.pop(0)] if len(name) < indent else wrap(name, width, subsequent_indent="    ")
    return [*(line.rstrip() for line in first), *(" " * indent + line for line in texts)]
