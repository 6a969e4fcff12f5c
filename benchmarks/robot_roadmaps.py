"""How few milestones are enough: a roadmap made for one robot against points that know only the joint box.

    python -m benchmarks.robot_roadmaps --problems 40 --draws 2 --out docs/data/robot_roadmaps.csv
    python -m benchmarks.robot_roadmaps --table docs/data/robot_roadmaps.csv --picture docs/robot_roadmaps.png

Problems of four kinds, from the seeds kept for reporting; only those count whose straight motion is not free.  No
trees, k = 10, and a path counts only where the check of all its motions, made anew, proves them free.  Methods:

* ``box, ends k``: scrambled Sobol (Owen) points of the joint box; start and goal linked to as many as milestones are.
* ``box``: the same, start and goal linked to 100, up to 256 points to all; so they are in what follows.
* ``control``: the first Owen points that are free of robot and cell, the roadmap's metric, motions checked beforehand:
  the same knowledge, but no spacing.
* ``roadmap``: as `evenroad.make_roadmap` makes it.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.arm_problems import KINDS, REPORTING, Pool, Problem, arm, problems
from evenroad.points import draw
from evenroad.roadmap import KNearest
from evenroad.roadmap.plan import plan
from evenroad.robot import ArmWorld, Robot, Scene
from evenroad.robot_roadmap.make import joined, make_roadmap
from evenroad.robot_roadmap.robot_roadmap import RobotRoadmap
from evenroad.robot_roadmap.scene_roadmap import SceneRoadmap

K = 10
SIZES = (64, 128, 256, 1024)
METHODS = ("box, ends k", "box", "control", "roadmap")
COLUMNS = ("method", "n", "draw", "kind", "seed", "solved", "configurations", "motions", "length")


def table_of(problem: Problem) -> Scene:
    """Return the cell that all problems share: the table that the robot stands on."""
    table = tuple(o for o in problem.scene.obstacles if o.name == "table")
    return Scene("table", table, frozenset(p for p in problem.scene.allowed if p[1] == "table"))


def roadmaps(robot: Robot, cell: Scene, n: int, run: int) -> dict[str, RobotRoadmap]:
    """Return roadmap and control."""
    made = make_roadmap(robot, cell, n, k=K, rng=run)
    return {"roadmap": made, "control": joined(made, first_free(made, n, run), K)}


def first_free(made: RobotRoadmap, n: int, run: int) -> np.ndarray:
    """Return the first Owen points that are free of robot and cell, (n, dim)."""
    points = draw("sobol", 16 * n, made.world.space.dim, rng=1000 + run).points
    q = made.one_turn.low + points * (made.one_turn.high - made.one_turn.low)
    return q[made.world.valid(q)][:n]


def rows(name: str, seeds: range, draws: int) -> Iterator[tuple[object, ...]]:
    """Yield a row for each method, size, draw and problem."""
    robot = arm(name)
    indirect = []
    for problem in problems(Pool(robot), seeds):
        world = ArmWorld(robot, problem.scene)
        if not world.motion_valid(problem.start[np.newaxis], problem.goal[np.newaxis])[0]:
            indirect.append((problem, world))
    cell = table_of(indirect[0][0])
    for run in range(draws):
        for n in SIZES:
            kept, points = roadmaps(robot, cell, n, run), draw("sobol", n, len(robot.group), rng=run)
            for problem, world in indirect:
                ends = problem.start, problem.goal
                for method in METHODS:
                    if method in kept:
                        result = SceneRoadmap(kept[method], problem.scene).plan(
                            *ends, shorten=False, trees=False
                        )
                    else:
                        links = None if method == "box, ends k" else 100
                        options = dict(rule=KNearest(K), search="lazy", lazy_milestones=True, shorten=False)
                        result = plan(world, *ends, points, links=links, **options)
                    solved = result.solved and bool(world.recheck(result.path).all())
                    counts = (
                        result.counts.get("configurations_checked", 0),
                        result.counts.get("edges_checked", 0),
                    )
                    yield method, n, run, problem.kind, problem.seed, int(solved), *counts, result.cost


def write(path: Path, name: str, seeds: range, draws: int) -> None:
    """Write rows as they come, so that a run that is cut short leaves what it has."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        for row in rows(name, seeds, draws):
            writer.writerow(row)
            file.flush()


def table(path: Path) -> None:
    """Print success by method and size, and paired differences with their standard errors over problems."""
    with path.open() as file:
        data = list(csv.DictReader(file))
    solved: dict[tuple[str, int], dict[tuple[str, str], list[int]]] = {}
    for row in data:
        by_problem = solved.setdefault((row["method"], int(row["n"])), {})
        by_problem.setdefault((row["kind"], row["seed"]), []).append(int(row["solved"]))
    print(
        "| N | method | "
        + " | ".join(KINDS)
        + " | all | roadmap - this |\n|---|---|"
        + "---|" * (len(KINDS) + 2)
    )
    for n in sorted({n for _, n in solved}):
        best = solved.get(("roadmap", n), {})
        for method in METHODS:
            share = {p: np.mean(v) for p, v in solved.get((method, n), {}).items()}
            if not share:
                continue
            cells = [[v for (kind, _), v in share.items() if kind == wanted] for wanted in KINDS]
            text = [f"{100 * np.mean(cell):.0f}" if cell else "-" for cell in cells]
            apart = 100 * np.array([np.mean(best[p]) - v for p, v in share.items() if p in best])
            error = apart.std(ddof=1) / np.sqrt(len(apart))
            gain = "" if method == "roadmap" else f"{apart.mean():+.1f} ± {error:.1f}"
            print(
                f"| {n} | {method} | {' | '.join(text)} | {100 * np.mean(list(share.values())):.0f} | {gain} |"
            )
    counts = {p: sum(kind == p for kind, _ in next(iter(solved.values()))) for p in KINDS}
    draws = max(int(row["draw"]) for row in data) + 1
    print(f"\nProblems: {counts}; draws so far: {draws}")
    for n in sorted({n for _, n in solved}):
        of_roadmap = [row for row in data if row["method"] == "roadmap" and int(row["n"]) == n]
        for kind in KINDS:
            some = [row for row in of_roadmap if row["kind"] == kind]
            middle = [np.median([int(row[what]) for row in some]) for what in ("configurations", "motions")]
            print(
                f"N={n} {kind}: median of {middle[0]:.0f} configurations and {middle[1]:.0f} motions a query"
            )


def success(path: Path) -> dict[tuple[str, int, str], float]:
    """Return the share of problems solved, in percent, by method, size and kind."""
    solved: dict[tuple[str, int, str], list[int]] = {}
    with path.open() as file:
        for row in csv.DictReader(file):
            solved.setdefault((row["method"], int(row["n"]), row["kind"]), []).append(int(row["solved"]))
    return {key: 100.0 * float(np.mean(values)) for key, values in solved.items()}


def picture(path: Path, out: Path) -> None:
    """Draw success over the number of milestones, a panel for each kind."""
    from matplotlib import pyplot as plt

    share = success(path)
    figure, panels = plt.subplots(1, len(KINDS), figsize=(11, 2.8), sharey=True, layout="constrained")
    for panel, kind in zip(panels, KINDS, strict=True):
        for method, colour in zip(METHODS, ("0.7", "0.45", "tab:blue", "tab:red"), strict=True):
            panel.plot(
                SIZES, [share[method, n, kind] for n in SIZES], "o-", color=colour, label=method, markersize=4
            )
        panel.set(xscale="log", xticks=SIZES, xticklabels=SIZES, xlabel="milestones", title=kind)
        panel.minorticks_off()
    panels[0].set_ylabel("solved without trees [%]")
    panels[0].legend(fontsize=7)
    figure.savefig(out, dpi=110)


def main() -> None:
    """Measure, or print what was measured."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--robot", default="ur5")
    parser.add_argument("--problems", type=int, default=0, help="of each kind")
    parser.add_argument("--draws", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path("docs/data/robot_roadmaps.csv"))
    parser.add_argument("--table", type=Path)
    parser.add_argument("--picture", type=Path)
    options = parser.parse_args()
    if options.problems:
        write(options.out, options.robot, REPORTING[: options.problems], options.draws)
    if options.problems or options.table:
        table(options.table or options.out)
    if options.picture:
        picture(options.table or options.out, options.picture)


if __name__ == "__main__":
    main()
