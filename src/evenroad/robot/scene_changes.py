"""What a scene is changed by: each verb returns another scene, which shares what stays."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from evenroad._arrays import Floats
from evenroad._call import explains_calls
from evenroad._checks import require_known
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import Shape
from evenroad.robot.held import HeldObject
from evenroad.robot.obstacle import Bodies, Obstacle, as_obstacles

_DERIVED = ("obstacles", "moved_from", "rows", "names", "numbers", "surfaces")
"""A scene's obstacles, and what it makes of them."""


@explains_calls
class SceneChanges:
    """The verbs that change a scene; see :class:`evenroad.Scene`."""

    if TYPE_CHECKING:
        name: str
        obstacles: tuple[Obstacle, ...]
        allowed: frozenset[tuple[str, str]]
        near_ends: frozenset[tuple[str, str, float]]
        attached: tuple[HeldObject, ...]
        moved_from: tuple[Any, dict[int, Pose]]

        def _require_names(self) -> None: ...

        @property
        def names(self) -> tuple[str, ...]: ...  # noqa: D102

    @cached_property
    def numbers(self) -> Mapping[str, int]:
        """The number of each obstacle, by name."""
        return {name: number for number, name in enumerate(self.names)}

    def moved(self, poses: Mapping[str, Pose]) -> Self:
        """Return the scene with obstacles in other poses, in some microseconds each.

        Parameters
        ----------
        poses : mapping of str to Pose
            Obstacle -> its pose in the frame of the robot's root link; of a capsule with its axis along z.

        Returns
        -------
        Scene

        Raises
        ------
        UnknownName
            If there is no such obstacle.
        InvalidValue
            If something is no pose.

        Examples
        --------
        >>> import evenroad as er
        >>> er.Scene([er.Sphere(0.1, name="ball")]).moved({"ball": er.Pose((0.5, 0, 0.2))}).obstacles[0].xyz
        (0.5, 0.0, 0.2)
        """
        if not isinstance(poses, Mapping):
            raise InvalidValue(f"poses must be a mapping, obstacle -> Pose, got {shown(poses)}")
        numbers, changed = self.numbers, {}
        for name, pose in poses.items():
            number = numbers.get(name, -1)
            if number < 0:
                require_known(f"obstacle of scene {self.name!r}:", name, self.names)
            if not isinstance(pose, Pose):
                raise InvalidValue(f"the pose of obstacle {name!r} must be a Pose, got {shown(pose)}")
            changed[number] = pose
        base, before = self.__dict__.get("moved_from", (self, {}))
        # Obstacles are made when they are first used.
        return self._changed(
            moved_from=(base, {**before, **changed}), names=self.names, numbers=numbers, **_solid(base)
        )

    def _changed(self, **parts: Any) -> Self:
        """Return a scene with other parts that fit each other."""
        scene: Any = object.__new__(type(self))
        made = {name: part for name, part in self.__dict__.items() if name not in _DERIVED}
        scene.__dict__.update(made, **parts)
        return scene

    def with_(self, *obstacles: Obstacle | Shape | Bodies, allowed: Sequence[tuple[str, str]] = ()) -> Self:
        """Return the scene with more obstacles, and more contacts left untested.

        Parameters
        ----------
        *obstacles : Shape, Obstacle, or sequence of such
            Of new names.
        allowed : sequence of (str, str)
            Contacts that are not tested, (link, obstacle).

        Returns
        -------
        Scene

        Raises
        ------
        InvalidValue
            As :class:`Scene`.

        Examples
        --------
        >>> import evenroad as er
        >>> er.load_scene("box-reach").with_(er.Sphere(0.05, xyz=(0.3, 0.3, 0.3), name="ball")).obstacles[-1].name
        'ball'
        """
        more: list[object] = []
        for each in obstacles:
            more += each if isinstance(each, list | tuple) else [each]
        added = as_obstacles(more, self.numbers, self.name)
        names = [each.name for each in added]
        scene = self._changed(
            obstacles=(*self.obstacles, *added),
            names=(*self.names, *names),
            allowed=self.allowed.union(allowed),
            **(_solid(self) if all(each.row for each in added) else {}),
        )
        if len(set(names)) < len(names) or not self.numbers.keys().isdisjoint(names) or self.attached:
            scene._require_names()
        return scene

    def with_clearance(self, clearance: Mapping[str, float]) -> Self:
        """Return the scene with obstacles from which robots keep more away.

        Parameters
        ----------
        clearance : mapping of str to float
            Obstacle -> distance to keep, 0 to 1 [m], beside the clearance of a world and the padding of links.

        Returns
        -------
        Scene

        Raises
        ------
        UnknownName
            If there is no such obstacle.
        InvalidValue
            If a distance is not such a number.

        Examples
        --------
        >>> import evenroad as er
        >>> scene = er.load_scene("box-reach").with_clearance({"box top": 0.01})
        >>> scene.obstacles[scene.names.index("box top")].clearance
        0.01
        """
        if not isinstance(clearance, Mapping):
            raise InvalidValue(f"clearance must be a mapping, obstacle -> metres, got {shown(clearance)}")
        for name in clearance:
            require_known(f"obstacle of scene {self.name!r}:", name, self.names)
        changed = (replace(each, clearance=clearance.get(each.name, each.clearance)) for each in self.obstacles)
        scene: Any = self
        return replace(scene, obstacles=tuple(changed))

    def without(self, *names: str) -> Self:
        """Return the scene without some obstacles, and without what was allowed to touch them.

        Parameters
        ----------
        *names : str
            Of the obstacles.

        Returns
        -------
        Scene

        Raises
        ------
        UnknownName
            If there is no such obstacle.

        Examples
        --------
        >>> import evenroad as er
        >>> er.Scene([er.Sphere(0.1, name="ball"), er.Sphere(0.2, name="moon")]).without("moon")
        Scene('scene', 1 obstacle: ball)
        """
        for name in names:
            if name not in self.numbers:
                require_known(f"obstacle of scene {self.name!r}:", name, self.names)
        left = sorted(self.numbers[name] for name in set(names))
        obstacles: list[Obstacle] = []
        others: list[str] = []
        for first, end in pairwise([-1, *left, len(self.names)]):
            obstacles += self.obstacles[first + 1 : end]
            others += self.names[first + 1 : end]
        return self._changed(
            obstacles=tuple(obstacles),
            names=tuple(others),
            allowed=frozenset((link, name) for link, name in self.allowed if name not in names),
            near_ends=frozenset(each for each in self.near_ends if each[1] not in names),
            **_solid(self),
        )

    def _rows_of(self, names: Collection[str]) -> Floats:
        """Return the rows, see `Scene.rows`, of some obstacles, neither clouds nor meshes: (n, 17)."""
        numbers = [self.numbers[name] for name in names] if len(names) else []
        if "moved_from" not in self.__dict__:
            return np.frombuffer(b"".join([self.obstacles[number].row for number in numbers])).reshape(-1, 17)
        base, poses = self.moved_from
        rows = base.rows[numbers]
        for row, number in zip(rows, numbers, strict=True):
            if (pose := poses.get(number)) is not None:
                row[4:16] = (*pose.rotation, *pose.xyz)
        return rows


def _solid(scene: Any) -> dict[str, Any]:
    """Return, as a part of other scenes, that a scene has neither clouds nor meshes, where that is so."""
    return {} if scene.surfaces else {"surfaces": ()}
