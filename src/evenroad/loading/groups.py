"""Groups of joints that are planned for, by name, and the chains of a robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from evenroad.errors import InvalidValue, Undecided, UnknownName, listed
from evenroad.loading.description import RobotDescription
from evenroad.loading.srdf import Srdf, few_of
from evenroad.robots.free_joints import named
from evenroad.robots.joint import Joint
from evenroad.robots.kinematics import KinematicTree, held_values

EVERY = "*"
"""Name for all joints of all groups."""


def choose_group(
    description: RobotDescription, srdf: Srdf | None, wanted: str | Sequence[str] | None
) -> tuple[str, ...]:
    """Return the joints that are planned for.

    `wanted` are groups of the SRDF and names of joints (as a text: with commas between them), in the order that is
    wanted; a joint of two groups counts for the first one.  ``*`` is all joints of all groups.  None: the SRDF's
    arm, see :func:`arm_group`, else every joint that moves, is no mimic and, by the SRDF, not passive.  None of a rigid
    body: another robot may carry it as a tool.  Raises UnknownName if there is no such group or joint; Undecided if
    none is wanted and the SRDF has several of which none is the arm; InvalidValue if a joint does not move or follows
    another, one is named twice, or no joint is left.
    """
    groups = {} if srdf is None else srdf.groups
    if wanted == EVERY and any(groups.values()):
        members = {name for joints in groups.values() for name in joints}
        return tuple(name for name in description.order if name in members)
    if wanted not in (None, EVERY):
        return _wanted_joints(description, groups, _words(wanted))
    if any(groups.values()):
        return groups[arm_group(description, groups)]
    if all(joint.kind == "fixed" for joint in description.joints):
        return ()
    return _movable_joints(description, srdf)


def _wanted_joints(
    description: RobotDescription, groups: Mapping[str, tuple[str, ...]], words: Sequence[str]
) -> tuple[str, ...]:
    """Return the joints of the groups and joints that words name, in this order."""
    owners = {joint.of for joint in description.joints}
    if groups and words and not set(words) & {*description.order, *groups, *owners}:
        raise UnknownName.among("group", ",".join(words), groups)
    chosen: list[str] = []
    for word in words:
        if word in groups:
            own = _not_empty(groups[word], f"group {word!r}")
            chosen += [name for name in own if name not in chosen]
        else:
            for name in named(word, description.joints) or [word]:
                _require_movable(description, name, chosen)
                chosen.append(name)
    return _not_empty(tuple(chosen), "the group")


def _movable_joints(description: RobotDescription, srdf: Srdf | None) -> tuple[str, ...]:
    """Return every joint that moves on its own, in the order of the file."""
    free = description.free - (frozenset() if srdf is None else srdf.passive)
    said = "".join(f"; {note}" for note in description.notes if note.startswith("joint"))
    locked = [joint.name for joint in description.joints if joint.kind != "fixed" and joint.lower == joint.upper]
    said = said or (f"; limits that are equal lock {', '.join(locked)}" if locked else "")
    loose = {joint.name for joint in description.joints if joint.of}
    return _not_empty(
        tuple(name for name in description.order if name in free - loose), f"robot {description.name!r}", said
    )


def arm_group(description: RobotDescription, groups: Mapping[str, tuple[str, ...]]) -> str:
    """Return the name of the group that is planned for where none is wanted, of those with joints.

    It is the only one, or else the longest chain: its joints follow each other without a branch, and none of them is a
    gripper's (see :func:`chains`).  Undecided if there is no chain, or another one as long.
    """
    filled = {name: joints for name, joints in groups.items() if joints}
    if len(filled) == 1:
        return next(iter(filled))
    runs = [{joint.name for joint in run} for run in chains(description.joints).values()]
    serial = {name: joints for name, joints in filled.items() if any(run >= set(joints) for run in runs)}
    longest = max(map(len, serial.values()), default=0)
    found = {name: joints for name, joints in serial.items() if len(joints) == longest}
    # A finger may have as many joints as the arm that carries it; parts of one run are no finger and arm.
    run_of = {joint: i for i, run in enumerate(runs) for joint in run}
    carried = {
        name
        for name, joints in found.items()
        for others in found.values()
        if run_of[joints[0]] != run_of[others[0]] and joints[0] in _below(description, others[-1])
    }
    found = {name: joints for name, joints in found.items() if name not in carried}
    if len(set(found.values())) != 1:
        which = "no one of which is the longest chain" if found else "none of which is a chain"
        raise Undecided(
            f"the SRDF has several groups, {which}; say with --group (group=) which one is planned for:"
            f" {few_of(list(filled))}"
        )
    return next(iter(found))


def _below(description: RobotDescription, name: str) -> set[str]:
    """Return the joints that a joint moves."""
    moved = {joint.child for joint in description.joints if joint.name == name}
    below = set()
    for joint in description.joints:
        if joint.parent in moved:
            moved.add(joint.child)
            below.add(joint.name)
    return below


def group_notes(
    description: RobotDescription, srdf: Srdf | None, wanted: str | Sequence[str] | None
) -> tuple[str, ...]:
    """Return a note about the group that was chosen by default, where there were several."""
    names = [] if srdf is None else [name for name, joints in srdf.groups.items() if joints]
    if srdf is None or wanted not in (None, EVERY) or len(names) < 2:
        return ()
    if wanted == EVERY:
        return (f"planned for are the joints of all groups of the SRDF; --group chooses one of {listed(names)}",)
    chosen = arm_group(description, srdf.groups)
    others = few_of([name for name in names if name != chosen])
    return (f"planned for is the group {chosen!r}, the longest chain of the SRDF; --group chooses from {others}, too",)


def chosen_states(
    srdf: Srdf, chosen: tuple[str, ...], wanted: str | Sequence[str] | None
) -> dict[str, dict[str, float]]:
    """Return the named states with a value for every joint chosen; states of the wanted groups come first."""
    mine = _words(wanted or ())

    def strangeness(group_and_name: tuple[str, str]) -> tuple[bool, bool]:
        group, _ = group_and_name
        return group not in mine, srdf.groups[group] != chosen

    found: dict[str, dict[str, float]] = {}
    together: dict[str, dict[str, float]] = {}
    for group, name in sorted(srdf.states, key=strangeness):
        values = dict(srdf.states[group, name])
        if group in mine:
            # Two arms are at home if each is, by the state of its own group.
            values = together[name] = values | together.get(name, {})
        if set(chosen) <= set(values):
            found.setdefault(name, values)
    return found


def held_states(srdf: Srdf, robot: KinematicTree) -> dict[str, float]:
    """Return the values of a robot's held joints in the first named state that has them, joint -> value."""
    held: dict[str, float] = {}
    joints = {joint.name: joint for joint in robot.joints}
    for values in srdf.states.values():
        for name in held_values(robot):
            lower, upper = joints[name].stops
            if name in values and lower <= values[name] <= upper:
                held.setdefault(name, values[name])
    return held


def _words(wanted: str | Sequence[str]) -> list[str]:
    words = wanted.split(",") if isinstance(wanted, str) else wanted
    return [word.strip() for word in words if word.strip()]


def _require_movable(description: RobotDescription, name: str, others: Sequence[str]) -> None:
    """Raise unless a joint that was named can be planned for beside others."""
    joints = {joint.name: joint for joint in description.joints}
    if name not in joints:
        movable = [each.name for each in description.joints if each.kind != "fixed" and each.mimic is None]
        raise UnknownName.among("joint of the group", name, movable)
    joint = joints[name]
    if joint.mimic is not None:
        raise InvalidValue(f"joint {name!r} cannot be planned for: it follows {joint.mimic.joint!r}")
    if joint.kind == "fixed":
        raise InvalidValue(f"joint {name!r} cannot be planned for: it is fixed")
    if name in others:
        raise InvalidValue(f"joint {name!r} is named twice in the group")


def _not_empty(joints: tuple[str, ...], what: str, said: str = "") -> tuple[str, ...]:
    if not joints:
        raise InvalidValue(f"{what} has no joint that could be planned for{said}")
    return joints


def chains(joints: Sequence[Joint]) -> dict[str, list[Joint]]:
    """Return the runs of joints that move by themselves, one after the other without a branch, by their last link.

    A joint that others mimic is that of a gripper, and begins a run.
    """
    free = {
        joint.child: joint
        for joint in joints
        if joint.kind != "fixed" and joint.mimic is None and joint.lower < joint.upper and not joint.of
    }
    parent = {joint.child: joint.parent for joint in joints}
    followers: dict[str | None, list[Joint]] = {}
    for joint in free.values():
        above: str | None = joint.parent
        while above is not None and above not in free:
            above = parent.get(above)
        followers.setdefault(above, []).append(joint)
    leaders = {joint.mimic.joint for joint in joints if joint.mimic is not None}
    following = {
        many[0].name: above
        for above, many in followers.items()
        if above is not None and len(many) == 1 and many[0].name not in leaders
    }
    runs: dict[str, list[Joint]] = {}
    for joint in free.values():
        # Every joint comes after the one that it follows.
        above = following.get(joint.name)
        run = [] if above is None else runs.pop(above)
        runs[joint.child] = [*run, joint]
    return runs
