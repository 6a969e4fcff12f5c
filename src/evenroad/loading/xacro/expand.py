"""Expanding a xacro: the URDF that its properties, macros, conditions and includes stand for."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from keyword import iskeyword
from pathlib import Path
from xml.etree.ElementTree import Element

from evenroad._files import read_bytes
from evenroad._yaml import require_keys
from evenroad.errors import BrokenFile, EvenroadError, InvalidValue, UnknownName, shown
from evenroad.loading.xacro.files import Files
from evenroad.loading.xacro.substitution import Texts
from evenroad.loading.xacro.values import Block, Budget, Lazy, Scope, literal, truth
from evenroad.loading.xml_file import read_xml

PREFIX = "xacro:"
_ELEMENT = 100
"""Work of an element, in units of `Budget`."""
_LONGEST = 10_000
"""Largest number of characters of a macro's parameters."""
_PARAMETER = re.compile(
    r"""\s*([^\s:=]+)(?:\s*:?=\s*(\^\|?)?((?:\$\{[^}]*\}|\$\([^)]*\)|'[^']*'|"[^"]*"|[^\s'"])+)?)?\s*"""
)
"""A parameter of a macro, whether it is forwarded (^), and its default."""
_ATTRIBUTES: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "property": (("name",), ("value", "default", "remove", "scope", "lazy_eval")),
    "macro": (("name",), ("params",)),
    "include": (("filename",), ("ns", "optional")),
    "insert_block": (("name",), ()),
    "if": (("value",), ()),
    "unless": (("value",), ()),
    "arg": (("name", "default"), ()),
    "attribute": (("name", "value"), ()),
}
"""Element -> attributes that it must have, and that it may have."""


_ARGUMENT = re.compile(r"""<xacro:arg\s[^>]*?\bname\s*=\s*["']([^"']+)|\$\(arg\s+([^)\s]+)""")
"""Declaration or use of an argument in a xacro."""


@dataclass(frozen=True)
class _Macro:
    """A macro: its content, and parameter -> (whether it is forwarded, default)."""

    content: tuple[Element, ...]
    parameters: Mapping[str, tuple[bool, str | None]]


def expanded(
    path: Path, arguments: Mapping[str, str], find: Callable[[str], Path], packages: Mapping[str, str]
) -> Element:
    """Return the outermost element of the XML that a xacro stands for.

    Python evaluates no text of the file, and the cost is bounded.  `find` returns the folder of a package,
    and raises LookupError where there is none; `packages` are the folders that the user named.  Raises UnknownName for
    an argument that no file declares, BrokenFile for all that cannot be expanded.
    """
    budget = Budget()
    files = Files(path, find, packages, budget)
    texts = Texts(files, dict(arguments), budget)
    expander = _Expander(texts)
    try:
        root = expander.root(path)
    except RecursionError:
        raise BrokenFile(
            f"the xacro {path} cannot be expanded: nested too deep, or a macro or include without an end"
        ) from None
    except EvenroadError as error:
        where = "" if files.stack[-1] == path else f"{files.stack[-1]}: "
        raise BrokenFile(f"the xacro {path} cannot be expanded: {where}{error}") from error
    known = _known_arguments(files.read)
    for name in arguments:
        if name not in known:
            raise UnknownName.among(f"argument of the xacro {path}:", name, known)
    return root


def _known_arguments(files: Iterable[Path]) -> set[str]:
    """Return the arguments that some xacros declare or use, also in parts that conditions leave out."""
    text = "".join(read_bytes(each).decode(errors="replace") for each in files)
    return {declared or used for declared, used in _ARGUMENT.findall(text)}


class _Expander:
    """Walks through the elements of one xacro and makes those of the XML."""

    def __init__(self, texts: Texts) -> None:
        self._texts, self._files, self._budget = texts, texts.files, texts.budget
        self._elements = {name: getattr(self, f"_{name}") for name in _ATTRIBUTES}

    def root(self, path: Path) -> Element:
        """Return the outermost element with what is in it."""
        source = read_xml(path, "robot", "a xacro", None)
        return self._plain(source, Scope(self._texts.names))

    def _content(self, into: Element, sources: Iterable[Element], scope: Scope) -> None:
        """Append to an element what some elements stand for."""
        for source in sources:
            self._budget.spend(_ELEMENT)
            if not source.tag.startswith(PREFIX):
                into.append(self._plain(source, scope))
                continue
            name = source.tag.removeprefix(PREFIX)
            if name == "element":
                tag = self._texts.text(source.get("xacro:name", ""), scope)
                if not tag or tag.startswith(PREFIX):
                    raise InvalidValue(f"{shown(tag)} is no name of an element")
                into.append(self._plain(source, scope, tag))
                continue
            if name not in self._elements:
                self._macro_call(into, source, name, scope)
                continue
            required, optional = _ATTRIBUTES[name]
            require_keys(source.attrib, required, optional, f"<{source.tag}>")
            self._elements[name](into, source, scope)

    def _plain(self, source: Element, scope: Scope, tag: str = "") -> Element:
        """Return an element that is no xacro's, with its attributes and content evaluated."""
        attributes = {
            name: self._texts.text(value, scope)
            for name, value in source.attrib.items()
            if not name.startswith((PREFIX, "xmlns:xacro"))
        }
        made = Element(tag or source.tag, attributes)
        made.text = self._texts.text(source.text or "", scope)
        self._content(made, source, scope)
        return made

    def _property(self, into: Element, source: Element, scope: Scope) -> None:
        read, name = source.get, self._texts.text(source.attrib["name"], scope)
        if not name.isidentifier() or iskeyword(name) or name.startswith("__"):
            raise InvalidValue(f"{shown(name)} is no name of a property")
        kinds = [kind for kind in ("value", "default", "remove") if kind in source.attrib]
        if len(kinds) > 1:
            raise InvalidValue(f"the property {name!r} has {' and '.join(kinds)}; one of them is allowed")
        if self._is_true(read("remove", "false"), scope):
            _forget(scope, name)
            return
        if "default" in source.attrib and name in scope:
            return
        target, lazy = scope, self._is_true(read("lazy_eval", "true"), scope)
        if read("scope") in ("parent", "global"):
            target, lazy = _outer(scope, read("scope") == "global"), False
        elif "scope" in source.attrib:
            raise UnknownName.among("scope of a property", read("scope"), ("parent", "global"))
        value = read("value", read("default"))
        if value is None:
            target.values[f"**{name}"] = Block(tuple(source))
        elif lazy and isinstance(literal(value), str):
            # xacro, too, removes quotes first.
            target.values[name] = Lazy(str(literal(value)))
        else:
            target.values[name] = literal(self._texts.value(value, scope))

    def _macro(self, into: Element, source: Element, scope: Scope) -> None:
        name, rest = source.attrib["name"].removeprefix(PREFIX), source.get("params", "").strip()
        if name in (*_ATTRIBUTES, "element", "call") or "." in name:
            raise InvalidValue(f"{shown(name)} is no name of a macro")
        if len(rest) > _LONGEST:
            raise InvalidValue(f"the parameters of the macro {name!r} have more than {_LONGEST} characters")
        parameters: dict[str, tuple[bool, str | None]] = {}
        while rest:
            match = _PARAMETER.match(rest)
            if match is None or match.end() == 0:
                raise InvalidValue(f"the parameters of the macro {name!r} end in {shown(rest)}")
            parameters[match[1]] = match[2] is not None, match[3]
            rest = rest[match.end() :]
        scope.values[f"<{name}>"] = _Macro(tuple(source), parameters)

    def _macro_call(self, into: Element, source: Element, name: str, scope: Scope) -> None:
        given = dict(source.attrib)
        if name == "call":
            name = self._texts.text(given.pop("macro", ""), scope)
        home, macro = _macro_of(name, scope)
        inner = Scope(home)
        for key, text in given.items():
            if key.startswith("xmlns:"):
                continue
            if key not in macro.parameters:
                known = [each for each in macro.parameters if not each.startswith("*")]
                raise UnknownName.among(f"parameter of the macro {name!r}:", key, known)
            inner.values[key] = literal(self._texts.value(text, scope))
        blocks = Element("blocks")
        self._content(blocks, source, scope)
        waiting = list(blocks)
        for key, (forwarded, default) in macro.parameters.items():
            if key.startswith("*"):
                if not waiting:
                    raise InvalidValue(f"the macro {name!r} needs a block for {key!r}")
                block = waiting.pop(0)
                inner.values[key] = Block(tuple(block) if key.startswith("**") else (block,))
            elif key not in inner.values:
                inner.values[key] = self._default(key, forwarded, default, scope, name)
        if waiting:
            raise InvalidValue(f"the macro {name!r} has no use for the block <{waiting[0].tag}>")
        self._content(into, macro.content, inner)

    def _default(self, key: str, forwarded: bool, default: str | None, scope: Scope, name: str) -> object:
        """Return the value of a parameter that a call leaves out."""
        if forwarded and key in scope:
            return scope[key]
        if default is None:
            raise InvalidValue(f"the macro {name!r} needs the parameter {key!r}")
        return literal(self._texts.value(default, scope))

    def _include(self, into: Element, source: Element, scope: Scope) -> None:
        optional = self._is_true(source.get("optional", "false"), scope)
        if "ns" in source.attrib:
            inner = Scope(scope, of_include=True)
            scope.values[self._texts.text(source.attrib["ns"], scope)] = inner
            scope = inner
        for path in self._files.included(self._texts.text(source.attrib["filename"], scope), optional):
            self._files.begin(path)
            self._content(into, read_xml(path, "xacro", "a xacro", None), scope)
            self._files.stack.pop()

    def _insert_block(self, into: Element, source: Element, scope: Scope) -> None:
        name = self._texts.text(source.attrib["name"], scope)
        for key in (f"**{name}", f"*{name}"):
            if key in scope:
                block = scope[key]
                assert isinstance(block, Block)
                self._content(into, block.elements, scope)
                return
        raise InvalidValue(f"there is no block {name!r}")

    def _if(self, into: Element, source: Element, scope: Scope) -> None:
        if self._is_true(source.attrib["value"], scope):
            self._content(into, source, scope)

    def _unless(self, into: Element, source: Element, scope: Scope) -> None:
        if not self._is_true(source.attrib["value"], scope):
            self._content(into, source, scope)

    def _arg(self, into: Element, source: Element, scope: Scope) -> None:
        name = source.attrib["name"]
        if name not in self._texts.arguments:
            self._texts.arguments[name] = self._texts.text(source.attrib["default"], scope)

    def _attribute(self, into: Element, source: Element, scope: Scope) -> None:
        name, value = (self._texts.text(source.attrib[key], scope) for key in ("name", "value"))
        into.set(name, value)

    def _is_true(self, text: str, scope: Scope) -> bool:
        return truth(self._texts.value(text, scope), text)


def _macro_of(name: str, scope: Scope) -> tuple[Scope, _Macro]:
    """Return the scope in which a macro is expanded, and the macro; names may begin with that of an include."""
    *spaces, last = name.split(".")
    for space in spaces:
        inner = scope[space]
        if not isinstance(inner, Scope):
            raise InvalidValue(f"{shown(space)} is not the name of an include")
        scope = inner
    if f"<{last}>" not in scope:
        raise UnknownName.among("macro", last, (each[1:-1] for each in scope.known() if each.startswith("<")))
    macro = scope[f"<{last}>"]
    assert isinstance(macro, _Macro)
    return scope, macro


def _outer(scope: Scope, outermost: bool) -> Scope:
    """Return the scope of a file, or that in which a macro is called."""
    outer = scope.around if scope.around is not None and scope.around.around is not None else scope
    while outer.around is not None and outer.around.around is not None and (outermost or outer.of_include):
        outer = outer.around
    return outer


def _forget(scope: Scope, name: str) -> None:
    """Remove a name from a scope and those around it; that of a function stays."""
    inner: Scope = scope
    while inner.around is not None:
        inner.values.pop(name, None)
        inner = inner.around
