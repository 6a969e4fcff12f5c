"""Reading XML files: robots, SRDFs, MJCFs, packages."""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from evenroad._files import not_a, read_bytes, read_known
from evenroad.errors import BrokenFile


def read_xml(path: Path, what: str, kind: str, tag: str | None = "robot") -> Element:
    """Return the outermost element of a file, which must have this tag; None allows any.

    `what` and `kind` name the file in errors, each a BrokenFile.
    """
    content = read_known(path, what)
    root = _parsed(content, path)
    if tag is not None and root.tag != tag:
        raise BrokenFile(f"{path} is not {kind}: its outermost element is <{root.tag}>, not <{tag}>")
    return root


def _parsed(content: bytes, path: Path) -> Element:
    """Return the root of an XML; prefixes may be unknown, and blanks around it, as in other readers of URDFs."""
    builder, parser = TreeBuilder(), expat.ParserCreate()
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.data
    try:
        parser.Parse(content.strip(b" \t\r\n\0"), True)
        return builder.close()
    except (expat.ExpatError, ValueError, LookupError) as error:
        raise _no_xml(content, path, error) from error


def _no_xml(content: bytes, path: Path, error: Exception) -> BrokenFile:
    """Return the error of broken XML, or of another kind of file."""
    if content.lstrip(b" \t\r\n\0\xef\xbb\xbf").startswith(b"<"):
        return BrokenFile(f"{path} is not XML: {error}")
    return not_a("XML, as URDF, xacro, MJCF and SRDF are", path)


def outermost(path: Path) -> str:
    """Return the tag of the outermost element of an XML; an empty text of what is none."""
    try:
        return _parsed(read_bytes(path), path).tag
    except (OSError, BrokenFile):
        return ""
