"""What a scene is changed by: each verb returns another scene, which shares what stays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

from evenroad._call import explains_calls
from evenroad._checks import require_known
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import Shape
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
        return self._changed(moved_from=(base, {**before, **changed}), names=self.names, numbers=numbers)

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
        added = as_obstacles(more, self.obstacles, self.name)
        changed: Any = self
        return replace(changed, obstacles=(*self.obstacles, *added), allowed=self.allowed.union(allowed))

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
            require_known(f"obstacle of scene {self.name!r}:", name, self.names)
        scene: Any = self
        return replace(
            scene,
            obstacles=tuple(obstacle for obstacle in self.obstacles if obstacle.name not in names),
            allowed=frozenset((link, name) for link, name in self.allowed if name not in names),
            near_ends=frozenset(each for each in self.near_ends if each[1] not in names),
        )
