"""The files of a claim: read once, each counted into one digest; and XML without surprises."""

from __future__ import annotations

import hashlib
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path

from evenroad_verify.errors import demand, require


class Files:
    """Reads files and keeps the digest of all of them, in the order in which they are asked for.

    While `own` holds, the next one that the certificate carries stands for each file; `taken` are name and bytes of
    these.
    """

    def __init__(self, carried: Sequence[bytes] = ()) -> None:
        self.own = False
        self.taken: list[tuple[str, bytes]] = []
        self._carried = list(carried)
        self._seen: dict[Path, bytes] = {}
        self._digest = hashlib.sha256()

    def read(self, path: Path) -> bytes:
        """Return what a file holds."""
        if self.own:
            demand(self._carried, f"it does not carry {path.name}")
            data = self._carried.pop(0)
            self.taken.append((path.name, data))
        else:
            require(path.is_file(), f"there is no file {path}")
            data = self._seen[path] if path in self._seen else path.read_bytes()
            self._seen[path] = data
        self._digest.update(hashlib.sha256(data).digest())
        return data

    @property
    def is_done(self) -> bool:
        """Whether all that the certificate carries was read."""
        return not self._carried

    def require_same(self, path: Path | None, digest: str) -> None:
        """Raise Refused where a file, if there is one, is not that which the writer has read."""
        if path is not None:
            same = path.is_file() and hashlib.sha256(path.read_bytes()).hexdigest() == digest
            demand(same, f"it carries what it is about, and that was not read from {path}: write - in its place")

    @property
    def digest(self) -> str:
        """The SHA-256 of the SHA-256 of every file that was asked for."""
        return self._digest.hexdigest()


def parse_xml(data: bytes, what: str) -> ET.Element:
    """Return the outermost element of an XML in UTF-8 that declares no entities."""
    try:
        text = data.decode("utf-8")
        require("<!DOCTYPE" not in text and "<!ENTITY" not in text, f"{what} declares entities")
        root = ET.fromstring(text)
    except (UnicodeDecodeError, ET.ParseError) as error:
        require(False, f"{what} is no XML in UTF-8: {error}")
        raise
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""
    return root


def only(element: ET.Element, tag: str) -> ET.Element | None:
    """Return the child of a tag; BadInput where there are several."""
    found = element.findall(tag)
    require(len(found) < 2, f"<{element.tag}> has more than one <{tag}>")
    return found[0] if found else None


def required(element: ET.Element, tag: str) -> ET.Element:
    """Return the child of a tag; BadInput unless there is one."""
    found = only(element, tag)
    require(found is not None, f"<{element.tag} {element.get('name', '')}> lacks <{tag}>")
    assert found is not None
    return found


def attribute(element: ET.Element | None, name: str) -> str:
    """Return an attribute; BadInput where it is missing."""
    value = None if element is None else element.get(name)
    require(value is not None, f"an element lacks {name}")
    return str(value)
