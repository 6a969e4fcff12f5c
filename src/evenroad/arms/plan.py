"""Planning for an arm in one call: from names and files to a path that the robot's meshes were asked about, too."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Unpack

from evenroad._arrays import Floats
from evenroad._rng import RngLike
from evenroad.arms.query import RESOLUTION, ArmQuery, Goal, PathLike, Place, arm_query, mesh_check, unreached
from evenroad.arms.ways import plan_ways
from evenroad.errors import InvalidValue
from evenroad.points import PointSet, draw
from evenroad.roadmap import Budget, PlanResult, Rule, Status
from evenroad.roadmap.answer import require_certified
from evenroad.roadmap.find_path import SECONDS, find_path, with_reasons
from evenroad.roadmap.plan import plan
from evenroad.robot import Robot, Scene
from evenroad.robot.load import RobotOptions
from evenroad.robot.reference.recheck import MeshCheck
from evenroad.robot.scan import allowed_everywhere
from evenroad.robot.straight import Straight
from evenroad.robot.trees import prepare
from evenroad.robot.upright import Upright
from evenroad.world import World

SEARCH = "lazy"
"""The same path as by the full search; of an arm, checks of motions are the dear part."""


@dataclass(frozen=True, eq=False)
class ArmPlanner:
    """How an arm's query is planned; but for what is said here as parameters of :func:`plan_arm`.

    Attributes
    ----------
    along : callable, optional
        Plans in place of trees and points from a start, (dim,), to goals, (g, dim); keywords `budget` and `shorten`.
    """

    budget: Budget
    points: PointSet | None = None
    rule: Rule | None = None
    improve: bool = False
    shorten: bool = True
    straight: Straight | None = None
    upright: Upright | None = None
    along: Callable[..., PlanResult] | None = None


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
    clearance: float = 0.0,
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
        A value may exceed its joint's limits by 1e-5, as five printed decimals do, and stays what it is.
    goal : str, array_like, Pose, PoseGoal, or a sequence of such
        As `start`, or where a link is to be: all configurations that are known to bring it there are goals.  Of several
        the path ends at the nearest, where that is soon reached, with points or `improve` at the cheapest.
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
    clearance : float
        How far the arm keeps from all obstacles, 0 to 1 [m]: its bodies are larger by that, but not against each other.
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
    if points is None:
        prepare()
    how = dict(resolution=resolution, clearance=clearance, degrees=degrees, tip=tip, frame=frame)
    query = arm_query(robot, scene, start, goal, **how, **options)  # type: ignore[arg-type]
    budget = Budget(seconds=seconds) if budget is None else budget
    if points is not None and not isinstance(points, PointSet):
        points = draw("even", points, query.world.space.cube_dim, rng=rng)

    planner = ArmPlanner(budget, points, rule, improve, shorten, straight, upright)
    return finished(query, plan_query(query, planner), certified=certified)[0]


def plan_query(query: ArmQuery, by: ArmPlanner) -> PlanResult:
    """Plan what an arm is asked; the path is free for its capsules."""
    apart = query.given.apart(query.world, straight=by.straight is not None)

    def plan_once(world: World, start: Floats, goals: Floats, shorten: bool) -> PlanResult:
        if by.along is not None:
            return by.along(start, goals, budget=by.budget, shorten=shorten)
        if by.points is None:
            how = dict(budget=by.budget, shorten=shorten, improve=by.improve, apart=apart)
            return find_path(world, start, goals, **how)  # type: ignore[arg-type]
        more = dict(rule=by.rule, search=SEARCH, shorten=shorten, budget=by.budget)
        return with_reasons(world, plan(world, start, goals, by.points, **more))  # type: ignore[arg-type]

    if (refused := unreached(query)) is not None:
        return refused
    return plan_ways(query.ends, by.straight, by.upright, plan_once, shorten=by.shorten)


def finished(
    query: ArmQuery, result: PlanResult, *, certified: bool = False
) -> tuple[PlanResult, MeshCheck | None]:
    """Return a plan with the name of its goal and the status that its path has after the last checks.

    The meshes of the robot's URDF are asked where it has some or where capsules always touch; what they say is None
    where there is no path, or nothing to ask.
    """
    if query.given.poses:
        result = replace(result, timings={"goals": query.given.seconds, **result.timings})
    name = "" if result.goal_index is None else query.goal_names[result.goal_index]
    if name and len(query.goals) > 1:
        to = f"to goal {result.goal_index}"
        result = replace(result, message=result.message.replace(to, f"{to} ({name})", 1))
    if result.path is not None and (pairs := allowed_everywhere(query.world.robot, query.world.scene)):
        untested = ", ".join(f"{link!r} against the whole cloud {cloud!r}" for link, cloud in pairs)
        result = replace(result, message=f"{result.message}; not tested, as the scene allows: {untested}")
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
