"""The values of a YAML text in one pass over what its parser says, with keys that are unique and a bounded size.

PyYAML makes a tree of nodes first, which takes several times as long, and keeps the last of equal keys silently.
Scalars mean what they mean to its safe loader.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

import yaml
from yaml.constructor import ConstructorError

from evenroad.errors import BrokenFile

# libyaml where PyYAML was built with it: ten times as fast.
Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_Mapping: TypeAlias = dict[object, object]
_DEEPEST = 100
_LARGEST, _LARGEST_SHARE = 1_000_000, 10
"""Largest number of characters and entries with all aliases expanded: a number, and one per character of the file."""
_TAG = "tag:yaml.org,2002:"
_MOST_DIGITS = 1000
_FLOAT = re.compile(r"[-+]?[0-9]+\.[0-9]*\Z")
"""Most numbers of a file; others are looked at by all rules."""
_MERGE, _NO_KEY = object(), object()


@dataclass(slots=True)
class _Open:
    """A list or mapping while it is read: its values, its size with all aliases written out, how deep it is."""

    values: list[object] | _Mapping
    anchor: str | None = None
    size: int = 1
    depth: int = 0
    key: object = _NO_KEY
    lines: dict[object, int] = field(default_factory=dict)
    merged: list[_Mapping] = field(default_factory=list)

    def add(self, value: object, event: yaml.Event, path: Path) -> None:
        """Add a value, or the key of the next one."""
        if isinstance(self.values, list):
            self.values.append(value)
        elif self.key is _NO_KEY:
            if value is not _MERGE:
                self._require_new(value, event, path)
            self.key = value
        elif self.key is _MERGE:
            # Of several the first counts most, and the mapping's own keys more.
            for part in value[::-1] if isinstance(value, list) else [value]:
                if not isinstance(part, dict):
                    raise _refused("expected a mapping or list of mappings for merging", event)
                self.merged.append(part)
            self.key = _NO_KEY
        else:
            self.values[self.key] = value
            self.key = _NO_KEY

    def _require_new(self, key: object, event: yaml.Event, path: Path) -> None:
        if isinstance(key, list | dict):
            raise _refused("found unhashable key", event)
        line = _mark(event).line + 1
        # As text and as it is: 1 and '1' are one key to us, 1 and true to Python.
        for name in (key,) if isinstance(key, str) else (str(key), key):
            if name in self.lines:
                raise BrokenFile(f"{path} has the key {str(key)!r} twice, in lines {self.lines[name]} and {line}")
        self.lines[key] = self.lines[str(key)] = line

    def closed(self) -> list[object] | _Mapping:
        """Return the whole list or mapping."""
        if not self.merged or isinstance(self.values, list):
            return self.values
        whole: _Mapping = {}
        for part in (*self.merged, self.values):
            whole |= part
        return whole


def _mark(event: yaml.Event) -> Any:
    """Return where an event begins; the marks of libyaml are a class of their own."""
    return event.start_mark


def _refused(problem: str, event: yaml.Event) -> ConstructorError:
    return ConstructorError(None, None, problem, _mark(event))


class _Scalars:
    """The values of scalars; `tags` are read by functions of the tag and the text, and dates then are texts."""

    def __init__(self, tags: Mapping[str, Callable[[str, str], object]], path: Path) -> None:
        self._tags, self._path, self._rules = tags, path, Loader("")
        self._known: dict[tuple[str, bool], object] = {}

    def value_of(self, event: yaml.ScalarEvent, *, is_key: bool) -> object:
        """Return the value of an event's scalar."""
        text, tag = event.value, event.tag
        if tag in (None, "!"):
            if _FLOAT.match(text) and event.implicit[0]:
                return float(text)
            kept = text, event.implicit[0]
            if kept not in self._known:
                self._known[kept] = self._made(self._rules.resolve(yaml.ScalarNode, text, event.implicit), event)
            value = self._known[kept]
        else:
            value = self._made(tag, event)
        if value is _MERGE and not is_key:
            raise _refused("<< is no value", event)
        return value

    def _made(self, tag: str, event: yaml.ScalarEvent) -> object:
        if tag in self._tags:
            return self._tags[tag](tag, event.value)
        if tag == _TAG + "merge":
            return _MERGE
        if tag == _TAG + "value" or (self._tags and tag == _TAG + "timestamp"):
            return event.value
        if tag == _TAG + "int" and len(event.value) > _MOST_DIGITS:
            # Python takes quadratic time to read it, and refuses to print it.
            where = f"{self._path} has a number of {len(event.value)} digits in line {_mark(event).line + 1}"
            raise BrokenFile(where)
        make = self._rules.yaml_constructors.get(tag, Loader.construct_undefined)
        return make(self._rules, yaml.ScalarNode(tag, event.value, _mark(event)))


def values_of(text: str, path: Path, tags: Mapping[str, Callable[[str, str], object]]) -> object:
    """Return the content of a YAML text, None for nothing.

    Refuses deep files, aliases that expand to gigabytes, and a key that a mapping has twice (BrokenFile); raises what
    PyYAML does, or what the tags' functions do, for a text that is no YAML.
    """
    allowed = _LARGEST + _LARGEST_SHARE * len(text)
    scalars, known = _Scalars(tags, path), dict[str, tuple[object, int, int]]()
    waiting = [_Open([])]
    for event in yaml.parse(text, Loader=Loader):
        if isinstance(event, yaml.ScalarEvent):
            of = waiting[-1]
            value = scalars.value_of(event, is_key=isinstance(of.values, dict) and of.key is _NO_KEY)
            anchor, size, depth = event.anchor, 1 + len(event.value), 0
        elif isinstance(event, yaml.CollectionStartEvent):
            waiting.append(_opened(event))
            anchor, size, depth, value = None, 0, 0, _NO_KEY
        elif isinstance(event, yaml.CollectionEndEvent):
            done = waiting.pop()
            value, anchor, size, depth = done.closed(), done.anchor, done.size, done.depth + 1
        elif isinstance(event, yaml.AliasEvent):
            if any(event.anchor == each.anchor for each in waiting):
                raise BrokenFile(f"{path} has an alias *{event.anchor} inside of what it stands for")
            if event.anchor not in known:
                raise _refused(f"found undefined alias {event.anchor!r}", event)
            anchor, (value, size, depth) = None, known[event.anchor]
        elif isinstance(event, yaml.DocumentStartEvent) and waiting[0].values:
            raise _refused("expected a single document", event)
        else:
            continue
        if anchor is not None:
            known[anchor] = value, size, depth
        around = waiting[-1]
        around.size, around.depth = around.size + size, max(around.depth, depth)
        if len(waiting) - 1 + around.depth > _DEEPEST:
            raise BrokenFile(f"{path} is nested more than {_DEEPEST} levels deep")
        if around.size > allowed:
            raise BrokenFile(f"{path} has {len(text)} characters and with its aliases written out more than {allowed}")
        if value is not _NO_KEY:
            around.add(value, event, path)
    return waiting[0].values[0] if waiting[0].values else None


def _opened(event: yaml.CollectionStartEvent) -> _Open:
    """Return the list or mapping that begins."""
    kind = "map" if isinstance(event, yaml.MappingStartEvent) else "seq"
    if event.tag not in (None, "!", _TAG + kind):
        raise _refused(f"could not determine a constructor for the tag {event.tag!r}", event)
    return _Open({} if kind == "map" else [], event.anchor)
