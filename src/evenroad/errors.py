"""The errors of evenroad.

Each is an :class:`EvenroadError` and the builtin that fits, so ``except ValueError`` works, too.  Its text names the
bad value and says what is allowed.  "No path" is a result, not an error: see ``evenroad.PlanResult.status``.
"""

import reprlib

SHOWN = 80
"""Largest number of characters of a value in an error's text."""
LONGEST = 600
"""Largest number of characters of an error's text."""
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


class UnknownName(EvenroadError, ValueError):
    """A name (sampler, family, rule, file key) is unknown; the text lists the known ones."""

    @classmethod
    def among(cls, what: str, name: object, known: object) -> "UnknownName":
        """Return the error ``unknown sampler 'evn'; known: even, halton; did you mean 'even'?``."""
        from difflib import get_close_matches

        names = [str(each) for each in sorted(known)]  # type: ignore[call-overload]
        near = get_close_matches(name, names, 1) if isinstance(name, str) and len(name) < SHOWN else []
        hint = f"; did you mean {near[0]!r}?" if near else ""
        return cls(f"unknown {what} {shown(name)}; known: {', '.join(names)}{hint}")


class NotAvailable(EvenroadError, LookupError):
    """Something exists in general, but not in this case: a set of this n, an optional package."""


class BrokenFile(EvenroadError, OSError):
    """A file is missing, unreadable, unwritable, or not what its name says."""


class Exhausted(EvenroadError, RuntimeError):
    """A finite point set has fewer points left than requested."""


class WorkerLost(EvenroadError, RuntimeError):
    """A worker process ended before its work was done: killed, or out of memory."""
