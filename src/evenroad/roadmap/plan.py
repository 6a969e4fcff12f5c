"""ps-PRM: plan on a roadmap of points that were drawn beforehand (Chahine et al. 2025, Algorithm 1)."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue
from evenroad.points.pointset import PointSet
from evenroad.roadmap.result import PlanResult, Roadmap, Status
from evenroad.roadmap.rules import KNearest, Rule
from evenroad.roadmap.search import pieces, shortest_path
from evenroad.roadmap.shortcut import path_length, shortcut
from evenroad.roadmap.stopwatch import Stopwatch
from evenroad.world import Explains, World


def plan(
    world: World,
    start: npt.ArrayLike,
    goal: npt.ArrayLike,
    points: PointSet,
    *,
    rule: Rule | None = None,
    shorten: bool = True,
) -> PlanResult:
    """Find a short free path from start to goal over the given points.

    Parameters
    ----------
    world : World
        Says which configurations and motions are free, and in which space.
    start, goal : array_like, shape (dim,)
        Configurations, in the units of the space.
    points : PointSet
        Points of the unit cube; the space maps them to configurations.
    rule : Rule, optional
        Which pairs to try; default ``KNearest(10)``.
    shorten : bool
        Also shortcut the path (the raw one is kept).

    Returns
    -------
    PlanResult
        Also when there is no path: the status and the message then say why.

    Raises
    ------
    InvalidValue
        If start, goal or points do not have the dimension of the space, or are not finite.
    """
    rule = KNearest() if rule is None else rule
    ends = _ends(start, goal, points, world.space.dim)
    answer: dict[str, Any] = dict(start=ends[0], goal=ends[1], origin=points.origin, rule=str(rule))
    watch = Stopwatch()

    with watch("validity"):
        free_ends = world.valid(ends)
        if not free_ends.all():
            return PlanResult(**_end_in_collision(free_ends, ends, world), **answer, seconds=watch.seconds)
        samples = world.space.from_cube(points.points)
        milestones = samples[world.valid(samples)]
    configurations = np.concatenate([milestones, ends])
    start_node, goal_node = len(milestones), len(milestones) + 1
    with watch("neighbours"):
        edges = rule.edges(configurations, world.space, ends=2)
    with watch("motions"):
        free = edges[world.motion_valid(configurations[edges[:, 0]], configurations[edges[:, 1]])]
    with watch("search"):
        lengths = world.space.distance(configurations[free[:, 0]], configurations[free[:, 1]])
        to_goal = world.space.distance(configurations, np.broadcast_to(ends[1], configurations.shape))
        way, cost = shortest_path(len(configurations), free, lengths, to_goal, start_node, goal_node)

    counts = dict(points=points.n, valid=len(milestones), edges_checked=len(edges), edges_free=len(free))
    answer |= dict(counts=counts, seconds=watch.seconds, roadmap=Roadmap(configurations, free))
    if not way.size:
        return PlanResult(**_not_connected(configurations, free, counts, rule), **answer)
    path = milestone_path = configurations[way]
    if shorten:
        with watch("shortcut"):
            path, counts["shortcut_motions"] = shortcut(milestone_path, world)
    length = path_length(path, world.space)
    message = f"path of length {length:.6g} with {len(path)} waypoints"
    answer |= dict(path=path, milestone_path=milestone_path, cost=length, milestone_cost=cost)
    return PlanResult(status=Status.SOLVED, message=message, **answer)


def _ends(start: npt.ArrayLike, goal: npt.ArrayLike, points: PointSet, dim: int) -> npt.NDArray[np.float64]:
    """Return start and goal as two rows, checked together with the dimension of the points."""
    if points.d != dim:
        raise InvalidValue(f"the points have d={points.d}, the space has {dim} dimensions")
    rows = []
    for name, value in (("start", start), ("goal", goal)):
        try:
            row = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            row = np.empty(0)
        if row.shape != (dim,) or not np.isfinite(row).all():
            raise InvalidValue(f"{name} must be {dim} finite numbers, got {value!r}")
        rows.append(row)
    return np.stack(rows)


def _end_in_collision(
    free: npt.NDArray[np.bool_], ends: npt.NDArray[np.float64], world: World
) -> dict[str, Any]:
    end, name, status = (1, "goal", Status.GOAL_INVALID) if free[0] else (0, "start", Status.START_INVALID)
    reason = f": {world.explain(ends[end])}" if isinstance(world, Explains) else ""
    return {"status": status, "message": f"the {name} is in collision{reason}"}


def _not_connected(
    configurations: npt.NDArray[np.float64],
    edges: npt.NDArray[np.int32],
    counts: dict[str, int],
    rule: Rule,
) -> dict[str, Any]:
    label = pieces(len(configurations), edges)
    for end, name in ((-2, "start_piece"), (-1, "goal_piece")):
        counts[name] = int(np.count_nonzero(label[:-2] == label[end]))
    message = (
        f"start reaches {counts['start_piece']} and goal {counts['goal_piece']} of {counts['valid']} valid"
        f" milestones, and the two pieces do not meet (n={counts['points']}, {rule}): try n={2 * counts['points']}"
        " or a larger k"
    )
    return dict(status=Status.NOT_CONNECTED, message=message)
