"""Obstacles of a scene, as a sequence that never changes; the cost of changes follows their number.

It has three sources: obstacles, rows, or changes of another sequence.  The other forms are made on first use.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import TypeVar, cast, overload

import numpy as np

from evenroad._arrays import Floats
from evenroad._native import robot as native
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import PRIMITIVES, Shape
from evenroad.scenes.obstacle import Obstacle, as_bodies, as_obstacles, names_of, obstacles_of_rows

MOST = 128
"""Number of changes from which on a sequence no longer refers to the one that it was changed from."""

Each = TypeVar("Each")


class Obstacles(Sequence[Obstacle]):
    """Obstacles by their names; two are equal if they have equal obstacles in one order."""

    def __init__(self, objects: Iterable[Obstacle]) -> None:
        self._objects = tuple(objects)

    @property
    def objects(self) -> tuple[Obstacle, ...]:
        """The obstacles themselves."""
        return self._objects

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the obstacles."""
        return tuple([each.name for each in self.objects])

    @cached_property
    def numbers(self) -> Mapping[str, int]:
        """The number of each obstacle, by name."""
        return {name: number for number, name in enumerate(self.names)}

    @cached_property
    def rows(self) -> Floats:
        """The obstacles but clouds and meshes, (n, 17), as the native kernel takes them; see :attr:`Scene.rows`."""
        return rows_of(self.objects)

    @cached_property
    def surfaces(self) -> tuple[tuple[int, Obstacle], ...]:
        """The clouds and meshes among them, with their numbers."""
        if len(self.rows) == len(self.names):
            return ()
        return tuple((number, each) for number, each in enumerate(self.objects) if not each.row)

    def has(self, name: str) -> bool:
        """Return whether one of them has this name."""
        return name in self.numbers

    def rows_named(self, names: Sequence[str]) -> Floats:
        """Return the rows of some obstacles, none of them a cloud or a mesh, (n, 17)."""
        return self.rows[[self.numbers[name] for name in names]]

    def moving(self, poses: Mapping[str, Pose]) -> Obstacles:
        """Return the same with some obstacles, which there are, in other poses."""
        if self.surfaces:
            return Obstacles(each.at(poses[each.name]) if each.name in poses else each for each in self.objects)
        return self._changes.moving(poses)

    def adding(self, more: Sequence[Obstacle]) -> Obstacles:
        """Return the same with more obstacles, of new names."""
        if self.surfaces or not all(each.row for each in more):
            return Obstacles((*self.objects, *more))
        return self._changes.adding(more)

    def removing(self, names: Sequence[str]) -> Obstacles:
        """Return the same without some obstacles, which there are."""
        if self.surfaces:
            return Obstacles(each for each in self.objects if each.name not in names)
        return self._changes.removing(names)

    @property
    def _changes(self) -> Changed:
        """These as no change of themselves."""
        return Changed(self)

    def __len__(self) -> int:
        return len(self.names)

    def __iter__(self) -> Iterator[Obstacle]:
        return iter(self.objects)

    @overload
    def __getitem__(self, which: int) -> Obstacle: ...
    @overload
    def __getitem__(self, which: slice) -> Sequence[Obstacle]: ...
    def __getitem__(self, which: int | slice) -> Obstacle | Sequence[Obstacle]:
        return self.objects[which]

    def __eq__(self, other: object) -> bool:
        return self is other or (isinstance(other, Obstacles | tuple) and tuple(self) == tuple(other))

    def __hash__(self) -> int:
        return hash(self.objects)

    def __repr__(self) -> str:
        return repr(self.objects)


class Rows(Obstacles):
    """Boxes, spheres, cylinders and capsules of rows, (n, 17), by their names."""

    def __init__(self, rows: Floats, names: tuple[str, ...]) -> None:
        rows.setflags(write=False)
        self.rows, self.names = rows, names

    @cached_property
    def objects(self) -> tuple[Obstacle, ...]:
        """The obstacles themselves, made when somebody looks."""
        return obstacles_of_rows(self.rows, self.names)

    @property
    def surfaces(self) -> tuple[tuple[int, Obstacle], ...]:
        """Nothing."""
        return ()


class ShapeRows(Rows):
    """Boxes, spheres, cylinders and capsules by their names, whose rows are read from shapes."""

    def __init__(self, rows: Floats, names: tuple[str, ...], shapes: Sequence[Shape]) -> None:
        super().__init__(rows, names)
        self._shapes = shapes

    @cached_property
    def objects(self) -> tuple[Obstacle, ...]:
        """The obstacles themselves, made when somebody looks."""
        return tuple([Obstacle(name, shape) for name, shape in zip(self.names, self._shapes, strict=True)])


class EntryRows(Rows):
    """Obstacles that a file or a mapping describes one by one."""


class Changed(Obstacles):
    """Changes of obstacles without clouds and meshes: some were moved or removed, and others came after them."""

    def __init__(
        self,
        base: Obstacles,
        moved: Mapping[str, Pose] | None = None,
        gone: frozenset[str] = frozenset(),
        more: Mapping[str, Obstacle] | None = None,
    ) -> None:
        self._base, self._moved, self._gone, self._more = base, moved or {}, gone, more or {}

    @cached_property
    def objects(self) -> tuple[Obstacle, ...]:
        """All obstacles."""
        objects = list(self._base.objects)
        for name, pose in self._moved.items():
            number = self._base.numbers[name]
            objects[number] = objects[number].at(pose)
        return (*self._left(objects), *self._more.values())

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of all obstacles."""
        return (*self._left(self._base.names), *self._more)

    @cached_property
    def rows(self) -> Floats:
        """The rows of all obstacles, (n, 17)."""
        rows = self._base.rows.copy()
        if self._moved:
            at = [self._base.numbers[name] for name in self._moved]
            rows[at, 4:16] = [(*pose.rotation, *pose.xyz) for pose in self._moved.values()]
        if self._gone:
            rows = np.delete(rows, [self._base.numbers[name] for name in self._gone], axis=0)
        return np.concatenate([rows, rows_of(self._more.values())]) if self._more else rows

    @property
    def surfaces(self) -> tuple[tuple[int, Obstacle], ...]:
        """Nothing."""
        return ()

    def has(self, name: str) -> bool:
        """Return whether one of them has this name."""
        return name in self._more or (name in self._base.numbers and name not in self._gone)

    def rows_named(self, names: Sequence[str]) -> Floats:
        """Return the rows of some obstacles, (n, 17)."""
        base, more = self._base, self._more
        rows = np.array([(0.0,) * 17 if name in more else base.rows[base.numbers[name]] for name in names])
        rows = rows.reshape(-1, 17)
        for row, name in zip(rows, names, strict=True):
            if name in more:
                row[:] = np.frombuffer(more[name].row)
            elif name in self._moved:
                row[4:16] = (*self._moved[name].rotation, *self._moved[name].xyz)
        return rows

    @property
    def _changes(self) -> Changed:
        if len(self._moved) + len(self._gone) + len(self._more) <= MOST:
            return self
        return Changed(self._alone)

    @cached_property
    def _alone(self) -> Obstacles:
        """These without reference to those that they were changed from, whose memory can then be freed."""
        alone = Obstacles(self.objects)
        alone.names, alone.rows = self.names, self.rows
        return alone

    def moving(self, poses: Mapping[str, Pose]) -> Changed:
        """Return the same with some obstacles, which there are, in other poses."""
        of = self._changes
        if not of._more:
            return Changed(of._base, {**of._moved, **poses}, of._gone)
        more = {name: each.at(poses[name]) if name in poses else each for name, each in of._more.items()}
        here = {name: pose for name, pose in poses.items() if name not in more}
        return Changed(of._base, {**of._moved, **here}, of._gone, more)

    def adding(self, more: Sequence[Obstacle]) -> Obstacles:
        """Return the same with more obstacles, of new names."""
        if not all(each.row for each in more):
            return Obstacles((*self.objects, *more))
        of = self._changes
        return Changed(of._base, of._moved, of._gone, {**of._more, **{each.name: each for each in more}})

    def removing(self, names: Iterable[str]) -> Changed:
        """Return the same without some obstacles, which there are."""
        of = self._changes
        left, gone = set(names), of._gone
        more = {name: each for name, each in of._more.items() if name not in left}
        if len(of._more) - len(more) < len(left):
            gone = gone.union(left.difference(of._more))
        return Changed(of._base, {n: pose for n, pose in of._moved.items() if n not in left}, gone, more)

    def _left(self, of_base: Sequence[Each]) -> list[Each]:
        """Return what is left of a list of the base's obstacles."""
        if not self._gone:
            return list(of_base)
        gone = {self._base.numbers[name] for name in self._gone}
        return [each for number, each in enumerate(of_base) if number not in gone]


def obstacles_of(bodies: object, scene: str) -> Obstacles:
    """Return the obstacles that shapes and obstacles are; InvalidValue, which names the scene, if one is neither."""
    listed = as_bodies(bodies, scene)
    if listed and (rows := native.shape_rows(listed, _SHAPES)) is not None:
        # Only shapes have rows here: obstacles have their own.
        return ShapeRows(rows, names_of(listed), cast("tuple[Shape, ...]", listed))
    return Obstacles(as_obstacles(listed, lambda name: False, scene))


_SHAPES = tuple(PRIMITIVES.values())


def rows_of(obstacles: Iterable[Obstacle]) -> Floats:
    """Return the rows of obstacles, (n, 17); clouds and meshes have none."""
    return np.frombuffer(b"".join([each.row for each in obstacles])).reshape(-1, 17)


def named_twice(names: Sequence[str]) -> list[str]:
    """Return the names that stand twice in a list, in alphabetical order."""
    return sorted({name for name in names if names.count(name) > 1}) if len(set(names)) < len(names) else []
