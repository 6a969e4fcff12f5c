"""Keyframes of a compiled MJCF as named states, and notes on what of it is left out."""

from __future__ import annotations

import numpy as np

from evenroad.errors import listed
from evenroad.loading.mjcf_model import CompiledMjcf

_SAME = 1e-6
"""Difference of ranges and poses below which they are equal."""


def keyframes(mjcf: CompiledMjcf) -> dict[str, dict[str, float]]:
    """Return the keyframes by name: joint -> value, for joints that turn or slide.

    Free joints and balls stay as they are drawn; a note says which keyframes have them elsewhere.
    """
    model = mjcf.model
    address = {
        mjcf.name("joint", number): int(model.jnt_qposadr[number])
        for number in range(model.njnt)
        if mjcf.kind_of("mjtJoint", "mjJNT_", model.jnt_type[number]) in ("hinge", "slide")
    }
    others = np.setdiff1d(np.arange(model.nq), list(address.values()))
    states, moved = {}, []
    for number in range(model.nkey):
        name, q = mjcf.name("key", number), model.key_qpos[number]
        states[name] = {joint: float(q[at]) for joint, at in address.items()}
        if np.abs(q[others] - model.qpos0[others]).max(initial=0.0) > _SAME:
            moved.append(name)
    if moved:
        mjcf.notes.append(f"free joints and balls stay as they are drawn, not as in keyframe {listed(moved)}")
    return states


def note_left_out(mjcf: CompiledMjcf) -> None:
    """Note what limits the motion of a robot, or is a part of it, and is not read."""
    model, notes = mjcf.model, mjcf.notes
    tendons = [mjcf.name("tendon", i) for i in range(model.ntendon) if model.tendon_limited[i]]
    if tendons:
        notes.append(f"the limits of tendons are left out: {listed(tendons)}")
    if model.nflex:
        notes.append(f"flexible bodies are left out: {listed(mjcf.name('flex', i) for i in range(model.nflex))}")
    narrower = [joint for i in range(model.nu) if (joint := _held_back(mjcf, i))]
    if narrower:
        notes.append(f"ranges of position actuators, narrower than those of joints, are left out: {listed(narrower)}")


def _held_back(mjcf: CompiledMjcf, number: int) -> str:
    """Return the joint whose limits a position actuator does not reach; "" for any other actuator."""
    mujoco, model = mjcf.mujoco, mjcf.model
    stiffness = model.actuator_gainprm[number][0]
    is_servo = (
        int(model.actuator_trntype[number]) == int(mujoco.mjtTrn.mjTRN_JOINT)
        and int(model.actuator_biastype[number]) == int(mujoco.mjtBias.mjBIAS_AFFINE)
        and model.actuator_biasprm[number][1] == -stiffness
        and model.actuator_gear[number][0] == 1.0
        and model.actuator_ctrllimited[number]
        and stiffness
    )
    if not is_servo:
        return ""
    joint = int(model.actuator_trnid[number][0])
    low, high = model.jnt_range[joint] if model.jnt_limited[joint] else (-np.inf, np.inf)
    low_driven, high_driven = model.actuator_ctrlrange[number]
    return mjcf.name("joint", joint) if low_driven > low + _SAME or high_driven < high - _SAME else ""
