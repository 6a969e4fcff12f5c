"""NumberedScene: a native scene with the number of each obstacle, so that the cost of changes follows their number."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

import numpy as np

from evenroad._native.robot import Robot as NativeRobot
from evenroad._native.robot import Scene as NativeScene
from evenroad.collision.robot_tables import RobotTables
from evenroad.scenes.obstacles import Obstacles
from evenroad.scenes.scene import Scene

FEW, MOST = 128, 128
"""`FEW`: scenes of fewer obstacles are made anew.  `MOST`: so are others after this number of changes, since checks
look at each changed obstacle."""


@dataclass(frozen=True, eq=False)
class NumberedScene:
    """A native scene, and the names of its obstacles by their numbers: `solid` were there when it was made.

    `base` are all obstacles of the scene that it was made of.  Those that came `later` have numbers after them;
    `last` of these were given away.
    """

    native: NativeScene
    solid: tuple[str, ...]
    base: Obstacles
    later: Mapping[str, int] = field(default_factory=dict)
    last: int = 0

    def name_of(self, number: int) -> str:
        """Return the name of an obstacle, no cloud and no mesh, by its number."""
        if number < len(self.solid):
            return self.solid[number]
        return next(name for name, at in self.later.items() if at == number)

    def changed(
        self,
        robot: NativeRobot,
        tables: RobotTables,
        scene: Scene,
        gone: Collection[str],
        come: Collection[str],
        clearance: float,
    ) -> NumberedScene | None:
        """Return that of a scene in which some obstacles are gone and others have come; None where it is made anew."""
        if len(self.solid) < FEW or self.base.surfaces or scene.surfaces or self.native.changes + len(come) > MOST:
            return None
        numbers, later, rows = self.base.numbers, self.later, scene.table.rows_named(list(come))
        left = [later[name] if name in later else numbers[name] for name in gone]
        if gone:
            later = {name: number for name, number in later.items() if name not in gone or name in come}
        at: list[int] = []
        fresh: dict[str, int] = {}
        for name in come:
            number = later.get(name, numbers.get(name, -1)) if gone else -1
            if number < 0:
                number = fresh[name] = len(self.solid) + self.last + len(fresh)
            at.append(number)
        tested = np.ones((len(tables.capsules), len(come)), dtype=np.bool_)
        for link, name in scene.allowed:
            if name in come:
                bodies = [capsule.link == link for capsule in tables.capsules]
                tested[bodies, list(come).index(name)] = False
        native = self.native.changed(robot, np.array(left, np.int64), rows, np.array(at, np.int64), tested, clearance)
        if native is None or native.too_far >= 0:
            return None
        return NumberedScene(native, self.solid, self.base, {**later, **fresh}, self.last + len(fresh))
