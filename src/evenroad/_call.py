"""Errors for wrong calls that say which arguments a function takes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from inspect import Parameter, signature
from types import FunctionType
from typing import TypeVar

from evenroad._hints import UnknownAttribute, is_keyword, keyword_hint, unknown_keyword
from evenroad.errors import EvenroadError, InvalidValue

_MAKERS = {"Robot": "er.load_robot(name or file)", "PlanResult": "er.plan", "Trajectory": "result.trajectory()"}
"""What makes values whose class is seldom called."""
Called = TypeVar("Called", bound=Callable[..., object])


def explains_calls(called: Called) -> Called:
    """Return a function, or a class with its methods, that raises UnknownName or InvalidValue for a wrong call.

    Python's own TypeError names the wrong keyword, but not the known ones.  A class also says what an unknown name of
    its values is called here.
    """
    if isinstance(called, type):
        if not any("__getattr__" in vars(each) for each in called.__mro__):
            called.__getattr__ = _unknown_attribute  # type: ignore[attr-defined]
        for name, each in vars(called).copy().items():
            public = name == "__init__" or not name.startswith("_")
            if public and isinstance(each, FunctionType) and not hasattr(each, "__wrapped__"):
                setattr(called, name, explains_calls(each))
        return called

    @wraps(called)
    def explained(*given: object, **named: object) -> object:
        try:
            return called(*given, **named)
        except TypeError as error:
            # An error from within the function has a frame of its own.
            if error.__traceback__ is None or error.__traceback__.tb_next is not None:
                raise
            raise _explained(called, given, named, str(error)) from None

    return explained  # type: ignore[return-value]


def _unknown_attribute(self: object, name: str) -> object:
    """Raise the error of an unknown name, or that of a property that failed."""
    if not name.startswith("__") and hasattr(type(self), name):
        return object.__getattribute__(self, name)
    raise UnknownAttribute(type(self), name)


def require_options(name: str, given: Mapping[str, object], options: type, own: Sequence[str] = ()) -> None:
    """Raise UnknownName for a keyword that is neither one of a function's own, nor in its TypedDict."""
    known = (*own, *options.__annotations__)
    for keyword in given:
        if keyword not in known:
            raise unknown_keyword(f"keyword of {name}", keyword, known)


def _explained(
    function: Callable[..., object], given: tuple[object, ...], named: dict[str, object], text: str
) -> EvenroadError:
    """Return the error of a call; `text` is Python's message."""
    name = function.__qualname__.rpartition(".")[2]
    if name == "__init__":
        # The class that was called may have its __init__ from another.
        name = type(given[0]).__name__
    every = {key: each for key, each in signature(function).parameters.items() if key != "self" and key[0] != "_"}
    taken = {key: each for key, each in every.items() if each.kind is not Parameter.VAR_KEYWORD}
    keywords = [key for key, each in taken.items() if each.kind is not Parameter.POSITIONAL_ONLY]
    strange = [key for key in named if key not in keywords]
    if len(taken) < len(every):
        # It takes other keywords, too: only of what has another name here is it sure that it is none of them.
        strange = [key for key in strange if keyword_hint(key, keywords) and not is_keyword(key)]
    if strange:
        return unknown_keyword(f"keyword of {name}", strange[0], keywords)
    alone = [key for key, each in taken.items() if each.kind is Parameter.KEYWORD_ONLY]
    first = [key for key in taken if key not in alone]
    words = ", ".join([*first, *(["*", *alone] if alone else [])])
    maker = f"; {_MAKERS[name]} makes one" if name in _MAKERS else ""
    return InvalidValue(f"{name} is called as {name}({words}): {text.partition('() ')[2] or text}{maker}")
