"""Running a task on an arm: a roadmap that was made before, asked lazily in a new scene; or trees."""

from __future__ import annotations

import re
import time

import numpy as np

from evenroad.errors import InvalidValue
from evenroad.planning.arm_trees import connect
from evenroad.roadmap.connector import Connection
from evenroad.robot import ArmWorld
from evenroad.robot_roadmap.world_roadmap import ArmWorldRoadmap
from evenroad_studies.arms.problems import draw_problem, robot_and_generator, stream_of
from evenroad_studies.arms.roadmaps import roadmap_of
from evenroad_studies.bench.task import Outcome, Problem, Task

KEPT, TREES = "kept", "trees"
SEARCHES_OF_ARMS = (KEPT, TREES)
"""Searches: of a roadmap that is kept for all scenes, and none."""

MOST_MOTIONS = 50_000
"""After which trees give up."""

_RULE = re.compile(r"k=(\d+) ends=(\d+)")
_warm: set[tuple[str, str]] = set()


def kept_rule(k: int, links: int) -> str:
    """Return the rule of roadmaps: neighbours of milestones, and milestones that start and goal are linked to."""
    return f"k={k} ends={links}"


def run_on_arm(task: Task) -> Outcome:
    """Run a task; the clock counts this thread's processor time from the scene to the path, unshortened.

    Of the outcome, `valid` are the configurations that were checked and `edges_checked` the motions.
    """
    robot, generator = robot_and_generator(task.problem)
    problem = draw_problem(robot, generator, stream_of(task.problem), task.instance)
    if (robot, task.search) not in _warm:
        _asked(task, robot, problem)
        _warm.add((robot, task.search))
    found, set_id, seconds = _asked(task, robot, problem)
    return Outcome(
        "solved" if found.goal >= 0 else "not_connected",
        valid=found.configurations,
        edges_checked=found.motions,
        length=_length(found),
        seconds=seconds,
        set_id=set_id,
    )


def _asked(task: Task, robot: str, problem: Problem) -> tuple[Connection, str, float]:
    """Return what is found, the set and the seconds of planning."""
    goals, set_id = problem.goal[np.newaxis], ""
    assert isinstance(problem.world, ArmWorld)
    if task.search == TREES:
        began = time.thread_time()
        world = ArmWorld(problem.world.robot, problem.world.scene)
        return connect(world, problem.start, goals, most_motions=MOST_MOTIONS), "", time.thread_time() - began
    if (parts := _RULE.fullmatch(task.rule)) is None:
        raise InvalidValue(f"a kept roadmap needs a rule like 'k=10 ends=100', got {task.rule!r}")
    k, links = map(int, parts.groups())
    roadmap, set_id = roadmap_of(robot, task.sampler, task.n, k, task.run, task.seed)
    began = time.thread_time()
    known = ArmWorldRoadmap(roadmap, ArmWorld(problem.world.robot, problem.world.scene))
    return known.connect(problem.start, goals, links=links), set_id, time.thread_time() - began


def _length(found: Connection) -> float:
    return float(np.linalg.norm(np.diff(found.path, axis=0), axis=1).sum()) if found.goal >= 0 else np.nan
