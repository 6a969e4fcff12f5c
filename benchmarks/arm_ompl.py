"""OMPL's RRT-Connect and PRM with our checker on the arm suite's problems, beside trees and roadmaps ([peers]).

    python -m benchmarks.arm_ompl --problems 60 -o docs/data/arms_ompl.csv
    python -m benchmarks.arm_ompl --store results.db --csv docs/data/arms_ompl.csv --picture docs/arms_ur5_costs.png

Both plan in the scene, from nothing, until `--seconds` of the processor are over.  What is counted is what they ask
for: states, and motions with all states in between, by batches in compiled code; milliseconds are the processor's,
with Python's callbacks.  The second command draws them beside the rows of `evenroad bench arms`, and prints what is
solved within which cost.
"""

from __future__ import annotations

import argparse
import csv
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from matplotlib.lines import Line2D

from evenroad.robot.arm_world import ArmWorld
from evenroad_studies.arms.problems import ARM_ROBOTS, draw_problem
from evenroad_studies.arms.scenes import GENERATORS

STEP = 1.5
"""RRT-Connect's range [rad]: the one that the compiled trees have for the UR5."""

SLICE = 0.1
"""Of the time, on the clock that OMPL reads [s]."""

CHECKS, MS = (30, 100, 300, 1000, 10_000), (0.3, 1.0, 10.0, 100.0)
"""Costs that the table shows the success of."""

PLANNERS = {"RRT-Connect": "tab:orange", "PRM": "tab:brown"}
"""OMPL's name -> colour."""


class Found(NamedTuple):
    """Whether start and goal were joined, what was asked for, and processor time [ms]."""

    solved: bool
    configurations: int
    motions: int
    ms: float


def ompl_plan(
    planner: str,
    world: ArmWorld,
    start: npt.NDArray[np.float64],
    goal: npt.NDArray[np.float64],
    seconds: float = 10.0,
) -> Found:
    """Plan with one of OMPL's planners, for so much processor time [s]; setting up is not timed."""
    from ompl import base as ob
    from ompl import geometric as og
    from ompl import util as ou

    ou.setLogLevel(ou.LogLevel.LOG_NONE)
    dim, asked = world.space.dim, [0, 0]

    class Motions(ob.MotionValidator):  # type: ignore[misc]
        def checkMotion(self, a, b, *rest) -> bool:  # type: ignore[no-untyped-def]
            asked[1] += 1
            return bool(world.motion_valid(np.array([a[0:dim]]), np.array([b[0:dim]]))[0])

    def is_valid(state) -> bool:  # type: ignore[no-untyped-def]
        asked[0] += 1
        return bool(world.valid(np.array([state[0:dim]]))[0])

    space = ob.RealVectorStateSpace(dim)
    bounds = ob.RealVectorBounds(dim)
    for k in range(dim):
        bounds.setLow(k, float(world.bounds[0, k]))
        bounds.setHigh(k, float(world.bounds[1, k]))
    space.setBounds(bounds)
    si = ob.SpaceInformation(space)
    si.setStateValidityChecker(is_valid)
    motions = Motions(si)
    si.setMotionValidator(motions)
    si.setup()
    problem = ob.ProblemDefinition(si)
    ends = [space.allocState(), space.allocState()]
    for state, values in zip(ends, (start, goal), strict=True):
        state[0:dim] = values.tolist()
    problem.setStartAndGoalStates(*ends)
    chosen = og.RRTConnect(si) if planner == "RRT-Connect" else og.PRM(si)
    if planner == "RRT-Connect":
        chosen.setRange(STEP)
    chosen.setProblemDefinition(problem)
    chosen.setup()
    asked[:] = 0, 0
    began = time.process_time()
    # In slices: a planner goes on where it stopped, and the clock of a slice is the wall's.
    while not problem.hasExactSolution() and time.process_time() - began < seconds:
        chosen.solve(SLICE)
    return Found(bool(problem.hasExactSolution()), *asked, 1e3 * (time.process_time() - began))


def run(robot: str, problems: int, seconds: float, path: Path) -> None:
    """Plan all problems with both planners, and write a line for each."""
    lines: list[tuple[object, ...]] = []
    for generator in GENERATORS:
        for instance in range(problems):
            problem = draw_problem(robot, generator, "report", instance)
            assert isinstance(problem.world, ArmWorld)
            for planner in PLANNERS:
                found = ompl_plan(planner, problem.world, problem.start, problem.goal, seconds)
                lines.append((robot, generator, instance, planner, seconds, *found[:3], round(found.ms, 3)))
        for planner in PLANNERS:
            here = [line for line in lines if line[1] == generator and line[3] == planner]
            columns = [[line[c] for line in here if line[5]] for c in (6, 7, 8)]
            medians = " / ".join(f"{np.median(column):.3g}" for column in columns if column)
            solved = sum(bool(line[5]) for line in here)
            print(
                f"{robot} {generator}: {planner} solves {solved} of {len(here)}; of these median configurations"
                f" / motions / ms {medians}",
                flush=True,
            )
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(("robot", "generator", "problem", "planner", "limit_s", "solved", *Found._fields[1:]))
        writer.writerows(lines)


def draw(store: Path, table: Path, robot: str, picture: Path) -> None:
    """Draw what success costs: the rows of a store, and OMPL's planners of a table that `run` wrote."""
    from evenroad_studies.bench.store import read_rows
    from evenroad_studies.report.arms import cost_curve, draw_costs

    with table.open() as file:
        lines = [line for line in csv.DictReader(file) if line["robot"] == robot]
    many = 1 + max(int(line["problem"]) for line in lines)
    rows = read_rows(store)
    rows = rows.where(rows.instance < many)
    figure = draw_costs(rows, robot, "10")
    panels = figure.axes[:2]
    for planner, colour in PLANNERS.items():
        mine = [line for line in lines if line["planner"] == planner]
        solved = np.array([line["solved"] == "True" for line in mine])
        checks = np.array([int(line["configurations"]) + int(line["motions"]) for line in mine])
        ms = np.array([float(line["ms"]) for line in mine])
        cost_curve(panels, (checks, ms), solved, f"OMPL's {planner}", colour, "-.")
    panels[1].legend(fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.savefig(picture, dpi=100)
    names = [f"{limit:g} checks" for limit in CHECKS] + [f"{limit:g} ms" for limit in MS]
    print(f"| solved [%] within | {' | '.join(names)} |\n|---|{'---|' * len(names)}")
    for first, second in zip(panels[0].lines, panels[1].lines, strict=True):
        shares = [*map(partial(_within, first), CHECKS), *map(partial(_within, second), MS)]
        print(f"| {first.get_label()} | {' | '.join(f'{share:.0f}' for share in shares)} |")


def _within(curve: Line2D, limit: float) -> float:
    """Return how high a curve is at a cost."""
    here = np.searchsorted(curve.get_xdata(), limit, side="right")
    return float(curve.get_ydata()[here - 1]) if here else 0.0


def main(arguments: Sequence[str] | None = None) -> None:
    """Run both planners, or draw the picture."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--robot", default="ur5-5", choices=ARM_ROBOTS)
    parser.add_argument("--problems", type=int, default=60, help="of each generator")
    parser.add_argument("--seconds", type=float, default=2.0, help="of the processor, for each problem")
    parser.add_argument("-o", "--csv", type=Path, default=Path("arms_ompl.csv"))
    parser.add_argument("--store", type=Path, help="of evenroad bench arms: draw only")
    parser.add_argument("--picture", type=Path, default=Path("arms_ur5_costs.png"))
    options = parser.parse_args(arguments)
    if options.store is None:
        run(options.robot, options.problems, options.seconds, options.csv)
    else:
        draw(options.store, options.csv, options.robot, options.picture)


if __name__ == "__main__":
    main()
