"""The part of YAML that scenes are written in: mappings and lists, in blocks or in brackets, of texts and numbers.

A text becomes JSON, token by token, with all scalars as texts.  Anchors, tags, texts of several lines and keys that
come twice are refused.
"""

from __future__ import annotations

import json
import re

from evenroad_verify.errors import BadInput, require

_TOKEN = re.compile(
    r"""[\[\]{},]|:(?=[\s,\]}]|$)|"[^"\\]*"|'(?:[^']|'')*'"""
    r"""|[^\s\[\]{},:"'&*!|>%@`\#](?:[^\[\]{},:]|:(?=[^\s,\]}]))*|\S"""
)
_KEY = re.compile(r"""("[^"\\]*"|'(?:[^']|'')*'|[^\s"'\[\]{}&*!|>%@`,#?-](?:[^:]|:(?=\S))*?)\s*:(?:\s+(.*)|$)""")
_COMMENT = re.compile(r"""((?:[^"'#]|"[^"]*"|'[^']*'|(?<=[^\s])#)*?)(?:(?:^|(?<=\s))#.*)?$""")


def parse_yaml(text: str) -> object:
    """Return mappings, lists and texts; BadInput for what is not understood."""
    require("\t" not in text, "the scene has tabs")
    lines: list[tuple[int, str]] = []
    for raw in text.split("\n"):
        found = _COMMENT.match(raw.rstrip("\r"))
        require(found, f"a line of the scene is not understood: {raw[:60]!r}")
        line = found.group(1).rstrip() if found else ""
        if lines and _is_open(lines[-1][1]):
            lines[-1] = (lines[-1][0], f"{lines[-1][1]} {line.strip()}")
        elif line == "---":
            require(not lines, "the scene has more than one document")
        elif line:
            lines.append((len(line) - len(line.lstrip()), line.strip()))
    lines.reverse()
    try:
        value = _block(lines) if lines else "{}"
        require(not lines, f"a line of the scene is not understood: {lines[-1][1][:60]!r}" if lines else "")
        return json.loads(value, object_pairs_hook=_once)
    except (ValueError, RecursionError):
        raise BadInput("the scene has brackets that are not understood, or a key twice") from None


def _once(pairs: list[tuple[str, object]]) -> dict[str, object]:
    require(len({key for key, _ in pairs}) == len(pairs), "the scene has a key twice")
    return dict(pairs)


def _is_open(line: str) -> bool:
    """Return whether brackets are open at the end of a line."""
    marks = _TOKEN.findall(line)
    return sum(mark in ("[", "{") for mark in marks) > sum(mark in ("]", "}") for mark in marks)


def _block(lines: list[tuple[int, str]]) -> str:
    """Take a block from the end of `lines`, which are in reverse; return it as JSON."""
    indent, text = lines[-1]
    entries = []
    if text == "-" or text.startswith("- "):
        while lines and lines[-1][0] == indent and (lines[-1][1] == "-" or lines[-1][1].startswith("- ")):
            rest = lines.pop()[1][1:]
            if rest.strip():
                lines.append((indent + 1 + len(rest) - len(rest.lstrip()), rest.strip()))
            entries.append(_block(lines) if lines and lines[-1][0] > indent else "null")
        return f"[{','.join(entries)}]"
    if not _KEY.fullmatch(text):
        return _flow(lines.pop()[1])
    while lines and lines[-1][0] == indent and (found := _KEY.fullmatch(lines[-1][1])):
        lines.pop()
        is_inner = lines and (lines[-1][0] > indent or (lines[-1][0] == indent and lines[-1][1].startswith("-")))
        value = _flow(found.group(2)) if found.group(2) else _block(lines) if is_inner else "null"
        entries.append(f"{_flow(found.group(1))}:{value}")
    return f"{{{','.join(entries)}}}"


def _flow(text: str) -> str:
    """Return a text in brackets, or a scalar, as JSON."""
    return "".join(
        token if token in ("[", "]", "{", "}", ",", ":") else _scalar(token) for token in _TOKEN.findall(text)
    )


def _scalar(token: str) -> str:
    quoted = token[0] in "\"'" and len(token) > 1
    require(quoted or token[0] not in "\"'&*!|>%@`#", f"not understood in the scene: {token[:40]!r}")
    return json.dumps(token[1:-1].replace("''", "'") if quoted else token.rstrip())
