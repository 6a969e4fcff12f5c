"""What queries of a robot's roadmap cost where meshes are the checker, beside trees with the same checker.

    python -m benchmarks.roadmap_meshes                       # extras [mesh] and [ompl]
    python -m benchmarks.roadmap_meshes --triangles           # our own compiled triangles as obstacles, core alone

The UR5's links are meshes, 24 corners around each capsule, inside of it; so are the obstacles.  `coal` asks coal about
every state, of trees and roadmap; `shapes` is what ``in_scene(scene, shapes)`` does, where coal is asked what the
capsules do not tell; with `--thicker 0.01` these are so many metres thicker than the meshes, which the queries are free
for.  Trees are OMPL's RRT-Connect through ``evenroad.adapters.ompl``, with the range of ours and the same checker, and
both paths are drawn tight by our compiled shortener, equally much; with --triangles they are ours, as `plan` grows
them.
Scenes and queries come from the seeds kept for reporting; times are of the processor, the first nine queries of a scene
are left out.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from tests_peers.engines.surface import shape_surface

from benchmarks.arm_problems import REPORTING, TUNING, Pool, arm, problems, queries
from benchmarks.clouds import triangles_of
from benchmarks.robot_roadmap_queries import COPIES, TightWorld, in_new_scene, ratio_of_tails, timed
from benchmarks.robot_roadmaps import table_of
from evenroad.geometry import Mesh
from evenroad.geometry.shapes import Shape, along_z
from evenroad.roadmap import Budget, PlanResult
from evenroad.roadmap.find_path import find_path
from evenroad.robot import ArmWorld, Obstacle, Robot, Scene
from evenroad.robot.reference.coal_world import CoalWorld
from evenroad.robot.trees import tighten
from evenroad.robot_roadmap.make import make_roadmap
from evenroad.robot_roadmap.own_shapes import OwnShapesWorld, SolidMeshes
from evenroad.robot_roadmap.robot_roadmap import RobotRoadmap
from evenroad.robot_roadmap.scene_roadmap import DEAR_WORK, SceneRoadmap
from evenroad.space.path import path_length

FIRST = 9
"""So many queries in a scene come before those that count."""

STEP = 1.5
"""Range of the trees [rad]: that of our compiled ones for the UR5."""

SECONDS = 20.0
Row = tuple[float, float, float]
Query = Callable[[np.ndarray, np.ndarray], Row]
"""From start and goal to seconds, states that coal was asked about, and the length of the path or nan."""


class Counted(CoalWorld):
    """Coal alone, which counts the states that it is asked about; of all worlds together."""

    states = 0

    def _free(self, q: np.ndarray) -> np.ndarray:
        Counted.states += len(q)
        return super()._free(q)


class OnlyCoal:
    """Coal alone, in the place of an arm's world."""

    backend, proof = "coal", "resolution"

    def __init__(self, world: ArmWorld, shapes: list[Shape]) -> None:
        self._world = Counted(world.robot, world.scene, shapes, world.resolution)
        self.shorten, self.explain = world.shorten, world.explain
        self.space, self.valid = self._world.space, self._world.valid
        self.motion_valid = self._world.motion_valid

    def motion_certified(self, a: np.ndarray, b: np.ndarray, tolerance: float) -> np.ndarray:
        """Return which motions are free, (m,)."""
        return self.motion_valid(a, b)


def count_states() -> None:
    """Make coal count what the library's checker asks it, too."""
    asked = SolidMeshes._free

    def _free(self: SolidMeshes, q: np.ndarray) -> np.ndarray:
        Counted.states += len(q)
        return asked(self, q)

    SolidMeshes._free = _free  # type: ignore[method-assign]


def thicker(robot: Robot, by: float) -> Robot:
    """Return a robot with thicker capsules, without the pairs that then always touch [m]."""
    capsules = tuple(replace(each, radius=each.radius + by) for each in robot.capsules)
    robot = replace(robot, capsules=capsules)
    q = ArmWorld(robot, Scene("nothing", ())).space.from_cube(np.random.default_rng(0).random((2000, 6)))

    def parts(pair: tuple[str, str]) -> bool:
        return bool(ArmWorld(replace(robot, pairs=(pair,)), Scene("nothing", ())).valid(q).any())

    return replace(robot, pairs=tuple(filter(parts, robot.pairs)))


def meshes_of(robot: Robot) -> list[Shape]:
    """Return the links' capsules as triangles."""
    return [Mesh(shape_surface(along_z(capsule)), link=capsule.link) for capsule in robot.capsules]


def of_meshes(scene: Scene, halvings: int = 0) -> Scene:
    """Return a scene in which all is triangles but the table, which is the cell's."""
    table, *things = scene.obstacles
    day = with_triangles(replace(scene, obstacles=tuple(things)), halvings)
    return replace(day, obstacles=(table, *day.obstacles))


def with_triangles(scene: Scene, halvings: int = 0) -> Scene:
    """Return a scene whose boxes and cylinders are triangles."""

    def as_mesh(obstacle: Obstacle) -> Obstacle:
        if halvings and obstacle.shape == "box":
            return replace(obstacle, body=Mesh(triangles_of(obstacle, halvings)))
        return replace(obstacle, body=Mesh(shape_surface(obstacle.body)))

    return replace(scene, obstacles=tuple(map(as_mesh, scene.obstacles)))


def by_trees(world: ArmWorld, checks: OnlyCoal | OwnShapesWorld) -> Query:
    """Return what asks OMPL's trees with a checker, then our shortener."""
    from ompl import geometric as og
    from ompl import util as ou

    from evenroad.adapters.ompl import solve, space_information

    ou.setLogLevel(ou.LogLevel.LOG_NONE)

    def ask(start: np.ndarray, goal: np.ndarray) -> Row:
        before, began = Counted.states, time.thread_time()
        planner = og.RRTConnect(space_information(checks))  # type: ignore[arg-type]
        planner.setRange(STEP)
        path = solve(planner, start, goal, SECONDS)
        length = np.nan
        if path is not None:
            path, _ = tighten(world, path, batches=DEAR_WORK)
            length = path_length(path, world.space)
        return time.thread_time() - began, Counted.states - before, length

    return ask


def along(known: SceneRoadmap) -> Query:
    """Return what asks a kept roadmap."""

    def ask(start: np.ndarray, goal: np.ndarray) -> Row:
        before, began = Counted.states, time.thread_time()
        result = known.plan(start, goal, budget=Budget(seconds=SECONDS))
        seconds = time.thread_time() - began
        return seconds, Counted.states - before, result.cost if result.solved else np.nan

    return ask


def by_coal(
    made: RobotRoadmap, world: ArmWorld, shapes: list[Shape], titles: tuple[str, ...]
) -> dict[str, tuple[Query, Query]]:
    """Return trees and the roadmap for some checkers."""
    pairs = {}
    if "coal" in titles:
        known = SceneRoadmap(made, world.scene)
        known._asked = OnlyCoal(known.world, shapes), OnlyCoal(known._day, shapes)  # type: ignore[assignment]
        pairs["coal"] = by_trees(world, OnlyCoal(world, shapes)), along(known)
    if "shapes" in titles:
        own = by_trees(world, OwnShapesWorld(world, shapes))
        pairs["shapes"] = own, along(SceneRoadmap(made, world.scene, shapes=shapes))
    return pairs


def among_triangles(pool: Pool, made: RobotRoadmap, seeds: range, options: argparse.Namespace) -> None:
    """Print what queries among obstacles of triangles cost, checked in compiled code; the best of three each."""
    print(
        "| kind | triangles | planner | median ms | mean ms | mean / trees | 95 % / trees | motions | length |"
    )
    print("|---|---|---|" + "---|" * 6, flush=True)
    budget = Budget(seconds=1.0)
    for kind in options.kinds:
        rows: dict[str, list[Row]] = {}
        sizes, made_in, lost = [], [], 0
        for seed in seeds[: options.scenes]:
            world, pairs = queries(pool, kind, seed, options.queries)
            scene, began = of_meshes(world.scene, options.halvings), time.thread_time()
            world = ArmWorld(pool.robot, scene)
            made_in.append(time.thread_time() - began)
            bodies = [obstacle.body for obstacle in world.scene.obstacles]
            sizes.append(sum(len(body.triangles.triangles) for body in bodies if isinstance(body, Mesh)))
            alone, tight = (
                [world_of(world.robot, world.scene) for _ in range(COPIES)]
                for world_of in (ArmWorld, TightWorld)
            )
            copies = [SceneRoadmap(made, world.scene) for _ in range(COPIES)]
            for number, (start, goal) in enumerate(pairs):
                ends = partial(find_path, start=start, goal=goal, budget=budget)
                calls: dict[str, list[Callable[[], PlanResult]]] = {
                    "trees": [partial(ends, w) for w in alone],
                    "trees, drawn tight": [partial(ends, w) for w in tight],
                    "roadmap, kept scene": [partial(k.plan, start, goal, budget=budget) for k in copies],
                    "roadmap, new scene": [partial(in_new_scene, made, world.scene, start, goal)] * COPIES,
                }
                answers = {title: timed(some) for title, some in calls.items()}
                solved = all(result.solved for _, result in answers.values())
                lost += not solved
                if number < FIRST or np.allclose(start, goal) or not solved:
                    continue
                for title, (seconds, result) in answers.items():
                    motions = sum(result.counts.get(c, 0) for c in ("edges_checked", "shortcut_motions"))
                    rows.setdefault(title, []).append((seconds, motions, result.cost or 0.0))
        print(
            f"{kind}: grids and trees of a new scene's meshes take {1e3 * np.median(made_in):.0f} ms; {lost} unsolved",
            file=sys.stderr,
        )
        trees = np.array(rows["trees"])
        for title, values in rows.items():
            table = np.array(values)
            seconds, motions, costs = table.T
            tails = "{:.2f} ({:.2f} .. {:.2f})".format(*ratio_of_tails(seconds, trees[:, 0]))
            print(
                f"| {kind}, {len(table)} | {np.mean(sizes):.0f} | {title} | {1e3 * np.median(seconds):.3f} |"
                f" {1e3 * seconds.mean():.3f} | {_interval(np.mean, seconds, trees[:, 0])} | {tails} |"
                f" {motions.mean():.0f} | {costs.sum() / trees[:, 2].sum():.3f} |",
                flush=True,
            )


def main() -> None:
    """Measure."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--triangles", action="store_true")
    parser.add_argument("--halvings", type=int, default=3, help="of the sides of these triangles")
    parser.add_argument("--thicker", type=float, default=0.0, help="capsules than meshes [m]")
    parser.add_argument("--tuning", action="store_true", help="the seeds that constants were chosen on")
    parser.add_argument("--queries", type=int, default=100, help="in each scene")
    parser.add_argument("--scenes", type=int, default=2, help="of each kind")
    parser.add_argument("--minutes", type=float, default=np.inf, help="after which a scene's next is begun")
    parser.add_argument("-n", type=int, default=1024, help="milestones")
    parser.add_argument("--checkers", nargs="+", default=["coal", "shapes"], choices=["coal", "shapes"])
    parser.add_argument("--kinds", nargs="+", default=["table", "box", "shelf"])
    options = parser.parse_args()
    count_states()
    seeds = TUNING if options.tuning else REPORTING
    pool = Pool(arm("ur5"))
    robot = thicker(pool.robot, options.thicker) if options.thicker else pool.robot
    made = make_roadmap(robot, table_of(next(problems(pool, seeds))), options.n)
    if options.triangles:
        among_triangles(pool, made, seeds, options)
        return
    shapes = meshes_of(pool.robot)
    print(
        "| kind | checker | queries | trees ms | roadmap ms | medians | means | 95 % | states | length | not solved |"
    )
    print("|---|---|---|" + "---|" * 8, flush=True)
    for kind in options.kinds:
        rows: dict[str, list[tuple[Row, Row, bool]]] = {}
        for seed in seeds[: options.scenes]:
            world, pairs = queries(pool, kind, seed, options.queries)
            world = ArmWorld(robot, of_meshes(world.scene))
            calls = by_coal(made, world, shapes, tuple(options.checkers))
            until = time.monotonic() + 60.0 * options.minutes
            for number, (start, goal) in enumerate(pairs):
                if time.monotonic() > until:
                    break
                least = path_length(np.array([start, goal]), world.space)
                for title, (trees, roadmap) in calls.items():
                    one, other = trees(start, goal), roadmap(start, goal)
                    if number >= FIRST and least > 0.0:
                        straight = bool(np.isclose(other[2], least))
                        rows.setdefault(title, []).append((one, other, straight))
        for title, values in rows.items():
            measured = np.array([[one, other] for one, other, _ in values])
            straight = np.array([each for _, _, each in values])
            for what, some in (("all", measured), ("not straight", measured[~straight])):
                print(f"| {kind} | {title} | {what}, {len(some)} | {_figures(some)} |", flush=True)


def _figures(table: np.ndarray) -> str:
    """Return the cells of a row of the table."""
    trees, roadmap = table[:, 0, 0], table[:, 1, 0]
    cells = [f"{1e3 * np.median(trees):.3g} | {1e3 * np.median(roadmap):.3g}"]
    cells += [_interval(of, roadmap, trees) for of in (np.median, np.mean)]
    cells += ["{:.2f} ({:.2f} .. {:.2f})".format(*ratio_of_tails(roadmap, trees))]
    cells += [f"{table[:, 0, 1].mean():.0f}, {table[:, 1, 1].mean():.0f}"]
    lost = np.isnan(table[:, :, 2]).sum(axis=0)
    return " | ".join([*cells, f"{np.nanmean(table[:, 1, 2] / table[:, 0, 2]):.3f}", f"{lost[0]}, {lost[1]}"])


def _interval(of: Callable[[np.ndarray], float], a: np.ndarray, b: np.ndarray) -> str:
    """Return the ratio of a quantity of two paired samples, and its 95 % interval by bootstrap."""
    rng = np.random.default_rng(0)
    rows = rng.integers(len(a), size=(2000, len(a)))
    low, high = np.quantile([of(a[r]) / of(b[r]) for r in rows], [0.025, 0.975])
    return f"{of(a) / of(b):.2f} ({low:.2f} .. {high:.2f})"


if __name__ == "__main__":
    main()
