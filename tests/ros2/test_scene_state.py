"""Planning scenes and differences to them: the scene after all of them is that of one whole message."""

from types import SimpleNamespace as Fields

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue
from evenroad.ros2.scene_state import SceneState, as_document, changed, joint_values, scene_of, standing_at_values

UR5 = er.load_robot("ur5")
HOME = dict(zip(UR5.group, (0.0, -1.57, 0.0, -1.57, 0.0, 0.0), strict=True))
ADD, REMOVE, APPEND, MOVE = range(4)


def thing(name, x=0.5, operation=ADD):
    at = {"position": {"x": x, "y": 0.3, "z": 0.5}, "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}
    whole = {"id": name, "operation": operation, "header": {"frame_id": "base_link"}}
    if operation == REMOVE:
        return whole
    if operation == MOVE:
        return {**whole, "pose": at}
    box = {"type": 1, "dimensions": [0.1, 0.1, 0.1]}
    return {**whole, "primitives": [box], "primitive_poses": [at]}


def scene(*things, joints=HOME, **more):
    state = {"joint_state": {"name": list(joints), "position": list(joints.values())}}
    return {"name": "cell", "world": {"collision_objects": list(things)}, "robot_state": state, **more}


def _found(document):
    return {each.name: each.xyz[0] for each in scene_of(document, UR5).obstacles}


def test_differences_add_move_and_remove_objects():
    whole = scene(thing("a", 0.4), thing("b", 0.6))
    whole = changed(whole, scene(thing("c", 0.7), thing("a", operation=REMOVE), is_diff=True))
    assert _found(whole) == {"b": 0.6, "c": 0.7}
    moved = changed(whole, scene(thing("b", 0.1, MOVE), is_diff=True))
    assert _found(moved)["b"] == pytest.approx(0.7)
    assert _found(changed(moved, scene(thing("", operation=REMOVE), is_diff=True))) == {}


def test_a_scene_of_many_differences_does_not_grow():
    whole = scene(thing("a"), thing("b"))
    for i in range(200):
        whole = changed(whole, scene(thing("a", 0.001 * i, MOVE), is_diff=True))
        whole = changed(whole, scene(thing("b", 0.001 * i), is_diff=True))
    assert len(whole["world"]["collision_objects"]) == 3
    assert _found(whole) == {"a": pytest.approx(0.699), "b": pytest.approx(0.199)}


def test_random_operations_leave_what_moveit_would_have():
    rng = np.random.default_rng(7)
    whole, there = scene(), {}
    for _ in range(150):
        name, operation = str(rng.choice(["a", "b", "c"])), int(rng.choice([ADD, REMOVE, MOVE]))
        if operation == MOVE and name not in there:
            continue
        x = float(rng.uniform(0.3, 0.7))
        whole = changed(whole, scene(thing(name, x, operation), is_diff=True))
        if operation == REMOVE:
            there.pop(name, None)
        else:
            # A box that is added is at its own pose; the pose of a moved object goes before that of its box.
            own = x if operation == ADD else there[name][0]
            there[name] = (own, own + (x if operation == MOVE else 0.0))
    assert _found(whole) == {name: pytest.approx(at) for name, (_, at) in there.items()}


def test_joints_padding_and_contacts_change_with_a_difference():
    padding = [{"link_name": "tool0", "padding": 0.01}]
    matrix = {"entry_names": ["tool0", "a"], "entry_values": [{"enabled": [False, True]}, {"enabled": [True, False]}]}
    whole = changed(scene(thing("a"), link_padding=padding), scene(joints={"elbow_joint": 1.0}, is_diff=True))
    whole = changed(whole, scene(is_diff=True, joints={}, allowed_collision_matrix=matrix))
    assert dict(zip(*whole["robot_state"]["joint_state"].values(), strict=True)) == {**HOME, "elbow_joint": 1.0}
    after = scene_of(whole, UR5)
    assert after.padding == {"tool0": 0.01}
    assert after.allowed == {("tool0", "a")}


def test_a_difference_needs_a_scene_and_a_refused_one_changes_nothing():
    state = SceneState(UR5)
    with pytest.raises(InvalidValue, match="before any whole one"):
        state.take(Fields(is_diff=True))
    message = Fields(
        name="cell",
        is_diff=False,
        world=Fields(collision_objects=[]),
        link_scale=[Fields(link_name="tool0", scale=1.1)],
    )
    with pytest.raises(InvalidValue, match="link_scale"):
        state.take(message)
    assert state.scene() is None


def test_a_message_becomes_plain_values():
    quaternion = Fields(x=0.0, y=0.0, z=0.0, w=0.0)
    message = Fields(operation=b"\x01", values=np.arange(2.0), orientation=quaternion, names=["a"])
    turn = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    assert as_document(message) == {"operation": 1, "values": [0.0, 1.0], "orientation": turn, "names": ["a"]}


def test_joint_states_say_where_the_group_and_the_others_are():
    state = Fields(name=[*HOME, "wheel"], position=[*HOME.values(), 7.0])
    values = joint_values(state, UR5, "it")
    robot, start = standing_at_values(values, UR5, "it")
    assert (robot.group, start) == (UR5.group, list(HOME.values()))
    with pytest.raises(InvalidValue, match="does not say where shoulder_pan_joint"):
        standing_at_values({}, UR5, "it")
    with pytest.raises(InvalidValue, match="1 names and 2 positions"):
        joint_values(Fields(name=["a"], position=[1.0, 2.0]), UR5, "it")
    with pytest.raises(InvalidValue, match="finite positions, got elbow_joint = nan"):
        joint_values(Fields(name=["elbow_joint"], position=[float("nan")]), UR5, "it")
