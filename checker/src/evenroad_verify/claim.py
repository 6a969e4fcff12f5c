"""The claim: which bodies are proved apart, and which are not spoken of."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np

from evenroad_verify.certificate import Certificate
from evenroad_verify.errors import Pose, demand, require
from evenroad_verify.files import Files
from evenroad_verify.frames import Frames, frames_of
from evenroad_verify.nodes import Nodes
from evenroad_verify.robot import Robot, read_robot
from evenroad_verify.scene import GROUND, Scene, read_scene
from evenroad_verify.shapes import Shape

Places: TypeAlias = dict[str, tuple[int, Pose]]
ENDLESS = 1000.0
"""A range of more than this is none [rad or m]."""
BEYOND = 1e-5
"""By how much a waypoint may exceed a limit, as planners do by rounding [rad or m]."""


@dataclass(frozen=True)
class Pair:
    """Two nodes that are proved to keep more than a distance [m]; `names` are their bodies."""

    first: int
    second: int
    keep: float
    names: tuple[str, str]


@dataclass(frozen=True)
class Inputs:
    """What the files say, whose digest is `digest`."""

    robot: Robot
    scene: Scene
    digest: str
    carried: tuple[tuple[str, bytes], ...] = ()
    """Names and contents of the files that the certificate carries."""


@dataclass(frozen=True)
class Claim:
    """Frames that move, nodes, and pairs of nodes; `silent` are lines about what is not claimed."""

    frames: Frames
    nodes: Nodes
    pairs: tuple[Pair, ...]
    silent: tuple[str, ...]


def read_inputs(
    robot: Path | None,
    scene: Path | None,
    srdf: Path | None,
    packages: dict[str, Path],
    certificate: Certificate | None = None,
) -> Inputs:
    """Return what the files of a robot and a scene say; BadInput where one cannot be read.

    Those that a certificate carries stand for them, and a file that is given besides must be what they were made of.
    """
    files = Files(() if certificate is None else certificate.carried)
    own = (None, None) if certificate is None else (certificate.robot, certificate.scene)
    files.own = own[0] is not None
    if own[0] is not None:
        files.require_same(robot, own[0])
        robot, srdf = Path("robot.urdf"), Path("robot.srdf")
    require(robot is not None, "the certificate carries no robot: give its URDF")
    read = read_robot(files, Path(robot or ""), srdf, packages)
    files.own = own[1] is not None
    if own[1] is not None:
        files.require_same(scene, own[1])
        scene = Path("scene.yaml")
    require(scene is not None, "the certificate carries no scene: give its file")
    around = read_scene(files, Path(scene or ""))
    demand(files.is_done, "it carries more files than it needs")
    return Inputs(read, around, files.digest, tuple(files.taken))


def claim_of(inputs: Inputs, certificate: Certificate) -> Claim:
    """Return what a certificate must prove about its inputs."""
    robot, scene = inputs.robot, inputs.scene
    frames, nodes = frames_of(robot, certificate), Nodes()
    bodies, place = bodies_of(inputs, frames)
    demand(certificate.padding.keys() <= bodies.keys(), "a link is padded that has no shape")
    demand(
        {each.link for each in certificate.kept} <= frames.place.keys(),
        "a constraint is about a link that the robot lacks",
    )
    require_limits(frames, scene, certificate)
    around = _around(frames, nodes, bodies, place, scene, certificate)
    whole = {name: nodes.whole(place[name][0], shapes) for name, shapes in bodies.items()}
    touching = may_touch(robot, scene, bodies)
    names = list(bodies)
    among = [
        Pair(whole[first], whole[second], 0.0, (first, second))
        for i, first in enumerate(names)
        for second in names[i + 1 :]
        if place[first][0] != place[second][0] and frozenset((first, second)) not in touching
    ]
    return Claim(frames, nodes, (*around, *among), silent(robot, scene, bodies, place, certificate))


def bodies_of(inputs: Inputs, frames: Frames) -> tuple[dict[str, list[Shape]], Places]:
    """Return the shapes of links and of what is held, each in its frame, and the places of all links in frames."""
    robot, bodies, place = inputs.robot, dict[str, list[Shape]](), dict(frames.place)
    for link in robot.links:
        if link in robot.shapes:
            bodies[link] = [shape.at(place[link][1]) for shape in robot.shapes[link]]
    for held in inputs.scene.held:
        require(held.link in place and held.name not in place, f"{held.name} is held by no link, or has a link's name")
        place[held.name] = place[held.link]
        bodies[held.name] = [shape.at(place[held.link][1]) for shape in held.shapes]
    return bodies, place


def _around(
    frames: Frames, nodes: Nodes, bodies: dict[str, list[Shape]], place: Places, scene: Scene, certificate: Certificate
) -> list[Pair]:
    """Return pairs of bodies and obstacles: bodies of a frame with the same allowances are one node."""
    groups: dict[tuple[int, frozenset[str], float], list[str]] = {}
    for name in bodies:
        frame = place[name][0]
        touched = frozenset(obstacle for obstacle, body in scene.allowed if body == name)
        groups.setdefault((frame, touched, certificate.padding.get(name, 0.0)), []).append(name)
    pairs, obstacles = [], dict[frozenset[str], int]()
    for (frame, touched, padding), names in groups.items():
        others = [each for each in scene.obstacles if each.name not in touched]
        if frame == 0 or not others:
            continue
        if touched not in obstacles:
            obstacles[touched] = nodes.whole(0, [shape for each in others for shape in each.shapes])
        node = nodes.whole(frame, [shape for name in names for shape in bodies[name]])
        keep = certificate.clearance + padding
        pairs.append(Pair(node, obstacles[touched], keep, (" and ".join(names), "the obstacles")))
    _, out = frames.far(certificate.curves, certificate.tolerance)
    reach = max((out[nodes.frame[node]] + nodes.reach[node] for pair in pairs for node in (pair.first,)), default=0.0)
    planes = [each.above for each in scene.obstacles if each.above is not None]
    demand(reach + max(planes, default=0.0) < GROUND or not planes, "the robot reaches beyond a plane")
    return pairs


def may_touch(robot: Robot, scene: Scene, bodies: dict[str, list[Shape]]) -> set[frozenset[str]]:
    """Return pairs that may touch: those of the SRDF or, without any there, neighbours; and what a held body may."""
    touching = {frozenset((held.name, link)) for held in scene.held for link in (held.link, *held.touches)}
    if robot.disabled is not None:
        return touching | robot.disabled
    above = {joint.child: joint for joint in robot.joints}
    for name in robot.links:
        link, moving = name, 0
        while link in above:
            moving += above[link].kind != "fixed"
            link = above[link].parent
            if link in robot.shapes:
                touching |= {frozenset((name, link))} if moving == 1 else set()
                break
    return touching


def require_limits(frames: Frames, scene: Scene, certificate: Certificate) -> None:
    """Raise Refused if a control point leaves the limits of a joint, or those of the scene."""
    limits = {joint.name: (joint.lower, joint.upper) for joint in frames.joints}
    for column, name in enumerate(certificate.joints):
        for low, high in (limits[name], scene.limits.get(name, (-np.inf, np.inf))):
            some = certificate.curves[:, :, column]
            within = some.min() >= low - BEYOND and some.max() <= high + BEYOND
            demand(within or high - low > ENDLESS, f"{name} leaves its limits")


def silent(
    robot: Robot, scene: Scene, bodies: dict[str, list[Shape]], place: Places, certificate: Certificate
) -> tuple[str, ...]:
    """Return lines about what is not claimed."""
    disabled = robot.disabled
    held = ", ".join(f"{name} {value:g}" for name, value in certificate.held.items())
    lines = {
        "links without collision shapes": ", ".join(link for link in robot.links if link not in bodies),
        "links that no joint of the path moves, with obstacles": ", ".join(
            name for name in bodies if place[name][0] == 0
        ),
        "links that are fixed to each other": "with each other",
        "pairs of links": f"{len(disabled)} that the SRDF disables"
        if disabled is not None
        else "neighbours, as no SRDF disables any",
        "allowed contacts": ", ".join(f"{obstacle} with {link}" for obstacle, link in sorted(scene.allowed)),
        "that other joints are where they are held": held or "at 0",
        "that what the certificate carries is the robot, or the scene, that is meant": ", ".join(
            name for name in ("robot", "scene") if getattr(certificate, name) is not None
        ),
        "that the robot is built, calibrated, placed and controlled as the files say": "and when it is where",
    }
    return tuple(f"{key}: {value}" for key, value in lines.items() if value)
