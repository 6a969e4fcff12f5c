"""Named states, and configurations as people write them: a list, joint by joint, or a name."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import as_row, require_known
from evenroad.errors import InvalidValue, UnknownName, listed, near, shown
from evenroad.robots.joint import Joint, require_within
from evenroad.robots.kinematics import held_values
from evenroad.robots.robot import ConfigurationLike, Robot, require_robot
from evenroad.robots.variants import with_group
from evenroad.scenes.scene import Scene, limits_in_words
from evenroad.space.joints import SLACK

_PAIR = re.compile(r"[\s,]*([^=,]*?)\s*=\s*([^\s,=]*)")
"""Pattern of ``name=value``; names may have blanks."""


def named_states(robot: Robot, scene: Scene | None = None) -> dict[str, dict[str, float]]:
    """Return the named states of robot and scene, joint -> value; the scene's where both have one of a name."""
    require_robot(robot)
    states = {name: dict(values) for name, values in robot.states.items()}
    return states | {name: dict(values) for name, values in (scene.states if scene else {}).items()}


def at_states(robot: Robot, texts: Iterable[str], scene: Scene | None = None) -> Robot:
    """Return the robot with the joints outside of its group held where named states, also of the scene, have them.

    `texts` are start and goal of a plan, as :func:`configuration` takes them; those that name no state hold no joint.
    Raises InvalidValue if two states have such a joint in different places, or one has it outside its limits;
    UnknownName if a state has a joint that the robot does not have.
    """
    names = [text.strip() for text in texts]
    if not names:
        return robot
    states = named_states(robot, scene)
    joints = {joint.name: joint for joint in robot.joints}
    held: dict[str, float] = {}
    said: dict[str, str] = {}
    for name in names:
        for joint, value in _outside_group(robot, name, states.get(name, {})).items():
            _require_within(joints[joint], value, f"the state {name!r}", scene)
            if abs(held.setdefault(joint, value) - value) > SLACK:
                raise InvalidValue(
                    f"joint {joint!r} is not planned for, so it cannot go from {held[joint]:.6g} in the state"
                    f" {said[joint]!r} to {value:.6g} in {name!r}; the group is {','.join(robot.group)}"
                )
            said.setdefault(joint, name)
    return with_group(robot, robot.group, {**robot.held, **held}) if held else robot


def _in_order(robot: Robot, name: str, values: Mapping[str, float]) -> Floats:
    """Return the values of a state as a configuration, (dim,) [rad or m].

    UnknownName if the state has a joint that the robot does not have; InvalidValue if it lacks a joint of the group, or
    has another joint elsewhere than where the robot holds it.
    """
    missing = [joint for joint in robot.group if joint not in values]
    if missing:
        raise InvalidValue(f"the state {name!r} has no value for {', '.join(missing)}")
    held = held_values(robot)
    for joint, value in _outside_group(robot, name, values).items():
        if abs(value - held[joint]) > SLACK:
            raise InvalidValue(
                f"the state {name!r} has joint {joint!r} at {value:.6g}, where {robot.name!r} holds it at"
                f" {held[joint]:.6g}: to hold it as the state does, see evenroad.robot.at_states"
            )
    return np.array([values[joint] for joint in robot.group], dtype=np.float64)


def _require_within(joint: Joint, value: float, what: str, scene: Scene | None) -> None:
    """Raise InvalidValue as `require_within`; the text names the scene where it is the scene that narrows."""
    require_within(joint, value, what, limits_in_words(scene, joint.name, *joint.stops))


def _outside_group(robot: Robot, name: str, values: Mapping[str, float]) -> dict[str, float]:
    """Return a state's values of movable joints outside of the group, without those of fixed joints and mimics."""
    known = [joint.name for joint in robot.joints]
    for joint in values:
        require_known(f"joint of the state {name!r}:", joint, known)
    return {joint: values[joint] for joint in held_values(robot) if joint in values}


def configuration(robot: Robot, text: str, scene: Scene | None = None, *, degrees: bool = False) -> Floats:
    """Return the configuration that a text describes, (dim,) [rad or m], in the order of the robot's group.

    Parameters
    ----------
    text : str
        One number a joint of the group, with commas (or blanks) between them, also in brackets as ROS prints a list:
        ``0,-1.57,0,-1.57,0,0``; or
        ``name=value`` for some joints of the group, the others at 0, or at the nearest to it within limits; or the
        name of a state, also of the `scene`.
    degrees : bool
        Angles in `text` are degrees; lengths stay metres, and named states what they are.

    Raises InvalidValue if a number is not one, there are too many or too few, a joint is given twice, or a value is
    outside the joint's limits by more than 1e-5: the text says which joint, and by how much; or if a state has a joint
    outside of the group elsewhere than where the robot holds it, which would be another posture: see :func:`at_states`.
    UnknownName if there is no such state, or no such joint in the group.
    """
    require_robot(robot)
    if not text.replace(",", " ").split():
        raise InvalidValue(f"a configuration of {robot.name!r} must not be empty")
    states = named_states(robot, scene)
    name = text.strip()
    if name in states:
        q = _in_order(robot, name, states[name])
    elif "=" in text:
        q = _from_pairs(robot, text, degrees)
    else:
        q = _from_list(robot, name[1:-1] if name[0] + name[-1] == "[]" else name, states, degrees)
    joints = {joint.name: joint for joint in robot.joints}
    for joint, value in zip(robot.group, q.tolist(), strict=True):
        _require_within(joints[joint], value, repr(text), scene)
    return q


def as_configuration(
    robot: Robot, q: ConfigurationLike, scene: Scene | None = None, *, name: str = "q", degrees: bool = False
) -> Floats:
    """Return a configuration, (dim,) [rad or m], from a text, a mapping or numbers; `name` names it in errors.

    Parameters
    ----------
    q : array_like, shape (dim,), mapping or str
        Numbers in the order of the group; or joint -> value, where joints that are left out are at 0, or the nearest to
        it within limits; or a text as :func:`configuration` takes it.
    degrees : bool
        Angles in a text are degrees.

    Raises as :func:`configuration` of texts; InvalidValue for another number of finite numbers, and for a joint
    outside of the group elsewhere than where the robot holds it; UnknownName for a joint that is not there.  Numbers
    and mappings may be outside of the limits.
    """
    require_robot(robot)
    if isinstance(q, str):
        return configuration(robot, q, scene, degrees=degrees)
    if not isinstance(q, np.ndarray) and isinstance(q, Mapping):
        neutral = {joint.name: joint.neutral for joint in robot.joints if joint.name in robot.group}
        return _in_order(robot, name, {**neutral, **{str(joint): _number(name, q, joint) for joint in q}})
    dim = len(robot.group)
    try:
        row = np.array(q, dtype=np.float64)
    except (TypeError, ValueError):
        row = np.empty(0)
    if row.shape != (dim,) or not all(map(math.isfinite, row.tolist())):
        several = f"; of {len(row)} rows give one" if row.ndim == 2 and row.shape[1:] == (dim,) else ""
        raise InvalidValue(f"{name} must be {dim} finite numbers, {','.join(robot.group)}, got {shown(q)}{several}")
    return row


def _number(name: str, values: Mapping[str, float], joint: str) -> float:
    """Return the value of a joint as a finite number."""
    (value,) = as_row(f"joint {joint!r} of {name}", [values[joint]], 1)
    return value


def _from_pairs(robot: Robot, text: str, degrees: bool) -> Floats:
    joints = {joint.name: joint for joint in robot.joints}
    values: dict[str, float] = {}
    offset = 0
    while pair := _PAIR.match(text, offset):
        offset = pair.end()
        name, number = pair.groups()
        require_known(f"joint of {robot.name!r}:", name, robot.group)
        if name in values:
            raise InvalidValue(f"joint {name!r} is given twice")
        values[name] = _value(robot, name, number, degrees)
    rest = text[offset:].strip(", \t\n")
    if rest:
        raise InvalidValue(f"{rest!r} is not of the form name=value")
    neutral = {name: joints[name].neutral for name in robot.group}
    return np.array([values.get(name, neutral[name]) for name in robot.group])


def _from_list(robot: Robot, text: str, states: Mapping[str, object], degrees: bool) -> Floats:
    words = text.replace(",", " ").split()
    if len(words) == 1 and not _is_number(words[0]):
        numbers = f"{len(robot.group)} numbers: {','.join(robot.group)}"
        if not states:
            raise UnknownName(
                f"unknown state {shown(text.strip())}: {robot.name!r} has no named states, as it has no SRDF: name some"
                f" under `states:` of the scene, or give {numbers}"
            )
        meant = near(text.strip(), states) or f"known: {listed(sorted(states))}; or give {numbers}"
        raise UnknownName(f"unknown state {shown(text.strip())}; {meant}")
    if len(words) != len(robot.group):
        raise InvalidValue(
            f"a configuration of {robot.name!r} has {len(robot.group)} numbers, {','.join(robot.group)};"
            f" got {len(words)} in {text!r}"
        )
    pairs = zip(robot.group, words, strict=True)
    return np.array([_value(robot, name, word, degrees) for name, word in pairs])


def _value(robot: Robot, name: str, word: str, degrees: bool) -> float:
    if not _is_number(word):
        raise InvalidValue(f"joint {name!r} must be a finite number, got {word!r}")
    is_angle = next(joint.kind for joint in robot.joints if joint.name == name) != "prismatic"
    return math.radians(float(word)) if degrees and is_angle else float(word)


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False
