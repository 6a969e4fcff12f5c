"""ArmUpdates: the path of an arm to its goal that is updated as the arm and the obstacles move."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from time import perf_counter as now

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import counted
from evenroad._native.planning import Drivers, Points, answer, shorten
from evenroad._rng import RngLike, variant_of
from evenroad._shared import once
from evenroad.collision.arm_world import VALIDATION_TOLERANCE, ArmWorld
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Pose
from evenroad.planning.arm_trees import checks_of
from evenroad.planning.attempt import Attempt
from evenroad.planning.connectors import drivers_of
from evenroad.planning.make_result import make_result, solution, unreached
from evenroad.planning.problem import Problem
from evenroad.planning.read_problem import problem_in, reaching
from evenroad.planning.reading import Goal, Reading
from evenroad.planning.refusal import refusal
from evenroad.planning.result import PlanResult, Status
from evenroad.points.reversed_halton import PAIRS, share_pairs
from evenroad.robots.robot import ConfigurationLike
from evenroad.scenes.obstacle import Bodies
from evenroad.scenes.scene import Scene
from evenroad.scenes.states import as_configuration

VARIANTS = 8
"""Number of even sequences that updates without a path use in turn."""
SHORTCUTS = 8
"""Number of pairs of positions along a path that each update tries to join; the next update tries others."""


class ArmUpdates:
    """The path of an arm to its goal, and how it is updated: see :class:`evenroad.Replanner`."""

    def __init__(
        self,
        world: ArmWorld,
        goal: Goal | Sequence[Goal],
        motions: int,
        rng: RngLike,
        reading: Reading,
    ) -> None:
        self.world: ArmWorld = world
        self.path: Floats | None = None
        self._motions = motions
        middle = world.space.from_cube(np.full((1, world.dim), 0.5))[0]
        # Read in an empty scene, because a posture that is blocked now may be free at a later update.
        empty = replace(world.scene, obstacles=(), allowed=frozenset())
        self._problem = problem_in(world.within(empty), middle, goal, reading)
        variant = variant_of(rng)
        self._variant, self._drivers = variant, [drivers_of(world.dim, variant)]
        self._last: tuple[Floats, int] | None = None
        """The last path and the row of its goal. It is kept when blocked, because an obstacle may leave it again."""
        self._failures = self._cut = 0

    @property
    def goals(self) -> str:
        """The number of goals, in words."""
        return counted(len(self._problem.goals), "goal")

    def update(
        self,
        q: ConfigurationLike,
        scene: object,
        moved: Mapping[str, Pose] | None,
        added: Bodies,
        removed: str | Sequence[str],
    ) -> PlanResult:
        """Return the rest of the last path where it is free, else a new one; arguments as of `Replanner.update`."""
        if scene is not None and not isinstance(scene, Scene):
            raise InvalidValue(f"scene must be a Scene, got {shown(scene)}")
        began, world = now(), self.world if scene is None else replace(self.world, scene=scene)
        if removed:
            world = world.without(*([removed] if isinstance(removed, str) else removed))
        if added:
            world = world.with_(added)
        if moved is not None:
            world = world.moved(moved)
        start = as_configuration(world.robot, q, world.scene, name="q")
        self.world, self.path = reaching(world, start), None
        result = self._kept(start, began)
        result = self._planned(start, began) if result is None else result
        self.path = result.path
        return result

    def _kept(self, start: Floats, began: float) -> PlanResult | None:
        """Return the rest of the last path from the arm's configuration, shortened, or None if it is not free."""
        if self._last is None:
            return None
        path, goal = self._last
        for rest in paths_on(self.world, start, path):
            if self.world.checker.motion_valid(rest[:-1], rest[1:], VALIDATION_TOLERANCE).all():
                break
        else:
            return None
        rest, more = self._shortened(rest)
        return self._result(start, rest, goal, "kept", {"shortcut_motions": more}, began)

    def _shortened(self, path: Floats) -> tuple[Floats, int]:
        """Return a path that is not longer, and the number of motions checked; each update tries other shortcuts."""
        if len(path) == 2:
            return path, 0
        self._cut = (self._cut + 1) % len(_pairs())
        return shorten(checks_of(self.world), path, _pairs()[self._cut], SHORTCUTS)

    def _planned(self, start: Floats, began: float) -> PlanResult:
        """Return a new path from the arm's configuration to the nearest goal that was not tried just before."""
        world, problem = self.world, replace(self._problem, world=self.world, start=start)
        if (result := unreached(problem)) is not None:
            return result
        goals = problem.goals
        (free,) = np.nonzero(world.valid(goals))
        if not len(free) or not world.valid(start):
            found = refusal(Attempt(problem, "trees"))
            assert found is not None
            return found
        order = free[np.argsort(world.space.distance(np.broadcast_to(start, goals[free].shape), goals[free]))]
        goal = int(order[self._failures % len(order)])
        answered = answer(world.checker, start, goals[goal], self._driver(), self._motions, np.inf, "none")
        counts = dict(
            nodes=answered.nodes, configurations_checked=answered.configurations, edges_checked=answered.motions
        )
        if answered.ended != "solved":
            self._failures += 1
            message = f"no path within {answered.motions} motions; the next update grows other trees"
            timings = {"search": now() - began}
            return make_result(problem, Status.BUDGET_SPENT, message, planner="trees", counts=counts, timings=timings)
        self._failures = 0
        path, counts["shortcut_motions"] = self._shortened(answered.path)
        return self._result(start, path, goal, "trees", counts, began)

    def _driver(self) -> Drivers:
        """Return the sequences that drive this update's trees."""
        number = self._failures % VARIANTS
        while len(self._drivers) <= number:
            self._drivers.append(drivers_of(self.world.dim, self._variant + len(self._drivers)))
        return self._drivers[number]

    def _result(
        self, start: Floats, path: Floats, goal: int, planner: str, counts: dict[str, int], began: float
    ) -> PlanResult:
        """Return the result with a path that is proved."""
        self._last = path, goal
        path.setflags(write=False)
        problem = Problem(self.world, start, self._problem.goals)
        return solution(problem, path, goal, planner=planner, counts=counts, timings={"search": now() - began})


@once
def _pairs() -> tuple[Points, ...]:
    """Return the pairs of positions that updates try to join, a few for each."""
    pairs = share_pairs(PAIRS)
    return tuple(Points(pairs[i : i + SHORTCUTS]) for i in range(0, len(pairs), SHORTCUTS))


def paths_on(world: ArmWorld, q: Floats, path: Floats) -> list[Floats]:
    """Return paths from a configuration, (dim,), to the end of a path, (p, dim), best first.

    The first leads to the next waypoint.  If the configuration is beside the path, the second leads to the nearest
    position on the path before.
    """
    flat = world.space.flat
    a, along = path[:-1], flat.difference(path[:-1], path[1:])
    aside = flat.difference(a, np.broadcast_to(q, a.shape))
    squared = np.einsum("ij,ij->i", along, along)
    share = np.clip(np.einsum("ij,ij->i", aside, along) / np.where(squared > 0.0, squared, 1.0), 0.0, 1.0)
    away = np.linalg.norm(aside - share[:, np.newaxis] * along, axis=1)
    nearest = len(away) - 1 - int(np.argmin(away[::-1]))
    on = np.concatenate([q[np.newaxis], path[nearest + 1 :]])
    if away[nearest] <= 1e-9:
        return [on]
    beside = world.space.interpolate(path[nearest : nearest + 1], path[nearest + 1 : nearest + 2], share[nearest])
    return [on, np.concatenate([q[np.newaxis], beside, path[nearest + 1 :]])]
