"""Reading the words of a command line as a verb's options; what is wrong becomes one line."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import MISSING
from typing import Any

from evenroad.cli.options import Option, options_of
from evenroad.errors import InvalidValue, UnknownName, near, shown

HELP = {"-h", "--help"}
AXES = ("-x", "-y", "-z")
"""Values that look like options."""
EARLIER = {"--family": "--sampler", "--certify": "--guarantees"}
"""Earlier name of an option -> its name; verbs without an option of the earlier name take it."""

_ELSEWHERE = {
    "--seconds": "--time", "--timeout": "--time", "--time-limit": "--time", "--max-time": "--time", "--rng": "--seed",
    "--random-seed": "--seed", "--output": "--out", "--save": "--out", "--radius": "--robot-radius",
    "--urdf": "--robot", "--arm": "--robot", "--end": "--goal", "--target": "--goal", "--pose": "--goal-pose",
    "--traj": "--trajectory", "--margin": "--clearance", "--degrees": "--deg",
}  # fmt: skip
"""What others call an option -> its name here."""
_WORLDS = {"--scene", "--map", "--world", "--input", "--file", "--plan"}
"""What others call the first word of a verb."""


def read_options(verb: str, kind: type, words: Sequence[str]) -> Any:
    """Return a verb with the options of a command line; the last of repeated ones counts.

    Raises InvalidValue or UnknownName for wrong or missing options, and SystemExit after printing help.
    """
    program, options = f"evenroad {verb}", options_of(kind)
    words, rest = _without_rest(words, options)
    if not HELP.isdisjoint(words):
        # The other options need not be complete for help, which is imported late.
        from evenroad.cli.help import help_of

        print(help_of(program, kind, options), end="")
        raise SystemExit(0)
    known = {name for option in options for name in option.names if name.startswith("--")}
    words = [current_option(word, known) for word in words]
    require_known_options(program, words, known)
    given, unknown, loose = _sorted(options, words, f"all options: {program} --help")
    if unknown:
        meant = near(unknown[0], known)
        raise InvalidValue(f"{program} has no use for the word {shown(unknown[0])}{meant and '; '}{meant}")
    values: dict[str, object] = dict(rest)
    for option in options:
        uses = given.get(option.field, [])
        if option.kind is bool:
            values[option.field] = bool(uses)
        elif uses:
            read = [option.of(each) for each in uses]
            values[option.field] = tuple(read) if option.repeatable else read[-1]
    missing = [each.text for each in options if each.default is MISSING and each.field not in values]
    if missing:
        raise InvalidValue(f"missing from {program}: {' and '.join(missing)}; all options: {program} --help")
    if loose:
        raise InvalidValue(f"{program} has no use for the word {shown(loose[0])}")
    return kind(**values)


def _without_rest(words: Sequence[str], options: Sequence[Option]) -> tuple[Sequence[str], dict[str, tuple[str, ...]]]:
    """Return the words before an option that takes all that follow, and these by its field."""
    for option in options:
        if option.takes_rest and option.names[0] in words:
            at = words.index(option.names[0])
            return words[:at], {option.field: tuple(words[at + 1 :])}
    return words, {}


def _sorted(
    options: Sequence[Option], words: Sequence[str], hint: str
) -> tuple[dict[str, list[list[str]]], list[str], list[str]]:
    """Return the words of each use of each option, by field; words like unknown options; and words left over."""
    named = {name: option for option in options for name in option.names}
    positional = [option for option in options if not option.names]
    needed = sum(option.default is MISSING for option in positional)
    given: dict[str, list[list[str]]] = {}
    loose: list[str] = []
    unknown: list[str] = []
    rest = deque(words)
    while rest:
        word = rest.popleft()
        if word == "--":
            loose += rest
            break
        name, equals, value = _split(word, named)
        option = named.get(name)
        if option is None:
            (unknown if _is_like_an_option(word) else loose).append(word)
            continue
        uses = given.setdefault(option.field, [])
        if option.kind is bool:
            uses.append([])
            unknown += [value] if equals else []
            continue
        # The last words of the line are those that have no name, if these are still to come.
        taken = _taken(option, [value] if equals else [], rest, named, needed - len(loose))
        if not taken:
            raise InvalidValue(f"{'/'.join(option.names)} needs a value: {option.text}; {hint}")
        uses.append(taken)
    for option in positional:
        if loose:
            count = len(loose) if option.several else 1
            given[option.field] = [loose[:count]]
            del loose[:count]
    return given, unknown, loose


def _split(word: str, named: dict[str, Option]) -> tuple[str, str, str]:
    """Return the name of an option, and the value that stands in the same word: ``-n3`` is ``-n=3``."""
    name, equals, value = word.partition("=")
    return (word[:2], "=", word[2:]) if name not in named and word[:2] in named else (name, equals, value)


def _taken(option: Option, values: list[str], rest: deque[str], named: dict[str, Option], reserved: int) -> list[str]:
    """Return the values of an option: those that it has, and words of the rest, of which some are reserved."""
    while rest and (option.several or not values) and not _stops(rest[0], named):
        if values and len(rest) <= reserved:
            break
        values.append(rest.popleft())
    return values


def _stops(word: str, named: dict[str, Option]) -> bool:
    name = word.partition("=")[0]
    return word == "--" or name in named or (_is_like_an_option(word) and word not in AXES)


def _is_like_an_option(word: str) -> bool:
    """Return whether a word is a dash and a letter: numbers and lists of them may begin with a dash, too."""
    name = word.partition("=")[0]
    try:
        float(name)
    except ValueError:
        return name.startswith("-") and name.lstrip("-")[:1].isalpha()
    return False


def require_known_options(program: str, words: Sequence[str], known: set[str]) -> None:
    """Raise UnknownName, which suggests a near one, if an option among the words is none of the long names known."""
    for name in sorted(given_options([current_option(word, known) for word in words]) - known):
        # All of them would fill half a screen.
        meant = _ELSEWHERE.get(name, "")
        hint = f"it is {meant}" if meant in known else near(name, known) or f"all options: {program} --help"
        hint = "the file or name is the first word, without an option" if name in _WORLDS else hint
        raise UnknownName(f"unknown option of {program}: {shown(name)}; {hint}")


def given_options(words: Sequence[str]) -> set[str]:
    """Return the long names among the words of a command line."""
    return {word.partition("=")[0].replace("_", "-") for word in words if word.startswith("--") and word != "--"}


def current_option(word: str, known: set[str]) -> str:
    """Return a word with the current name of its option, with hyphens."""
    if not word.startswith("--") or word == "--":
        return word
    name, equals, value = word.partition("=")
    name = name.replace("_", "-")
    new = EARLIER.get(name, name)
    return (new if new in known and name not in known else name) + equals + value
