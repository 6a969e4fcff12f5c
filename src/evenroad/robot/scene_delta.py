"""By what a scene differs from the one that it was changed from: few changes to many obstacles cost as the few."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from evenroad._arrays import Floats
from evenroad.geometry.pose import Pose
from evenroad.robot.obstacle import Obstacle

MOST = 128
"""A scene that differs from its base by more changes becomes a base."""


class Delta:
    """What of a base scene, which has neither clouds nor meshes, was moved or is gone, and what came after it."""

    __slots__ = ("base", "gone", "more", "moved")

    def __init__(
        self,
        base: Any,
        moved: Mapping[str, Pose] | None = None,
        gone: frozenset[str] = frozenset(),
        more: Mapping[str, Obstacle] | None = None,
    ) -> None:
        self.base, self.moved, self.gone, self.more = base, moved or {}, gone, more or {}

    def __len__(self) -> int:
        return len(self.moved) + len(self.gone) + len(self.more)

    def __contains__(self, name: object) -> bool:
        return name in self.more or (name in self.base.numbers and name not in self.gone)

    def moving(self, poses: Mapping[str, Pose]) -> Delta:
        """Return the same with some obstacles, which there are, in other poses."""
        if not self.more:
            return Delta(self.base, {**self.moved, **poses}, self.gone)
        more = {name: each.at(poses[name]) if name in poses else each for name, each in self.more.items()}
        here = {name: pose for name, pose in poses.items() if name not in more}
        return Delta(self.base, {**self.moved, **here}, self.gone, more)

    def adding(self, obstacles: Iterable[Obstacle]) -> Delta:
        """Return the same with more obstacles, of new names."""
        return Delta(self.base, self.moved, self.gone, {**self.more, **{each.name: each for each in obstacles}})

    def removing(self, names: Iterable[str]) -> Delta:
        """Return the same without some obstacles, which there are."""
        left, of_base = set(names), self.gone
        more = {name: each for name, each in self.more.items() if name not in left}
        if len(self.more) - len(more) < len(left):
            of_base = of_base.union(left.difference(self.more))
        return Delta(self.base, {n: pose for n, pose in self.moved.items() if n not in left}, of_base, more)

    def _left(self, of_base: Sequence[Any]) -> list[Any]:
        """Return what is left of a list of the base's obstacles."""
        if not self.gone:
            return list(of_base)
        gone = {self.base.numbers[name] for name in self.gone}
        return [each for number, each in enumerate(of_base) if number not in gone]

    def names(self) -> tuple[str, ...]:
        """Return the names of all obstacles."""
        return (*self._left(self.base.names), *self.more)

    def obstacles(self) -> tuple[Obstacle, ...]:
        """Return all obstacles."""
        obstacles = list(self.base.obstacles)
        for name, pose in self.moved.items():
            number = self.base.numbers[name]
            obstacles[number] = obstacles[number].at(pose)
        return (*self._left(obstacles), *self.more.values())

    def of(self, name: str) -> tuple[Obstacle | None, bool, Pose | None]:
        """Return what an obstacle is, if it came later; whether that of the base is gone; and where else it is."""
        return self.more.get(name), name in self.gone, self.moved.get(name)

    def rows(self, names: Iterable[str] | None = None) -> Floats:
        """Return the rows, see `Scene.rows`, of some obstacles, (n, 17); by default of all."""
        numbers, moved = self.base.numbers, self.moved
        if names is None:
            rows = self.base.rows.copy()
            if moved:
                at = [numbers[name] for name in moved]
                rows[at, 4:16] = [(*pose.rotation, *pose.xyz) for pose in moved.values()]
            if self.gone:
                rows = np.delete(rows, [numbers[name] for name in self.gone], axis=0)
            return np.concatenate([rows, rows_of(self.more.values())]) if self.more else rows
        rows = np.array([(0.0,) * 17 if name in self.more else self.base.rows[numbers[name]] for name in names])
        rows = rows.reshape(-1, 17)
        for row, name in zip(rows, names, strict=True):
            if name in self.more:
                row[:] = np.frombuffer(self.more[name].row)
            elif name in moved:
                row[4:16] = (*moved[name].rotation, *moved[name].xyz)
        return rows


def rows_of(obstacles: Iterable[Obstacle]) -> Floats:
    """Return the rows of obstacles, (n, 17); clouds and meshes have none."""
    return np.frombuffer(b"".join([each.row for each in obstacles])).reshape(-1, 17)


def delta_of(scene: Any) -> Delta:
    """Return by what a scene without clouds and meshes differs from its base, or from itself."""
    delta: Delta | None = scene.__dict__.get("delta")
    return Delta(scene) if delta is None else delta
