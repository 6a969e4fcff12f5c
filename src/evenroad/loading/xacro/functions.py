"""Functions and methods that expressions of a xacro may call; none can take more memory than its result."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping

from evenroad.errors import InvalidValue
from evenroad.loading.xacro.values import Function, Scope, require_size

_MATH = (
    *("acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "ceil", "copysign", "cos", "cosh", "degrees", "dist"),
    *("erf", "erfc", "exp", "expm1", "fabs", "floor", "fmod", "frexp", "fsum", "gamma", "gcd", "hypot", "isclose"),
    *("isfinite", "isinf", "isnan", "ldexp", "lgamma", "log", "log10", "log1p", "log2", "modf", "pow", "radians"),
    *("remainder", "sin", "sinh", "sqrt", "tan", "tanh", "trunc"),
)
_CONSTANTS = ("pi", "e", "tau", "inf", "nan")
_PERCENT = re.compile(r"%(?:[-+ 0]?\d{0,2}(?:\.\d{1,2})?[sdifeEgGxXo]|%)")
"""A format of one value, at most 99 characters wide."""


def _range(*bounds: int) -> list[int]:
    numbers = range(*bounds)
    require_size(max(0, (numbers.stop - numbers.start) // numbers.step))
    return list(numbers)


def _round(number: float, ndigits: int | None = None) -> float:
    # Python makes 10**ndigits first.
    if ndigits is not None and abs(ndigits) > 100:
        raise InvalidValue(f"round to {ndigits} digits; at most 100")
    return round(number, ndigits)


def _sum(entries: list[object], start: float = 0) -> float:
    numbers = [each for each in entries if isinstance(each, int | float)]
    # A sum of lists copies each of them again and again.
    if len(numbers) < len(entries):
        raise InvalidValue("sum takes numbers alone")
    return sum(numbers, start)


def _tokenize(text: str, sep: str = ",; ", skip_empty: bool = True) -> list[str]:
    tokens = text.translate(dict.fromkeys(map(ord, sep), "\0")).split("\0")
    return [token for token in tokens if token or not skip_empty]


def _join(separator: str, parts: list[str]) -> str:
    require_size(len(separator) * len(parts))
    return separator.join(parts)


def _replace(text: str, old: str, new: str, count: int = -1) -> str:
    require_size(text.count(old) * len(new))
    return text.replace(old, new, count)


def filled_by_percent(text: str, values: object) -> str:
    """Return ``text % values`` for plain formats, at most 99 characters wide, or raise InvalidValue."""
    if "%" in _PERCENT.sub("", text) or isinstance(values, dict):
        raise InvalidValue(f"the format {text!r} is not plain: %s, %d, %.3f and the like")
    return text % values


def _named(*calls: Callable[..., object]) -> dict[str, Callable[..., object]]:
    """Return functions by their names in a xacro."""
    return {call.__name__.removeprefix("_"): call for call in calls}


def _functions(*calls: Callable[..., object]) -> dict[str, object]:
    return {name: Function(name, call) for name, call in _named(*calls).items()}


def _listing(call: Callable[..., Iterable[object]]) -> Callable[..., list[object]]:
    """Return a function that returns a list where another one returns an iterator or a view."""

    def listed(*values: object) -> list[object]:
        return list(call(*values))

    listed.__name__ = call.__name__
    return listed


MAP = Function("map", map)
"""The one function that takes a function; the evaluator calls it."""
_PYTHON: dict[str, object] = {
    **_functions(abs, all, any, bool, dict, divmod, float, int, len, list, max, min, ord, sorted, str, tuple),
    **_functions(_range, _round, _sum, *map(_listing, (enumerate, reversed, zip))),
    "map": MAP,
}
_NUMBERS = {name: getattr(math, name) for name in _CONSTANTS} | _functions(*(getattr(math, name) for name in _MATH))
METHODS: Mapping[type, Mapping[str, Callable[..., object]]] = {
    str: {
        **_named(str.capitalize, str.count, str.endswith, str.find, str.index, str.isdigit, str.lower, str.lstrip),
        **_named(str.rsplit, str.rstrip, str.split, str.splitlines, str.startswith, str.strip, str.title, str.upper),
        **_named(_join, _replace),
    },
    list: _named(list.count, list.index),
    tuple: _named(tuple.count, tuple.index),
    dict: _named(dict.get, *map(_listing, (dict.items, dict.keys, dict.values))),
}
"""Type -> name -> the method: none of them changes the value."""


def names_of(own: Mapping[str, Callable[..., object]]) -> dict[str, object]:
    """Return all names of expressions; `own` are the functions of the file that is read, as ``xacro.arg``."""
    silent = dict.fromkeys(("message", "warning", "error", "print_location"), Function("message", lambda *_: ""))
    functions: dict[str, object] = {name: Function(name, call) for name, call in own.items()}
    xacro = functions | silent | _functions(_fatal, _tokenize)
    deprecated: dict[str, object] = {
        name: xacro[name] for name in ("load_yaml", "abs_filename", "dotify") if name in xacro
    }
    spaces = {"math": Scope(names=_NUMBERS), "python": Scope(names=_PYTHON), "xacro": Scope(names=xacro)}
    return {**_NUMBERS, **_PYTHON, **deprecated, **spaces}


def _fatal(*said: object) -> str:
    raise InvalidValue(f"the file says: {' '.join(map(str, said))}")
