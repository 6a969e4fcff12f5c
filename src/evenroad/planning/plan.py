"""``er.plan``: a path in a world from a start to a goal, given as values, names or files, or why there is none."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from evenroad._call import explains_calls
from evenroad._rng import RngLike
from evenroad._shared import once
from evenroad._time_limit import BudgetSpent, within
from evenroad.errors import InvalidValue, shown
from evenroad.planning.connector import Smooth
from evenroad.planning.diagnose import with_reasons
from evenroad.planning.finish import finished
from evenroad.planning.make_result import out_of_time, unreached
from evenroad.planning.planners import planner_of, unknown_planner
from evenroad.planning.planners.trees import RRTConnect, default_planner
from evenroad.planning.problem import Interrupted, Planner, Problem, Wanted
from evenroad.planning.read_problem import read_problem
from evenroad.planning.reading import Goal, PathLike, Reading
from evenroad.planning.result import PlanResult
from evenroad.points.pointset import PointSet
from evenroad.poses.constraint import Constraint
from evenroad.roadmap.budget import Budget
from evenroad.robots.robot import ConfigurationLike
from evenroad.scenes.scene import Scene
from evenroad.space.protocol import is_directed
from evenroad.world import World

if TYPE_CHECKING:
    from evenroad.driving import GoalRegion, PolygonMap
    from evenroad.roadmap.roadmap import Roadmap
    from evenroad.world import GridMap

_PLAIN = Reading()


@explains_calls
def plan(
    world: World | GridMap | PolygonMap | Scene | PathLike,
    start: ConfigurationLike,
    goal: Goal | GoalRegion | Sequence[Goal | GoalRegion],
    planner: Planner | Roadmap | PointSet | str | os.PathLike[str] | None = None,
    *,
    seconds: float | None = None,
    limits: Budget | Mapping[str, int] | None = None,
    smooth: Smooth = True,
    rng: RngLike = 0,
    certified: bool = False,
    constraints: Constraint | None = None,
    prefer_clearance: float = 0.0,
    degrees: bool = False,
    tip: str = "",
    frame: str = "",
    **of_world: Any,
) -> PlanResult:
    """Plan a path; stop with the path, with a proof that there is none, or when the budget is spent.

    Parameters
    ----------
    world : World, GridMap, PolygonMap, Scene, str or path-like
        The world to plan in.  A map, or its file, goes with ``radius=`` or ``footprint=``; a scene, its file or the
        name of a shipped one, with ``robot=``.
    start : array_like, shape (dim,), str or mapping
        A configuration in the units of the world's space.  For an arm also joint -> value, or a text: the name of a
        state, ``0,-1.57,...`` or ``name=value``.  A value may exceed its joint's limits by 1e-5, the rounding of five
        printed decimals, and is not changed.
    goal : as `start`, Pose, PoseGoal, or a sequence of such
        A pose stands for all configurations found that reach it.  A (4, 4) array is the matrix of a pose, unless the
        arm has four joints.  For a car or a disk also a :class:`evenroad.driving.GoalRegion`.  With several goals the
        path ends at the nearest one if it is reached soon; along a roadmap, or with ``improve``, at the cheapest.
    planner : Planner, Roadmap, PointSet, str or path-like, optional
        A planner, such as ``er.RRTConnect()``, ``er.PRM(512)`` or ``"fmt"``.  Default: trees for an arm, a search of
        cells for a disk on a map, a growing roadmap for any other world.  A PointSet stands for ``er.PRM(points)``;
        a Roadmap, or its file, for that roadmap within the world.
    seconds : float, optional
        Largest wall time, > 0.  The call ends by then and returns what it has found.  Reading and packing the world is
        not included.  Default: 5; for planners on points that are drawn beforehand 60.
    limits : mapping or Budget, optional
        Other limits: ``motions``, ``samples``, ``rounds``; integers >= 1.  With these the same call gives the same
        answer on every machine, unless the time runs out first.  A :class:`evenroad.roadmap.Budget` includes the time.
    smooth : bool or "quick"
        Whether the path is smoothed.  An arm's waypoints slide along obstacles, with a clearance of 5 mm if that costs
        at most 2 % of the length.  "quick": only straight shortcuts, in less time.
    rng : int, SeedSequence or Generator
        Seed of the planner; the same seed gives the same path.
    certified : bool
        Check once more that every motion is proved free.  If one is not, the status is ``not_certified``, and the
        message says which.
    constraints : Constraint, optional
        Constraints of an arm, such as ``er.CartesianLine(0.1)`` or ``er.constraints.KeepUpright(0.1)``;
        ``one & other`` means both.
    prefer_clearance : float
        Distance from obstacles, >= 0, that the path of a disk or a car keeps where there is room for it, in map units.
        A length at an obstacle counts three times one with all of this clearance.  ``clearance=`` is always kept.
    degrees : bool
        Angles in texts are degrees.
    tip, frame : str
        The link that goal poses refer to, and the link whose frame they are in; default: the last link, and the root.
    **of_world
        For a map: ``radius``, ``clearance``, ``unknown_is_free``, ``rules``.  For a scene: ``robot``, ``clearance``,
        ``resolution``, and the keywords of :func:`evenroad.load_robot`.

    Returns
    -------
    PlanResult
        Without a path, ``status`` and ``message`` say why.  ``mesh_collision``: the path is free for the bodies it was
        planned with, but not for the meshes of the arm's file.  ``goal_unreachable``: no configuration was found for a
        pose.

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
    by = None if planner is None else _as_planner(planner)
    budget = budget_of(by, seconds, limits)
    reading = Reading(degrees, tip, frame) if degrees or tip or frame else _PLAIN
    wanted: Wanted = {
        "budget": budget,
        "smooth": smooth,
        "rng": rng,
        "certified": certified,
        "constraints": constraints,
        "prefer_clearance": prefer_clearance,
    }
    with within(budget.seconds):
        problem = read_problem(world, start, goal, reading, wanted, **of_world)
        return solve(problem, by)


def solve(problem: Problem, planner: Planner | Roadmap | None = None) -> PlanResult:
    """Return the finished result of a problem, by a planner or its world's default, before this thread's deadline."""
    stopped = False

    def plan_once(part: Problem) -> PlanResult:
        nonlocal stopped
        try:
            found = (default_planner(part.world) if by is None else by).solve(part)
        except Interrupted as stop:
            found, stopped = stop.best, True
        return found if found.solved else with_reasons(part.world, found)

    if problem.prefer_clearance > 0.0:
        # Imported late: it is of disks and cars alone.
        from evenroad.planning.preferred_clearance import require_preferring, with_preferred_clearance

        require_preferring(problem)
    try:
        by = None if planner is None else _within(planner, problem.world)
        if (found := unreached(problem)) is None and problem.constraints is None:
            found = plan_once(problem)
            if problem.prefer_clearance > 0.0 and found.solved:
                found = with_preferred_clearance(problem, found)
        elif found is None:
            # Imported late: most plans have no constraints.
            from evenroad.planning.tip_motion import plan_constrained

            found = plan_constrained(problem, plan_once)
    except BudgetSpent:
        found = out_of_time(problem)
    result = finished(problem, found)
    if stopped:
        raise Interrupted(result)
    return result


def _as_planner(planner: object) -> Planner | Roadmap:
    """Return the planner, or the roadmap, that a value, a name or a file stands for."""
    if isinstance(planner, str) and (make := planner_of(planner)) is not None:
        return make()
    if isinstance(planner, str | os.PathLike):
        if isinstance(planner, str) and "." not in planner and not os.path.exists(planner):
            raise unknown_planner(planner)
        # Imported late: most plans read no roadmap.
        from evenroad.roadmap.npz import load_roadmap

        return load_roadmap(planner)
    # Imported late: most plans need neither.
    from evenroad.planning.planners.prm import PRM
    from evenroad.roadmap.roadmap import Roadmap

    if isinstance(planner, PointSet):
        return PRM(planner)
    if not isinstance(planner, Planner | Roadmap):
        raise InvalidValue(
            f"planner must be a planner, such as er.RRTConnect(), er.PRM(512) or a roadmap, got {shown(planner)}"
        )
    return planner


def _within(planner: Planner | Roadmap, world: World) -> Planner:
    """Return the planner in a world: a roadmap within it."""
    from evenroad.planning.world_roadmap import WorldRoadmap
    from evenroad.roadmap.roadmap import Roadmap

    if is_directed(world.space) and not getattr(planner, "is_directed", False):
        raise InvalidValue(
            "only CarSearch plans for a car that drives only forwards, and only FlightSearch for what flies, got"
            f" {shown(planner)}"
        )
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
