"""Limits on the cost of an MJCF, checked before MuJoCo reads it: repetitions, sizes, and the files it names."""

from __future__ import annotations

import math
from pathlib import Path
from xml.etree.ElementTree import Element

from evenroad._files import read_bytes, require_file
from evenroad.errors import BrokenFile
from evenroad.loading.xml_file import read_xml

_FEW, _TIMES = 10_000, 2
"""Largest number of elements with all repetitions: a number, or a multiple of those that are written out."""
_LARGEST_SIZE = 100_000
"""Largest number of <size>."""
_CELLS = {"hfield": ("nrow", "ncol"), "texture": ("width", "height"), "flexcomp": ("count",), "composite": ("count",)}
"""Element -> attributes whose product is the number of its cells."""
_MOST_CELLS = 10_000_000
_PARTS = ("include", "model")
"""Elements that name another MJCF."""
_FOLDERS = ("meshdir", "texturedir", "assetdir")


def require_bounded(path: Path) -> None:
    """Raise BrokenFile for an MJCF that stands for far more than it holds, or names what is no file.

    MuJoCo multiplies as a file says, waits for pipes, and overflows its stack on a model that has itself in it.
    """
    guard = _Guard(path)
    if guard.size_of(path, ()) > max(_FEW, _TIMES * guard.written):
        raise BrokenFile(f"{path} has more than {_FEW} elements with its repetitions")


class _Guard:
    """One MJCF with its parts: each is read once, whatever names it."""

    def __init__(self, path: Path) -> None:
        self.path, self.sizes, self.written = path, dict[Path, int](), 0
        self.folders = {path.parent}

    def size_of(self, path: Path, inside: tuple[Path, ...]) -> int:
        """Return the number of elements that a file stands for; `inside` are the files that led to it."""
        if path in inside or len(inside) > 20:
            raise BrokenFile(f"{self.path}: {path} has itself in it, or too many files inside of each other")
        if path not in self.sizes:
            root = read_xml(path, "MJCF", "an MJCF", None)
            # MuJoCo's reader knows no document types, and could see other elements than ours.
            if b"<!DOCTYPE" in read_bytes(path):
                raise BrokenFile(f"{path} has a document type, which an MJCF must not have")
            for compiler in root.iter("compiler"):
                self.folders |= {self.path.parent / compiler.get(name, "") for name in _FOLDERS}
            models = {
                each.get("name", Path(each.get("file", "")).stem): self._part(each, (*inside, path))
                for each in root.iter("model")
                if each.get("file")
            }
            self.sizes[path] = self._size(root, models, (*inside, path))
        return self.sizes[path]

    def _size(self, root: Element, models: dict[str, int], inside: tuple[Path, ...]) -> int:
        """Return the number of elements in a file; attached models count where they are attached."""
        total, waiting = 0, [(root, 1)]
        while waiting:
            element, times = waiting.pop()
            self._require_plain(element)
            if element.tag == "replicate":
                times *= max(1, int(min(_number(element.get("count", "1")), _FEW + 1)))
            total += times
            self.written += 1
            if element.tag == "include":
                total += times * self._part(element, inside)
            elif element.tag == "attach":
                total += times * models.get(element.get("model", ""), 0)
            waiting += [(child, times) for child in element]
        return total

    def _part(self, element: Element, inside: tuple[Path, ...]) -> int:
        """Return the size of another MJCF that an element names; MuJoCo refuses one that is missing."""
        name = element.get("file", "")
        paths = [folder / name for folder in {self.path.parent, inside[-1].parent}]
        return sum(self.size_of(path, inside) for path in paths if path.exists() and not path.is_dir())

    def _require_plain(self, element: Element) -> None:
        """Raise BrokenFile where an element gives a huge size, or names what is no file."""
        words = [word for name in _CELLS.get(element.tag, ()) for word in element.get(name, "").split()]
        if math.prod(max(1.0, _number(word)) for word in words) > _MOST_CELLS:
            raise BrokenFile(f"{self.path}: a <{element.tag}> has more than {_MOST_CELLS} cells")
        for name, value in element.attrib.items():
            if element.tag == "size" and name != "memory" and _number(value) > _LARGEST_SIZE:
                raise BrokenFile(f"{self.path}: {name} of <size> must be at most {_LARGEST_SIZE}, got {value!r}")
            if name.startswith("file") and element.tag not in _PARTS:
                for folder in self.folders:
                    try:
                        require_file(folder / value)
                    except FileNotFoundError:
                        continue
                    except (OSError, ValueError) as error:
                        said = getattr(error, "strerror", None) or error
                        raise BrokenFile(f"{self.path}: cannot read {folder / value}: {said}") from error


def _number(word: str) -> float:
    """Return a number that MuJoCo reads; what is none it refuses itself."""
    try:
        number = float(word)
    except ValueError:
        return 1.0
    return number if math.isfinite(number) else math.inf
