"""``er.plan``: from a world, a start and a goal, as values, names or files, to a path, or why there is none."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from evenroad._arrays import Floats
from evenroad._rng import RngLike
from evenroad._shared import once
from evenroad._time_limit import BudgetSpent, within
from evenroad.collision.arm_world import ArmWorld
from evenroad.collision.validate import MeshCheck
from evenroad.errors import InvalidValue, shown
from evenroad.planning.answer import apart_in, out_of_time, require_certified
from evenroad.planning.connector import Smooth
from evenroad.planning.diagnose import with_reasons
from evenroad.planning.prm import FMT, PRM
from evenroad.planning.problem import Planner, Problem
from evenroad.planning.read_request import mesh_check, read_request
from evenroad.planning.request import Goal, Reading, Request, unreached
from evenroad.planning.result import PlanResult, Status
from evenroad.planning.trees import RRTConnect, default_planner
from evenroad.planning.world_roadmap import WorldRoadmap
from evenroad.points.pointset import PointSet
from evenroad.poses.constraint import Constraint
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.roadmap import Roadmap
from evenroad.robots.robot import ConfigurationLike
from evenroad.scenes.scan import allowed_everywhere
from evenroad.world import World

if TYPE_CHECKING:
    from evenroad.planning.tip_motion import TipMotion

PLANNERS: dict[str, Callable[[], Planner]] = {"rrtconnect": RRTConnect, "prm": PRM, "fmt": FMT}
"""Planners by name."""

_PLAIN = Reading()


@dataclass(frozen=True)
class Options:
    """The options of a path that hold for every planner; see :func:`plan`."""

    budget: Budget = field(default_factory=lambda: Budget(seconds=RRTConnect.seconds))
    smooth: Smooth = True
    rng: RngLike = 0
    certified: bool = False
    constraints: Constraint | None = None


def plan(
    world: Any,
    start: ConfigurationLike,
    goal: Goal | Sequence[Goal],
    planner: Planner | Roadmap | PointSet | str | os.PathLike[str] | None = None,
    *,
    seconds: float | None = None,
    limits: Budget | Mapping[str, int] | None = None,
    smooth: Smooth = True,
    rng: RngLike = 0,
    certified: bool = False,
    constraints: Constraint | None = None,
    degrees: bool = False,
    tip: str = "",
    frame: str = "",
    **of_world: Any,
) -> PlanResult:
    """Plan a path; stop with the path, with a proof that there is none, or when the budget is spent.

    Parameters
    ----------
    world : World, GridMap, Scene, str or path-like
        Where to plan.  A map, or its file, goes with ``radius=``; a scene, its file or the name of a shipped one, with
        ``robot=``.
    start : array_like, shape (dim,), str or mapping
        A configuration in the units of the world's space.  Of an arm also joint -> value, or a text: the name of a
        state, ``0,-1.57,...`` or ``name=value``.  A value may exceed its joint's limits by 1e-5, as five printed
        decimals do, and stays what it is.
    goal : as `start`, Pose, PoseGoal, or a sequence of such
        A pose stands for all configurations found that reach it; its (4, 4) matrix as an array is one, too, unless the
        arm has four joints.  Of several goals the path ends at the nearest if it
        is reached soon; along a roadmap, or with ``improve``, at the cheapest.
    planner : Planner, Roadmap, PointSet, str or path-like, optional
        Such as ``er.RRTConnect()``, ``er.PRM(512)`` or ``"fmt"``.  Default: trees for an arm, a search of cells
        for a disk on a map, points that grow for any other world.  A PointSet stands for ``er.PRM(points)``,
        a Roadmap, or its file, for that roadmap within the world.
    seconds : float, optional
        Largest wall time, > 0: the call ends by then, with what has been found.  What the world is made of is read and
        packed before the time begins.  Default: 5; for planners on points that are drawn beforehand 60.
    limits : mapping or Budget, optional
        Other limits: ``motions``, ``samples``, ``rounds``; integers >= 1.  With these the same call gives the same
        answer on every machine, unless the time runs out first.  A :class:`evenroad.roadmap.Budget` says the time, too.
    smooth : bool or "quick"
        Whether the path is made shorter once it is found.  Waypoints of an arm slide along what they touch, 5 mm off
        where that costs at most 2 % of the length; "quick": the path is cut short by straight motions alone, in less
        time.
    rng : int, SeedSequence or Generator
        Seed of what the planner draws; the same seed gives the same path.
    certified : bool
        Check once more that every motion is proved free throughout.  Where one is not, the status is
        ``not_certified``, and the message says which.
    constraints : Constraint, optional
        Of an arm, such as ``er.CartesianLine(0.1)`` or ``er.constraints.KeepUpright(0.1)``; ``one & other`` holds both.
    degrees : bool
        Angles in texts are degrees.
    tip, frame : str
        The link that goal poses place, and the link in whose frame; default: the last link, and the root.
    **of_world
        ``radius``, ``clearance``, ``unknown_is_free``, ``rules`` of a map; ``robot``, ``clearance``, ``resolution``,
        and what :func:`evenroad.load_robot` takes, of a scene.

    Returns
    -------
    PlanResult
        Without a path, ``status`` and ``message`` say why.  ``mesh_collision`` is the status of a path that is free for
        the bodies it was planned with, but not for the meshes of the arm's file; ``goal_unreachable`` that of a pose
        that no configuration was found for.

    Raises
    ------
    InvalidValue, UnknownName, BrokenFile, NotAvailable
        If an argument is not one of these.

    Examples
    --------
    >>> import evenroad as er
    >>> er.plan("box-reach", "home", "inside", robot="ur5").status
    <Status.SOLVED: 'solved'>
    """
    given = None if planner is None else _as_planner(planner)
    reading = Reading(degrees, tip, frame) if degrees or tip or frame else _PLAIN
    options = Options(budget_of(given, seconds, limits), smooth, rng, certified, constraints)
    with within(options.budget.seconds):
        request = read_request(world, start, goal, reading, given, **of_world)
        try:
            by = None if given is None else _within(given, request.world)
        except BudgetSpent:
            return _out_of_time(request, options)
        return finished(request, _solved(request, by, options), certified=certified)[0]


def _as_planner(planner: object) -> Planner | Roadmap:
    """Return the planner, or the roadmap, that a value, a name or a file stands for."""
    if isinstance(planner, str) and planner.lower() in PLANNERS:
        return PLANNERS[planner.lower()]()
    if isinstance(planner, str | os.PathLike):
        # Imported late: most plans read no roadmap.
        from evenroad.roadmap.npz import load_roadmap

        return load_roadmap(planner)
    if isinstance(planner, PointSet):
        return PRM(planner)
    if not isinstance(planner, Planner | Roadmap):
        raise InvalidValue(
            f"planner must be a planner, such as er.RRTConnect(), er.PRM(512) or a roadmap, got {shown(planner)}"
        )
    return planner


def _within(planner: Planner | Roadmap, world: World) -> Planner:
    """Return the planner in a world: a roadmap within it."""
    if isinstance(planner, Roadmap):
        return planner.within(world)
    if isinstance(planner, WorldRoadmap) and planner.world is not world:
        raise InvalidValue(f"a roadmap plans in its own world: give er.plan its .world, got {world!r}")
    return planner


def budget_of(
    planner: Planner | Roadmap | None, seconds: float | None, limits: Budget | Mapping[str, int] | None
) -> Budget:
    """Return a planner's budget: the given limits, else its own."""
    if seconds is None and limits is None:
        return _default_budget(getattr(planner, "seconds", RRTConnect.seconds))
    if isinstance(limits, Budget):
        if seconds is not None:
            raise InvalidValue("give seconds, or limits that are a Budget, not both")
        return limits
    if seconds is None:
        seconds = getattr(planner, "seconds", RRTConnect.seconds)
    try:
        return Budget(seconds=seconds, **({} if limits is None else limits))
    except TypeError:
        raise InvalidValue(f"limits must be of motions, samples or rounds, got {shown(limits)}") from None


@once
def _default_budget(seconds: float) -> Budget:
    """Return the budget of a planner that is given no limits."""
    return Budget(seconds=seconds)


def solve(request: Request, planner: Planner | None, options: Options) -> PlanResult:
    """Plan a request; the path is free in its world."""
    with within(options.budget.seconds):
        return _solved(request, planner, options)


def _solved(request: Request, planner: Planner | None, options: Options) -> PlanResult:
    given, motion = request.given, None if options.constraints is None else _motion_of(options.constraints)
    if (result := unreached(request)) is not None:
        return result
    if given is not None and motion is not None and motion.line is not None:
        # Lines to other postures may lead elsewhere: nothing is proved about poses.
        given = replace(given, poses=(), whole=False)
    stopped = False

    def plan_once(world: World, start: Floats, goals: Floats, smooth: Smooth) -> PlanResult:
        problem = Problem(
            world,
            start,
            goals,
            budget=options.budget,
            smooth=smooth,
            rng=options.rng,
            given=given,
        )
        nonlocal stopped
        try:
            found = (default_planner(world) if planner is None else planner).solve(problem)
        except KeyboardInterrupt as stop:
            if (best := getattr(stop, "best", None)) is None:
                raise
            found, stopped = best, True
        return found if found.solved else with_reasons(world, found)

    try:
        if motion is None:
            found = plan_once(request.world, request.start, request.goals, options.smooth)
        else:
            found = motion.plan(request, plan_once, options.smooth)
    except BudgetSpent:
        found = _out_of_time(request, options)
    if stopped:
        # Imported late: few plans become shorter until somebody stops them.
        from evenroad.planning.growing import Interrupted

        raise Interrupted(found)
    return found


def _out_of_time(request: Request, options: Options) -> PlanResult:
    return out_of_time(Problem(request.world, request.start, request.goals, budget=options.budget))


def _motion_of(constraints: Constraint) -> TipMotion:
    # Imported late: most plans have no constraints.
    from evenroad.planning.tip_motion import TipMotion

    return TipMotion.of(constraints)


def finished(request: Request, result: PlanResult, *, certified: bool = False) -> tuple[PlanResult, MeshCheck | None]:
    """Return a plan with the name of its goal and its status after the last checks, and the check of the meshes.

    Meshes of the robot's URDF are checked where it has some or where capsules always touch.  Their check is None where
    there is no path or nothing to check.
    """
    given, world = request.given, request.world
    if request.notes:
        result = replace(result, notes=request.notes)
    if given is not None and given.poses and not given.unreached:
        result = replace(result, timings={"goals": given.seconds, **result.timings})
    if not result.solved and "points" in result.counts:
        result = _with_proof(request, result)
    name = "" if result.goal_index is None or not request.goal_names else request.goal_names[result.goal_index]
    if name and len(request.goals) > 1:
        to = f"to goal {result.goal_index}"
        result = replace(result, message=result.message.replace(to, f"{to} ({name})", 1))
    if (
        result.path is not None
        and isinstance(world, ArmWorld)
        and (pairs := allowed_everywhere(world.robot, world.scene))
    ):
        untested = ", ".join(f"{link!r} against the whole cloud {cloud!r}" for link, cloud in pairs)
        result = replace(result, message=f"{result.message}; not tested, as the scene allows: {untested}")
    if certified:
        result = require_certified(world, result)
    if result.path is None or not result.solved:
        return result, None
    try:
        meshes = mesh_check(request, result.path)
    except BudgetSpent:
        message = f"{result.message}, but there was no time to check it with the meshes of the robot's file"
        return replace(result, status=Status.BUDGET_SPENT, message=message), MeshCheck("not checked", message="no time")
    if meshes is None or meshes.verdict != "in collision":
        return result, meshes
    message = (
        "the path is free for the bodies of the plan, but not for the shapes that they stand for: in collision"
        f" {meshes.message}"
    )
    return replace(result, status=Status.MESH_COLLISION, message=message), meshes


def _with_proof(request: Request, result: PlanResult) -> PlanResult:
    """Return a result of points without a path, with the proof that more points would not find one."""
    if result.status is not Status.NOT_CONNECTED:
        return result
    try:
        found = apart_in(Problem(request.world, request.start, request.goals, given=request.given))
    except BudgetSpent:
        return replace(result, message=f"{result.message}; there was no time for a proof that there is no path")
    if found is None or not found.proved:
        return result
    return replace(result, message=f"{found.message}; {result.message.partition(': try')[0]}")
