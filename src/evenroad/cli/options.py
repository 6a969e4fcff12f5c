"""Options of a verb, read by tyro from a command line; its errors become one line.

A verb is a frozen dataclass: its fields are the options, and the text below a field is its help.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import MISSING, fields, is_dataclass, replace
from inspect import get_annotations
from io import StringIO
from itertools import dropwhile, takewhile
from textwrap import fill
from typing import Annotated, Any, Union

from tyro import cli, conf
from tyro.constructors import (
    ConstructorRegistry,
    PrimitiveConstructorSpec,
    PrimitiveTypeInfo,
    StructConstructorSpec,
    StructFieldSpec,
    StructTypeInfo,
)

from evenroad._checks import require_known
from evenroad._terminal import table_width
from evenroad.cli.help import regrouped
from evenroad.errors import InvalidValue, UnknownName, shown

HELP = {"-h", "--help"}
MARKS = (conf.FlagCreatePairsOff, conf.DisallowNone, conf.PositionalMetavarFromFieldName)
NUMBERS = {int: "a whole number", float: "a number"}
RULES = ConstructorRegistry()
AXES = ("-x", "-y", "-z")
EARLIER = {"--family": "--sampler", "--certify": "--guarantees"}
"""Earlier name of an option -> its name; verbs without an option of the earlier name take it."""
_INSIDE: list[StructTypeInfo] = []
"""The verb whose options tyro lists now."""
UNSAID = (None, False, "", ())
"""Defaults that the help does not print: its text describes them."""


def read_options(verb: str, kind: type, words: Sequence[str]) -> Any:
    """Return a verb with the options of a command line; the last of repeated ones counts.

    Raises InvalidValue or UnknownName for wrong or missing options, and SystemExit after printing help.
    """
    known, program = option_names(kind), f"evenroad {verb}"
    if not HELP.isdisjoint(words):
        # Whoever wants help need not have finished the other options.
        words = ["--help"]
    words = [current_option(word, known) for word in words]
    for name in sorted(given_options(words) - known - HELP):
        raise UnknownName.among(f"option of {program}:", name, known)
    texts = [" ".join(text.split()) for text in (kind.__doc__ or "").split("\n\n")]
    # Tyro does not wrap the text about a verb, and joins lines that begin with a letter.
    about = "\n\n".join(fill(text, table_width(), subsequent_indent="  ") for text in texts)
    printed = StringIO()
    try:
        with redirect_stdout(printed):
            options, unknown = _parsed(kind, program, _with_axes(words), about)
    except SystemExit:
        print(regrouped(printed.getvalue(), getattr(kind, "groups", {})), end="")
        raise
    if unknown:
        raise InvalidValue(f"{program} has no use for the word {shown(unknown[0])}")
    for field in fields(kind):
        # Tyro does not require repeatable options.
        if field.default is MISSING and getattr(options, field.name) == ():
            raise InvalidValue(f"missing from {program}: --{field.name}; all options: {program} --help")
    return options


def print_completion(kinds: Mapping[str, type], words: Sequence[str]) -> None:
    """Print tyro's completion script of these verbs for a shell; ends with SystemExit."""
    require_known("shell", "".join(words[1:2]), ("bash", "zsh", "fish"))
    verbs = [Annotated[kind, conf.subcommand(verb, prefix_name=False)] for verb, kind in kinds.items()]
    _parsed(Union[tuple(verbs)], "evenroad", words)  # noqa: UP007


def option_names(kind: type) -> set[str]:
    """Return the long names of a verb's options, such as ``--start``."""
    return {f"--{each.name.replace('_', '-')}" for each in fields(kind) if "Positional" not in str(each.type)}


def given_options(words: Sequence[str]) -> set[str]:
    """Return the long names among the words of a command line."""
    return {word.partition("=")[0].replace("_", "-") for word in words if word.startswith("--")}


def current_option(word: str, known: set[str]) -> str:
    """Return a word with the current name of its option."""
    name, equals, value = word.partition("=")
    new = EARLIER.get(name, name)
    return new + equals + value if new in known and name not in known else word


def _with_axes(words: Sequence[str]) -> list[str]:
    """Return words with axes joined to their options: ``--away -z`` becomes ``--away=-z``."""
    joined: list[str] = []
    for word in words:
        if word in AXES and joined and joined[-1].startswith("--") and "=" not in joined[-1]:
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def _parsed(kind: Any, prog: str, words: Sequence[str], about: str = "") -> Any:
    """Return the options that tyro reads from the words, and the unknown words."""
    said = StringIO()
    try:
        with redirect_stderr(said), RULES:
            return cli(kind, prog=prog, description=about, args=words, config=MARKS, return_unknown_args=True)
    except SystemExit as end:
        if not end.code:
            raise
        raise InvalidValue(f"{_in_words(said.getvalue())}; all options: {prog} --help") from None


@RULES.struct_rule
def _verb(info: StructTypeInfo) -> StructConstructorSpec | None:
    """Make tyro list a verb's own options before shared ones, with our text for defaults."""
    if _INSIDE or not is_dataclass(info.type):
        return None
    _INSIDE.append(info)
    try:
        made = ConstructorRegistry.get_struct_spec(info)
    finally:
        _INSIDE.pop()
    assert isinstance(made, StructConstructorSpec)
    # From the verb's class up to those that it inherits from.
    declared = [name for each in info.type.__mro__ for name in get_annotations(each)]
    listed = sorted(made.fields, key=lambda field: declared.index(field.name))
    return replace(made, fields=tuple(map(_worded, listed)))


def _worded(field: StructFieldSpec) -> StructFieldSpec:
    """Return an option with its text in one piece, and without an empty default."""
    hint = None
    if "AppendAction" in str(field.type):
        hint = "(repeatable)" if field.default == () else "(required, repeatable)"
    elif any(field.default is each for each in UNSAID):
        hint = ""
    kind = field.type if hint is None else Annotated[field.type, conf.arg(help_behavior_hint=hint)]
    return replace(field, helptext=lambda: _text(field.helptext), type=kind)  # type: ignore[arg-type]


def _text(help: str | Callable[[], str | None] | None) -> str:
    """Return the help of an option in one line."""
    return " ".join(((help() if callable(help) else help) or "").split())


@RULES.primitive_rule
def _number(info: PrimitiveTypeInfo) -> PrimitiveConstructorSpec[Any] | None:
    """Make tyro read numbers, with our errors."""
    kind = next((each for each in NUMBERS if info.type in (each, each | None)), None)
    if kind is None:
        return None

    def read(words: list[str]) -> Any:
        try:
            return kind(words[0])
        except ValueError:
            raise ValueError(f"must be {NUMBERS[kind]}, got {shown(words[0])}") from None

    return PrimitiveConstructorSpec(1, kind.__name__.upper(), read, lambda _: True, lambda each: [str(each)])


def _in_words(box: str) -> str:
    """Return the message in a box of tyro, without title, frame, colours and help."""
    rule = re.compile("[─-]+").fullmatch
    lines = [line[2:].rstrip("│ ") for line in re.sub(r"\x1b\[[\d;]*m", "", box).splitlines()[1:]]
    above = takewhile(lambda line: not rule(line), dropwhile(rule, lines))
    said = " ".join(line.strip() for line in above if not line.startswith(" " * 8)) or box.strip()
    said = re.sub(r"^Error parsing (\S+):", r"\1", said).rstrip(".")
    return said[:1].lower() + said[1:]
