"""Equalities of a compiled MJCF as mimics and locked joints; closed loops are refused."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from evenroad.errors import BrokenFile
from evenroad.loading.mjcf_model import CompiledMjcf
from evenroad.robots.joint import Joint, Mimic


def with_equalities(mjcf: CompiledMjcf, joints: Sequence[Joint]) -> list[Joint]:
    """Return the joints after all equalities.

    ``q1 = c0 + c1 q2`` makes a mimic, ``q1 = c0`` a locked joint.  Inactive ones are left out with a note, and so are
    welds to bodies of motion capture, which are placed from outside.  Raises BrokenFile if bodies that move on each
    other are connected or welded, or an equality is of any other kind.
    """
    model, where = mjcf.model, mjcf.where
    mimics: dict[str, Mimic] = {}
    locked: dict[str, float] = {}
    for number in range(model.neq):
        kind = mjcf.kind_of("mjtEq", "mjEQ_", model.eq_type[number])
        if kind in ("connect", "weld"):
            said = _loop(mjcf, number, kind)
        elif kind == "joint":
            said = f"its equality of joint {mjcf.name('joint', model.eq_obj1id[number])!r}"
        else:
            said = f"its equality of {kind}s"
        if not said:
            continue
        if not model.eq_active0[number]:
            mjcf.notes.append(f"{said} is left out: it is not active")
        elif kind in ("connect", "weld"):
            raise BrokenFile(
                f"{where} closes a loop: {said}; links must form a tree, and without it this one would be planned as"
                " an open chain"
            )
        elif kind == "joint":
            _of_joint(mjcf, number, mimics, locked, f"{where} cannot be planned for: {said}")
        else:
            raise BrokenFile(f"{where} cannot be planned for: {said}, where only those of two joints are known")
    return [_changed(joint, mimics, locked) for joint in joints]


def _loop(mjcf: CompiledMjcf, number: int, kind: str) -> str:
    """Return, in words, the loop that an equality closes; empty if none."""
    model = mjcf.model
    joined = [int(model.eq_obj1id[number]), int(model.eq_obj2id[number])]
    if int(model.eq_objtype[number]) == int(mjcf.mujoco.mjtObj.mjOBJ_SITE):
        joined = [int(model.site_bodyid[site]) for site in joined]
    if model.body_weldid[joined[0]] == model.body_weldid[joined[1]]:
        return ""
    first, second = (mjcf.name("body", body) for body in joined)
    said = f"the {kind} of {first!r} with {second!r}"
    if any(model.body_mocapid[body] >= 0 for body in joined):
        mjcf.notes.append(f"{said} is left out: a body of motion capture goes where it is put")
        return ""
    return said


def _of_joint(mjcf: CompiledMjcf, number: int, mimics: dict[str, Mimic], locked: dict[str, float], said: str) -> None:
    """Add the mimic or locked joint that an equality makes."""
    model = mjcf.model
    first, second = int(model.eq_obj1id[number]), int(model.eq_obj2id[number])
    name = mjcf.name("joint", first)
    c0, c1, *others = model.eq_data[number][:5].tolist()
    if name in mimics or name in locked:
        raise BrokenFile(f"{said} is its second")
    own = float(model.qpos0[model.jnt_qposadr[first]])
    if second < 0 or not (c1 or any(others)):
        locked[name] = own + c0
        return
    if any(others):
        raise BrokenFile(f"{said} is not linear, which no mimic is")
    other = float(model.qpos0[model.jnt_qposadr[second]])
    mimics[name] = Mimic(mjcf.name("joint", second), c1, c0 + own - c1 * other)


def _changed(joint: Joint, mimics: dict[str, Mimic], locked: dict[str, float]) -> Joint:
    if joint.name in locked:
        value = locked[joint.name]
        kind = "revolute" if joint.kind == "continuous" else joint.kind
        return replace(joint, kind=kind, lower=value, upper=value)
    return replace(joint, mimic=mimics.get(joint.name))
