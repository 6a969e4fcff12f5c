"""What queries of a robot's roadmap cost where meshes are the checker, beside trees with the same checker.

    python -m benchmarks.roadmap_meshes                       # extras [mesh] and [ompl]
    python -m benchmarks.roadmap_meshes --triangles           # our own compiled triangles as obstacles

The UR5's links are meshes, 24 corners around each capsule, inside of it; so are the obstacles.  `coal` asks coal about
every state; `capsules, then coal` asks coal only about motions that are not proved free for the capsules.  Trees are
OMPL's RRT-Connect through ``evenroad.adapters.ompl``, with the range of ours; with --triangles they are ours.  Both
paths are shortened by our compiled shortener, equally much.  Scenes and queries come from the seeds kept for reporting;
times are of the processor, the first nine queries of a scene are left out.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from tests_peers.engines.surface import shape_surface

from benchmarks.arm_problems import REPORTING, Pool, arm, problems, queries
from benchmarks.clouds import triangles_of
from benchmarks.robot_roadmap_queries import QuickWorld, ratio_of_tails
from benchmarks.robot_roadmaps import table_of
from evenroad.geometry import Mesh
from evenroad.geometry.shapes import Shape, along_z
from evenroad.roadmap import Budget
from evenroad.roadmap.find_path import find_path
from evenroad.robot import ArmWorld, Obstacle, Robot, Scene
from evenroad.robot.reference.coal_world import CoalWorld
from evenroad.robot.trees import shorten
from evenroad.robot_roadmap.make import make_roadmap
from evenroad.robot_roadmap.own_shapes import OwnShapesWorld
from evenroad.robot_roadmap.robot_roadmap import RobotRoadmap
from evenroad.robot_roadmap.scene_roadmap import CUTS, PAIRS, SceneRoadmap
from evenroad.space.path import path_length

FIRST = 9
"""So many queries in a scene come before those that count."""

STEP = 1.5
"""Range of the trees [rad]: that of our compiled ones for the UR5."""

SECONDS = 20.0
Row = tuple[float, float, float]
Query = Callable[[np.ndarray, np.ndarray], Row | None]


class OnlyCoal:
    """Coal alone, in the place of an arm's world."""

    backend, proof = "coal", "resolution"

    def __init__(self, world: ArmWorld, shapes: list[Shape]) -> None:
        self._world = CoalWorld(world.robot, world.scene, shapes, world.resolution)
        self.shorten = world.shorten
        self.space, self.valid = self._world.space, self._world.valid
        self.motions = 0

    def motion_valid(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Return which motions are free, (m,)."""
        self.motions += len(a)
        return self._world.motion_valid(a, b)

    def motion_certified(self, a: np.ndarray, b: np.ndarray, tolerance: float) -> np.ndarray:
        """Return which motions are free, (m,)."""
        return self.motion_valid(a, b)


class CapsulesFirst(OwnShapesWorld):
    """The checker of the library, counted."""

    def motion_certified(self, a: np.ndarray, b: np.ndarray, tolerance: float) -> np.ndarray:
        """Return which motions are free, (m,)."""
        object.__setattr__(self, "motions", getattr(self, "motions", 0) + len(a))
        return super().motion_certified(a, b, tolerance)


def meshes_of(robot: Robot) -> list[Shape]:
    """Return the links' capsules as triangles."""
    return [Mesh(shape_surface(along_z(capsule)), link=capsule.link) for capsule in robot.capsules]


def with_triangles(scene: Scene, halvings: int = 0) -> Scene:
    """Return a scene whose boxes and cylinders are triangles."""

    def as_mesh(obstacle: Obstacle) -> Obstacle:
        if halvings and obstacle.shape == "box":
            return replace(obstacle, body=Mesh(triangles_of(obstacle, halvings)))
        return replace(obstacle, body=Mesh(shape_surface(obstacle.body)))

    return replace(scene, obstacles=tuple(map(as_mesh, scene.obstacles)))


def by_trees(world: ArmWorld, checks: OnlyCoal | CapsulesFirst) -> Query:
    """Return what asks OMPL's trees with a checker, then our shortener."""
    from ompl import geometric as og
    from ompl import util as ou

    from evenroad.adapters.ompl import solve, space_information

    ou.setLogLevel(ou.LogLevel.LOG_NONE)

    def ask(start: np.ndarray, goal: np.ndarray) -> Row | None:
        before = getattr(checks, "motions", 0)
        began = time.thread_time()
        planner = og.RRTConnect(space_information(checks))  # type: ignore[arg-type]
        planner.setRange(STEP)
        path = solve(planner, start, goal, SECONDS)
        if path is None:
            return None
        path, _ = shorten(world, path, pairs=PAIRS, cuts=CUTS)
        seconds = time.thread_time() - began
        return seconds, getattr(checks, "motions", 0) - before, path_length(path, world.space)

    return ask


def along(known: SceneRoadmap, counted: Callable[[], int]) -> Query:
    """Return what asks a kept roadmap."""

    def ask(start: np.ndarray, goal: np.ndarray) -> Row | None:
        before, began = counted(), time.thread_time()
        result = known.plan(start, goal, budget=Budget(seconds=SECONDS))
        seconds = time.thread_time() - began
        return (seconds, counted() - before, result.cost) if result.solved else None

    return ask


CHECKERS = {"coal": OnlyCoal, "capsules-coal": CapsulesFirst}


def by_coal(
    made: RobotRoadmap, world: ArmWorld, shapes: list[Shape], titles: tuple[str, ...]
) -> dict[str, tuple[Query, Query]]:
    """Return trees and the roadmap for some checkers."""
    pairs = {}
    for title in titles:
        kind = CHECKERS[title]
        known = SceneRoadmap(made, world.scene)
        whole, day = kind(known.world, shapes), kind(known._day, shapes)
        known._asked = whole, day  # type: ignore[assignment]

        def counted(whole: object = whole, day: object = day) -> int:
            return getattr(whole, "motions", 0) + getattr(day, "motions", 0)

        pairs[title] = by_trees(world, kind(world, shapes)), along(known, counted)
    return pairs


def by_triangles(made: RobotRoadmap, world: ArmWorld) -> dict[str, tuple[Query, Query]]:
    """Return our trees, shortened as much as the roadmap's paths, and the roadmap; both compiled."""
    quick = QuickWorld(world.robot, world.scene)

    def trees(start: np.ndarray, goal: np.ndarray) -> Row | None:
        began = time.thread_time()
        result = find_path(quick, start, goal, budget=Budget(seconds=SECONDS))
        seconds = time.thread_time() - began
        return (seconds, result.counts["edges_checked"], result.cost) if result.solved else None

    return {"our triangles": (trees, along(SceneRoadmap(made, world.scene), lambda: 0))}


def main() -> None:
    """Measure."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--triangles", action="store_true")
    parser.add_argument("--queries", type=int, default=40, help="in each scene")
    parser.add_argument("--scenes", type=int, default=2, help="of each kind")
    parser.add_argument("-n", type=int, default=1024, help="milestones")
    parser.add_argument("--checkers", nargs="+", default=[*CHECKERS], choices=CHECKERS)
    parser.add_argument("--kinds", nargs="+", default=["table", "box", "shelf"])
    options = parser.parse_args()
    pool = Pool(arm("ur5"))
    made = make_roadmap(pool.robot, table_of(next(problems(pool, REPORTING))), options.n)
    shapes = meshes_of(pool.robot)
    print("| kind | checker | queries | trees ms | roadmap ms | medians | means | 95 % | motions | length |")
    print("|---|---|---|" + "---|" * 7, flush=True)
    for kind in options.kinds:
        rows: dict[str, list[tuple[Row, Row, bool]]] = {}
        lost: dict[str, int] = {}
        for seed in REPORTING[: options.scenes]:
            world, pairs = queries(pool, kind, seed, options.queries)
            # The table is the cell's, and stays a box.
            table, *things = world.scene.obstacles
            day = with_triangles(replace(world.scene, obstacles=tuple(things)), 3 if options.triangles else 0)
            world = ArmWorld(world.robot, replace(day, obstacles=(table, *day.obstacles)))
            how = () if options.triangles else tuple(options.checkers)
            calls = by_coal(made, world, shapes, how) or by_triangles(made, world)
            for number, (start, goal) in enumerate(pairs):
                for title, (trees, roadmap) in calls.items():
                    one, other = trees(start, goal), roadmap(start, goal)
                    if one is None or other is None:
                        lost[title] = lost.get(title, 0) + 1
                    elif number >= FIRST:
                        least = path_length(np.array([start, goal]), world.space)
                        rows.setdefault(title, []).append((one, other, bool(np.isclose(other[2], least))))
        for title, values in rows.items():
            measured = np.array([[one, other] for one, other, _ in values])
            straight = np.array([each for _, _, each in values])
            for what, some in (("all", measured), ("not straight", measured[~straight])):
                print(f"| {kind} | {title} | {what}, {len(some)} | {_figures(some)} |", flush=True)
            print(f"{kind}, {title}: {lost.get(title, 0)} not solved by one", flush=True)


def _figures(table: np.ndarray) -> str:
    """Return the cells of a row of the table."""
    trees, roadmap = table[:, 0, 0], table[:, 1, 0]
    cells = [f"{1e3 * np.median(trees):.3g} | {1e3 * np.median(roadmap):.3g}"]
    cells += [_interval(of, roadmap, trees) for of in (np.median, np.mean)]
    cells += ["{:.2f} ({:.2f} .. {:.2f})".format(*ratio_of_tails(roadmap, trees))]
    cells += [f"{table[:, 0, 1].mean():.0f}, {table[:, 1, 1].mean():.0f}"]
    return " | ".join([*cells, f"{np.mean(table[:, 1, 2] / table[:, 0, 2]):.3f}"])


def _interval(of: Callable[[np.ndarray], float], a: np.ndarray, b: np.ndarray) -> str:
    """Return the ratio of a quantity of two paired samples, and its 95 % interval by bootstrap."""
    rng = np.random.default_rng(0)
    rows = rng.integers(len(a), size=(2000, len(a)))
    low, high = np.quantile([of(a[r]) / of(b[r]) for r in rows], [0.025, 0.975])
    return f"{of(a) / of(b):.2f} ({low:.2f} .. {high:.2f})"


if __name__ == "__main__":
    main()
