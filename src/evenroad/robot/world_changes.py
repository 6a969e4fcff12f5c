"""How the scene of an arm's world is changed: what native checks know of the obstacles that stay is shared."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from evenroad._arrays import Floats
from evenroad._call import explains_calls
from evenroad._native.robot import Scene as NativeScene
from evenroad.geometry.pose import Pose
from evenroad.robot.changes import Changes
from evenroad.robot.kernel.robot_tables import RobotTables
from evenroad.robot.obstacles import rows_of
from evenroad.robot.prepared_robots import prepared
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Scene

_STAYS = ("robot", "resolution", "clearance", "_space", "bounds", "robot_tables")

FEW, MOST = 128, 128
"""Scenes of fewer obstacles are made anew, and others after this number of changes: checks look at each changed one."""


@explains_calls
class WorldChanges(Changes):
    """How the scene of a world is changed; see :class:`evenroad.ArmWorld`."""

    if TYPE_CHECKING:
        scene: Scene
        robot: Robot
        clearance: float
        robot_tables: RobotTables
        native_scene: NativeScene

    _last = 0
    """How many obstacles have come later since the scene was made for native checks."""

    def _moved(self, poses: Mapping[str, Pose]) -> Self:
        return self._changed(self.scene._moved(poses), poses, poses)

    def _with(self, obstacles: Sequence[object], allowed: Sequence[tuple[str, str]]) -> Self:
        added = self.scene._named_new(obstacles)
        scene = self.scene._with(added, allowed)
        if allowed or scene.surfaces:
            return self.within(scene)
        return self._changed(scene, (), [each.name for each in added], rows_of(added))

    def _without(self, names: Sequence[str]) -> Self:
        return self._changed(self.scene._without(names), names, ())

    def within(self, scene: Scene) -> Self:
        """Return the same world with the obstacles of another scene.

        Parameters
        ----------
        scene : Scene
            Its ranges of joints are not looked at.

        Returns
        -------
        ArmWorld

        Raises
        ------
        UnknownName, InvalidValue
            If the scene does not fit the robot.

        Examples
        --------
        >>> import evenroad as er
        >>> er.ArmWorld("ur5", "box-reach").within(er.Scene()).scene.names
        ()
        """
        world: Any = object.__new__(type(self))
        world.__dict__.update({name: self.__dict__[name] for name in _STAYS}, scene=scene)
        _ = world.native_scene  # at once: it refuses obstacles that are too far
        return world

    def _number_name(self, number: int) -> str:
        """Return the name of an obstacle, no cloud and no mesh, by its number for native checks."""
        names, later = self._numbered
        return names[number] if number < len(names) else next(name for name, at in later.items() if at == number)

    @cached_property
    def _numbered(self) -> tuple[tuple[str, ...], Mapping[str, int]]:
        """The names of obstacles by their numbers for native checks, and the numbers of those that came later."""
        return self.scene.solid_names, {}

    @cached_property
    def _numbers(self) -> Mapping[str, int]:
        """The number of each obstacle for native checks, by name, but of those that came later."""
        return {name: number for number, name in enumerate(self._numbered[0])}

    def _changed(self, scene: Scene, gone: Collection[str], come: Collection[str], rows: Floats | None = None) -> Self:
        """Return the same world with a scene in which some obstacles are gone and others have come, of these rows."""
        before, (names, later), numbers = self.native_scene, self._numbered, self._numbers
        if len(names) < FEW or self.scene.surfaces or scene.surfaces or before.changes + len(come) > MOST:
            return self.within(scene)
        left = [later[name] if name in later else numbers[name] for name in gone]
        if gone:
            later = {name: number for name, number in later.items() if name not in gone or name in come}
        at: list[int] = []
        fresh: dict[str, int] = {}
        for name in come:
            number = later.get(name, numbers.get(name, -1)) if gone else -1
            if number < 0:
                number = fresh[name] = len(names) + self._last + len(fresh)
            at.append(number)
        tested = np.ones((len(self.robot_tables.capsules), len(come)), dtype=np.bool_)
        for link, name in scene.allowed:
            if name in come:
                bodies = [capsule.link == link for capsule in self.robot_tables.capsules]
                tested[bodies, list(come).index(name)] = False
        rows = scene.table.rows_named(list(come)) if rows is None else rows
        native = before.changed(
            prepared(self.robot).native, np.array(left, np.int64), rows, np.array(at, np.int64), tested, self.clearance
        )
        if native is None or native.too_far >= 0:
            return self.within(scene)
        since, changed = self.__dict__.get("_since", (self, {}))
        world: Any = object.__new__(type(self))
        values = world.__dict__
        for name in _STAYS:
            values[name] = self.__dict__[name]
        values["scene"], values["native_scene"] = scene, native
        values["_numbered"], values["_numbers"] = (names, {**later, **fresh}), numbers
        values["_last"] = self._last + len(fresh)
        values["_since"] = since, {**changed, **dict.fromkeys(gone), **dict.fromkeys(come)}
        return world

    def _after_changes(self, made: Callable[[Self], Self]) -> Self | None:
        """Return what is made of this world by what is made of the one that it was changed from, or None."""
        if "_since" not in self.__dict__:
            return None
        since, changed = self.__dict__["_since"]
        gone = [name for name in changed if since.scene.table.has(name)]
        return made(since)._changed(self.scene, gone, [name for name in changed if self.scene.table.has(name)])
