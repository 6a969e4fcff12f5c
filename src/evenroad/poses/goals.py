"""Goals of a plan: configurations, and poses of links with all postures that reach them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter as now
from typing import TYPE_CHECKING

import numpy as np

from evenroad._arrays import Floats
from evenroad.geometry.pose import Pose
from evenroad.poses.chain import chain_of, default_tip, frame_pose
from evenroad.poses.pose_goal import PoseGoal, as_pose_goal
from evenroad.robots.robot import ConfigurationLike, Robot

if TYPE_CHECKING:
    from evenroad.poses.inverse_kinematics import Checks, Reached

MANY = 8
"""Number of goal poses from which on those that are hard to reach count only where no other is reached."""

_POSES = (Pose, PoseGoal)


@dataclass(frozen=True, eq=False)
class Goals:
    """The goals of a plan."""

    configurations: Floats
    """Goals, (g, dim); where no pose is reached and there is no other goal, the nearest configuration."""
    names: tuple[str, ...]
    """Text by which the caller named each goal, or nothing."""
    poses: tuple[tuple[PoseGoal, Reached], ...] = ()
    """The poses, and the configurations that reach them."""
    seconds: float = 0.0
    """Time of inverse kinematics [s]."""
    whole: bool = True
    """Whether the world stays the same for postures that were not found; allowed contacts near goals change it."""

    @property
    def unreached(self) -> str:
        """Why no goal can be planned to, or nothing."""
        if (len(self.names) and not self.spent) or not self.poses:
            return ""
        return "; ".join(reached.why for _, reached in self.poses if reached.spent or not self.spent)

    @property
    def spent(self) -> bool:
        """Whether there was no time to look for the postures of some pose."""
        return any(reached.spent for _, reached in self.poses)

    @property
    def in_collision(self) -> bool:
        """Whether some pose is reached, but always in collision."""
        return any(reached.in_collision for _, reached in self.poses)

    def records(self, world: Checks, end: Floats | None) -> list[dict[str, object]]:
        """Return the poses as plain values; `end`, (dim,), is the end of a path, for its deviations from them."""
        return [_record(world, goal, reached, end) for goal, reached in self.poses]


def require_tips(robot: Robot, targets: Sequence[object], tip: str = "", frame: str = "") -> None:
    """Raise what `goals_of` would for a pose of an impossible link or frame: making a world first is expensive."""
    for target in targets:
        if isinstance(target, _POSES):
            goal = as_pose_goal(target, tip, frame)
            chain_of(robot, goal.tip or default_tip(robot))
            frame_pose(robot, goal.frame)


def goals_of(
    world: Checks,
    start: Floats,
    targets: Sequence[Pose | PoseGoal | ConfigurationLike],
    read: Callable[[ConfigurationLike], Floats],
    tip: str = "",
    frame: str = "",
) -> Goals:
    """Return the goals of some targets: poses, with this tip and frame by default, and configurations that `read`
    reads.
    """
    rows: list[Floats] = []
    names: list[str] = []
    poses = []
    began = now()
    given = [target for target in targets if isinstance(target, _POSES)]
    if given and not tip and not all(isinstance(target, PoseGoal) and target.tip for target in given):
        tip = default_tip(world.robot)
    wanted = [as_pose_goal(target, tip, frame) for target in given]
    many = len(wanted) >= MANY
    found: list[Reached] = []
    if wanted:
        # Imported late: a plan from posture to posture needs no inverse kinematics.
        from evenroad.poses.inverse_kinematics import reach, reach_quickly

        found = reach_quickly(world, wanted, start) if many else [reach(world, goal, start) for goal in wanted]
    with_postures = zip(wanted, found, strict=True)
    for target in targets:
        if not isinstance(target, _POSES):
            rows.append(read(target)[np.newaxis])
            names.append(target.strip() if isinstance(target, str) else "")
            continue
        goal, reached = next(with_postures)
        poses.append((goal, reached))
        rows.append(reached.configurations)
        if len(reached.configurations):
            names += [str(goal)] * len(reached.configurations)
    if many and not names and not found[0].spent:
        # Nothing was reached soon: all are looked at again, in full.
        poses = [(goal, reach(world, goal, start)) for goal, _ in poses]
        rows = [reached.configurations for _, reached in poses]
        names = [str(goal) for goal, reached in poses for _ in reached.configurations]
    if not names:
        rows = [reached.nearest[np.newaxis] for _, reached in poses]
    took = now() - began if poses else 0.0
    return Goals(rows[0] if len(rows) == 1 else np.concatenate(rows), tuple(names), tuple(poses), took)


def _record(world: Checks, goal: PoseGoal, reached: Reached, end: Floats | None) -> dict[str, object]:
    record: dict[str, object] = {
        "tip": goal.tip,
        "frame": goal.frame or world.robot.links[0],
        "xyz": list(goal.pose.xyz),
        "rotation": list(goal.pose.rotation),
        "free_axis": None if goal.free_axis is None else list(goal.free_axis),
        "position_only": goal.position_only,
        "position_tolerance": goal.position_tolerance,
        "angle_tolerance": goal.angle_tolerance,
        "solver": reached.solver,
        "postures": reached.branches,
        "in_collision": reached.blocked,
        "goals": len(reached.configurations),
        "why_not": reached.why,
    }
    if end is not None:
        from evenroad.poses.inverse_kinematics import task_of

        chain, task = task_of(world.robot, goal)
        record["off_m"], record["off_rad"] = task.misses(chain.tip_poses(end[np.newaxis])[0])
    return record
