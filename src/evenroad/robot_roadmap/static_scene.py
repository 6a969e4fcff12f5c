"""The robot and static scene of a roadmap, and whether a world still has them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from evenroad.errors import InvalidValue
from evenroad.geometry.rotation import NO_ROTATION
from evenroad.geometry.shapes import PRIMITIVES
from evenroad.robot import ArmWorld, Obstacle, Robot, Scene, held_values, in_scene
from evenroad.robot_roadmap.arm_roadmap import ArmRoadmap

LONG = 120
"""Largest number of characters that describe a body."""


def require_within(roadmap: ArmRoadmap, world: ArmWorld) -> Scene:
    """Return the dynamic scene: obstacles of a world that are not in the static scene of a roadmap.

    Raises InvalidValue if the robot is another one, if its clearance is larger, or if an obstacle of the static scene
    stands elsewhere, has another shape, or lacks an allowed contact: the milestones would be in collision.
    """
    scene = require_agrees(roadmap.scene, world.scene)
    require_same_robot(roadmap.robot, roadmap.scene, world.robot.empty_handed())
    if world.clearance > roadmap.clearance:
        raise InvalidValue(
            f"the world has a clearance of {world.clearance:g} m, the roadmap was built with {roadmap.clearance:g} m:"
            " build it in a world of that clearance"
        )
    return scene


def require_agrees(static: Scene, scene: Scene) -> Scene:
    """Return a scene without what is in the static one; raise InvalidValue if they contradict each other."""
    fixed = {obstacle.name: obstacle for obstacle in static.obstacles}
    named = {obstacle.name for obstacle in scene.obstacles}
    for obstacle in scene.obstacles:
        made = fixed.get(obstacle.name, obstacle)
        if obstacle.body != made.body or obstacle.clearance > made.clearance:
            raise InvalidValue(
                f"obstacle {obstacle.name!r} of scene {scene.name!r} is a {_text(obstacle)}, in the roadmap's static"
                f" scene a {_text(made)}: build the roadmap for the scene as it is"
            )
    forbidden = sorted(pair for pair in static.allowed if pair[1] in named and pair not in scene.allowed)
    if forbidden:
        raise InvalidValue(
            f"scene {scene.name!r} has {forbidden[0][1]!r} but does not allow {forbidden[0][0]!r} to touch it, as the"
            " roadmap's static scene does: allow it, or build the roadmap without"
        )
    return scene.without(*(name for name in named if name in fixed))


def joined_scenes(static: Scene, scene: Scene) -> Scene:
    """Return a scene with all of the static one, repeated in it or not; raises as `require_agrees`."""
    require_agrees(static, scene)
    named = {obstacle.name for obstacle in scene.obstacles}
    return replace(
        scene,
        obstacles=(*(o for o in static.obstacles if o.name not in named), *scene.obstacles),
        allowed=scene.allowed | static.allowed,
        states={**static.states, **scene.states},
        limits={**static.limits, **_narrower(static, scene)},
    )


def left_to_check(robot: Robot, static: Scene, moving: Scene, everything: Scene) -> tuple[Robot, Scene]:
    """Return robot and scene with what a roadmap of the empty-handed robot in its static scene did not check.

    That is the moving obstacles; and for what the robot holds all obstacles and the robot itself.
    """
    held = set(robot.holds)
    if not held:
        return replace(robot, pairs=()), moving
    known = {(link, fixed.name) for link in robot.links if link not in held for fixed in static.obstacles}
    pairs = tuple(pair for pair in robot.pairs if not held.isdisjoint(pair))
    return replace(robot, pairs=pairs), replace(everything, allowed=everything.allowed | known)


def _narrower(static: Scene, scene: Scene) -> dict[str, tuple[float, float]]:
    """Return the ranges of a scene, cut to those of the static one."""
    ranges = {}
    for joint, (lower, upper) in scene.limits.items():
        least, most = static.limits.get(joint, (lower, upper))
        ranges[joint] = (max(lower, least), min(upper, most))
    return ranges


def _text(obstacle: Obstacle) -> str:
    apart = f" with a clearance of {obstacle.clearance:g} m" if obstacle.clearance else ""
    if obstacle.shape not in PRIMITIVES:
        return f"{obstacle.body}{apart}"
    size, xyz = (", ".join(f"{value:g}" for value in values) for values in (obstacle.size, obstacle.xyz))
    turned = ""
    if obstacle.rotation != NO_ROTATION:
        turned = f" turned by [{', '.join(f'{value:.4g}' for value in obstacle.rotation)}]"
    return f"{obstacle.shape} of {size} at ({xyz}){turned}{apart}"


def require_same_robot(made: Robot, static: Scene, given: Robot) -> None:
    """Raise InvalidValue unless a robot, in the static scene's ranges, moves and is tested as the one of a roadmap.

    Its limits may differ.  The text says what else does.
    """
    names = {joint.name for joint in given.joints}
    known = {joint: limits for joint, limits in static.limits.items() if joint in names}
    given = in_scene(given, replace(static, limits=known))
    if (difference := next(_differences(made, given), None)) is not None:
        other = "another group of" if made.links == given.links and made.group != given.group else "another robot,"
        raise InvalidValue(f"the roadmap was made for {other} {made.name!r}: {difference}")


def _differences(made: Robot, given: Robot) -> Iterator[str]:
    """Yield, in words, the differences of two robots that decide a check, except for limits."""
    for what, ours, theirs in (
        ("joints of the group", made.group, given.group),
        ("links", made.links, given.links),
    ):
        if tuple(ours) != tuple(theirs):
            yield _lists(what, ours, theirs)
    yield from _of_joints(made, given)
    # What a scene narrows keeps the bodies and pairs themselves.
    if not (made.capsules is given.capsules and made.hulls is given.hulls and made.pairs is given.pairs):
        yield from _of_bodies(made, given)
    if made.shapes != given.shapes:
        both = f"its {made.bodies}, now with its {given.bodies}"
        yield f"it touched obstacles with {both}: read both with the same bodies"
    was, now = dict(made.padding), dict(given.padding)
    for link in sorted(link for link in was.keys() | now.keys() if was.get(link) != now.get(link)):
        yield f"link {link!r} had a padding of {was.get(link, 0.0):g} m, now {now.get(link, 0.0):g} m"
    held = held_values(given)
    for name, value in held_values(made).items():
        if held.get(name) != value:
            yield f"joint {name!r} was held at {value:g}, now at {held.get(name)}"


def _of_joints(made: Robot, given: Robot) -> Iterator[str]:
    joints = {joint.name: joint for joint in given.joints}
    for joint in made.joints:
        other = joints.get(joint.name)
        if other is None:
            yield f"it had a joint {joint.name!r}, which this one lacks"
        elif other is joint:
            continue
        for field in ("kind", "parent", "child", "xyz", "rotation", "axis", "mimic"):
            was, now = getattr(joint, field), getattr(other, field)
            if was != now:
                yield f"joint {joint.name!r} had {field} {was}, now {now}"
    if len(joints) != len(made.joints):
        yield "this one has more joints"


def _of_bodies(made: Robot, given: Robot) -> Iterator[str]:
    for link in made.links:
        if _bodies(made, link) != _bodies(given, link):
            had, has = _lost(made, given, link), _lost(given, made, link)
            yield f"the bodies of {link!r} differ: it had {had}; this one has {has}"
    ours, theirs = (tuple(sorted(map(str, map(sorted, robot.pairs)))) for robot in (made, given))
    if ours != theirs:
        yield _lists("tested pairs", ours, theirs)


def _bodies(robot: Robot, link: str) -> list[str]:
    """Return the capsules and hulls of a link as texts; different bodies have different texts."""
    capsules = [f"a capsule of radius {c.radius!r} from {c.a!r} to {c.b!r}" for c in robot.capsules if c.link == link]
    hulls = [
        f"a hull of radius {hull.radius!r} of {hull.points.tolist()!r}" for hull in robot.hulls if hull.link == link
    ]
    return sorted(capsules + hulls)


def _lost(of: Robot, other: Robot, link: str) -> str:
    """Return the number of bodies of a link that another robot does not have, and the first of them."""
    lost = [body for body in _bodies(of, link) if body not in _bodies(other, link)]
    return f"{len(lost)}, {lost[0][:LONG]}" if lost else "none"


def _lists(what: str, ours: object, theirs: object) -> str:
    """Return, in words, the differences of two lists."""
    first, second = list(ours), list(theirs)  # type: ignore[call-overload]
    lost = [str(name) for name in first if name not in second]
    new = [str(name) for name in second if name not in first]
    if not (lost or new):
        return f"its {what} were in another order: {', '.join(map(str, first))}"
    parts = [f"{word} {', '.join(names[:6])}" for word, names in (("without", lost), ("with", new)) if names]
    return f"this one is {' and '.join(parts)} among its {what}"
