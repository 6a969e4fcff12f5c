"""Named states: configurations with a name, and where the joints are that are not planned for."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue, UnknownName
from evenroad.robot.alter import with_group
from evenroad.robot.joint import Joint
from evenroad.robot.kinematics import held_values
from evenroad.robot.limits import require_within
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Scene

_SLACK = 1e-6
"""Values that files write differ by rounding [rad or m]."""


def named_states(robot: Robot, scene: Scene | None = None) -> dict[str, dict[str, float]]:
    """Return the named states of robot and scene, joint -> value; the scene's where both have one of a name."""
    states = {name: dict(values) for name, values in robot.states.items()}
    return states | {name: dict(values) for name, values in (scene.states if scene else {}).items()}


def at_states(robot: Robot, texts: Iterable[str], scene: Scene | None = None) -> Robot:
    """Return the robot with the joints outside of its group held where named states have them.

    Parameters
    ----------
    robot : Robot
        A robot.
    texts : iterable of str
        Start and goal of a plan, as :func:`configuration` takes them; what is no name of a state holds nothing.
    scene : Scene, optional
        Whose named states are known, too.

    Raises
    ------
    InvalidValue
        If two states have such a joint in different places, or one has it outside its limits.
    UnknownName
        If a state has a joint that the robot does not have.
    """
    states = named_states(robot, scene)
    joints = {joint.name: joint for joint in robot.joints}
    held: dict[str, float] = {}
    said: dict[str, str] = {}
    for name in (text.strip() for text in texts):
        for joint, written in _outside_group(robot, name, states.get(name, {})).items():
            value = _within_limits(joints[joint], written, name)
            if held.setdefault(joint, value) != value:
                raise InvalidValue(
                    f"joint {joint!r} is not planned for, so it cannot go from {held[joint]:.6g} in the state"
                    f" {said[joint]!r} to {value:.6g} in {name!r}; the group is {','.join(robot.group)}"
                )
            said.setdefault(joint, name)
    return with_group(robot, robot.group, {**robot.held, **held})


def state_values(robot: Robot, name: str, scene: Scene | None = None) -> npt.NDArray[np.float64]:
    """Return the configuration, (dim,), that a named state of robot or scene stands for [rad or m].

    Raises
    ------
    UnknownName
        If the state has a joint that the robot does not have.
    InvalidValue
        If it lacks a joint of the group, or has another joint elsewhere than where the robot holds it.
    """
    values = named_states(robot, scene)[name]
    missing = [joint for joint in robot.group if joint not in values]
    if missing:
        raise InvalidValue(f"the state {name!r} has no value for {', '.join(missing)}")
    held = held_values(robot)
    for joint, value in _outside_group(robot, name, values).items():
        if abs(value - held[joint]) > _SLACK:
            raise InvalidValue(
                f"the state {name!r} has joint {joint!r} at {value:.6g}, where {robot.name!r} holds it at"
                f" {held[joint]:.6g}: to hold it as the state does, see evenroad.robot.at_states"
            )
    return np.array([values[joint] for joint in robot.group], dtype=np.float64)


def _within_limits(joint: Joint, value: float, state: str) -> float:
    """Return the value, brought to a limit that it exceeds by no more than rounding."""
    nearest = min(max(value, joint.lower), joint.upper)
    if abs(value - nearest) > _SLACK:
        require_within(joint, value, f"the state {state!r}")
    return nearest


def _outside_group(robot: Robot, name: str, values: Mapping[str, float]) -> dict[str, float]:
    """Return what a state says of joints that are not planned for; of what is fixed or follows, it says nothing."""
    known = [joint.name for joint in robot.joints]
    for joint in values:
        if joint not in known:
            raise UnknownName.among(f"joint of the state {name!r}:", joint, known)
    return {joint: values[joint] for joint in held_values(robot) if joint in values}
