"""Choosing the recipe of one robot in its cell, by random problems that no task has shown."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import islice
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad.robot import ArmWorld, Scene
from evenroad.robot.arm_world import RECHECK_TOLERANCE
from evenroad.robot_roadmap.chance import Surroundings, random_scene
from evenroad.robot_roadmap.pockets import body_of, links_of, pockets_around, tips_of
from evenroad.robot_roadmap.recipe import Recipe
from evenroad.robot_roadmap.robot_roadmap import RobotRoadmap
from evenroad.robot_roadmap.scene_roadmap import SceneRoadmap

GAMMAS = (0.0, 1.0, 2.0, 4.0, 8.0, 16.0)
"""Powers of the chance of being free that are tried."""

PROBLEMS = 200
"""Random problems that choose, and as many others that say by how much."""

TRIES = 100
"""Scenes that are drawn for each problem, at most."""

EASY = 48
"""Configurations of the pool that must not do for a problem."""

PAIRS = 16
"""Starts and goals that are drawn for a scene, which gives one problem at most."""

PLACES = 1 << 12
"""Configurations that starts and goals are taken from, where they are free."""

MOST_MOTIONS = 20_000
"""What trees do not solve with so many motions is no problem."""


class RandomProblem(NamedTuple):
    """A scene, and two configurations, (dim,) each, that neither a straight motion nor few milestones join."""

    scene: Scene
    start: Floats
    goal: Floats


def random_problems(few: RobotRoadmap, rng: np.random.Generator) -> Iterator[RandomProblem]:
    """Draw problems that a roadmap of few milestones does not solve, but trees do, until hardly a scene has one.

    In every other scene the tip of the goal is in a pocket; boxes stand anywhere.
    """
    robot, cell, one = few.robot, few.cell, few.one_turn
    places = one.low + rng.random((PLACES, len(one.low))) * (one.high - one.low)
    places = places[few.world.valid(places)]
    if not len(places):
        return
    around, tips = Surroundings.of(robot, places), tips_of(robot, places)
    body, radii = body_of(robot, places)
    drawn, found = 0, 0
    while drawn < TRIES * (found + 1):
        drawn += 1
        ends = rng.integers(len(places), size=(2, PAIRS))
        things = random_scene(*around, rng).obstacles
        if drawn % 2 and tips.shape[1]:
            goals = ends[1]
            around_goals = pockets_around(tips[goals, rng.integers(tips.shape[1], size=PAIRS)], around, rng)
            # The last one, too, where all are touched.
            clear = np.append(np.flatnonzero(~around_goals.touched_by(body[goals], radii)), PAIRS - 1)[0]
            ends[1] = goals[clear]
            things += around_goals.walls(int(clear))
        things = tuple(
            replace(each, name=f"{number} of a random problem") for number, each in enumerate(things)
        )
        scene = replace(cell, name="random problem", obstacles=(*cell.obstacles, *things))
        problem = _worth(scene, places[ends[0]], places[ends[1]], few)
        if problem is not None:
            found += 1
            yield problem


def _worth(scene: Scene, starts: Floats, goals: Floats, few: RobotRoadmap) -> RandomProblem | None:
    """Return the first pair of starts and goals, (m, dim) each, that trees join, and nothing simpler does."""
    world = ArmWorld(few.robot, scene, resolution=few.resolution)
    free = world.valid(starts) & world.valid(goals)
    starts, goals = starts[free], goals[free]
    apart = ~world.motion_certified(starts, goals, RECHECK_TOLERANCE)
    for start, goal in zip(starts[apart], goals[apart], strict=True):
        problem = RandomProblem(scene, start, goal)
        if not solved_by(few, [problem])[0]:
            # One try: the next pair of this scene is most likely as hard.
            joined = world.connect(start, goal[np.newaxis], most_motions=MOST_MOTIONS).goal >= 0
            return problem if joined else None
    return None


def tune_recipe(
    few: RobotRoadmap,
    recipes: Sequence[Recipe],
    made: Callable[[Recipe], RobotRoadmap],
    rng: np.random.Generator,
    progress: Callable[[str, float], None] = lambda what, share: None,
) -> tuple[Recipe, str]:
    """Return the recipe that solves the most of random problems, and in words by how much it is better than the first.

    Another than the first is taken where it wins by more than a standard error, over problems; by how much is measured
    on other problems.
    """
    problems = []
    for problem in islice(random_problems(few, rng), 2 * PROBLEMS):
        problems.append(problem)
        progress("tuning: problems", len(problems) / (2 * PROBLEMS))
    half = len(problems) // 2
    if half < 2:
        return recipes[0], f"not tuned: only {len(problems)} random problems were found"
    solved = []
    for number, recipe in enumerate(recipes):
        solved.append(solved_by(made(recipe), problems))
        progress("tuning: recipes", (number + 1) / len(recipes))
    best = max(range(len(recipes)), key=lambda i: int(solved[i][:half].sum()))
    gain, error = _paired(solved[best][:half], solved[0][:half])
    if gain <= error:
        best = 0
    gain, error = _paired(solved[best][half:], solved[0][half:])
    share = 100.0 * float(solved[best][half:].mean())
    said = f"gamma {recipes[best].gamma:g} of {len(recipes)} tried"
    said += f": {share:.0f} % of {len(problems) - half} random problems"
    if best:
        said += f", {100.0 * gain:+.1f} ± {100.0 * error:.1f} to gamma {recipes[0].gamma:g}"
    return recipes[best], said


def solved_by(roadmap: RobotRoadmap, problems: Sequence[RandomProblem]) -> Bools:
    """Return which problems a roadmap solves without trees."""
    links = links_of(len(roadmap.milestones))
    return np.array(
        [
            SceneRoadmap(roadmap, each.scene).connect(each.start, each.goal[np.newaxis], links=links).goal
            >= 0
            for each in problems
        ]
    )


def _paired(first: Bools, second: Bools) -> tuple[float, float]:
    """Return the mean difference and its standard error."""
    apart = first.astype(np.float64) - second
    return float(apart.mean()), float(apart.std(ddof=1) / np.sqrt(len(apart)))
