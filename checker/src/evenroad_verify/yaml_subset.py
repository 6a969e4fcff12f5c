"""The part of YAML that scenes are written in: mappings and lists, in blocks or in brackets, of texts and numbers.

Anchors, tags, texts of several lines and keys that come twice are refused.  All scalars are texts.
"""

from __future__ import annotations

import re

from evenroad_verify.errors import require

_TOKEN = re.compile(
    r"""\s*(?:(?P<mark>[\[\]{},])|(?P<colon>:)(?=[\s,\]}]|$)|"(?P<double>[^"\\]*)"|'(?P<single>(?:[^']|'')*)'"""
    r"""|(?P<plain>[^\s\[\]{},:"'&*!|>%@`\#](?:[^\[\]{},:]|:(?=[^\s,\]}]))*))"""
)
_KEY = re.compile(r"""("[^"\\]*"|'(?:[^']|'')*'|[^\s"'\[\]{}&*!|>%@`,#-](?:[^:]|:(?=\S))*?)\s*:(?:\s+(.*)|$)""")
_COMMENT = re.compile(r"""((?:[^"'#]|"[^"]*"|'[^']*'|(?<=[^\s])#)*?)(?:(?:^|(?<=\s))#.*)?$""")
_DEEPEST = 30


def parse_yaml(text: str) -> object:
    """Return mappings, lists and texts; BadInput for what is not understood."""
    require("\t" not in text, "the scene has tabs")
    lines: list[tuple[int, str]] = []
    for raw in text.split("\n"):
        found = _COMMENT.match(raw.rstrip("\r"))
        require(found, f"a line of the scene is not understood: {raw[:60]!r}")
        line = found.group(1).rstrip() if found else ""
        if lines and _open(lines[-1][1]):
            lines[-1] = (lines[-1][0], f"{lines[-1][1]} {line.strip()}")
        elif line and line != "---":
            lines.append((len(line) - len(line.lstrip()), line.strip()))
    lines.reverse()
    value = _block(lines, 0) if lines else {}
    require(not lines, f"a line of the scene is not understood: {lines[-1][1][:60]!r}" if lines else "")
    return value


def _open(line: str) -> bool:
    """Return whether brackets are open at the end of a line."""
    marks = [found.group("mark") for found in _TOKEN.finditer(line)]
    return sum(mark in ("[", "{") for mark in marks) > sum(mark in ("]", "}") for mark in marks)


def _block(lines: list[tuple[int, str]], depth: int) -> object:
    """Take a block from the end of `lines`, which are in reverse."""
    require(depth < _DEEPEST, "the scene is nested too deep")
    indent, text = lines[-1]
    if text == "-" or text.startswith("- "):
        entries = []
        while lines and lines[-1][0] == indent and (lines[-1][1] == "-" or lines[-1][1].startswith("- ")):
            rest = lines.pop()[1][1:]
            if rest.strip():
                lines.append((indent + 1 + len(rest) - len(rest.lstrip()), rest.strip()))
            entries.append(_block(lines, depth + 1) if lines and lines[-1][0] > indent else None)
        return entries
    if not _KEY.fullmatch(text):
        return _flow(lines.pop()[1])
    values: dict[str, object] = {}
    while lines and lines[-1][0] == indent and (found := _KEY.fullmatch(lines[-1][1])):
        lines.pop()
        key, rest = _unquoted(found.group(1)), found.group(2)
        require(key not in values, f"the scene has {key!r} twice")
        if rest:
            values[key] = _flow(rest)
        else:
            inner = lines and (lines[-1][0] > indent or (lines[-1][0] == indent and lines[-1][1].startswith("-")))
            values[key] = _block(lines, depth + 1) if inner else None
    return values


def _unquoted(text: str) -> str:
    return text[1:-1].replace("''", "'") if text[0] == "'" else text[1:-1] if text[0] == '"' else text


def _flow(text: str) -> object:
    """Return the value of a text in brackets, or of one scalar."""
    tokens, at = [], 0
    while text[at:].strip():
        found = _TOKEN.match(text, at)
        require(found and found.end() > at, f"not understood in the scene: {text[:60]!r}")
        assert found is not None
        kind = str(found.lastgroup)
        tokens.append((kind, found.group(kind).rstrip() if kind == "plain" else found.group(kind).replace("''", "'")))
        at = found.end()
    tokens.reverse()
    value = _value(tokens, 0)
    require(not tokens, f"not understood in the scene: {text[:60]!r}")
    return value


def _value(tokens: list[tuple[str, str]], depth: int) -> object:
    require(tokens and depth < _DEEPEST, "the scene has brackets that do not close")
    kind, text = tokens.pop()
    if kind in ("plain", "single", "double"):
        return text
    require(kind == "mark" and text in "[{", f"the scene has {text!r} where a value should be")
    end, entries, values = {"[": "]", "{": "}"}[text], list[object](), dict[str, object]()
    while tokens and tokens[-1] != ("mark", end):
        entry = _value(tokens, depth + 1)
        if text == "{":
            require(
                isinstance(entry, str) and entry not in values, f"the scene has a bad or double key: {str(entry)[:40]}"
            )
            require(tokens and tokens.pop()[0] == "colon", f"the scene has {str(entry)[:40]!r} without a value")
            values[str(entry)] = _value(tokens, depth + 1)
        else:
            entries.append(entry)
        require(tokens and tokens[-1] in (("mark", ","), ("mark", end)), "the scene has brackets that do not close")
        if tokens[-1] == ("mark", ","):
            tokens.pop()
    require(tokens, "the scene has brackets that do not close")
    tokens.pop()
    return entries if text == "[" else values
