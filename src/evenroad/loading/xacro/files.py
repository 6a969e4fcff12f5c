"""Files that a xacro names: packages, includes and YAML, the last only where its packages are."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Mapping
from glob import escape, glob
from pathlib import Path

from evenroad._yaml import read_yaml
from evenroad.errors import BrokenFile, InvalidValue, shown
from evenroad.loading.xacro.values import Budget, literal

_PACKAGE = re.compile(r"\w[\w.-]*")
_MANIFEST = "package.xml"
_UNITS = {
    "!radians": 1.0,
    "!degrees": math.pi / 180.0,
    "!meters": 1.0,
    "!millimeters": 0.001,
    "!foot": 0.3048,
    "!inches": 0.0254,
}
"""Tag of a YAML -> what its numbers are times."""


class Files:
    """Files of one xacro, and which of them is read now.

    `find` returns the folder of a package, and raises LookupError where there is none; `given` are folders of packages
    that the user named.
    """

    def __init__(self, path: Path, find: Callable[[str], Path], given: Mapping[str, str], budget: Budget) -> None:
        self.stack, self.read = [path], [path]
        self._find, self._budget = find, budget
        self._roots = {_around(path.absolute().parent), *map(Path, given.values())}

    def folder(self) -> str:
        """Return the folder of the file that is read now."""
        return os.path.abspath(self.stack[-1].parent)

    def absolute(self, name: str) -> str:
        """Return a name that is relative to the file that is read now."""
        return os.path.join(self.folder(), _text(name))

    def package(self, name: str) -> str:
        """Return the folder of a package; raises BrokenFile, with the option that names it, where there is none."""
        if not _PACKAGE.fullmatch(_text(name)):
            raise InvalidValue(f"{shown(name)} is no name of a package")
        try:
            folder = self._find(name)
        except LookupError as error:
            raise BrokenFile(f"the package {name!r} is missing; --package {name}=FOLDER says where it is") from error
        # Any folder beside the file may have the name that is sought; what has a manifest is a package.
        if (folder / _MANIFEST).is_file():
            self._roots.add(folder)
        return str(folder)

    def included(self, name: str, optional: bool) -> list[Path]:
        """Return the files that an include names; only the last part of a name may have wildcards."""
        path = Path(self.absolute(name))
        paths = sorted(map(Path, glob(os.path.join(escape(str(path.parent)), path.name))))
        if paths or optional:
            return paths
        raise BrokenFile(f"the included file {path} is missing")

    def begin(self, path: Path) -> None:
        """Go on in an included file."""
        self._spend(path)
        self.stack.append(path)
        self.read.append(path)

    def load_yaml(self, name: str) -> object:
        """Return the content of a YAML file of the robot's package; numbers may have units as tags."""
        path = Path(self.absolute(name))
        real = path.resolve()
        if not any(real.is_relative_to(inside) for root in self._roots for inside in _folders(root)):
            hint = "--package NAME=FOLDER allows a folder"
            raise InvalidValue(f"load_yaml reads within the folders of the robot and its packages, not {real}; {hint}")
        self._spend(path)
        return read_yaml(path, "YAML file of a xacro", tags=dict.fromkeys(_UNITS, _in_units))

    def _spend(self, path: Path) -> None:
        self._budget.spend(path.stat().st_size if path.is_file() else 0)


def _text(name: object) -> str:
    if not isinstance(name, str) or "\0" in name:
        raise InvalidValue(f"the name of a file or package must be a text, got {shown(name)}")
    return name


def _around(folder: Path) -> Path:
    """Return the package that a folder is in, or the folder itself where it is in none."""
    return next((each for each in (folder, *folder.parents) if (each / _MANIFEST).is_file()), folder)


def _folders(root: Path) -> list[Path]:
    """Return the folder of a package, and that of its sources, to which a workspace links each of its files."""
    source = (root / _MANIFEST).resolve()
    return [root.resolve(), *([source.parent] if source.name == _MANIFEST and source.is_file() else [])]


def _in_units(tag: str, text: str) -> float:
    number = literal(text)
    if isinstance(number, bool) or not isinstance(number, int | float):
        raise InvalidValue(f"{tag} is of a number, got {shown(text)}")
    return number * _UNITS[tag]
