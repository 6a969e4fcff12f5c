"""Reading MoveIt's text files ``.scene``: boxes, spheres and cylinders in a frame that must be the robot's root link.

Quaternions are (x, y, z, w) there.  An object of several shapes becomes obstacles ``NAME/0``, ``NAME/1``, ...
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from evenroad._files import read_bytes
from evenroad.errors import BrokenFile
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.scenes.entry import pose_of
from evenroad.scenes.planning_objects import ROOT, Frame, Object, dimensions_of, solid_of
from evenroad.scenes.scene import Obstacle, Scene

Numbers = tuple[float, ...]


def read_scene_text(path: Path) -> Scene:
    """Read a ``.scene`` file: a name, then objects that begin with ``*``, and a full stop.

    An object has a name, in newer files a pose, the number of its shapes, and each shape with its dimensions, pose and
    colour; in newer files subframes follow, which are skipped.  Raises BrokenFile if the file is missing or ends too
    early, or a number is none; UnknownName if a shape is none of box, sphere and cylinder; InvalidValue if a dimension
    is not > 0, a quaternion has no direction, or two objects share a name.
    """
    try:
        lines = read_bytes(path).decode().splitlines()
    except (OSError, ValueError) as error:
        raise BrokenFile(f"cannot read scene {path}: {getattr(error, 'strerror', None) or error}") from error
    return Scene(tuple(_from_text(lines, path)), name=lines[0].strip() or path.stem if lines else path.stem)


def _from_text(lines: list[str], path: Path) -> Iterator[Obstacle]:
    """Read the obstacles of a text, word by word."""
    first = next((i for i, line in enumerate(lines) if line.lstrip().startswith("*")), len(lines))
    # Newer files have the object's position, three numbers, where older ones have the number of its shapes.
    posed = first + 1 < len(lines) and len(lines[first + 1].split()) > 1
    rest = [line.split() for line in lines[1:]][::-1]

    def word(what: str) -> str:
        while rest and not rest[-1]:
            rest.pop()
        if not rest:
            raise BrokenFile(f"{path} ends where {what} must be")
        return rest[-1].pop(0)

    def row(count: int) -> Numbers:
        words = [word("a number") for _ in range(count)]
        try:
            return tuple(map(float, words))
        except ValueError:
            raise BrokenFile(f"{path} must have {count} number(s), got {' '.join(words)!r}") from None

    def how_many(what: str) -> range:
        count = word(f"the number of {what}")
        if not count.isdecimal() or len(count) > 6:
            raise BrokenFile(f"{path} must have a number of {what}, got {count!r}")
        return range(int(count))

    def pose() -> Pose:
        return pose_of(row(3), row(4), str(path))

    while (marker := word("'*' or '.'")) != ".":
        if marker != "*":
            raise BrokenFile(f"{path} must have '*' before every object and '.' at its end, got {marker!r}")
        name = " ".join(rest.pop())
        where = f"object {name!r} in {path}"
        made = Object(Frame(ROOT, pose() if posed else IDENTITY))
        for _ in how_many("shapes"):
            kind = word("a shape")
            made.shapes.append(solid_of(kind, row(dimensions_of(kind, where)), pose(), where))
            row(4)
        for _ in how_many("subframes") if posed else ():
            word("a subframe")
            pose()
        yield from (Obstacle(own, body) for own, body in made.named(name).items())
