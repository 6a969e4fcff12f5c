"""Functions and methods that expressions of a xacro may call; none can take more memory than its result."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping

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


def _rounded(number: float, ndigits: int | None = None) -> float:
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


def _tokens(text: str, sep: str = ",; ", skip_empty: bool = True) -> list[str]:
    tokens = text.translate(dict.fromkeys(map(ord, sep), "\0")).split("\0")
    return [token for token in tokens if token or not skip_empty]


def _joined(separator: str, parts: list[str]) -> str:
    require_size(len(separator) * len(parts))
    return separator.join(parts)


def _replaced(text: str, old: str, new: str, count: int = -1) -> str:
    require_size(text.count(old) * len(new))
    return text.replace(old, new, count)


def filled_by_percent(text: str, values: object) -> str:
    """Return ``text % values`` for plain formats, at most 99 characters wide, or raise InvalidValue."""
    if "%" in _PERCENT.sub("", text) or isinstance(values, dict):
        raise InvalidValue(f"the format {text!r} is not plain: %s, %d, %.3f and the like")
    return text % values


def _function(call: Callable[..., object], name: str = "") -> Function:
    return Function(name or call.__name__, call)


MAP = Function("map", map)
"""The one function that takes a function; the evaluator calls it."""
_PYTHON: dict[str, object] = {
    **{call.__name__: _function(call) for call in (abs, all, any, bool, dict, divmod, float, int, len, list, max, min)},
    **{call.__name__: _function(call) for call in (ord, sorted, str, tuple)},
    **{"range": _function(_range, "range"), "round": _function(_rounded, "round"), "sum": _function(_sum, "sum")},
    **{
        made.__name__: _function(lambda *values, made=made: list(made(*values)), made.__name__)
        for made in (enumerate, reversed, zip)
    },
    "map": MAP,
}
_NUMBERS: dict[str, object] = {
    **{name: getattr(math, name) for name in _CONSTANTS},
    **{name: _function(getattr(math, name)) for name in _MATH},
}

METHODS: Mapping[type, Mapping[str, Callable[..., object]]] = {
    str: {
        **{call.__name__: call for call in (str.count, str.endswith, str.find, str.index, str.isdigit, str.lower)},
        **{call.__name__: call for call in (str.lstrip, str.rstrip, str.split, str.startswith, str.strip, str.title)},
        **{call.__name__: call for call in (str.capitalize, str.upper, str.rsplit, str.splitlines)},
        **{"join": _joined, "replace": _replaced},
    },
    list: {"count": list.count, "index": list.index},
    tuple: {"count": tuple.count, "index": tuple.index},
    dict: {
        "get": dict.get,
        **{call.__name__: lambda each, call=call: list(call(each)) for call in (dict.items, dict.keys, dict.values)},
    },
}
"""Type -> name -> the method: none of them changes the value."""


def names_of(own: Mapping[str, Callable[..., object]]) -> dict[str, object]:
    """Return all names of expressions; `own` are the functions of the file that is read, as ``xacro.arg``."""
    functions: dict[str, object] = {name: Function(name, call) for name, call in own.items()}
    silent = dict.fromkeys(("message", "warning", "error", "print_location"), Function("message", lambda *_: ""))
    xacro = {**functions, **silent, "fatal": Function("fatal", _fatal), "tokenize": Function("tokenize", _tokens)}
    deprecated: dict[str, object] = {
        name: xacro[name] for name in ("load_yaml", "abs_filename", "dotify") if name in xacro
    }
    spaces = {"math": Scope(names=_NUMBERS), "python": Scope(names=_PYTHON), "xacro": Scope(names=xacro)}
    return {**_NUMBERS, **_PYTHON, **deprecated, **spaces}


def _fatal(*said: object) -> str:
    raise InvalidValue(f"the file says: {' '.join(map(str, said))}")
