"""Tasks from YAML files: the robot, its scene, a start, and the steps."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import reduce
from operator import and_
from pathlib import Path
from typing import Any, TypeVar

from evenroad._call import explains_calls
from evenroad._yaml import numbers, read_mapping, require_keys
from evenroad.constraints.text import constraint_of
from evenroad.constraints.tip import KeepUpright
from evenroad.errors import EvenroadError, InvalidValue, shown
from evenroad.poses.constraint import Constraint
from evenroad.poses.pose_goal import PoseGoal, as_axis, as_numbers, pose_of
from evenroad.task.gripper import Close, Open
from evenroad.task.steps import Attach, Detach, MoveAlong, MoveCircular, MoveLinear, MoveTo, Step, Wait
from evenroad.task.task import Task

_T = TypeVar("_T")
_TO_POSES = ("tip", "frame", "free_axis", "tolerance")
_OF_A_CURVE = ("tip", "frame", "speed")
_OF_A_MOTION = ("goals", "poses", "approach", "retreat", "away", "upright", "constraints", *_TO_POSES)


@dataclass(frozen=True)
class TaskFile:
    """A task from a file, with the `robot` and `scene` that it names, or None; `scene` may be a mapping.

    Paths are relative to the folder of the task's file.
    """

    task: Task
    start: str
    robot: str | None = None
    scene: str | Mapping[str, object] | None = None


@explains_calls
def load_task(path: str | os.PathLike[str]) -> TaskFile:
    """Return a task from its YAML file.

    ::

        robot: ur5                        # a name, or a file beside this one
        scene: shelf.yaml                 # a name, a file, or what a scene's file says
        start: home                       # as evenroad plan --start takes it
        steps:
          - move_to: {poses: ["0.5 0.2 0.142 3.14159 0 0"], free_axis: z, approach: 0.1}
          - attach: can                   # or {object: can, link: tool0, touches: [...], depth: 0.005, reach: 0.1}
          - move_to: {poses: ["0.5 -0.3 0.061 0 0 0"], tip: can, free_axis: z, retreat: 0.05,
                      approach: 0.05, away: up}
          - detach: {object: can, onto: [table]}
          - open:                           # or a value, or {to: ..., link: hand}; also - close: {until: can}
          - wait: 0.5
          - move_linear: "0.5 -0.3 0.3 0 0 0"     # or {pose: ..., tip: tool0, frame: base_link, speed: 0.1}
          - move_along: {poses: ["0.5 -0.2 0.3 0 0 0", ...], blend: 0.02}     # or spline: true; speed
          - move_circular: {via: "0.6 -0.1 0.3 0 0 0", to: "0.5 0 0.3 0 0 0", speed: 0.1}
          - move_to: home                 # a goal, or {goals: [home, "0 -1.57 0 -1.57 0 0"], retreat: 0.1}

    Poses are texts like those of ``--goal-pose`` [m, rad].  With ``upright: 0.1`` the tip tilts by at most that.
    ``constraints: [line y, orientation 0.001]`` are texts like those of ``--constraint``.

    Parameters
    ----------
    path : str or path-like

    Raises
    ------
    BrokenFile
        If the file is missing or is not YAML.
    UnknownName, InvalidValue
        For an unknown key or an invalid value; the text names the step.
    """
    file = Path(path)
    said = read_mapping(file, "task")
    require_keys(said, ("start", "steps"), ("robot", "scene"), f"{file}")
    steps = said["steps"]
    if not isinstance(steps, list):
        raise InvalidValue(f"steps in {file} must be a list, got {shown(steps)}")
    made = []
    for number, step in enumerate(steps):
        try:
            made.append(_step(step))
        except EvenroadError as error:
            raise type(error)(f"step {number} in {file}: {error}") from None
    for name in ("robot", "start"):
        if name in said and not isinstance(said[name], str):
            raise InvalidValue(f"{name} in {file} must be a text, got {shown(said[name])}")
    return TaskFile(Task(made), said["start"], _beside(file, said.get("robot")), _beside(file, said.get("scene")))


def _beside(file: Path, source: _T) -> _T | str:
    """Return the path of a file of this name beside the task's file, if there is one."""
    found = file.parent / source if isinstance(source, str) else None
    return source if found is None or not found.is_file() else str(found)


def _step(said: object) -> Step:
    """Return a step from ``{kind: what}``, or the name of one that needs nothing."""
    said = {said: None} if said in ("open", "close") else said
    if not isinstance(said, Mapping) or len(said) != 1:
        raise InvalidValue(f"a step must be one of {', '.join(f'{kind}: ...' for kind in _STEPS)}, got {shown(said)}")
    require_keys([str(key) for key in said], (), _STEPS, "a step")
    ((kind, what),) = said.items()
    return _STEPS[kind](what)


def _move_to(what: object) -> MoveTo:
    if isinstance(what, str):
        return MoveTo(what)
    said = _mapping("move_to", what, (), _OF_A_MOTION)
    goals: list[str | PoseGoal] = [str(each) for each in _texts("goals", said)]
    tip, frame = str(said.get("tip", "")), str(said.get("frame", ""))
    axis = as_axis("free_axis", said["free_axis"]) if "free_axis" in said else None
    near, tilt, *_ = (*as_numbers("tolerance", str(said.get("tolerance", "0 0")), (1, 2)), 0.0)
    for text in _texts("poses", said):
        pose, turned = pose_of(str(text))
        if axis is not None and not turned:
            raise InvalidValue(f"free_axis needs a rotation, got the pose {shown(text)} without one")
        goals.append(PoseGoal(pose, tip, frame, axis, not turned, near, tilt))
    if not goals:
        raise InvalidValue("move_to needs goals or poses")
    lines = {name: said[name] for name in ("approach", "retreat", "away") if name in said}
    keeps: list[Constraint] = [constraint_of(str(text)) for text in _texts("constraints", said)]
    if "upright" in said:
        keeps.append(KeepUpright(numbers([said["upright"]], 1, "upright")[0]))
    return MoveTo(goals[0] if len(goals) == 1 else goals, constraints=reduce(and_, keeps) if keeps else None, **lines)


def _move_linear(what: object) -> MoveLinear:
    said = _mapping("move_linear", {"pose": what} if isinstance(what, str) else what, ("pose",), _OF_A_CURVE)
    return MoveLinear(_whole(said, said["pose"]), speed=said.get("speed"))


def _move_along(what: object) -> MoveAlong:
    said = _mapping("move_along", what, ("poses",), ("blend", "spline", *_OF_A_CURVE))
    options = {name: said[name] for name in ("blend", "spline", "speed") if name in said}
    return MoveAlong([_whole(said, text) for text in _texts("poses", said)], **options)  # type: ignore[arg-type]


def _move_circular(what: object) -> MoveCircular:
    said = _mapping("move_circular", what, ("via", "to"), _OF_A_CURVE)
    return MoveCircular(_whole(said, said["via"]), _whole(said, said["to"]), speed=said.get("speed"))


def _whole(said: Mapping[str, object], text: object) -> PoseGoal:
    """Return a pose with a rotation, of the step's tip."""
    pose, turned = pose_of(str(text))
    if not turned:
        raise InvalidValue(f"a pose along a curve needs a rotation, got {shown(text)} without one")
    return PoseGoal(pose, str(said.get("tip", "")), str(said.get("frame", "")))


def _attach(what: object) -> Attach:
    said = {"object": what} if isinstance(what, str) else what
    return Attach(**_mapping("attach", said, ("object",), ("link", "touches", "depth", "reach")))


def _detach(what: object) -> Detach:
    said = {"object": what} if isinstance(what, str) else what
    return Detach(**_mapping("detach", said, ("object",), ("onto",)))


def _open(what: object) -> Open:
    said = what if isinstance(what, Mapping) else {} if what is None else {"to": what}
    return Open(**_mapping("open", said, (), ("to", "link")))


def _close(what: object) -> Close:
    said = what if isinstance(what, Mapping) else {} if what is None else {"to": what}
    return Close(**_mapping("close", said, (), ("to", "until", "link")))


def _wait(what: Any) -> Wait:
    return Wait(what)


def _mapping(kind: str, what: object, required: tuple[str, ...], optional: tuple[str, ...]) -> dict[str, Any]:
    if not isinstance(what, Mapping):
        raise InvalidValue(f"{kind} must have key: value pairs, got {shown(what)}")
    require_keys([str(key) for key in what], required, optional, kind)
    return dict(what)


def _texts(name: str, said: Mapping[str, object]) -> list[object]:
    given = said.get(name, [])
    return given if isinstance(given, list) else [given]


_STEPS: dict[str, Callable[[object], Step]] = {
    "move_to": _move_to,
    "move_linear": _move_linear,
    "move_along": _move_along,
    "move_circular": _move_circular,
    "attach": _attach,
    "detach": _detach,
    "open": _open,
    "close": _close,
    "wait": _wait,
}
