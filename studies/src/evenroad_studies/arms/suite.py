"""The suite of arms: every robot and generator, samplers of the joint box beside roadmaps made for the robot."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product

from evenroad._checks import require_count, require_known
from evenroad.robot_roadmap.world_roadmap import links_of
from evenroad_studies.arms.execute import KEPT, TREES, kept_rule
from evenroad_studies.arms.problems import ARM_ROBOTS, problem_name
from evenroad_studies.arms.roadmaps import BOX_SAMPLERS, KNOWING, why_no_roadmap
from evenroad_studies.arms.scenes import GENERATORS
from evenroad_studies.bench.task import Task

ARM_COUNTS = (64, 128, 256, 512, 1024, 2048, 4096)
ARM_NEIGHBOURS = (4, 10, 20)
DEFAULT_COUNTS, DEFAULT_NEIGHBOURS, DEFAULT_DRAWS, DEFAULT_RUNS = (64, 256), (10,), 2, 40
QUICK_RUNS, QUICK_DRAWS = 10, 1

METHODS = (*BOX_SAMPLERS, *KNOWING)
TODAY = "sobol scrambled"
"""The sampler with which points planned before there were roadmaps: ends joined as milestones are, in the scene."""


def arm_tasks(
    runs: int | None = None,
    seed: int = 1,
    only: Iterable[str] = (),
    quick: bool = False,
    *,
    draws: int | None = None,
    counts: Sequence[int] = (),
    neighbours: Sequence[int] = (),
    samplers: Sequence[str] = (),
) -> tuple[Task, ...]:
    """Return the tasks; what shares a roadmap stands together.

    `runs` are problems of each robot and generator, `draws` sets of each sampler; `only` names problems, robots or
    generators.  All of `counts`, 64 to 4096 points, and `neighbours`, 4, 10 and 20, take a night.
    """
    runs = DEFAULT_RUNS if runs is None else require_count("runs", runs)
    draws = DEFAULT_DRAWS if draws is None else require_count("draws", draws)
    if quick:
        runs, draws = min(runs, QUICK_RUNS), min(draws, QUICK_DRAWS)
    counts = tuple(require_count("counts", n, at_least=8) for n in counts) or DEFAULT_COUNTS
    neighbours = tuple(require_count("neighbours", k) for k in neighbours) or DEFAULT_NEIGHBOURS
    for name in samplers:
        require_known("sampler of this suite", name, (*METHODS, TREES))
    chosen = [name for name in (*METHODS, TREES) if not samplers or name in samplers]
    pairs = _chosen(tuple(only))
    tasks: list[Task] = []
    for robot in dict.fromkeys(robot for robot, _ in pairs):
        names = [problem_name(robot, generator) for who, generator in pairs if who == robot]
        if TREES in chosen:
            tasks += [Task(name, i, TREES, 0, "-", TREES, 0, seed) for name in names for i in range(runs)]
        for run, n, k, sampler in product(range(draws), sorted(counts), neighbours, chosen):
            if sampler == TREES or why_no_roadmap(sampler, n, ARM_ROBOTS[robot]):
                continue
            ways = [(kept_rule(k, links_of(n)), KEPT)]
            if sampler == TODAY:
                ways.append((f"k={k} symmetrised", "connect"))
            tasks += [
                Task(name, i, sampler, n, rule, search, run, seed)
                for rule, search in ways
                for name in names
                for i in range(runs)
            ]
    return tuple(tasks)


def _chosen(only: tuple[str, ...]) -> list[tuple[str, str]]:
    """Return the robots and generators that names of problems, robots or generators ask for; all for none."""
    every = {problem_name(*pair): pair for pair in product(ARM_ROBOTS, GENERATORS)}
    for name in only:
        require_known("problem, robot or generator of this suite", name, (*every, *ARM_ROBOTS, *GENERATORS))
    if not only:
        return list(every.values())
    problems = {name for name in only if name in every}
    robots = {name for name in only if name in ARM_ROBOTS} or set(ARM_ROBOTS)
    generators = {name for name in only if name in GENERATORS} or set(GENERATORS)
    whole = len(problems) < len(only)
    return [
        pair
        for name, pair in every.items()
        if name in problems or (whole and pair[0] in robots and pair[1] in generators)
    ]
