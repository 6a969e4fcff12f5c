"""The answer to a task as a page that plays offline: all motions in turn, and what is held while it is held."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from evenroad._arrays import Floats
from evenroad.collision.arm_world import ArmWorld
from evenroad.constraints.constrained_world import KeptWorld
from evenroad.errors import EvenroadError, NotAvailable
from evenroad.loading.robot_file import RobotFile
from evenroad.planning.result import PlanResult
from evenroad.robots.kinematics import joint_values
from evenroad.task.result import TaskResult, pauses_of, timed_parts
from evenroad.viz import style
from evenroad.viz.bodies import shape_parts
from evenroad.viz.player import Data, Timed, arm_data, body_data, clearances, filled, obstacle_data, rounded, states_of

_PAUSE = 0.3
"""Pause between two motions of a robot without limits, whose times are not known [s]."""


@dataclass(frozen=True, eq=False)
class _Played:
    """A part of a task: its world, when the part before it ends and it ends itself [s], its times and states."""

    world: ArmWorld
    since: float
    until: float
    times: Floats
    states: Floats


def page_of_task(done: TaskResult, file: RobotFile | None = None) -> str:
    """Return the text of a page that plays all motions of a task; NotAvailable if it is not solved, or no arm moves.

    Each motion is in its own world: an obstacle that is picked up moves with the link that holds it.  `file` says how
    the robot looks, as in :func:`evenroad.viz.player.save_page`.
    """
    of_arm = [part for motion in done.motions if not motion.fingers for part in motion.parts if part.cost]
    if done.path is None or not of_arm:
        raise NotAvailable(f"there is no path to play: {done.message if not done.solved else 'the arm stays'}")
    played, timed = _played(done)
    first = _arm_of(of_arm[0])
    data = arm_data(first, replace(of_arm[0], path=done.path), file)
    fixed = [body for body in _bodies(data) if body["set"] != "scene" and body["name"] not in first.robot.holds]
    # As in a plan of the robot alone, whose joints all worlds have.
    values = [joint_values(each.world.robot, each.states) for each in played]
    listed = [
        None if joint.kind == "fixed" else rounded(np.concatenate([row[joint.name] for row in values]), 5)
        for joint in first.robot.joints
    ]
    near = [clearances(each.world, each.states) for each in played]
    data |= {
        "title": f"{done.status}: {done.message}",
        "bodies": fixed + _things(played, first),
        "times": rounded(np.concatenate([each.times for each in played]), 4),
        "values": listed,
        "clearance": None if None in near else [each for row in near for each in row or ()],
        "timed": timed,
    }
    return filled(data)


def _bodies(data: Data) -> list[Data]:
    bodies = data["bodies"]
    assert isinstance(bodies, list)
    return bodies


def _played(done: TaskResult) -> tuple[list[_Played], bool]:
    """Return the parts in which something moves, one after the other, and whether their times are known."""
    moving = [part for part in done.parts if part.cost]
    try:
        parts: list[tuple[PlanResult, Timed]] = [
            (part, (made.times, made.positions)) for part, made in timed_parts(done, {})
        ]
        pauses, timed = pauses_of(done), True
    except EvenroadError:
        parts = [(part, states_of(part, _arm_of(part), None)) for part in moving]
        pauses, timed = [_PAUSE] * len(parts), False
    played: list[_Played] = []
    end = 0.0
    for (part, times), pause in zip(parts, pauses, strict=False):
        rows, states = states_of(part, _arm_of(part), times)
        begin = end + (pause if played else 0.0)
        played.append(_Played(_arm_of(part), end, begin + float(rows[-1]), begin + rows, states))
        end = played[-1].until
    return played, timed


def _arm_of(part: PlanResult) -> ArmWorld:
    """Return the arm's world that a part is planned in, also where its path keeps something."""
    world = part.world.world if isinstance(part.world, KeptWorld) else part.world
    if not isinstance(world, ArmWorld):
        raise NotAvailable("the motions of this task do not know their worlds")
    return world


def _things(played: list[_Played], first: ArmWorld) -> list[Data]:
    """Return obstacles and held bodies, each with the times at which it is there, `when`, unless it always is."""
    there: dict[str, list[list[float]]] = defaultdict(list)
    for each in played:
        for body in _in_world(each.world, first):
            there[json.dumps(body)].append([round(each.since, 4), round(each.until, 4)])
    things: list[Data] = []
    for text, spans in there.items():
        # What is there at the end stays there.
        shown = [[a, 1e9 if b == round(played[-1].until, 4) else b] for a, b in spans]
        things.append(json.loads(text) | ({} if len(spans) == len(played) else {"when": shown}))
    return things


def _in_world(world: ArmWorld, first: ArmWorld) -> Iterator[Data]:
    """Yield the obstacles of a world, and what its robot holds, as bodies of the links that hold it."""
    for obstacle in world.scene.obstacles:
        yield obstacle_data(obstacle)
    parts = shape_parts(world.robot) if world.robot.holds else {}
    for joint in world.robot.joints:
        if joint.child in world.robot.holds and joint.child in parts:
            part = replace(parts[joint.child].moved(joint.origin.matrix), colour=style.THING)
            yield body_data(part, first.robot.links.index(joint.parent), "held", joint.child)
