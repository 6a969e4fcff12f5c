"""Reading YAML files with unique keys; errors name what is wrong, and where."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from evenroad._files import not_a, read_bytes
from evenroad._understood import Kind, require_understood
from evenroad.errors import BrokenFile, InvalidValue, shown

# libyaml where PyYAML was built with it: ten times as fast.
_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_DEEPEST = 100
_LARGEST, _LARGEST_SHARE = 1_000_000, 10
"""Largest number of characters and entries with all aliases expanded: a number, and one per character of the file."""
_MERGE, _INTEGER = "tag:yaml.org,2002:merge", "tag:yaml.org,2002:int"
_MOST_DIGITS = 1000


def read_mapping(path: Path, what: str) -> dict[str, Any]:
    """Return the mapping of a YAML file of the kind `what`, its keys as text.

    Raises BrokenFile if the file is missing, no YAML or no mapping, or any mapping in it has a key twice (``1`` and
    ``'1'`` are the same).
    """
    document = read_yaml(path, what)
    if not isinstance(document, dict):
        raise not_a(f"a {what}", path, "it must consist of 'key: value' lines")
    return {str(key): value for key, value in document.items()}


def read_yaml(path: Path, what: str, *, tags: Mapping[str, Callable[[str, str], object]] | None = None) -> object:
    """Return the content of a YAML file; `tags` of scalars are read by functions of the tag and the text.

    Raises BrokenFile as `read_mapping`.
    """
    try:
        text = read_bytes(path).decode()
        _require_bounded(text, path)
        return _document(text, path, _with_tags(tags) if tags else _Loader)
    except BrokenFile:
        raise
    except OSError as error:
        raise BrokenFile(f"cannot read the {what} {path}: {error.strerror or error}") from error
    except (yaml.YAMLError, ValueError, LookupError, AttributeError, RecursionError) as error:
        raise not_a(f"YAML, as a {what} is", path, _why(error)) from error


def _with_tags(tags: Mapping[str, Callable[[str, str], object]]) -> Any:
    """Return a loader that knows some tags, and leaves dates as texts."""

    class Loader(_Loader):
        pass

    def construct(loader: Any, node: yaml.Node) -> object:
        return tags[node.tag](node.tag, loader.construct_scalar(node))

    for tag in tags:
        Loader.add_constructor(tag, construct)
    Loader.add_constructor("tag:yaml.org,2002:timestamp", _Loader.construct_yaml_str)
    return Loader


def _why(error: Exception) -> str:
    """Return the message of a YAML error, with its position, in one line."""
    mark = getattr(error, "problem_mark", None)
    if mark is None:
        return " ".join(str(error).split())
    return f"line {mark.line + 1}, column {mark.column + 1}: {error.problem}"  # type: ignore[attr-defined]


def _require_bounded(text: str, path: Path) -> None:
    """Refuse deep files, on which libyaml overflows the stack, and aliases that expand to gigabytes."""
    allowed = _LARGEST + _LARGEST_SHARE * len(text)
    known: dict[str, tuple[int, int]] = {}
    # Anchor, size and depth of each open collection so far.
    waiting: list[tuple[str | None, int, int]] = [(None, 0, 0)]
    for event in yaml.parse(text, Loader=_Loader):
        if isinstance(event, yaml.CollectionStartEvent):
            waiting.append((event.anchor, 1, 0))
            size, depth = 0, 0
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, size, depth = waiting.pop()
            depth += 1
            known |= {anchor: (size, depth)} if anchor else {}
        elif isinstance(event, yaml.ScalarEvent):
            size, depth = 1 + len(event.value), 0
            known |= {event.anchor: (size, depth)} if event.anchor else {}
        elif isinstance(event, yaml.AliasEvent):
            if any(event.anchor == each[0] for each in waiting):
                raise BrokenFile(f"{path} has an alias *{event.anchor} inside of what it stands for")
            # The reader refuses an unknown alias.
            size, depth = known.get(str(event.anchor), (1, 0))
        else:
            continue
        anchor, around, below = waiting[-1]
        waiting[-1] = anchor, around + size, max(below, depth)
        if len(waiting) - 1 + waiting[-1][2] > _DEEPEST:
            raise BrokenFile(f"{path} is nested more than {_DEEPEST} levels deep")
        if waiting[-1][1] > allowed:
            raise BrokenFile(f"{path} has {len(text)} characters and with its aliases written out more than {allowed}")


def _document(text: str, path: Path, kind: Any) -> object:
    loader = kind(text)
    try:
        root = loader.get_single_node()
        if root is None:
            return None
        # Before construction: PyYAML keeps the last of equal keys silently, and merging (<<) makes intended ones.
        _require_sound(loader, root, path)
        return loader.construct_document(root)
    finally:
        loader.dispose()


def _require_sound(loader: Any, root: yaml.Node, path: Path) -> None:
    pending, seen = [root], set()
    while pending:
        node = pending.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        if node.tag == _INTEGER and len(node.value) > _MOST_DIGITS:
            # Python takes quadratic time to read it, and refuses to print it.
            raise BrokenFile(f"{path} has a number of {len(node.value)} digits in line {node.start_mark.line + 1}")
        if isinstance(node, yaml.SequenceNode):
            pending.extend(node.value)
        elif isinstance(node, yaml.MappingNode):
            lines: dict[object, int] = {}
            for key, value in node.value:
                pending.append(value)
                if not isinstance(key, yaml.ScalarNode) or key.tag == _MERGE:
                    continue
                made, line = loader.construct_object(key), key.start_mark.line + 1
                # As text and as it is: 1 and '1' are one key to us, 1 and true to Python.
                earlier = [lines[name] for name in (str(made), made) if name in lines]
                if earlier:
                    raise BrokenFile(f"{path} has the key {str(made)!r} twice, in lines {earlier[0]} and {line}")
                lines |= {str(made): line, made: line}


def require_keys(keys: Iterable[str], required: Collection[str], optional: Iterable[str], where: str) -> None:
    """Raise UnknownName for a key that is neither required nor optional, BrokenFile for one that is missing.

    It is the guard of :mod:`evenroad._understood` for a mapping whose entries are read where it is.
    """
    require_understood(dict.fromkeys(keys), Kind((*required, *optional)), where)
    missing = [key for key in required if key not in keys]
    if missing:
        raise BrokenFile(f"{where} lacks {', '.join(missing)}; it needs {', '.join(required)}")


def numbers(value: object, count: int, what: str) -> tuple[float, ...]:
    """Return `value` as a tuple of `count` finite floats, or raise InvalidValue naming it."""
    value = value.tolist() if isinstance(value, np.ndarray) else value
    entries = list(value) if isinstance(value, list | tuple) else [value]
    plain = [entry for entry in entries if isinstance(entry, int | float) and not isinstance(entry, bool)]
    with suppress(OverflowError):
        row = tuple(map(float, plain))
        if len(entries) == count == len(row) and all(map(math.isfinite, row)):
            return row
    allowed = "a finite number" if count == 1 else f"a list of {count} finite numbers"
    given = entries[0] if count == 1 and len(entries) == 1 else value
    hint = ""
    if any(isinstance(entry, str) for entry in entries):
        hint = " (text; YAML reads an exponent only after a decimal point: 1.0e-2, not 1e-2)"
    raise InvalidValue(f"{what} must be {allowed}, got {shown(given)}{hint}")
