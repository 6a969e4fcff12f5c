"""Entry: a mapping of a scene's file, read key by key; errors say which key is wrong, and where."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from evenroad._checks import require_positive
from evenroad._yaml import numbers, require_keys
from evenroad.errors import BrokenFile, InvalidValue, shown
from evenroad.geometry.pose import Pose


def pose_of(xyz: Sequence[float], quaternion: Sequence[float], where: str) -> Pose:
    """Return a pose by its position [m] and its quaternion, x y z w; InvalidValue names `where`."""
    try:
        return Pose.from_quaternion(xyz, xyzw=quaternion)
    except InvalidValue as error:
        raise InvalidValue(f"{where}: {error}") from None


@dataclass(frozen=True)
class Entry:
    """A mapping, what it is called in errors, and the folder of the file that it is in."""

    content: Mapping[str, object]
    where: str
    folder: Path = Path()

    def __contains__(self, key: str) -> bool:
        return key in self.content

    def get(self, key: str, default: object = None) -> object:
        """Return what is under a key."""
        return self.content.get(key, default)

    def called(self, where: str) -> Entry:
        """Return the same, called otherwise in errors."""
        return replace(self, where=where)

    def without(self, *keys: str) -> Entry:
        """Return the same without some keys."""
        return replace(self, content={key: value for key, value in self.content.items() if key not in keys})

    def require(self, required: Iterable[str], optional: Iterable[str] = ()) -> None:
        """Raise UnknownName for a key that is neither, BrokenFile for one that is missing."""
        require_keys(self.content, tuple(required), optional, self.where)

    def inside(self, value: object, where: str) -> Entry:
        """Return a mapping in this one, empty for None; BrokenFile, which names `where`, if it is none."""
        if not isinstance(value, Mapping | None):
            raise BrokenFile(f"{where} must consist of 'key: value' entries, got {shown(value)}")
        return Entry({str(key): each for key, each in (value or {}).items()}, where, self.folder)

    def each(self, key: str, what: str) -> Iterator[tuple[str, Entry]]:
        """Yield the mappings under a key by their names; `what` is each of them in errors."""
        for name, value in self.inside(self.get(key), f"{key} in {self.where}").content.items():
            yield name, self.inside(value, f"{what} {name!r} in {self.where}")

    def parts(self, key: str) -> list[Entry]:
        """Return the mappings of a list, or a single one; BrokenFile if something is none."""
        found = self.get(key)
        listed = found if isinstance(found, list) else [] if found is None else [found]
        return [self.inside(each, f"{key!r} in {self.where}").called(self.where) for each in listed]

    def part(self, key: str) -> Entry:
        """Return the mapping under a key, an empty one where there is none; BrokenFile if it is none."""
        return next(iter(self.parts(key)), Entry({}, self.where, self.folder))

    def entries(self, key: str) -> list[object]:
        """Return a list, empty where there is none; InvalidValue if it is none."""
        found = self.get(key)
        if not isinstance(found, list | None):
            raise InvalidValue(f"{key} of {self.where} must be a list, got {shown(found)}")
        return found or []

    def texts(self, key: str, of: str) -> tuple[str, ...]:
        """Return a list of texts, which errors call `of`, empty where there is none; InvalidValue if it is none."""
        found = self.get(key) or []
        if not isinstance(found, list) or not all(isinstance(each, str) for each in found):
            raise InvalidValue(f"{key} of {self.where} must be a list of {of}, got {shown(found)}")
        return tuple(found)

    def row(self, key: str, count: int, default: object = None) -> tuple[float, ...]:
        """Return numbers; InvalidValue if there are others, or what they are is none."""
        return numbers(self.get(key, default), count, f"{key} of {self.where}")

    def number(self, key: str, default: object = None, what: str = "") -> float:
        """Return a number, which errors call `what`; InvalidValue if it is none."""
        return numbers(self.get(key, default), 1, f"{what or key} of {self.where}")[0]

    def length(self, key: str, default: object = None, *, or_zero: bool = False) -> float:
        """Return a number > 0, or >= 0."""
        return require_positive(f"{key} of {self.where}", self.number(key, default), or_zero=or_zero)

    def yes(self, key: str) -> bool:
        """Return whether something is so, False by default; InvalidValue if it is neither true nor false."""
        value = self.get(key, False)
        if not isinstance(value, bool):
            raise InvalidValue(f"{key} of {self.where} must be true or false, got {value!r}")
        return value

    def file(self, key: str = "file") -> Path:
        """Return the file that is named, beside that of the entry; BrokenFile if it is missing."""
        name = self.get(key)
        if not isinstance(name, str):
            raise InvalidValue(f"file of {self.where} must be the name of a file, got {name!r}")
        if not (file := self.folder / name).is_file():
            raise BrokenFile(f"the file {file} of {self.where} is missing")
        return file

    def pose(self) -> Pose:
        """Return the pose by xyz, and rpy or xyzw."""
        xyz = self.row("xyz", 3, [0, 0, 0])
        if "rpy" in self and "xyzw" in self:
            raise InvalidValue(f"{self.where} must have one of rpy and xyzw, got both")
        if "xyzw" in self:
            return pose_of(xyz, self.row("xyzw", 4), self.where)
        return Pose.from_rpy(xyz, self.row("rpy", 3)) if "rpy" in self else Pose(xyz)
