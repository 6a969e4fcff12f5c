"""State that threads share: values made once, and locks."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from functools import cached_property, wraps
from typing import Concatenate, ParamSpec, Protocol, Self, TypeVar, overload

Made = TypeVar("Made")
Given = ParamSpec("Given")
Locked = TypeVar("Locked", bound="_Locked")


def once(function: Callable[..., Made]) -> Callable[..., Made]:
    """Return a function that caches one value per arguments, the same in all threads.

    With ``functools.cache`` two threads at once may get two values, of which it keeps one.
    """
    kept: dict[tuple[object, ...], Made] = {}
    making = threading.RLock()

    @wraps(function)
    def cached(*arguments: object) -> Made:
        if arguments not in kept:
            with making:
                if arguments not in kept:
                    kept[arguments] = function(*arguments)
        return kept[arguments]

    return cached


def recent(most: int = 256) -> Callable[[Callable[Given, Made]], Callable[Given, Made]]:
    """Return a decorator of functions that caches values by the identity of arguments that cannot be keys.

    Robots and scenes are such arguments; they must not change.  They are kept, so that no other object takes their
    place in memory.  At most `most` values are kept.
    """

    def decorated(function: Callable[Given, Made]) -> Callable[Given, Made]:
        kept: dict[tuple[object, ...], tuple[tuple[object, ...], Made]] = {}

        @wraps(function)
        def cached(*arguments: Given.args, **named: Given.kwargs) -> Made:
            key = tuple([each if isinstance(each, _PLAIN) else id(each) for each in arguments])
            found = kept.get(key)
            if found is None:
                if len(kept) >= most:
                    kept.clear()
                found = kept[key] = arguments, function(*arguments, **named)
            return found[1]

        return cached

    return decorated


_PLAIN = (int, float, str, tuple)


class once_property(cached_property[Made]):
    """A cached property with the same value in all threads."""

    @overload
    def __get__(self, instance: None, owner: type | None = None) -> Self: ...
    @overload
    def __get__(self, instance: object, owner: type | None = None) -> Made: ...
    def __get__(self, instance: object, owner: type | None = None) -> Self | Made:
        """Return the value of an instance, or the property itself of a class."""
        if instance is None:
            return self
        assert self.attrname is not None
        made: Made = vars(instance).setdefault(self.attrname, self.func(instance))
        return made


def state_without(value: object, made: Iterable[str]) -> dict[str, object]:
    """Return the state of which a copy of a value is made; what it has `made` from its fields, it makes anew."""
    return {name: each for name, each in vars(value).items() if name not in made}


class OwnLock:
    """A lock of one value; its copies, also in another process, have their own."""

    def __init__(self) -> None:
        self._lock = threading.Lock()

    def __enter__(self) -> None:
        self._lock.acquire()

    def __exit__(self, *_: object) -> None:
        self._lock.release()

    def __reduce__(self) -> tuple[object, ...]:
        return OwnLock, ()


class _Locked(Protocol):
    _lock: OwnLock


def one_at_a_time(method: Callable[Concatenate[Locked, Given], Made]) -> Callable[Concatenate[Locked, Given], Made]:
    """Return a method under the `_lock` of its value."""

    @wraps(method)
    def called(self: Locked, /, *given: Given.args, **named: Given.kwargs) -> Made:
        with self._lock:
            return method(self, *given, **named)

    return called
