"""The guard of every reader: what a file says and its reader does not understand is refused by name, or noted.

A reader describes once, as a :class:`Kind`, each kind of mapping or XML element that it reads, and calls
:func:`require_understood` before it reads any.  Each key, attribute and element is then one of these:

* known and used, or known and harmless, as it changes nothing here: it passes;
* listed as refused: it raises, with what to do in its place;
* misspelt, which is near to a used name: it raises, with a hint;
* unknown: it raises, or is noted where the reader gives a list of notes.  Readers of other tools' files do so, as
  refusing would lock their users out.

To read a file of one's own, or one where an unknown name may be an obstacle or a limit, give no notes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from xml.etree.ElementTree import Element

from evenroad.errors import UnknownName, near, shown

_MOST_HINTS = 200
"""Largest number of unknown names of a file that are compared with known ones."""
_MOST_NAMED = 6
"""Largest number of unknown names in a note."""
_MOST_AROUND = 4
"""Largest number of mappings or elements around an unknown name that are named with it."""
_OF_XML = ("xml", "xsi:")
"""Beginnings of attributes that belong to XML itself."""


@dataclass(frozen=True)
class Kind:
    """One kind of mapping or XML element, by what a reader knows of it.

    Attributes
    ----------
    names : collection of str
        Keys, or attributes, that are read.
    parts : mapping of str to Kind
        Keys, or tags, whose mappings or elements are read, each of its own kind.  A list in a mapping stands for each
        of its entries.
    each : Kind or None
        Kind of what a mapping has under names of the file's own, such as names of joints; these are not looked at.
    harmless : collection of str
        Keys, attributes or tags that change nothing here, with all that is in them; a set where there are many.
    refused : mapping of str to str
        Names that are refused, each with what to do in its place: "padding of links is load_robot(padding=...)".
    """

    names: Collection[str] = ()
    parts: Mapping[str, Kind] = field(default_factory=dict)
    each: Kind | None = None
    harmless: Collection[str] = frozenset()
    refused: Mapping[str, str] = field(default_factory=dict)

    @cached_property
    def passing(self) -> frozenset[str]:
        """Names that pass as keys or attributes: used and harmless ones."""
        return frozenset((*self.names, *self.harmless))


_Node = tuple[Mapping[str, object] | Element, str, "_Node | None"]
"""A mapping or element, the key or tag that it has, and what it is in."""


def require_understood(
    document: Mapping[str, object] | Element, kind: Kind, where: str, notes: list[str] | None = None
) -> None:
    """Raise UnknownName, or add one note, for what a mapping or XML element has that its kind does not know.

    The time is linear in the size of the document.

    Parameters
    ----------
    document : mapping or Element
    kind : Kind
        Of the document itself.
    where : str
        The document in errors, such as ``"the scene shelf.yaml"``.
    notes : list of str, optional
        Where one line is added about all unknown names, which then do not raise unless they are near to a used one.
    """
    first: dict[tuple[str, str], _Node] = {}
    counts: Counter[tuple[str, str]] = Counter()
    waiting: list[tuple[_Node, Kind]] = [((document, getattr(document, "tag", ""), None), kind)]
    while waiting:
        node, kind = waiting.pop()
        for name, sort in _strange(node, kind, waiting):
            if name in kind.refused:
                raise UnknownName(f"{_label(node, sort, name, where)} is not taken: {kind.refused[name]}")
            said = _said(sort, name), node[1]
            counts[said] += 1
            if said in first:
                continue
            known = [*kind.parts] if sort == "element" else [*kind.names]
            known += [*kind.parts] if sort == "key" else []
            compared = len(first) < _MOST_HINTS and ":" not in name
            if notes is None or (compared and near(name, known)):
                raise UnknownName.among(f"{_label(node, sort, '', where)}:", name, known)
            first[said] = node
    if notes is not None and first:
        labels = [
            f"{said} of {_owner(first[said, tag])}" + (f" ({counts[said, tag]} times)" if counts[said, tag] > 1 else "")
            for said, tag in list(first)[:_MOST_NAMED]
        ]
        more = f" and {len(first) - _MOST_NAMED} more" if len(first) > _MOST_NAMED else ""
        notes.append(f"left out, as it is not understood: {', '.join(labels)}{more}")


def _strange(node: _Node, kind: Kind, waiting: list[tuple[_Node, Kind]]) -> Iterator[tuple[str, str]]:
    """Yield each name in a mapping or element that its kind neither uses nor skips, and its sort: key, ...

    What is inside of it, and its kind knows, is put onto the list of those that wait.
    """
    content = node[0]
    if isinstance(content, Element):
        for name in content.attrib:
            if name not in kind.passing and not name.startswith(_OF_XML):
                yield name, "attribute"
        for child in content:
            if child.tag in kind.parts:
                waiting.append(((child, child.tag, node), kind.parts[child.tag]))
            elif child.tag not in kind.harmless:
                yield child.tag, "element"
        return
    for key, value in content.items():
        name = str(key)
        inner = kind.parts.get(name, kind.each if name not in kind.passing else None)
        if inner is not None:
            values = value if isinstance(value, list | tuple) else (value,)
            waiting += [((each, name, node), inner) for each in values if isinstance(each, Mapping)]
        elif name not in kind.passing:
            yield name, "key"


def _said(sort: str, name: str) -> str:
    return f"<{name}>" if sort == "element" else f"{sort} {shown(name)}"


def _label(node: _Node, sort: str, name: str, where: str) -> str:
    """Return where a name stands, in words: ``attribute 'rgb' of <origin> of <link> 'arm' in arm.urdf``."""
    owner = _owner(node)
    return f"{_said(sort, name) if name else sort} of " + (f"{owner} in {where}" if owner else where)


def _owner(node: _Node) -> str:
    """Return a mapping or element in words, and what is around it, up to the first that has a name of its own."""
    words: list[str] = []
    above: _Node | None = node
    while above is not None and len(words) < _MOST_AROUND:
        content, name, around = above
        own = content.get("name") or content.get("id")
        said = f"<{name}>" if isinstance(content, Element) else name
        words.append(f"{said} {shown(str(own))}".strip() if own else said)
        above = None if own else around
    return " of ".join(word for word in words if word)
