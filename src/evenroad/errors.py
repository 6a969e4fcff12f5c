"""The one error tree of evenroad.

Every error we raise on purpose is an :class:`EvenroadError` and also the builtin that fits it, so that
``except ValueError`` and ``except EvenroadError`` both work.  The text names the bad value and says what is
allowed.  "No path" is not here: it is an answer (see ``evenroad.roadmap.PlanResult.status``).
"""

SHOWN = 80
"""Characters of a value that an error's text repeats."""


def shown(value: object) -> str:
    """Return ``repr(value)`` for an error's text, its middle left out where it has more than 80 characters."""
    text = repr(value)
    if len(text) <= SHOWN:
        return text
    mark = f" ... ({len(text)} characters) ... "
    end = (SHOWN - len(mark)) // 2
    return text[: SHOWN - len(mark) - end] + mark + text[-end:]


class EvenroadError(Exception):
    """Base of every error that evenroad raises on purpose."""


class InvalidValue(EvenroadError, ValueError):
    """An argument has a value, shape or type that the function does not take."""


class UnknownName(EvenroadError, ValueError):
    """A name (sampler, family, rule, file key) that is not one of the known ones, which the text lists."""

    @classmethod
    def among(cls, what: str, name: object, known: object) -> "UnknownName":
        """Build the usual sentence: ``unknown sampler 'x'; known: a, b, c``."""
        return cls(f"unknown {what} {shown(name)}; known: {', '.join(map(str, sorted(known)))}")  # type: ignore[call-overload]


class NotAvailable(EvenroadError, LookupError):
    """Something that exists in general but not for what was asked: a set of this n, a stored cell."""


class BrokenFile(EvenroadError, OSError):
    """A file is missing, unreadable, unwritable, or not what its name says."""


class Exhausted(EvenroadError, RuntimeError):
    """A finite point set was asked for more points than it has."""


class WorkerLost(EvenroadError, RuntimeError):
    """A worker process ended before its work was done: killed, or out of memory."""
