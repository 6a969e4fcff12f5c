"""Expressions of a xacro, evaluated node by node: Python's ``eval`` never sees a text of a file.

`_Evaluator` is the whole grammar.  It never looks up an attribute of an object by a name of the file, and calls no
function that `functions` does not list.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache

from evenroad.errors import EvenroadError, InvalidValue, UnknownName, shown
from evenroad.loading.xacro.functions import MAP, METHODS, filled_by_percent
from evenroad.loading.xacro.values import Budget, Function, Scope, require_bits, require_size

_LONGEST = 2000
"""Largest number of characters of an expression: Python's parser overflows its stack on deep ones."""
_STEP = 10
"""Work of a node, in units of `Budget`."""
_OPERATORS: dict[type[ast.AST], Callable[..., object]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Not: operator.not_,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
    ast.In: lambda entry, within: entry in within,
    ast.NotIn: lambda entry, within: entry not in within,
}
_item: Callable[..., object] = operator.getitem
_FAULTS = (TypeError, ValueError, LookupError, ArithmeticError, AttributeError)
"""Errors that operations on plain values raise."""


def evaluate(text: str, names: Scope, budget: Budget) -> object:
    """Return the value of an expression: a number, text, truth value, None, list, tuple or dictionary of these.

    Raises InvalidValue or UnknownName, with the expression, for what is not in the grammar or has no value.
    """
    try:
        return budget.weigh(_Evaluator(names, budget).value(_parsed(text.strip())))
    except EvenroadError as error:
        raise InvalidValue(f"{error}, in {shown(text)}") from error
    except _FAULTS as error:
        raise InvalidValue(f"{type(error).__name__} {error}, in {shown(text)}") from error


@lru_cache(1024)
def _parsed(text: str) -> ast.expr:
    if len(text) > _LONGEST:
        raise InvalidValue(f"an expression has {len(text)} characters, at most {_LONGEST} are read")
    try:
        return ast.parse(text, mode="eval").body
    except (SyntaxError, MemoryError) as error:
        raise InvalidValue(f"no expression ({getattr(error, 'msg', 'nested too deep')})") from error


class _Evaluator:
    """The grammar: a method for each kind of node."""

    def __init__(self, names: Scope, budget: Budget) -> None:
        self._names, self._budget = names, budget

    def value(self, node: ast.expr) -> object:
        """Return the value of a node."""
        self._budget.spend(_STEP)
        method = getattr(self, f"_{type(node).__name__.lower()}", None)
        if method is None:
            raise InvalidValue(f"{type(node).__name__} is not part of expressions that are read")
        found: object = method(node)
        return found

    def _plain(self, node: ast.expr) -> object:
        """Return the value of a node after its size is spent."""
        return self._budget.weigh(self.value(node))

    def _constant(self, node: ast.Constant) -> object:
        return self._budget.weigh(node.value)

    def _name(self, node: ast.Name) -> object:
        return self._names[node.id]

    def _attribute(self, node: ast.Attribute) -> object:
        """Return an entry of a namespace or a dictionary: never an attribute of a Python object."""
        owner = self.value(node.value)
        if isinstance(owner, Scope):
            return owner[node.attr]
        if isinstance(owner, dict):
            if node.attr not in owner:
                raise UnknownName.among("key", node.attr, map(str, owner))
            return owner[node.attr]
        raise InvalidValue(f"{type(owner).__name__} has no attribute {node.attr!r} that is read")

    def _subscript(self, node: ast.Subscript) -> object:
        owner, index = _with_entries(self.value(node.value)), node.slice
        if not isinstance(index, ast.Slice):
            return _item(owner, self._plain(index))
        lower, upper, step = (each and self._plain(each) for each in (index.lower, index.upper, index.step))
        return self._budget.weigh(_item(owner, slice(lower, upper, step)))

    def _binop(self, node: ast.BinOp) -> object:
        left, right, kind = self.value(node.left), self.value(node.right), type(node.op)
        operate = _operator(node.op)
        if kind is ast.Pow and isinstance(left, int) and isinstance(right, int):
            require_bits(left.bit_length() * max(right, 0))
        if kind is ast.Mult:
            for many, times in ((left, right), (right, left)):
                if isinstance(many, str | list | tuple) and isinstance(times, int):
                    require_size(len(many) * max(times, 0))
        if kind is ast.Mod and isinstance(left, str):
            return self._budget.weigh(filled_by_percent(left, self._budget.weigh(right)))
        return self._budget.weigh(operate(left, right))

    def _unaryop(self, node: ast.UnaryOp) -> object:
        return _operator(node.op)(self.value(node.operand))

    def _boolop(self, node: ast.BoolOp) -> object:
        found: object = None
        for each in node.values:
            found = self.value(each)
            if bool(found) is isinstance(node.op, ast.Or):
                break
        return found

    def _compare(self, node: ast.Compare) -> object:
        left = self._plain(node.left)
        for kind, each in zip(node.ops, node.comparators, strict=True):
            right = self._plain(each)
            if not _operator(kind)(left, right):
                return False
            left = right
        return True

    def _ifexp(self, node: ast.IfExp) -> object:
        return self.value(node.body if self.value(node.test) else node.orelse)

    def _list(self, node: ast.List) -> object:
        return self._budget.weigh([self.value(each) for each in node.elts])

    def _tuple(self, node: ast.Tuple) -> object:
        return self._budget.weigh(tuple(self.value(each) for each in node.elts))

    def _call(self, node: ast.Call) -> object:
        if any(word.arg is None for word in node.keywords):
            raise InvalidValue("** is not part of expressions that are read")
        function = node.func
        if isinstance(function, ast.Attribute):
            owner = self.value(function.value)
            if not isinstance(owner, Scope):
                return self._method(owner, function.attr, node)
            called = owner[function.attr]
        else:
            called = self.value(function)
        if not isinstance(called, Function):
            raise InvalidValue(f"a {type(called).__name__.lower()} is no function")
        if called is MAP:
            return self._mapped(node.args)
        return self._called(called.call, node)

    def _method(self, owner: object, name: str, node: ast.Call) -> object:
        methods = METHODS.get(type(owner), {})
        if name not in methods:
            raise UnknownName.among(f"method of a {type(owner).__name__.lower()}", name, methods)
        return self._called(methods[name], node, self._budget.weigh(owner))

    def _called(self, call: Callable[..., object], node: ast.Call, *first: object) -> object:
        values = [self._plain(each) for each in node.args]
        named = {str(word.arg): self._plain(word.value) for word in node.keywords}
        return self._budget.weigh(call(*first, *values, **named))

    def _mapped(self, arguments: Sequence[ast.expr]) -> object:
        function, *rows = (self.value(each) for each in arguments)
        if not isinstance(function, Function) or function is MAP:
            raise InvalidValue("map takes a function that is read, and lists")
        every = zip(*map(_with_entries, rows), strict=False)
        return self._budget.weigh([self._budget.weigh(function.call(*row)) for row in every])

    def _listcomp(self, node: ast.ListComp | ast.GeneratorExp) -> object:
        made = [inner.value(node.elt) for inner in self._each(node.generators)]
        return self._budget.weigh(made)

    _generatorexp = _listcomp

    def _each(self, loops: Sequence[ast.comprehension]) -> Iterator[_Evaluator]:
        """Yield an evaluator for each round of the loops of a comprehension."""
        if not loops:
            yield self
            return
        loop = loops[0]
        for entry in _with_entries(self._plain(loop.iter)):
            self._budget.spend(_STEP)
            inner = _Evaluator(Scope(self._names, _bound(loop.target, entry)), self._budget)
            if all(inner.value(condition) for condition in loop.ifs):
                yield from inner._each(loops[1:])


def _operator(node: ast.operator | ast.unaryop | ast.cmpop) -> Callable[..., object]:
    if type(node) not in _OPERATORS:
        raise InvalidValue(f"the operator {type(node).__name__} is not part of expressions that are read")
    return _OPERATORS[type(node)]


def _with_entries(value: object) -> Iterable[object]:
    """Return a text, list, tuple or dictionary; InvalidValue for what has no entries."""
    if not isinstance(value, str | list | tuple | dict):
        raise InvalidValue(f"a {type(value).__name__.lower()} has no entries")
    return value


def _bound(target: ast.expr, entry: object) -> dict[str, object]:
    """Return the names that a loop binds."""
    if isinstance(target, ast.Name):
        return {target.id: entry}
    names = [each.id for each in getattr(target, "elts", ()) if isinstance(each, ast.Name)]
    if not isinstance(target, ast.Tuple) or len(names) < len(target.elts):
        raise InvalidValue("a loop binds one name, or several with commas")
    return dict(zip(names, _with_entries(entry), strict=True))
