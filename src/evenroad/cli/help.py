"""The help of a verb: its options in groups, each in one paragraph beside its name."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING
from inspect import cleandoc, get_annotations, getsource
from itertools import pairwise
from textwrap import fill, wrap

from evenroad._terminal import table_width
from evenroad.cli.options import Option

_INDENT = 23
"""Column at which the texts of options begin, in a terminal that is wide enough."""
_LISTED = 3
"""Most options that the line of usage lists."""
UNSAID = (None, False, "", ())
"""Defaults that the help does not print: its text describes them."""


def help_of(program: str, kind: type, options: Sequence[Option]) -> str:
    """Return the help of a verb's class: how it is used, what it does, and its options."""
    # From the verb's class up to those that it inherits from.
    declared = [name for each in kind.__mro__ for name in get_annotations(each)]
    listed = sorted(options, key=lambda option: declared.index(option.field))
    positional, named = [each for each in listed if not each.names], [each for each in listed if each.names]
    about = [fill(" ".join(text.split()), table_width(), break_on_hyphens=False) for text in _paragraphs(kind)]
    texts = _texts(kind)
    entries = {each.field: (each.text, _with_default(each, texts.get(each.field, ""))) for each in positional}
    entries["help"] = ("-h, --help", "show this help message and exit")
    entries |= {each.field: (each.text, _with_default(each, texts.get(each.field, ""))) for each in named}
    lines = [_usage(program, positional, named), "", "\n\n".join(about)]
    for title, names in _grouped(entries, getattr(kind, "groups", {})):
        lines += ["", f"{title}:"]
        for name in names:
            lines += _entry(*entries[name])
    return "\n".join(lines) + "\n"


def _usage(program: str, positional: Sequence[Option], named: Sequence[Option]) -> str:
    words = [each.text for each in positional]
    if len(named) > _LISTED:
        words = ["[OPTIONS]", *words]
    else:
        # The last of its names is the long one; the first is what most type.
        uses = ((each.text.partition(", ")[0], each.default is MISSING) for each in named)
        words += [text if required else f"[{text}]" for text, required in uses]
    return f"usage: {program} [-h] {' '.join(words)}"


def _paragraphs(kind: type) -> list[str]:
    return cleandoc(kind.__doc__ or "").split("\n\n")


def _grouped(names: Iterable[str], groups: Mapping[str, Iterable[str]]) -> list[tuple[str, list[str]]]:
    """Return each group's title and those of its names that there are; what is in none comes first."""
    there = list(names)
    found = [(title, [each for each in group if each in there]) for title, group in groups.items()]
    in_groups = {each for _, group in found for each in group}
    found.insert(0, ("options", [each for each in there if each not in in_groups]))
    return [(title, group) for title, group in found if group]


def _texts(kind: type) -> dict[str, str]:
    """Return the texts below the fields of a class and of those that it inherits from, in one line each."""
    texts: dict[str, str] = {}
    for each in reversed(kind.__mro__[:-1]):
        tree = ast.parse(getsource(sys.modules[each.__module__]))
        classes = {node.name: node for node in ast.walk(tree) if isinstance(node, ast.ClassDef)}
        for field, below in pairwise(classes[each.__name__].body):
            if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and isinstance(below, ast.Expr):
                text = below.value.value if isinstance(below.value, ast.Constant) else None
                if isinstance(text, str):
                    texts[field.target.id] = " ".join(text.split())
    return texts


def _with_default(option: Option, text: str) -> str:
    """Return the text of an option, and whether it is required and repeatable, or what it is by default."""
    said = ["required"] if option.default is MISSING else []
    if option.repeatable and "several" not in text:
        said.append("repeatable")
    if not said and not any(option.default is each for each in UNSAID):
        said.append(f"default: {option.default}")
    return f"{text} ({', '.join(said)})" if said else text


def _entry(name: str, about: str) -> list[str]:
    width = table_width()
    indent = min(_INDENT, width // 3)
    name = f"  {name}"
    texts = wrap(about, max(width - indent, 20), break_on_hyphens=False) or [""]
    first = [name.ljust(indent) + texts.pop(0)] if len(name) < indent else wrap(name, width, subsequent_indent="    ")
    return [*(line.rstrip() for line in first), *(" " * indent + line for line in texts)]
