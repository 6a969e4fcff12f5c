"""How a scene is changed: what comes of it is remembered as few changes of its base."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self, cast

from evenroad._call import explains_calls
from evenroad._checks import require_known
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Pose
from evenroad.robot.changes import Changes
from evenroad.robot.held import HeldObject
from evenroad.robot.obstacle import Obstacle, as_obstacles
from evenroad.robot.scene_delta import MOST, Delta

_DERIVED = ("obstacles", "delta", "rows", "names", "numbers", "surfaces")
"""A scene's obstacles, and what it makes of them."""


@explains_calls
class SceneChanges(Changes):
    """How a scene is changed; see :class:`evenroad.Scene`."""

    if TYPE_CHECKING:
        name: str
        obstacles: tuple[Obstacle, ...]
        allowed: frozenset[tuple[str, str]]
        near_ends: frozenset[tuple[str, str, float]]
        attached: tuple[HeldObject, ...]
        delta: Delta

        def _require_names(self) -> None: ...

        @property
        def names(self) -> tuple[str, ...]: ...  # noqa: D102

        @property
        def surfaces(self) -> tuple[tuple[int, Obstacle], ...]: ...  # noqa: D102

    @cached_property
    def numbers(self) -> Mapping[str, int]:
        """The number of each obstacle, by name."""
        return {name: number for number, name in enumerate(self.names)}

    def _moved(self, poses: Mapping[str, Pose]) -> Self:
        delta = self._delta_of()
        taken = self.numbers if delta is None else delta
        for name, pose in poses.items():
            if name not in taken:
                require_known(f"obstacle of scene {self.name!r}:", name, self.names)
            if not isinstance(pose, Pose):
                raise InvalidValue(f"the pose of obstacle {name!r} must be a Pose, got {shown(pose)}")
        if delta is not None:
            return self._changed(delta=delta.moving(poses), surfaces=())
        moved = [each.at(poses[each.name]) if each.name in poses else each for each in self.obstacles]
        return self._changed(obstacles=tuple(moved))

    def _delta_of(self) -> Delta | None:
        """Return by what the scene differs from its base, or None where it has clouds or meshes."""
        delta: Delta | None = self.__dict__.get("delta")
        if delta is not None and len(delta) > MOST:
            # It has all lists now, and does without the scene that it was changed from.
            _ = self.obstacles, self.names, self.rows  # type: ignore[attr-defined]
            self.__dict__.pop("delta", None)
            delta = None
        if delta is None and not self.surfaces:
            return Delta(self)
        return delta

    def _changed(self, **parts: Any) -> Self:
        """Return a scene with other parts that fit each other."""
        scene: Any = object.__new__(type(self))
        values = scene.__dict__
        values.update(self.__dict__)
        for name in _DERIVED:
            values.pop(name, None)
        values.update(parts)
        return scene

    def _with(self, obstacles: Sequence[object], allowed: Sequence[tuple[str, str]]) -> Self:
        return self._with_these(obstacles, allowed)[0]

    def _with_these(
        self, obstacles: Sequence[object], allowed: Sequence[tuple[str, str]]
    ) -> tuple[Self, list[Obstacle]]:
        """Return the scene with more obstacles, and these."""
        more: list[object] = []
        for each in obstacles:
            more += each if isinstance(each, list | tuple) else [each]
        delta = self._delta_of()
        taken = self.numbers if delta is None else delta
        added = as_obstacles(more, taken, self.name)
        may_touch = self.allowed.union(allowed)
        if delta is not None and all(each.row for each in added):
            scene = self._changed(delta=delta.adding(added), allowed=may_touch, surfaces=())
        else:
            scene = self._changed(obstacles=(*self.obstacles, *added), allowed=may_touch)
        names = {each.name for each in added}
        if len(names) < len(added) or self.attached or any(name in taken for name in names):
            # Those that are here twice are named.
            replace(cast("Any", self), obstacles=(*self.obstacles, *added))
        return scene, list(added)

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

    def _without(self, names: Sequence[str]) -> Self:
        delta = self._delta_of()
        taken = self.numbers if delta is None else delta
        for name in names:
            if name not in taken:
                require_known(f"obstacle of scene {self.name!r}:", name, self.names)
        left: dict[str, Any] = {
            "allowed": frozenset(each for each in self.allowed if each[1] not in names),
            "near_ends": frozenset(each for each in self.near_ends if each[1] not in names),
        }
        if delta is not None:
            return self._changed(delta=delta.removing(names), surfaces=(), **left)
        return self._changed(obstacles=tuple(each for each in self.obstacles if each.name not in names), **left)
