"""Stage: the state of an arm between two steps of a task: its configuration, held objects and surroundings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_known
from evenroad._time_limit import look_at_clock
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue, UnknownName
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import WORLD
from evenroad.poses.chain import default_tip
from evenroad.robots.held import HeldObject
from evenroad.robots.kinematics import link_poses, tip_links
from evenroad.robots.robot import Robot
from evenroad.scenes.obstacle import Obstacle
from evenroad.scenes.scene import Scene
from evenroad.task.contact import core_of, distance_of
from evenroad.task.fingers import with_fingers
from evenroad.task.steps import Attach, Detach

Contacts = frozenset[tuple[str, str]]

_TO_HOLD = 8e-3
"""Time to make the tables of a robot that holds an object [s]."""


@dataclass(frozen=True, eq=False)
class Stage:
    """A world, and the configuration of its arm, (dim,).

    `near_start` are contacts, (link, obstacle), that are not tested on the straight line of the next motion from here.
    They are those of the gripper with an object that it has put down, and of an attached object with its support.
    `empty` is the robot without objects that the task attached.  `depths` are the allowed depths of such contacts of a
    held object, and `clearances` those that an object keeps from the robot after it is put down [m].
    """

    world: ArmWorld
    q: Floats
    empty: Robot
    near_start: Contacts = frozenset()
    depths: Mapping[str, float] = field(default_factory=dict)
    clearances: Mapping[str, float] = field(default_factory=dict)

    def with_contacts(self, contacts: Contacts, depths: Mapping[str, float] | None = None) -> ArmWorld:
        """Return the world in which some contacts are not tested; those of held or taken objects must not be deep.

        To bound their depth, the arm holds the object a second time, smaller by the allowed depth, or there is such an
        obstacle for its fingers.  `depths` are those of objects not yet held.  Capsules are wider than fingers, so a
        robot without true shapes may have them in the object.
        """
        look_at_clock()
        if not contacts:
            return self.world
        held, scene, robot = {each.name: each for each in self.world.scene.attached}, self.world.scene, self.world.robot
        deep = {**self.depths, **(depths or {})}
        for name in sorted({link for link, _ in contacts} & held.keys() & deep.keys()):
            robot = _holding_core(robot, held[name], deep[name], as_capsule=not robot.shapes)
        bodies = contacts - {each for each in contacts if each[1] in held}
        cores: list[Obstacle] = []
        allowed = set(scene.allowed)
        touched = {name for link, name in bodies if link not in held} & deep.keys()
        for each in (each for each in scene.obstacles if self.empty.shapes and each.name in touched):
            core = core_of(each.body, deep[each.name], as_capsule=False)
            if core is not None:
                cores.append(Obstacle(_smaller(each.name, deep[each.name]), core))
                allowed |= {(link, cores[-1].name) for link, name in scene.allowed if name == each.name}
        scene = replace(scene, obstacles=(*scene.obstacles, *cores), allowed=frozenset(allowed) | bodies)
        return replace(self.world, robot=robot, scene=scene)

    def gripping(self, step: Attach) -> ArmWorld:
        """Return the world in which the gripper may touch the object that it takes, but not deeply."""
        links = (carrier_of(step, self.world.robot), *touches(step, self.world.robot))
        return self.with_contacts(frozenset((link, step.object) for link in links), {step.object: step.depth})

    def attach(self, step: Attach, where: str, *, first: bool = False) -> Stage:
        """Return the stage after an obstacle is attached; `where` names the step.

        Raises UnknownName if there is no such obstacle.  Raises InvalidValue if it is out of reach or, at the `first`
        step, too deep in the gripper; a motion before it would prevent the latter.
        """
        scene, robot = self.world.scene, self.world.robot
        touching = touches(step, robot)
        found = [each for each in scene.obstacles if each.name == step.object]
        if not found:
            raise UnknownName.among(f"obstacle of {where}", step.object, scene.names)
        link = carrier_of(step, robot, where)
        if first and not (taking := self.gripping(step)).valid(self.q):
            raise InvalidValue(f"{where} attaches {step.object!r} where {taking.explain(self.q)}")
        look_at_clock()
        far = distance_of(found[0].body, robot, self.q, {link, *touching})
        if far > step.reach:
            raise InvalidValue(
                f"{where} attaches {step.object!r}, which is {far:.3g} m from {link!r} there, more than its reach of"
                f" {step.reach:g} m: let a MoveTo before it end at the object"
            )
        frame = pose_of(robot, self.q, link)
        body = replace(found[0].body, pose=frame.inverse() @ found[0].body.pose)
        held = HeldObject(step.object, body, link, touching)
        setup = replace(scene.setup, attached=(*scene.attached, held))
        attached = replace(scene.without(step.object), setup=setup)
        depths = {**self.depths, step.object: step.depth}
        clearances = {**self.clearances, step.object: found[0].clearance}
        stage = replace(self, depths=depths, clearances=clearances)
        stage = replace(stage, world=_world(stage, attached))
        # The object may touch its support until it is lifted.
        stood = frozenset((step.object, each) for each in stage.touched(step.object))
        return replace(stage, near_start=self.near_start | stood)

    def detach(self, step: Detach, where: str) -> Stage:
        """Return the stage after an object is detached.  Raises InvalidValue if the task has not attached it."""
        scene, robot = self.world.scene, self.world.robot
        held = {each.name: each for each in scene.attached if each.name not in self.empty.holds}
        if step.object not in held:
            holds = ", ".join(held) or "nothing that the task has attached"
            raise InvalidValue(f"{where} lets go of {step.object!r}, which it cannot: the arm holds {holds}")
        body = held[step.object].body
        frame = pose_of(robot, self.q, held[step.object].link)
        placed = Obstacle(step.object, replace(body, pose=frame @ body.pose, link=WORLD))
        placed = replace(placed, clearance=self.clearances.get(step.object, 0.0))
        left = tuple(each for each in scene.attached if each.name != step.object)
        allowed = frozenset(each for each in scene.allowed if each[0] != step.object)
        setup = replace(scene.setup, attached=left)
        scene = replace(scene, obstacles=(*scene.obstacles, placed), setup=setup, allowed=allowed)
        let_go = frozenset((link, step.object) for link in (held[step.object].link, *held[step.object].touches))
        # Contacts of the object itself end, because it is no longer a body of the robot.
        others = frozenset(each for each in self.near_start if each[0] != step.object)
        return replace(self, world=_world(self, scene), near_start=others | let_go)

    def with_fingers(self, values: Mapping[str, float]) -> Stage:
        """Return the stage with the fingers at these values, joint -> value, where the arm stays."""
        scene = self.world.scene
        states = {name: {j: v for j, v in said.items() if j not in values} for name, said in scene.states.items()}
        scene = replace(scene, setup=replace(scene.setup, states=states)) if states else scene
        stage = replace(self, empty=with_fingers(self.empty, values))
        return replace(stage, world=_world(stage, scene))

    def touched(self, held: str) -> list[str]:
        """Return the obstacles that a held object touches."""
        scene, world = self.world.scene, self.world
        found: list[str] = []
        for each in scene.obstacles:
            look_at_clock()
            alone = replace(scene, obstacles=(each,), allowed=frozenset(a for a in scene.allowed if a[1] == each.name))
            spared = replace(alone, allowed=alone.allowed | {(held, each.name)})
            if not replace(world, scene=alone).valid(self.q) and replace(world, scene=spared).valid(self.q):
                found.append(each.name)
        return found


def _smaller(name: str, depth: float) -> str:
    return f"{name} less {1e3 * depth:g} mm"


def carrier_of(step: Attach, robot: Robot, where: str = "the task") -> str:
    """Return the link that carries an object: that of the step, the last one, or the hand from which fingers branch.

    Raises InvalidValue, which names the step `where`, if there are several.
    """
    if step.link:
        return step.link
    try:
        return default_tip(robot)
    except InvalidValue:
        hands = tip_links(robot)
        if len(hands) != 1:
            raise InvalidValue(
                f"{where} must say which link of {robot.name!r} carries {step.object!r}: Attach({step.object!r},"
                f" link={hands[0]!r}), or {', '.join(hands[1:8])}"
            ) from None
        return hands[0]


def touches(step: Attach, robot: Robot) -> tuple[str, ...]:
    """Return the links that may touch an attached object; default: all that no planned joint moves against its link.

    Raises UnknownName if there is no such link.
    """
    if step.link:
        require_known(f"link that takes {step.object!r}:", step.link, robot.links)
    if step.touches is not None:
        return step.touches
    first = {robot.links[0]: robot.links[0]}
    for joint in robot.joints:
        leader = joint.name if joint.mimic is None else joint.mimic.joint
        first[joint.child] = joint.child if leader in robot.group else first[joint.parent]
    link = carrier_of(step, robot)
    return tuple(each for each in robot.links if first[each] == first[link] and each not in robot.holds)


def pose_of(robot: Robot, q: Floats, link: str) -> Pose:
    """Return the pose of a link at a configuration, (dim,)."""
    return Pose.from_matrix(link_poses(robot, q[np.newaxis])[0, robot.links.index(link)])


def _holding_core(robot: Robot, held: HeldObject, depth: float, *, as_capsule: bool) -> Robot:
    """Return the robot that holds an object a second time, smaller by a depth, if it does not yet."""
    name, core = _smaller(held.name, depth), core_of(held.body, depth, as_capsule=as_capsule)
    if core is None or name in robot.holds:
        return robot
    return robot.holding(HeldObject(name, core, held.link, held.touches))


def _world(stage: Stage, scene: Scene) -> ArmWorld:
    """Return the stage's world with another scene, and the robot that holds the attached objects.

    The smaller body that must not touch either is added at the same time, since making a robot is most of the work.
    """
    robot = stage.empty
    for held in scene.attached:
        if held.name not in robot.holds:
            look_at_clock(_TO_HOLD)
            # The core comes first, so that messages name the object if both touch.
            if held.name in stage.depths:
                as_capsule = not robot.holding(held).shapes
                robot = _holding_core(robot, held, stage.depths[held.name], as_capsule=as_capsule)
            look_at_clock(_TO_HOLD)
            robot = robot.holding(held)
    return replace(stage.world, robot=robot, scene=scene)
