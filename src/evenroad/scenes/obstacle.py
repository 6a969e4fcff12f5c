"""Obstacle: a body around a robot that does not move, by its name."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import count
from struct import Struct
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import FARTHEST, as_batch, require_positive
from evenroad._native import robot as native
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Pose, Vector
from evenroad.geometry.rotation import NO_ROTATION
from evenroad.geometry.shapes import PRIMITIVES, Capsule, Mesh, PointCloud, Shape, along_z, shape_of

MARGIN = 0.02
"""Default distance from the robot up to which points of a scan belong to it [m]."""


MOST_CLEARANCE = 1.0
"""Largest clearance that an obstacle or a world can have [m]."""
_ROW = Struct("17d")
_NUMBERS = {kind: number for number, kind in enumerate(PRIMITIVES)}
_LESS = {"box": (2.0, 2.0, 2.0), "sphere": (1.0,), "cylinder": (1.0, 2.0), "capsule": (1.0,)}
"""Kind -> how many times a distance its dimensions lose where its surface is moved inwards by that."""


@dataclass(frozen=True)
class Seen:
    """Configuration of a robot when a cloud was recorded, as :func:`evenroad.robot.configuration` takes it, and a
    margin [m].

    Balls of the cloud within the margin of its bodies belong to the robot; :func:`evenroad.robot.without_robot` removes
    them.
    """

    at: str
    margin: float = MARGIN

    def __post_init__(self) -> None:
        require_positive("the margin of a scan", self.margin, or_zero=True)


@dataclass(frozen=True)
class Cut:
    """An attached object that is removed from a cloud, since the camera saw it where it is grasped.

    Balls of the cloud whose centres come within `grow` [m], >= 0, of the `attached` object of that name are removed,
    with the robot standing `at`, as :func:`evenroad.robot.configuration` takes it.
    """

    attached: str
    at: str
    grow: float = MARGIN

    def __post_init__(self) -> None:
        require_positive("by how much a cut grows", self.grow, or_zero=True)


@explains_calls
@dataclass(frozen=True, repr=False)
class Obstacle:
    """A body that does not move, by a name that is unique in its scene.

    `body` is a box, sphere, cylinder, capsule, mesh, or cloud of radius > 0, with its pose in the frame of the robot's
    root link; others, and what is fixed to a link, are refused (InvalidValue).  `cell` says whether it is part of the
    fixed cell, the same for every task of this installation; `seen`, where the robot stands that is in a cloud itself;
    `cuts`, what else is taken out of the cloud.  Robots keep `clearance` away from it, 0 to 1 [m], beside the clearance
    of their world.
    """

    name: str
    body: Shape
    cell: bool = False
    seen: Seen | None = None
    cuts: tuple[Cut, ...] = ()
    clearance: float = 0.0
    row: bytes = field(init=False, repr=False, compare=False)
    """Seventeen doubles for native code, see ``kernel/native_scene.py``; none for clouds and meshes."""

    def __post_init__(self) -> None:
        body = along_z(self.body) if isinstance(self.body, Capsule) else self.body
        kinds = (*PRIMITIVES, PointCloud.kind, Mesh.kind)
        if getattr(body, "kind", None) not in kinds:
            raise InvalidValue(f"obstacle {self.name!r} must be one of {', '.join(kinds)}, got a {body}")
        if isinstance(body, Mesh):
            # Read now: a file may change, or be gone, before its triangles are used.
            body = replace(body, source=body.triangles, scale=(1.0, 1.0, 1.0))
        if body.link:
            raise InvalidValue(f"obstacle {self.name!r} must be fixed to the world, not to a link, got {body.link!r}")
        if self.clearance != 0.0:
            of = f"clearance of obstacle {self.name!r}"
            set_fields(self, clearance=require_positive(of, self.clearance, or_zero=True, at_most=MOST_CLEARANCE))
        # Now rather than for every world: an obstacle is in many scenes.
        size, row = (*body.size, 0.0, 0.0)[:3], b""
        if body.kind in PRIMITIVES:
            row = _ROW.pack(_NUMBERS[body.kind], *size, *body.pose.rotation, *body.pose.xyz, self.clearance)
        set_fields(self, body=body, row=row)

    @classmethod
    def of(
        cls,
        name: str,
        kind: str,
        size: Sequence[float],
        xyz: Sequence[float] = (0.0, 0.0, 0.0),
        rotation: Sequence[float] = NO_ROTATION,
        cell: bool = False,
    ) -> Obstacle:
        """Return an obstacle by its dimensions (:func:`evenroad.geometry.shape_of`), origin [m] and rotation (9,).

        Raises UnknownName if there is no such shape; InvalidValue, which names the obstacle, if a dimension is not a
        finite number > 0, or the rotation is none.
        """
        try:
            return cls(name, shape_of(kind, size, Pose(xyz, rotation)), cell)
        except InvalidValue as error:
            raise InvalidValue(f"obstacle {name!r}: {error}") from None

    def __repr__(self) -> str:
        return f"Obstacle({self.name!r}, {self.body!r})"

    def at(self, pose: Pose) -> Obstacle:
        """Return the obstacle in another pose."""
        if not self.row:
            return replace(self, body=replace(self.body, pose=pose))
        # Nothing else changes, so nothing is looked at again.
        body, moved = object.__new__(type(self.body)), object.__new__(Obstacle)
        numbers = (*_ROW.unpack(self.row)[:4], *pose.rotation, *pose.xyz, self.clearance)
        set_fields(body, **{**vars(self.body), "pose": pose})
        set_fields(moved, **{**vars(self), "body": body, "row": _ROW.pack(*numbers)})
        return moved

    @property
    def shape(self) -> str:
        """Kind of its body: ``box``, ``sphere``, ``cylinder``, ``capsule``, ``cloud`` or ``mesh``."""
        return self.body.kind

    @property
    def size(self) -> tuple[float, ...]:
        """Dimensions of its body, as :func:`evenroad.geometry.shape_of` takes them [m]."""
        return self.body.size

    @property
    def xyz(self) -> Vector:
        """Its middle in the frame of the robot's root link [m]."""
        return self.body.pose.xyz

    @property
    def rotation(self) -> tuple[float, ...]:
        """From the body's frame to that of the robot's root link, (9,) row by row."""
        return self.body.pose.rotation


_BODIES = (Shape, Obstacle)
Bodies: TypeAlias = "Sequence[Obstacle | Shape]"


def as_obstacles(bodies: object, taken: Callable[[str], bool], scene: str) -> tuple[Obstacle, ...]:
    """Return shapes and obstacles as obstacles; a shape without a name gets one that is new and not `taken`."""
    listed = as_bodies(bodies, scene)
    names = names_of(listed, taken)
    return tuple(
        [each if isinstance(each, Obstacle) else Obstacle(name, each) for name, each in zip(names, listed, strict=True)]
    )


def as_bodies(bodies: object, scene: str) -> tuple[Obstacle | Shape, ...]:
    """Return shapes and obstacles as a tuple; InvalidValue if one is neither."""
    if isinstance(bodies, Shape | Obstacle):
        bodies = [bodies]
    if isinstance(bodies, str) or not isinstance(bodies, Iterable):
        hint = "a scene is read from its file by load_scene, and its name is name=..."
        raise InvalidValue(f"obstacles of scene {scene!r} must be a list of shapes, got {shown(bodies)}; {hint}")
    listed = tuple(bodies)
    for each in listed:
        if not isinstance(each, _BODIES):
            raise InvalidValue(
                f"obstacles of scene {scene!r} must be shapes, as er.Box((x, y, z), xyz=...), got {shown(each)}"
            )
    return listed


def names_of(bodies: Sequence[Obstacle | Shape], taken: Callable[[str], bool] = lambda name: False) -> tuple[str, ...]:
    """Return the names of bodies; a shape without a name gets one that is new and not `taken`."""
    names = [each.name for each in bodies]
    if all(names):
        return tuple(names)
    own = set(names)
    for i, each in enumerate(bodies):
        if not names[i] and isinstance(each, Shape):
            free = (text for k in count() if (text := f"{each.kind} {k}") not in own and not taken(text))
            names[i] = next(free)
            own.add(names[i])
    return tuple(names)


def box_rows(size: npt.ArrayLike, xyz: npt.ArrayLike, xyzw: npt.ArrayLike | None) -> Floats:
    """Return the rows of boxes of these full extents, centres and quaternions, (n, 17); see :attr:`Scene.rows`.

    Raises InvalidValue for arrays of other shapes, or with entries that are not allowed.
    """
    if (made := native.box_rows(size, xyz, xyzw)) is not None:
        return made
    # Arrays of another kind, or boxes that are none: which, is said here.
    extents, centres = as_batch("size", size, 3), as_batch("xyz", xyz, 3)
    if len(extents) != len(centres):
        raise InvalidValue(f"size and xyz must have one row a box, got {len(extents)} and {len(centres)}")
    if len(extents) and not (extents.min() > 0.0 and extents.max() <= FARTHEST):
        raise InvalidValue(f"size must be > 0 and at most {FARTHEST:g}, got from {extents.min()} to {extents.max()}")
    if len(extents) and not np.abs(centres).max() <= FARTHEST:
        raise InvalidValue(
            f"xyz must lie between -{FARTHEST:g} and {FARTHEST:g}, got {centres.flat[np.abs(centres).argmax()]}"
        )
    turns = None
    if xyzw is not None:
        turns = as_batch("xyzw", xyzw, 4)
        largest = np.abs(turns).max(axis=1, keepdims=True, initial=0.0)
        if len(turns) != len(extents) or not largest.all():
            raise InvalidValue(f"xyzw must be one quaternion a box, of a norm > 0, got {shown(xyzw)}")
        # The squares of large or small numbers would leave the range.
        turns = turns / largest
    made = native.box_rows(extents, centres, turns)
    assert made is not None  # as all that it refuses is refused above
    return made


def smaller_rows(rows: Floats, by: float) -> tuple[Floats, Bools]:
    """Return the rows of obstacles, (n, 17), that reach less far by a distance [m], and of which anything is left.

    A ball of that radius about any point of them lies in the obstacle as it was.
    """
    kinds, less = rows[:, 0].astype(int), np.zeros((len(PRIMITIVES), 3))
    for kind, of in _LESS.items():
        less[_NUMBERS[kind], : len(of)] = of
    small = rows.copy()
    small[:, 1:4] -= by * less[kinds]
    left = ((small[:, 1:4] > 0.0) | (less[kinds] == 0.0)).all(axis=1)
    return small[left], left


def obstacles_of_rows(rows: Floats, names: Sequence[str]) -> tuple[Obstacle, ...]:
    """Return the boxes, spheres, cylinders and capsules of rows, (n, 17), as obstacles of these names."""
    kinds = tuple(PRIMITIVES)
    counts = [sum(count for _, count in PRIMITIVES[kind].dimensions) for kind in kinds]
    return tuple(
        Obstacle.of(name, kinds[int(row[0])], row[1 : 1 + counts[int(row[0])]], row[13:16], row[4:13])
        for name, row in zip(names, rows.tolist(), strict=True)
    )
