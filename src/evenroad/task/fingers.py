"""The fingers of a gripper: which joints they are, where a step brings them, and the motion there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_known
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue
from evenroad.geometry.pose import Pose
from evenroad.loading.groups import chains
from evenroad.planning.make_result import make_result, solution
from evenroad.planning.problem import Problem
from evenroad.planning.read_problem import goal_list
from evenroad.planning.reading import Goal, Reading
from evenroad.planning.result import PlanResult, Status
from evenroad.poses.pose_goal import PoseGoal
from evenroad.robots.joint import Joint, require_within
from evenroad.robots.kinematics import endpoints_at, held_values, poses_at, with_mimics
from evenroad.robots.robot import ConfigurationLike, Robot
from evenroad.robots.variants import with_group
from evenroad.scenes.scene import Scene
from evenroad.scenes.states import as_configuration, named_states
from evenroad.task.gripper import OfFingers, Open
from evenroad.task.motion import Leg, Motion
from evenroad.task.steps import MoveTo, Step

_STATES = {True: ("open",), False: ("close", "closed")}
"""Names of the states in which fingers are open, and in which they are closed."""
_SHARES = 129
"""Number of states along a motion of fingers at which their first contact is looked for."""
_HALVINGS = 30
_SAME_SPREAD = 1e-4
"""Difference of the distances of fingers below which neither limit of a joint is the open one [m]."""


def finger_values(step: OfFingers, robot: Robot, scene: Scene, where: str) -> dict[str, float]:
    """Return where a step, named `where`, brings the fingers: joint -> value [rad or m].

    Raises InvalidValue if there are no fingers, several hands, a value outside limits, or no known direction;
    UnknownName for an unknown link, state or joint.
    """
    joints = {joint.name: joint for joint in robot.joints}
    if isinstance(step.to, Mapping):
        values = dict(step.to)
        for name in values:
            require_known(f"joint of {where}:", name, joints)
            if name not in held_values(robot):
                why = (
                    "is planned for: MoveTo moves it, or give a group without it"
                    if name in robot.group
                    else "is fixed, or follows another"
                )
                raise InvalidValue(f"{where} moves joint {name!r}, which {why}")
    else:
        names = finger_joints(step, robot, where)
        values = _at_state(step, robot, scene, names, where) or {
            name: step.to if isinstance(step.to, float) else _limit(step, robot, name) for name in names
        }
    for name, value in values.items():
        require_within(joints[name], value, where)
    return values


def finger_joints(step: OfFingers, robot: Robot, where: str) -> tuple[str, ...]:
    """Return the independent joints of the fingers below the hand of a step."""
    if step.link:
        require_known(f"link of {where}:", step.link, robot.links)
    fingers = fingers_in_group(robot)
    arm = [name for name in robot.group if name not in fingers]
    above, inside = {robot.links[0]: ""}, {robot.links[0]: step.link == robot.links[0]}
    for joint in robot.joints:
        above[joint.child] = joint.name if joint.name in arm else above[joint.parent]
        inside[joint.child] = inside[joint.parent] or joint.child == step.link
    carrying = {"", *(above[joint.parent] for joint in robot.joints if joint.name in arm)}
    free = {*held_values(robot), *fingers}
    found = [joint for joint in robot.joints if joint.name in free and above[joint.parent] not in carrying]
    if step.link:
        found = [joint for joint in found if inside[joint.parent]]
    if not found:
        of = f"below {step.link!r}" if step.link else f"beyond {', '.join(arm)}"
        raise InvalidValue(f"{where} needs fingers: {robot.name!r} has no joint {of} that could move")
    hands = {above[joint.parent]: joint.parent for joint in reversed(found)}
    if len(hands) > 1:
        text = " or ".join(f"{type(step).__name__}(link={hand!r})" for hand in sorted(hands.values()))
        raise InvalidValue(f"{where} must say which hand of {robot.name!r} it is: {text}")
    return tuple(joint.name for joint in found)


def fingers_in_group(robot: Robot) -> tuple[str, ...]:
    """Return the planned joints that are fingers: single ones at the end of a chain that branches, or is followed."""
    moved = {joint.child: joint for joint in robot.joints}
    runs = chains(robot.joints).values()
    free = {joint.name for run in runs for joint in run}

    def carrier(joint: Joint) -> str:
        link = joint.parent
        while link in moved and moved[link].name not in free:
            link = moved[link].parent
        return moved[link].name if link in moved else ""

    carriers = {run[0].name: carrier(run[0]) for run in runs}
    alone = {run[0].name for run in runs if len(run) == 1 and carriers[run[0].name]} - {*carriers.values()}
    return tuple(name for name in robot.group if name in alone)


def arm_alone(
    steps: tuple[Step, ...], world: ArmWorld, start: ConfigurationLike, reading: Reading
) -> tuple[tuple[Step, ...], ArmWorld, ConfigurationLike]:
    """Return steps, world and start of the arm without the fingers that steps move, which are held at the start.

    Goals of all joints become those of the arm's: fingers are where their steps say.
    """
    robot, scene = world.robot, world.scene
    moved: set[str] = set()
    for number, step in enumerate(steps):
        if isinstance(step, OfFingers):
            said = step.to if isinstance(step.to, Mapping) else None
            moved |= {*(said or finger_joints(step, robot, f"step {number} of the task"))}
    moved &= {*fingers_in_group(robot)}
    if not moved:
        return steps, world, start
    columns = [i for i, name in enumerate(robot.group) if name not in moved]

    def of_arm(goal: Goal) -> Goal:
        if isinstance(goal, Pose | PoseGoal):
            return goal
        return as_configuration(robot, goal, scene, name="goal", degrees=reading.degrees)[columns]

    first = as_configuration(robot, start, scene, name="start", degrees=reading.degrees)
    at_start = {name: value for name, value in zip(robot.group, first.tolist(), strict=True) if name in moved}
    alone = with_group(robot, [robot.group[i] for i in columns], {**robot.held, **at_start})
    alone = replace(alone, pairs=_without(alone, gripper_links(alone, at_start)))
    changed = tuple(
        replace(step, goal=[of_arm(each) for each in goal_list(step.goal, robot.dof)])
        if isinstance(step, MoveTo)
        else step
        for step in steps
    )
    return changed, replace(world, robot=alone), first[columns]


def gripper_links(robot: Robot, joints: Mapping[str, float]) -> set[str]:
    """Return the links that no planned joint moves against those of some finger joints, without held objects."""
    first = {robot.links[0]: robot.links[0]}
    for joint in robot.joints:
        leader = joint.name if joint.mimic is None else joint.mimic.joint
        first[joint.child] = joint.child if leader in robot.group else first[joint.parent]
    bases = {first[joint.child] for joint in robot.joints if joint.name in joints}
    return {link for link in robot.links if first[link] in bases and link not in robot.holds}


def moved_links(robot: Robot, joints: Mapping[str, float]) -> set[str]:
    """Return the links that some joints move, and those that follow them."""
    moved: set[str] = set()
    for joint in robot.joints:
        leader = joint.name if joint.mimic is None else joint.mimic.joint
        if leader in joints or joint.parent in moved:
            moved.add(joint.child)
    return moved


def with_fingers(robot: Robot, values: Mapping[str, float]) -> Robot:
    """Return a robot with its fingers at these values, joint -> value, whose gripper is not tested against itself.

    Named states no longer say where these joints are: as goals, they are postures of the arm.
    """
    moved = with_group(robot, robot.group, {**robot.held, **values})
    states = {name: {j: v for j, v in state.items() if j not in values} for name, state in robot.states.items()}
    return replace(moved, states=states, pairs=_without(moved, gripper_links(robot, values)))


def finger_world(world: ArmWorld, q: Floats, values: Mapping[str, float]) -> ArmWorld:
    """Return the world in which the finger joints move and the arm stays at a configuration, (dim,)."""
    robot = world.robot
    held = {name: value for name, value in held_values(robot).items() if name not in values}
    arm = dict(zip(robot.group, q.tolist(), strict=True))
    pairs = _without(robot, gripper_links(robot, values))
    fingers = with_group(replace(robot, resting=()), tuple(values), {**held, **arm})
    return replace(world, robot=replace(fingers, pairs=pairs))


def touching(world: ArmWorld, q: Floats, values: Mapping[str, float]) -> dict[str, float] | None:
    """Return the values at which fingers first touch something on their way to others; None if they do not."""
    moving, start, goal = _terminals(world, q, values)
    shares = np.linspace(0.0, 1.0, _SHARES)[:, np.newaxis]
    blocked = ~moving.valid(start + shares * (goal - start))
    if not blocked.any():
        return None
    row = int(np.argmax(blocked))
    low, high = float(shares[max(row - 1, 0), 0]), float(shares[row, 0])
    for _ in range(_HALVINGS if row else 0):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if not moving.valid(start + middle * (goal - start)) else (middle, high)
    return dict(zip(values, (start + high * (goal - start)).tolist(), strict=True))


def finger_leg(step: OfFingers, world: ArmWorld, q: Floats, values: Mapping[str, float]) -> Leg | PlanResult:
    """Return the straight motion of the fingers to these values, which is proved free, or why it is not."""
    moving, start, goal = _terminals(world, q, values)
    problem = Problem(moving, start, goal[np.newaxis])
    if np.array_equal(start, goal):
        return Leg(q, motion=Motion((), 0, fingers=values))
    path = np.stack([start, goal])
    if not moving.validate(path).all():
        rows = np.linspace(start, goal, _SHARES)
        bad = rows[~moving.valid(rows)]
        why = moving.explain(bad[0]) if len(bad) else "that is not proved free"
        return make_result(problem, Status.NOT_CONNECTED, f"the fingers cannot move there: {why}")
    to = ", ".join(f"{name} at {value:.4g}" for name, value in values.items())
    message = f"the fingers {'open' if isinstance(step, Open) else 'close'}: {to}"
    made = solution(problem, path, message=message, planner="fingers")
    return Leg(q, (made,), None, (), Motion((), 0, fingers=values))


def _terminals(world: ArmWorld, q: Floats, values: Mapping[str, float]) -> tuple[ArmWorld, Floats, Floats]:
    """Return the world of some fingers, and where they are and will be, (dim,) each."""
    now = held_values(world.robot)
    start = np.array([now[name] for name in values], dtype=np.float64)
    return finger_world(world, q, values), start, np.array(list(values.values()), dtype=np.float64)


def _at_state(
    step: OfFingers, robot: Robot, scene: Scene, names: tuple[str, ...], where: str
) -> dict[str, float] | None:
    """Return the values of a named state, or of the one that means it; None if there is none of those."""
    states = named_states(robot, scene)
    if isinstance(step.to, str):
        require_known(f"state of {where}:", step.to, states)
        values = {name: states[step.to][name] for name in names if name in states[step.to]}
        if not values:
            raise InvalidValue(f"{where}: the state {step.to!r} has none of the finger joints {', '.join(names)}")
        return values
    if step.to is None:
        for state in _STATES[isinstance(step, Open)]:
            if set(names) <= states.get(state, {}).keys():
                return {name: states[state][name] for name in names}
    return None


def _limit(step: OfFingers, robot: Robot, name: str) -> float:
    """Return the limit of a finger joint at which the fingers are farthest apart, or nearest to each other."""
    joint = next(each for each in robot.joints if each.name == name)
    limits = np.array([joint.lower, joint.upper])
    spread = np.zeros(2)
    if np.isfinite(limits).all():
        free = {each: np.full(2, value) for each, value in held_values(robot).items()}
        arm = {each: np.zeros(2) for each in robot.group}
        poses = poses_at(robot, with_mimics(robot, {**arm, **free, name: limits}), 2)
        links = gripper_links(robot, {name: 0.0})
        rows = [i for i, capsule in enumerate(robot.capsules) if capsule.link in links]
        middles = endpoints_at(robot, poses)[:, rows].mean(axis=2)
        spread = np.linalg.norm(middles[:, :, np.newaxis] - middles[:, np.newaxis], axis=3).sum(axis=(1, 2))
    if abs(spread[1] - spread[0]) < _SAME_SPREAD:
        kind = type(step).__name__
        raise InvalidValue(
            f"{kind} cannot know where joint {name!r} is {kind.lower()}: give {kind}(to={{{name!r}: ...}})"
        )
    wider = int(spread[1] > spread[0])
    return float(limits[wider if isinstance(step, Open) else 1 - wider])


def _without(robot: Robot, links: set[str]) -> tuple[tuple[str, str], ...]:
    """Return the tested pairs of a robot, without those within some links."""
    return tuple(pair for pair in robot.pairs if not links.issuperset(pair))
