"""Reading start and goals of a query: numbers, texts, and poses, which postures reach."""

from __future__ import annotations

from collections.abc import Sequence

import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad.geometry.pose import Pose
from evenroad.roadmap import PlanResult, Status
from evenroad.roadmap.query import as_start_and_goals
from evenroad.roadmap.result import make_result
from evenroad.robot import ArmWorld, configuration
from evenroad.robot.goals import Goals, goals_of
from evenroad.robot.pose_goal import PoseGoal

ConfigurationLike = str | npt.ArrayLike
"""A configuration: numbers in the order of the group, or a text as :func:`evenroad.robot.configuration` takes it."""

POSES = (Pose, PoseGoal)
Goal = ConfigurationLike | Pose | PoseGoal
"""A configuration, or a pose of a link."""


def read_start_and_goals(
    world: ArmWorld, start: ConfigurationLike, goal: Goal | Sequence[Goal]
) -> tuple[Floats, Goals] | PlanResult:
    """Return start, (dim,), and goals, with all postures found for poses; or the result if a pose is not reached."""
    if not any(isinstance(each, POSES) for each in (goal if isinstance(goal, list | tuple) else (goal,))):
        first, goals = as_start_and_goals(_configuration(world, start), _configurations(world, goal), world.space)
        return first, Goals(goals, ("",) * len(goals))
    targets: Sequence[Goal] = [goal] if isinstance(goal, POSES) else goal  # type: ignore[assignment]
    at_start, space = _configuration(world, start), world.space
    first = as_start_and_goals(at_start, at_start, space)[0]
    given = goals_of(
        world,
        first,
        targets,
        lambda each: as_start_and_goals(at_start, _configuration(world, each), space)[1][0],
    )
    if not given.unreached:
        return first, given
    status = Status.GOAL_INVALID if given.in_collision else Status.GOAL_UNREACHABLE
    timings = {"goals": given.seconds}
    return make_result(world, first, given.configurations, status, given.unreached, timings=timings)


def _configuration(world: ArmWorld, given: ConfigurationLike) -> npt.ArrayLike:
    """Return the configuration of a text; numbers stay as they are."""
    return configuration(world.robot, given, world.scene) if isinstance(given, str) else given


def _configurations(world: ArmWorld, goal: Goal | Sequence[Goal]) -> npt.ArrayLike:
    if isinstance(goal, list | tuple) and any(isinstance(each, str) for each in goal):
        return [_configuration(world, each) for each in goal]  # type: ignore[return-value]
    return _configuration(world, goal)  # type: ignore[arg-type]
