"""The errors of evenroad.

Each is an :class:`EvenroadError` and the builtin that fits, so ``except ValueError`` works, too.  Its text names the
bad value and says what is allowed.  "No path" is a result, not an error: see ``evenroad.PlanResult.status``.
"""

import reprlib
from collections.abc import Iterable

SHOWN = 80
"""Largest number of characters of a value in an error's text."""
LONGEST = 600
"""Largest number of characters of an error's text."""
LISTED = 300
"""Largest number of characters of a list of names in an error's text."""
_MOST_PARTS = 1000
"""Largest number of parts of a value that is formatted as a whole."""


def shown(value: object) -> str:
    """Return ``repr(value)`` for an error's text, without its middle if it has more than 80 characters.

    Nested lists of more than 1000 parts are abbreviated: shared ones can be exponentially long.
    """
    try:
        text = repr(value) if _has_few_parts(value) else _BRIEF.repr(value)
    except ValueError:
        # Python does not write integers of more than 4300 digits.
        return f"a number of type {type(value).__name__} with very many digits"
    if len(text) <= SHOWN:
        return text
    mark = f" ... ({len(text)} characters) ... "
    end = (SHOWN - len(mark)) // 2
    return text[: SHOWN - len(mark) - end] + mark + text[-end:]


def in_one_line(text: str) -> str:
    """Return a text in one line, without its middle if it is too long."""
    line = text if text.isprintable() else " ".join(text.split())
    if len(line) <= LONGEST:
        return line
    half = (LONGEST - len(_GAP)) // 2
    return f"{line[:half]}{_GAP}{line[-half:]}"


def distinguished(first: float, second: float) -> tuple[str, str]:
    """Return two different numbers with six digits, or with as many as show that they differ."""
    for digits in range(6, 17):
        texts = f"{first:.{digits}g}", f"{second:.{digits}g}"
        if texts[0] != texts[1]:
            return texts
    return repr(first), repr(second)


def near(name: object, known: Iterable[str]) -> str:
    """Return ``did you mean 'even'?`` for the known names that may be meant, at most three, or "".

    A name may be meant that begins or ends with what was given, that differs from it in numbers alone, or in few
    letters.  Capitals, underscores, and dashes and dots before it make no difference.
    """
    from difflib import get_close_matches

    if not isinstance(name, str) or len(name) >= SHOWN:
        return ""
    word, names = _plain(name), {_plain(each): each for each in known}
    parts = [each for each in names if len(word) > 2 and _is_part(word, each)]
    meant = [word] if word in names else parts
    if not meant:
        meant = get_close_matches(word, names, 1, _NEAR)
    return f"did you mean {' or '.join(repr(names[each]) for each in meant)}?" if 1 <= len(meant) <= 3 else ""


def listed(names: Iterable[str]) -> str:
    """Return names with commas between them; of a long list the first ones, and how many there are."""
    every = list(names)
    text = ", ".join(every)
    if len(text) <= LISTED:
        return text
    return f"{text[:LISTED].rpartition(', ')[0]}, ... ({len(every)} in all)"


def _plain(name: str) -> str:
    return name.lstrip("-.").replace("_", "-").casefold()


def _is_part(word: str, name: str) -> bool:
    """Return whether a name begins or ends with a word, or differs from it in numbers alone."""
    return name.startswith(word) or name.endswith(f"-{word}") or _without_digits(name) == _without_digits(word)


def _without_digits(word: str) -> str:
    return "".join(each for each in word if not each.isdigit())


_NEAR = 0.7
"""Least share of letters in common, in their order, of names that may be meant for each other."""
_GAP = " ... "
_BRIEF = reprlib.Repr()
_BRIEF.maxlevel, _BRIEF.maxstring, _BRIEF.maxother = 2, SHOWN, SHOWN


def _has_few_parts(value: object) -> bool:
    """Return whether nested lists, tuples, sets and mappings have few parts in all, repetitions included."""
    waiting, parts = [value], 0
    while waiting:
        each = waiting.pop()
        inside = [*each.keys(), *each.values()] if isinstance(each, dict) else each
        if isinstance(inside, list | tuple | set | frozenset):
            parts += len(inside)
            if parts > _MOST_PARTS:
                return False
            waiting.extend(inside)
    return True


class EvenroadError(Exception):
    """Base of every error that evenroad raises on purpose; its text is one line of at most 600 characters."""

    def __init__(self, *arguments: object) -> None:
        super().__init__(*(in_one_line(each) if isinstance(each, str) else each for each in arguments))


class InvalidValue(EvenroadError, ValueError):
    """An argument has a value, shape or type that the function does not take."""


class Undecided(InvalidValue):
    """A choice was left open that has several answers, such as a group of joints; the text lists them."""


class UnknownName(EvenroadError, ValueError):
    """A name (sampler, family, rule, file key) is unknown; the text suggests a near one, or lists the known ones."""

    @classmethod
    def among(cls, what: str, name: object, known: Iterable[object]) -> "UnknownName":
        """Return ``unknown sampler 'evn'; did you mean 'even'?``, or the known names where none is near."""
        names = [str(each) for each in sorted(known)]  # type: ignore[type-var]
        return cls(f"unknown {what} {shown(name)}; {near(name, names) or f'known: {listed(names)}'}")


class NotAvailable(EvenroadError, LookupError):
    """Something exists in general, but not in this case: a set of this n, an optional package."""


class BrokenFile(EvenroadError, OSError):
    """A file is missing, unreadable, unwritable, or not what its name says."""


class Exhausted(EvenroadError, RuntimeError):
    """A finite point set has fewer points left than requested."""


class WorkerLost(EvenroadError, RuntimeError):
    """A worker process ended before its work was done: killed, or out of memory."""
