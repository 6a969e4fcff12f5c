"""Values of a xacro and their scopes, with limits on size and work."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from xml.etree.ElementTree import Element

from evenroad.errors import InvalidValue, UnknownName, near, shown

WORK = 10_000_000
"""Work that one file may cost: a real robot takes 1 % of it, and all of it is some seconds."""
LARGEST = 100_000
"""Largest number of characters of a text, and of entries of nested lists with repetitions written out."""
_BITS = 64
"""Largest number of bits of an integer: larger ones could share their hashes, which makes dictionaries slow."""
_DIGITS = 18
"""Whole numbers of more digits are texts, as serial numbers are."""


class Budget:
    """Work that is left for one file."""

    def __init__(self, work: int = WORK) -> None:
        self._left = work

    def spend(self, work: int) -> None:
        """Take work from what is left; raises InvalidValue if there is too little."""
        self._left -= work
        if self._left < 0:
            raise InvalidValue(f"it takes more than {WORK} steps: macros, lists or texts that grow without end")

    def weigh(self, value: object) -> object:
        """Return a value after spending its size; raises InvalidValue for one that is too large, or no plain value.

        Lists may share their entries, so a few of them can be exponentially large where they are compared or printed.
        """
        waiting, size = [value], 0
        while waiting:
            each = waiting.pop()
            if isinstance(each, str):
                size += 1 + len(each)
            elif isinstance(each, list | tuple):
                size += 1 + len(each)
                waiting.extend(each if size <= LARGEST else ())
            elif isinstance(each, dict):
                size += 1 + 2 * len(each)
                waiting.extend([*each, *each.values()] if size <= LARGEST else ())
            elif isinstance(each, int | float | None):
                size += 1
                require_bits(each.bit_length() if isinstance(each, int) else 0)
            else:
                raise InvalidValue(f"a {type(each).__name__.lower()} is not a value")
            require_size(size)
        self.spend(size)
        return value


def require_size(size: int) -> None:
    """Raise InvalidValue for a text or list that would be too large."""
    if size > LARGEST:
        raise InvalidValue(f"a text or list has more than {LARGEST} characters or entries")


def require_bits(bits: int) -> None:
    """Raise InvalidValue for an integer that would be too large."""
    if bits > _BITS:
        raise InvalidValue(f"an integer has more than {_BITS} bits")


@dataclass(frozen=True)
class Function:
    """A function that expressions may call; it is no value itself."""

    name: str
    call: Callable[..., object]


@dataclass(frozen=True)
class Block:
    """Elements under a name: those in a property, or a block that a macro takes with or without its own element."""

    elements: tuple[Element, ...]


@dataclass(frozen=True)
class Lazy:
    """A text that is evaluated when it is first used."""

    text: str


_BEGUN = object()
"""Mark of a text that is being evaluated."""


class Scope:
    """Names of a file or macro; it sees those of the scope around it."""

    def __init__(
        self,
        around: Scope | None = None,
        names: Mapping[str, object] | None = None,
        *,
        evaluate: Callable[[str, Scope], object] | None = None,
        of_include: bool = False,
    ) -> None:
        self.around, self.of_include = around, of_include
        self.values: dict[str, object] = dict(names or {})
        self.evaluate: Callable[[str, Scope], object] | None = evaluate if around is None else around.evaluate

    def owner(self, name: str) -> Scope | None:
        """Return the innermost scope that has a name."""
        scope: Scope | None = self
        while scope is not None and name not in scope.values:
            scope = scope.around
        return scope

    def __contains__(self, name: str) -> bool:
        return self.owner(name) is not None

    def __getitem__(self, name: str) -> object:
        owner = self.owner(name)
        if owner is None:
            hint = near(name, filter(str.isidentifier, self.known()))
            raise UnknownName(f"unknown name {shown(name)}{hint and '; '}{hint}")
        value = owner.values[name]
        if value is _BEGUN:
            raise InvalidValue(f"the property {name!r} is defined by itself")
        if isinstance(value, Lazy):
            assert self.evaluate is not None
            owner.values[name] = _BEGUN
            owner.values[name] = value = literal(self.evaluate(value.text, owner))
        return value

    def known(self) -> set[str]:
        """Return all names of a scope and those around it."""
        return set(self.values) | (self.around.known() if self.around is not None else set())


def literal(value: object) -> object:
    """Return what a text stands for: a number, a truth value, what is in its quotes, or itself."""
    if not isinstance(value, str):
        return value
    if len(value) >= 2 and value[0] == value[-1] == "'":
        return value[1:-1]
    # Names such as 1_2 are numbers to Python alone.
    if "_" not in value and not (value.isdigit() and len(value) > _DIGITS):
        for number in (int, float):
            try:
                return number(value)
            except ValueError:
                continue
    return {"true": True, "True": True, "false": False, "False": False}.get(value, value)


def truth(value: object, text: str) -> bool:
    """Return the truth value of a condition, or raise InvalidValue with its text."""
    found = literal(value)
    if isinstance(found, str):
        raise InvalidValue(f"the condition {text!r} is {value!r}, neither true nor false")
    return bool(found)
