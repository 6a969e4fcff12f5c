"""Planning for an arm in one call: from names and files to a path that the robot's meshes were asked about, too."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Unpack

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._rng import RngLike
from evenroad.arm_goals import find_cheapest
from evenroad.arm_ways import Ends, plan_ways
from evenroad.errors import InvalidValue
from evenroad.geometry.pose import Pose
from evenroad.points import PointSet, draw
from evenroad.roadmap import Budget, PlanResult, Rule, Status
from evenroad.roadmap.answer import require_certified
from evenroad.roadmap.find_path import SECONDS, with_reasons
from evenroad.roadmap.plan import plan
from evenroad.robot import (
    ArmWorld,
    Robot,
    RobotModel,
    Scene,
    at_states,
    configuration,
    in_scene,
    load_model,
    load_scene,
    scene_seen_by,
)
from evenroad.robot.goals import Goals, goals_of
from evenroad.robot.load import RobotOptions
from evenroad.robot.pose_goal import PoseGoal
from evenroad.robot.reference.recheck import MeshCheck, has_meshes, recheck, unseen_pairs
from evenroad.robot.robot import with_group
from evenroad.robot.states import clipped
from evenroad.robot.straight import Straight
from evenroad.robot.upright import Upright
from evenroad.robot.urdf_xml import RobotFile
from evenroad.world import World

PathLike = str | os.PathLike[str]
Place = str | npt.ArrayLike
"""A configuration: numbers in the order of the group, or a text as :func:`evenroad.robot.configuration` takes it."""

Goal = Place | Pose | PoseGoal
"""A configuration, or where a link is to be."""

RESOLUTION = 0.05
"""Largest step of a motion check when none is given [rad]."""

SEARCH = "lazy"
"""The same path as by the full search; of an arm, checks of motions are the dear part."""


@dataclass(frozen=True, eq=False)
class ArmQuery:
    """An arm in its scene, with where it is to go from and to.

    The world's robot is held where named states have the joints that are not planned for, within the scene's ranges.
    Start, (dim,), and goals, (g, dim), are in rad or m; `given` says what the goals were made of.
    `source`, where the robot was read, and `model`, how it was made, are None for a robot that was given as a value.
    """

    world: ArmWorld
    start: Floats
    goals: Floats
    given: Goals
    source: RobotFile | None = None
    model: RobotModel | None = None

    @property
    def goal_names(self) -> tuple[str, ...]:
        """By which texts the caller called the goals, or nothing."""
        return self.given.names

    @property
    def ends(self) -> Ends:
        """World, start and goals, and the tip that goal poses are of."""
        tip = self.given.poses[0][0].tip if self.given.poses else ""
        return Ends(self.world, self.start, self.goals, tip)


def plan_arm(
    robot: PathLike | Robot,
    scene: PathLike | Scene,
    start: Place,
    goal: Goal | Sequence[Goal],
    points: int | PointSet | None = None,
    *,
    seconds: float = SECONDS,
    budget: Budget | None = None,
    improve: bool = False,
    certified: bool = False,
    rng: RngLike = 0,
    rule: Rule | None = None,
    shorten: bool = True,
    resolution: float = RESOLUTION,
    degrees: bool = False,
    tip: str = "",
    frame: str = "",
    straight: Straight | None = None,
    upright: Upright | None = None,
    **options: Unpack[RobotOptions],
) -> PlanResult:
    """Plan for an arm among obstacles, as ``evenroad plan --robot`` does: until there is a path or the time is over.

    Parameters
    ----------
    robot : str, path-like or Robot
        A URDF file, or the name of a shipped robot (``ur5``, ``arm7``).
    scene : str, path-like or Scene
        A scene file, or the name of a shipped one (``box-reach``, ...).
    start : str or array_like, shape (dim,)
        Numbers in the order of the group [rad or m], or a text: the name of a state, ``0,-1.57,...`` or ``name=value``.
        A value that is outside of its joint's limits by no more than 1e-6 is brought to the limit.
    goal : str, array_like, Pose, PoseGoal, or a sequence of such
        As `start`, or where a link is to be: all configurations that are known to bring it there are goals.  Of several
        the path ends at a cheap one, with points or `improve` at the cheapest.
    points : int or PointSet, optional
        Plan on a roadmap (ps-PRM) of this set, or of exactly so many points of the sampler ``even``.  Default: no
        roadmap, but trees that grow from both ends until they meet.
    seconds : float
        How long to plan at most, > 0.
    budget : Budget, optional
        In place of `seconds`, where other limits are wanted.
    improve : bool
        Use up the time, and return the best of all paths; not with points.
    certified : bool
        Check once more that every motion is proved free throughout for the robot's capsules; where one is not, the
        status is ``not_certified`` and the message says which.
    rng : int, SeedSequence or Generator
        For points that are drawn.
    rule, shorten
        As in :func:`evenroad.roadmap.plan`; a rule goes with points.
    resolution : float
        Largest step of a motion check, > 0 [rad].
    degrees : bool
        Angles in texts are degrees.
    tip, frame : str
        Of which link goal poses are, and in the frame of which; default: the last link, the root.
    straight : Straight, optional
        How far the tip moves in straight lines from its start and to its goal.
    upright : Upright, optional
        Which axis of the tip is to be upright along the whole path; `budget` then counts samples and motions of a
        roadmap.
    **options
        ``srdf``, ``group``, ``bodies``, ... of :func:`evenroad.robot.load_model`, for a robot that is read from a file.

    Returns
    -------
    PlanResult
        ``mesh_collision`` is the status of a path that is free for the capsules, but not for the URDF's meshes;
        ``proof`` says what was shown of the path, for the capsules.  ``goal_unreachable`` is that of a pose that no
        configuration was found for; the message says why.

    Raises
    ------
    InvalidValue, UnknownName, BrokenFile, NotAvailable
        As `load_model`, `load_scene` and `configuration`.

    Examples
    --------
    >>> import evenroad as er
    >>> er.plan_arm("ur5", "box-reach", "home", "inside").status
    <Status.SOLVED: 'solved'>
    """
    if points is None and rule is not None:
        raise InvalidValue(f"rule says how points are joined, so it goes with points=N, got {rule!r}")
    if points is not None and improve:
        raise InvalidValue("improve goes without points: a roadmap of exactly so many has one best path")
    how = dict(resolution=resolution, degrees=degrees, tip=tip, frame=frame)
    query = arm_query(robot, scene, start, goal, **how, **options)  # type: ignore[arg-type]
    if (refused := unreached(query)) is not None:
        return refused
    budget = Budget(seconds=seconds) if budget is None else budget
    if points is not None and not isinstance(points, PointSet):
        points = draw("even", points, query.world.space.cube_dim, rng=rng)

    def plan_once(world: World, start: Floats, goals: Floats, shorten: bool) -> PlanResult:
        if points is None:
            return find_cheapest(world, start, goals, budget=budget, shorten=shorten, improve=improve)
        return plan_on_points(world, start, goals, points, rule=rule, shorten=shorten, budget=budget)

    result = plan_ways(query.ends, straight, upright, plan_once, shorten=shorten)
    return finished(query, result, certified=certified)[0]


def plan_on_points(
    world: World,
    start: Floats,
    goals: Floats,
    points: PointSet,
    *,
    rule: Rule | None,
    shorten: bool,
    budget: Budget,
) -> PlanResult:
    """Plan on a roadmap of these points; where they do not suffice, the message says what hems in start and goals."""
    result = plan(world, start, goals, points, rule=rule, search=SEARCH, shorten=shorten, budget=budget)
    return with_reasons(world, result)


def unreached(query: ArmQuery) -> PlanResult | None:
    """Return the result where no goal pose can be reached and there is no other goal; else None."""
    given = query.given
    if not given.unreached:
        return None
    status = Status.GOAL_INVALID if given.in_collision else Status.GOAL_UNREACHABLE
    return replace(query.ends.refused(status, given.unreached), seconds={"goals": given.seconds})


def finished(
    query: ArmQuery, result: PlanResult, *, certified: bool = False
) -> tuple[PlanResult, MeshCheck | None]:
    """Return a plan with the name of its goal and the status that its path has after the last checks.

    The meshes of the robot's URDF are asked where it has some or where capsules always touch; what they say is None
    where there is no path, or nothing to ask.
    """
    if query.given.poses:
        result = replace(result, seconds={"goals": query.given.seconds, **result.seconds})
    name = "" if result.goal_index is None else query.goal_names[result.goal_index]
    if name and len(query.goals) > 1:
        to = f"to goal {result.goal_index}"
        result = replace(result, message=result.message.replace(to, f"{to} ({name})", 1))
    if certified:
        result = require_certified(query.world, result)
    if not result.solved or result.path is None:
        return result, None
    meshes = mesh_check(query, result.path)
    if meshes is None or meshes.verdict != "in collision":
        return result, meshes
    message = (
        "the path is free for the robot's capsules, but not for the shapes that they stand for: in collision"
        f" {meshes.message}"
    )
    return replace(result, status=Status.MESH_COLLISION, message=message), meshes


def mesh_check(query: ArmQuery, path: Floats) -> MeshCheck | None:
    """Return what the meshes of the robot's file say of a path, (p, dim); None where there is nothing to ask."""
    world, source, model = query.world, query.source, query.model
    if source is None or model is None:
        return None
    unseen = unseen_pairs(model)
    if not (has_meshes(model) or unseen):
        return None
    return recheck(source, world.robot, world.scene, path, world.resolution, unseen)


def arm_query(
    robot: PathLike | Robot,
    scene: PathLike | Scene,
    start: Place,
    goal: Goal | Sequence[Goal],
    *,
    resolution: float = RESOLUTION,
    degrees: bool = False,
    tip: str = "",
    frame: str = "",
    held: Mapping[str, float] | None = None,
    **options: Unpack[RobotOptions],
) -> ArmQuery:
    """Read robot, scene and configurations, and put them together; parameters and errors as :func:`plan_arm`.

    Joints outside of the group are held at `held`, else where the named states of start and goal have them.
    """
    scene = scene if isinstance(scene, Scene) else load_scene(scene)
    source, model = None, None
    if isinstance(robot, Robot):
        if options:
            raise InvalidValue(f"{', '.join(options)} must go with the file of a robot, not with a Robot")
    else:
        model = load_model(robot, **options)
        source, robot = model.file, model.robot
    goals = _places(goal)
    texts = [place for place in (start, *goals) if isinstance(place, str)]
    robot = at_states(in_scene(robot, scene), texts, scene)
    if held:
        robot = with_group(robot, robot.group, {**robot.held, **held})
    scene = scene_seen_by(robot, scene)
    first = _configuration(robot, scene, "start", start, degrees)
    world = ArmWorld(robot, scene, resolution=resolution)

    def read(place: Place) -> Floats:
        return _configuration(robot, scene, "goal", place, degrees)

    given = goals_of(world, first, goals, read, tip, frame)
    return ArmQuery(world, first, given.configurations, given, source, model)


def _places(goal: Goal | Sequence[Goal]) -> list[Goal]:
    """Return one goal or several as a list."""
    if isinstance(goal, str | Pose | PoseGoal):
        return [goal]
    if isinstance(goal, np.ndarray):
        return list(goal) if goal.ndim == 2 else [goal]
    several = isinstance(goal, Sequence) and any(
        isinstance(each, str | Pose | PoseGoal) or np.ndim(each) > 0 for each in goal
    )
    return list(goal) if several else [goal]  # type: ignore[arg-type, list-item]


def _configuration(robot: Robot, scene: Scene, name: str, place: Place, degrees: bool) -> Floats:
    """Return a configuration, (dim,), from a text or numbers; `name` says what it is in an error."""
    if isinstance(place, str):
        return configuration(robot, place, scene, degrees=degrees)
    dim = len(robot.group)
    try:
        q = np.array(place, dtype=np.float64)
    except (TypeError, ValueError):
        q = np.empty(0)
    if q.shape != (dim,) or not np.isfinite(q).all():
        raise InvalidValue(f"{name} must be {dim} finite numbers, {','.join(robot.group)}, got {place!r}")
    return clipped(robot, q)
