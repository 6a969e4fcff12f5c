"""Which joints are planned for."""

from __future__ import annotations

from collections.abc import Sequence

from evenroad.errors import InvalidValue, UnknownName
from evenroad.robot.srdf import Srdf
from evenroad.robot.urdf import Urdf


def choose_group(urdf: Urdf, srdf: Srdf | None, wanted: str | Sequence[str] | None) -> tuple[str, ...]:
    """Return the joints of a planning group in the order of the URDF.

    Parameters
    ----------
    urdf, srdf : Urdf, Srdf or None
        The robot.
    wanted : str, sequence of str, or None
        A group of the SRDF, or names of joints (as a text: with commas between them).  None: the SRDF's group where
        it has one, else every joint that moves, is no mimic and, by the SRDF, not passive.

    Raises
    ------
    UnknownName
        If there is no such group or joint.
    InvalidValue
        If the SRDF has several groups and none is wanted, a joint does not move or follows another, one is named
        twice, or no joint is left.
    """
    groups = {} if srdf is None else srdf.groups
    if isinstance(wanted, str):
        if wanted in groups:
            return _not_empty(groups[wanted], f"group {wanted!r}")
        wanted = [name.strip() for name in wanted.split(",") if name.strip()]
        if groups and not set(wanted) & set(urdf.order):
            raise UnknownName.among("group", ",".join(wanted), groups)
    if wanted is not None:
        return _listed(urdf, wanted)
    if len(groups) > 1:
        raise InvalidValue(f"the SRDF has several groups, say which one is planned for: {', '.join(groups)}")
    if groups:
        ((name, joints),) = groups.items()
        return _not_empty(joints, f"group {name!r}")
    free = urdf.free - (frozenset() if srdf is None else srdf.passive)
    return _not_empty(tuple(name for name in urdf.order if name in free), f"robot {urdf.name!r}")


def _listed(urdf: Urdf, wanted: Sequence[str]) -> tuple[str, ...]:
    joints = {joint.name: joint for joint in urdf.joints}
    movable = [name for name in urdf.order if joints[name].kind != "fixed" and joints[name].mimic is None]
    for name in wanted:
        if name not in joints:
            raise UnknownName.among("joint of the group", name, movable)
        mimic = joints[name].mimic
        if mimic is not None:
            raise InvalidValue(f"joint {name!r} cannot be planned for: it follows {mimic.joint!r}")
        if joints[name].kind == "fixed":
            raise InvalidValue(f"joint {name!r} cannot be planned for: it is fixed")
        if list(wanted).count(name) > 1:
            raise InvalidValue(f"joint {name!r} is named twice in the group")
    return _not_empty(tuple(name for name in urdf.order if name in wanted), "the group")


def _not_empty(joints: tuple[str, ...], what: str) -> tuple[str, ...]:
    if not joints:
        raise InvalidValue(f"{what} has no joint that could be planned for")
    return joints
