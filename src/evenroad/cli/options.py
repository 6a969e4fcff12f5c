"""The options of a verb, from the fields of its class.

A verb is a frozen dataclass: its fields are the options, their types say what is read, and the text below a field is
its help. Marks say what a type does not: ``Positional[Path]``, ``Repeatable[tuple[str, ...]]``, and the short name in
``Annotated[int, "-n"]``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, TypeVar, get_args, get_origin, get_type_hints

from evenroad.errors import InvalidValue, shown

_T = TypeVar("_T")
Positional = Annotated[_T, "positional"]
"""A word by its position, without a name."""
Repeatable = Annotated[_T, "repeatable"]
"""An option that may be given several times: a tuple of its values."""
Rest = Annotated[_T, "rest"]
"""An option that takes all words that follow, whatever they look like."""

READ: dict[type, tuple[str, Callable[[str], object], str]] = {
    str: ("STR", str, "a text"),
    Path: ("PATH", Path, "a path"),
    int: ("INT", int, "a whole number"),
    float: ("FLOAT", float, "a number"),
}
"""Type of a value -> its name in the help, what reads it, and what it must be."""


class Option(NamedTuple):
    """One option of a verb, or a word by its position, which has no names."""

    field: str
    names: tuple[str, ...]
    kind: type
    """Type of a single value; an option of type bool stands alone."""
    choices: tuple[str, ...]
    several: bool
    """Takes all words up to the next option."""
    repeatable: bool
    default: object
    """MISSING where it is required."""
    takes_rest: bool = False
    """Takes all words that follow."""

    @property
    def value(self) -> str:
        """Return what stands for its value in the help."""
        one = (
            f"{{{','.join(self.choices)}}}"
            if self.choices
            else READ[self.kind][0]
            if self.names
            else self.field.upper()
        )
        return f"{one} ..." if self.several else one

    @property
    def text(self) -> str:
        """Return the option as the help names it: ``-n INT, --n INT``."""
        if not self.names:
            return self.value if self.default is MISSING else f"[{self.value}]"
        return ", ".join(self.names if self.kind is bool else (f"{name} {self.value}" for name in self.names))

    def of(self, words: Sequence[str]) -> object:
        """Return the value that the words of one use say."""
        values = tuple(map(self._read, words))
        return values if self.several else values[0]

    def _read(self, word: str) -> object:
        name = "/".join(self.names) or self.field.upper()
        if self.choices:
            if word not in self.choices:
                raise InvalidValue(f"{name} must be one of {', '.join(self.choices)}, got {shown(word)}")
            return word
        _, read, must_be = READ[self.kind]
        try:
            return read(word)
        except ValueError:
            raise InvalidValue(f"{name} must be {must_be}, got {shown(word)}") from None


def options_of(kind: type) -> list[Option]:
    """Return the options of a verb's class, in the order of its fields."""
    hints = get_type_hints(kind, include_extras=True)
    return [_option(each.name, hints[each.name], each.default) for each in fields(kind)]


def _option(field: str, hint: Any, default: object) -> Option:
    marks: tuple[str, ...] = getattr(hint, "__metadata__", ())
    kind = get_args(hint)[0] if marks else hint
    if type(None) in get_args(kind):
        kind, *_ = (each for each in get_args(kind) if each is not type(None))
    repeatable = "repeatable" in marks
    depth = 0
    while get_origin(kind) is tuple:
        kind, depth = get_args(kind)[0], depth + 1
    choices = get_args(kind) if get_origin(kind) is Literal else ()
    short = tuple(mark for mark in marks if mark.startswith("-"))
    names = () if "positional" in marks else (*short, f"--{field.replace('_', '-')}")
    return Option(
        field, names, str if choices else kind, choices, depth > repeatable, repeatable, default, "rest" in marks
    )


def option_names(kind: type) -> set[str]:
    """Return the long names of a verb's options, such as ``--start``."""
    return {f"--{each.name.replace('_', '-')}" for each in fields(kind) if "Positional" not in str(each.type)}
