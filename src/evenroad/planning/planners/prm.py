"""PRM and FMT: planners on points that were drawn beforehand (ps-PRM, Chahine et al. 2025; Janson et al. 2015)."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, replace
from typing import ClassVar

from evenroad._call import explains_calls
from evenroad._checks import require_count, require_known
from evenroad.errors import InvalidValue
from evenroad.planning.answer import answer, in_its_time
from evenroad.planning.attempt import Attempt
from evenroad.planning.connectors import connector_of
from evenroad.planning.problem import Problem
from evenroad.planning.refusal import refusal
from evenroad.planning.result import PlanResult, Status
from evenroad.points.pointset import PointSet
from evenroad.roadmap.edges import LINKS, EdgeCost, require_links
from evenroad.roadmap.points_of import as_points
from evenroad.roadmap.rules import KNearest, Rule, default_rule
from evenroad.roadmap.search import FINDERS, FREE, Finder, find_any, march
from evenroad.space import Space


@dataclass(frozen=True, repr=False)
class OnPoints:
    """Base of :class:`PRM` and :class:`FMT`: the points, the pairs of them to try, and the costs of motions."""

    seconds: ClassVar[float] = 60.0

    points: PointSet | int = 512
    _: KW_ONLY
    k: int | None = None
    rule: Rule | None = None
    edge_cost: EdgeCost | None = None
    links: int | None = LINKS

    def __post_init__(self) -> None:
        require_links(self.links)
        if self.k is not None:
            require_count("k", self.k)
            if self.rule is not None:
                raise InvalidValue("give k or rule, not both")

    def __repr__(self) -> str:
        points, rule = self.points, self.rule if self.k is None else f"k={self.k}"
        what = f"{points.n} points" if isinstance(points, PointSet) else str(points)
        return f"{type(self).__name__}({what}{'' if rule is None else f', {rule}'})"


@explains_calls
@dataclass(frozen=True, repr=False)
class PRM(OnPoints):
    """A roadmap on points that are drawn beforehand: Algorithm 1 of Chahine et al. (2025).

    Parameters
    ----------
    points : int or PointSet
        Points of the unit cube, or a number of even ones to draw; the space maps them to configurations.
    k : int, optional
        Number of nearest milestones that each is joined to, symmetrised; instead of `rule`.
    rule : Rule, optional
        The rule that chooses pairs of milestones.  Default: that of :func:`evenroad.roadmap.default_rule`.
    search : {"lazy", "full"}
        Check only the edges that could lie on the shortest path, or every edge before the search.  Both find the same
        path, bit for bit.
    success_only : bool
        Stop at any path; the one returned is not the shortest.
    edge_cost : callable, optional
        Costs of the motions between the rows of two (m, dim) arrays, at least their lengths.  Default: the lengths.
    links : int or None
        Number of nearest milestones that start and goals are linked to, besides those of the rule.  A roadmap of up to
        256 milestones is linked to all.  None: only those of the rule, as in published protocols.
    certify : bool
        Add a :class:`evenroad.roadmap.Certificate` to the result.  It bounds how much longer than the best path this
        one can be, and the clearance of a path that may have been missed.

    Raises
    ------
    InvalidValue
        If both `k` and `rule` are given, points have another dimension than the space, an edge costs less than its
        length, or `certify` is given with `edge_cost` or `success_only`.
    NotAvailable
        With `certify` if the metric is not flat.
    UnknownName
        If there is no such search.

    Examples
    --------
    >>> import numpy as np
    >>> import evenroad as er
    >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
    >>> er.plan(world, (3, 3), (27, 17), er.PRM(64)).status
    <Status.SOLVED: 'solved'>
    """

    _: KW_ONLY
    search: str = "lazy"
    success_only: bool = False
    certify: bool = False

    def __post_init__(self) -> None:
        require_known("search", self.search, FINDERS)
        super().__post_init__()
        if self.certify and (self.success_only or self.edge_cost is not None):
            raise InvalidValue("certify speaks of shortest paths: it goes without edge_cost and success_only")

    @in_its_time
    def solve(self, problem: Problem) -> PlanResult:
        """Return the shortest path along the roadmap, smoothed; see :class:`PRM`."""
        name, find = ("any", find_any) if self.success_only else (self.search, FINDERS[self.search])
        return _on_points(self, problem, f"prm {name}", find)


@explains_calls
@dataclass(frozen=True, repr=False)
class FMT(OnPoints):
    """A tree over points that grows outwards in the order of cost: FMT* (Janson et al. 2015).

    Each milestone is joined to the tree by the neighbour that would be best without obstacles, and only that motion
    is checked.  The tree is then nearly the shortest one, for about one check per milestone.  It can miss a path
    that :class:`PRM` finds with the same points.  Without a path, the count ``start_component`` is the size of the
    tree.  Errors are those of :class:`PRM`.

    Parameters
    ----------
    points, k, rule, edge_cost, links
        As in :class:`PRM`.

    Examples
    --------
    >>> import numpy as np
    >>> import evenroad as er
    >>> world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
    >>> er.plan(world, (3, 3), (27, 17), er.FMT(64)).planner
    'fmt*'
    """

    certify: ClassVar[bool] = False

    points: PointSet | int = 1024

    @in_its_time
    def solve(self, problem: Problem) -> PlanResult:
        """Return the path along the tree, smoothed; see :class:`FMT`."""
        return _on_points(self, problem, "fmt*", march)


def rule_of(planner: OnPoints, space: Space) -> Rule:
    """Return the connection rule of a planner in a space."""
    if planner.rule is not None:
        return planner.rule
    return default_rule(space) if planner.k is None else KNearest(planner.k)


def _on_points(planner: PRM | FMT, problem: Problem, name: str, find: Finder) -> PlanResult:
    """Map the points into the space, join them by the rule, and find a path along the free motions."""
    world = problem.world
    # A given rule decides which points are drawn.
    given = rule_of(planner, world.space) if planner.rule is not None or planner.k is not None else None
    points = as_points(planner.points, world.space, given, rng=problem.rng)
    rule = default_rule(world.space) if given is None else given
    connector, origin = connector_of(world), points.origin
    attempt = Attempt(problem, name, origin, str(rule), connector, planner.edge_cost, planner.links)
    if (refused := refusal(attempt)) is not None:
        return refused
    milestones = world.space.from_cube(points.points)
    milestones = milestones[attempt.valid(milestones)]
    states = attempt.candidates(rule, milestones)
    states.node_states[:] = FREE
    certificate = None
    if planner.certify:
        terminals = 1 + len(attempt.goals)
        # Imported late: few plans have a certificate.
        from evenroad.roadmap.certify import certify_graph

        certificate = certify_graph(points, world.space, states.configurations, states.edges, terminals)
    result = answer(attempt, attempt.search(find, states), points.n)
    if certificate is not None and result.status in (Status.SOLVED, Status.NOT_CONNECTED):
        message = result.message
        if not result.solved and certificate.complete:
            message += f"; certified: no path has a clearance of {certificate.dispersion:.6g}"
        result = replace(result, certificate=certificate, message=message)
    return result
