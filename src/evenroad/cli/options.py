"""A verb's options: read from the words of a command line, and told as help.

A verb is a frozen dataclass.  Its fields are its options, and the text below a field is that option's help.
``Annotated[int, "-n"]`` gives an option a short name, too; ``Annotated[Path, "positional"]`` needs none;
``Annotated[tuple[str, ...], "repeated"]`` takes one value each time that it is given.
"""

from __future__ import annotations

import re
import types
from collections.abc import Sequence
from dataclasses import MISSING, Field, dataclass, fields
from pathlib import Path
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from evenroad._checks import require_known
from evenroad.errors import InvalidValue, UnknownName, shown

POSITIONAL, REPEATED = "positional", "repeated"
HELP = {"-h", "--help"}

_KINDS: dict[Any, str] = {int: "a whole number", float: "a number", str: "a text", Path: "a path"}
_OPTION = re.compile(r"--|-[a-zA-Z]$")
"""How a word begins that is an option; -1.57,0,0 is a value."""


@dataclass(frozen=True)
class _Option:
    """An option: its field and names; which values are `known`; whether it takes `several` a time, and `repeats`."""

    field: Field[Any]
    names: tuple[str, ...]
    kind: Any
    known: tuple[object, ...] = ()
    several: bool = False
    repeats: bool = False

    @property
    def title(self) -> str:
        short = len(self.field.name) == 1
        return self.names[0 if short else -1] if self.names else self.field.name.upper()

    @property
    def required(self) -> bool:
        return self.field.default is MISSING

    def value(self, word: str) -> Any:
        if self.known:
            require_known(f"{self.title}:", word, self.known)
            return word
        try:
            return self.kind(word)
        except ValueError:
            raise InvalidValue(f"{self.title} must be {_KINDS[self.kind]}, got {shown(word)}") from None


def read_options(verb: str, kind: type, words: Sequence[str]) -> Any:
    """Return a verb with the options that its words give; of an option given twice the last one counts.

    Raises InvalidValue or UnknownName for what the verb lacks or needs, and for a value that is none of its kind.
    """
    options = _options(kind)
    by_name = {name: option for option in options for name in option.names}
    places = [option for option in options if not option.names]
    values: dict[str, Any] = {}
    rest = list(words)
    while rest:
        word = rest.pop(0)
        if not _OPTION.match(word):
            if not places:
                raise InvalidValue(f"evenroad {verb} has no use for the word {shown(word)}")
            option = places.pop(0)
            values[option.field.name] = option.value(word)
            continue
        name, equals, value = word.partition("=")
        name = name.replace("_", "-")
        if name not in by_name:
            raise UnknownName.among(f"option of evenroad {verb}:", name, [each.title for each in options])
        option = by_name[name]
        if option.kind is bool:
            if equals:
                raise InvalidValue(f"{name} takes no value, got {shown(value)}")
            values[option.field.name] = True
            continue
        taken = [value] * bool(equals)
        while not equals and rest and not _OPTION.match(rest[0]) and (option.several or not taken):
            taken.append(rest.pop(0))
        if not taken:
            raise InvalidValue(f"{name} needs a value")
        given = tuple(map(option.value, taken)) if option.several else option.value(taken[0])
        earlier = values.get(option.field.name, ())
        values[option.field.name] = (*earlier, given) if option.repeats else given
    missing = [each.title for each in options if each.required and each.field.name not in values]
    if missing:
        raise InvalidValue(f"evenroad {verb} needs {', '.join(missing)}; all options: evenroad {verb} --help")
    return kind(**values)


def _options(kind: type) -> list[_Option]:
    """Return the options of a verb, in the order of its fields."""
    hints = get_type_hints(kind, include_extras=True)
    options = []
    for field in fields(kind):
        hint, marks = hints[field.name], ()
        if hasattr(hint, "__metadata__"):
            hint, marks = hint.__origin__, hint.__metadata__
        if get_origin(hint) in (Union, types.UnionType):
            (hint,) = (each for each in get_args(hint) if each is not type(None))
        known = get_args(hint) if get_origin(hint) is Literal else ()
        depth = 0
        while get_origin(hint) is tuple:
            hint, depth = get_args(hint)[0], depth + 1
        repeated = REPEATED in marks
        short = () if repeated else marks
        names = () if POSITIONAL in marks else (*short, f"--{field.name.replace('_', '-')}")
        options.append(
            _Option(
                field, names, hint, known, several=depth > 0 and not repeated, repeats=depth > 1 or repeated
            )
        )
    return options


def option_names(kind: type) -> set[str]:
    """Return the long names of a verb's options, such as ``--start``."""
    return {name for option in _options(kind) for name in option.names if name.startswith("--")}


def help_text(verb: str, kind: type, width: int) -> str:
    """Return a verb's usage, what it does, and each of its options with its default."""
    import inspect
    from textwrap import fill

    options, texts = _options(kind), _texts(kind)
    required = [_with_value(each.title, each) for each in options if each.required]
    usage = fill(f"usage: evenroad {verb} {' '.join(required)} [options]", width, subsequent_indent="    ")
    about = inspect.cleandoc(kind.__doc__ or "").split("\n\n")
    lines = [usage, *("\n" + fill(" ".join(text.split()), width) for text in about)]
    lines += ["", "options:", "  -h, --help"]
    for option in options:
        default, indent = option.field.default, " " * 6
        note = " (required)" if option.required else f" (default: {default})"
        if default is None or default is False or default in ("", ()):
            note = ""
        lines.append(f"  {_with_value(', '.join(option.names) or option.title, option)}")
        text = texts[option.field.name] + note
        lines.append(fill(text, width, initial_indent=indent, subsequent_indent=indent))
    return "\n".join(lines)


def _with_value(name: str, option: _Option) -> str:
    """Return an option's name with what follows it."""
    if option.kind is bool or not option.names:
        return name
    value = "{" + ",".join(map(str, option.known)) + "}"
    if not option.known:
        value = option.field.name.upper() if option.kind in (str, Path) else "NUMBER"
    return f"{name} {value}" + " ..." * option.several


def _texts(kind: type) -> dict[str, str]:
    """Return the text below each field, read from the source of the classes that have them."""
    import ast
    import inspect
    from itertools import pairwise
    from textwrap import dedent

    texts = {}
    for each in reversed(kind.__mro__[:-1]):
        (body,) = ast.parse(dedent(inspect.getsource(each))).body
        assert isinstance(body, ast.ClassDef)
        for first, second in pairwise(body.body):
            if isinstance(first, ast.AnnAssign) and isinstance(second, ast.Expr):
                texts[ast.unparse(first.target)] = " ".join(ast.literal_eval(second.value).split())
    return texts
