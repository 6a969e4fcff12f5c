"""The claim: which bodies are proved apart, and which are not spoken of."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evenroad_verify.certificate import Certificate
from evenroad_verify.errors import Floats, demand, require
from evenroad_verify.files import Files
from evenroad_verify.frames import Frames, frames_of
from evenroad_verify.nodes import Nodes
from evenroad_verify.robot import Robot, read_robot
from evenroad_verify.scene import GROUND, Scene, read_scene
from evenroad_verify.shapes import Shape

LEAST = 1e-9
"""What a computed gap must exceed, beyond the distance that is to be kept [m]."""
ROUNDING = 2.0**-46
"""Times the joints of a chain, reach and the largest joint value, a bound of the error of a computed gap."""
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


@dataclass(frozen=True)
class Body:
    """Shapes of one name, in a frame: a link, what is attached to one, or an obstacle."""

    name: str
    frame: int
    shapes: list[Shape]
    is_obstacle: bool


def claim_of(inputs: Inputs, certificate: Certificate) -> Claim:
    """Return what a certificate must prove about its inputs."""
    frames, nodes = frames_of(inputs.robot, certificate), Nodes()
    demand({each.link for each in certificate.kept} <= frames.place.keys(), "a constraint is about no link")
    bodies = bodies_of(inputs, frames, certificate)
    require_limits(ranges_of(inputs, frames, certificate), certificate)
    require_bounded(inputs, frames, bodies, certificate)
    links = [body for body in bodies if not body.is_obstacle]
    around = _around(nodes, bodies, inputs.scene, certificate)
    whole = [nodes.whole(body.frame, body.shapes) for body in links]
    touching = may_touch(inputs, bodies)
    among = [
        Pair(whole[i], whole[k], 0.0, (links[i].name, links[k].name))
        for i, k in itertools.combinations(range(len(links)), 2)
        if links[i].frame != links[k].frame and frozenset((links[i].name, links[k].name)) not in touching
    ]
    return Claim(frames, nodes, (*around, *among), silent(inputs, bodies, certificate))


def bodies_of(inputs: Inputs, frames: Frames, certificate: Certificate) -> list[Body]:
    """Return links with shapes, what is attached, and obstacles; Refused where the certificate pads another one."""
    bodies = [
        Body(
            link, frames.place[link][0], [shape.at(frames.place[link][1]) for shape in inputs.robot.shapes[link]], False
        )
        for link in inputs.robot.links
        if link in inputs.robot.shapes
    ]
    for held in inputs.scene.held:
        known = held.link in frames.place and held.name not in frames.place
        require(known, f"{held.name} is held by no link, or has a link's name")
        frame, pose = frames.place[held.link]
        bodies.append(Body(held.name, frame, [shape.at(pose) for shape in held.shapes], False))
    demand(certificate.padding.keys() <= {body.name for body in bodies}, "a link is padded that has no shape")
    return bodies + [Body(each.name, 0, list(each.shapes), True) for each in inputs.scene.obstacles]


def require_bounded(inputs: Inputs, frames: Frames, bodies: list[Body], certificate: Certificate) -> None:
    """Raise Refused if rounding could exceed `LEAST` on the curves, or if the robot reaches beyond a plane."""
    _, out = frames.far(certificate.curves, certificate.tolerance)
    reach = np.array([out[body.frame] + max(shape.reach for shape in body.shapes) for body in bodies])
    robot = max((far for far, body in zip(reach, bodies, strict=True) if body.frame), default=0.0)
    planes = [each.above for each in inputs.scene.obstacles if each.above is not None]
    demand(not planes or robot + max(planes) < GROUND, "the robot reaches beyond a plane")
    places = [(frames.place[each.link], each.part) for each in certificate.kept if not each.is_axis]
    arms = [out[frame] + np.linalg.norm(turn @ point + shift) for (frame, (turn, shift)), point in places]
    largest = 1.0 + np.abs(certificate.curves).max() * max(1.0, float(np.abs(frames.factor).max()))
    error = ROUNDING * inputs.robot.depth * max(reach.max(initial=0.0), *arms, 0.0) * largest
    demand(error < LEAST, "the robot is too large for double precision")


def _around(nodes: Nodes, bodies: list[Body], scene: Scene, certificate: Certificate) -> list[Pair]:
    """Return pairs of bodies and obstacles: bodies of a frame with the same allowances are one node."""
    groups: dict[tuple[int, frozenset[str], float], list[Body]] = {}
    for body in bodies:
        touched = frozenset(obstacle for obstacle, name in scene.allowed if name == body.name)
        if body.frame and not touched >= {each.name for each in scene.obstacles}:
            groups.setdefault((body.frame, touched, certificate.padding.get(body.name, 0.0)), []).append(body)
    pairs, obstacles = [], dict[frozenset[str], int]()
    for (frame, touched, padding), group in groups.items():
        if touched not in obstacles:
            left = [each for each in scene.obstacles if each.name not in touched]
            obstacles[touched] = nodes.whole(0, [shape for each in left for shape in each.shapes])
        node = nodes.whole(frame, [shape for body in group for shape in body.shapes])
        names = " and ".join(body.name for body in group), "the obstacles"
        pairs.append(Pair(node, obstacles[touched], certificate.clearance + padding, names))
    return pairs


def may_touch(inputs: Inputs, bodies: list[Body]) -> set[frozenset[str]]:
    """Return pairs that may touch: those of the SRDF or, without any there, neighbours; and what a held body may."""
    robot, names = inputs.robot, {body.name for body in bodies if not body.is_obstacle}
    touching = {frozenset((held.name, link)) for held in inputs.scene.held for link in (held.link, *held.touches)}
    if robot.disabled is not None:
        return touching | robot.disabled
    above = {joint.child: joint for joint in robot.joints}
    for name in robot.links:
        link, moving = name, 0
        while link in above:
            moving += above[link].kind != "fixed"
            link = above[link].parent
            if link in names:
                touching |= {frozenset((name, link))} if moving == 1 else set()
                break
    return touching


def ranges_of(inputs: Inputs, frames: Frames, certificate: Certificate) -> Floats:
    """Return how far the joints of a certificate may go, (joints, 2): infinitely far those without limits.

    A joint that follows another one limits it, unless this would leave it no range.
    """
    ranges = np.tile([-np.inf, np.inf], (len(certificate.joints), 1))
    order = sorted(range(len(frames.joints)), key=lambda k: frames.joints[k].leader != frames.joints[k].name)
    for k in order:
        joint, factor, column = frames.joints[k], float(frames.factor[k]), int(frames.column[k])
        if joint.upper - joint.lower <= ENDLESS and factor != 0.0:
            ends = (np.array([joint.lower, joint.upper]) - frames.offset[k]) / factor
            # Limits the wrong way round leave a joint no range.
            least, most = ends if joint.leader == joint.name else np.sort(ends)
            low, high = max(ranges[column, 0], least), min(ranges[column, 1], most)
            if joint.leader == joint.name or high - low > LEAST:
                ranges[column] = low, high
    ranges += (-BEYOND, BEYOND)
    for column, name in enumerate(certificate.joints):
        low, high = inputs.scene.limits.get(name, (-np.inf, np.inf))
        if high - low <= ENDLESS:
            ranges[column] = max(ranges[column, 0], low - BEYOND), min(ranges[column, 1], high + BEYOND)
    return np.asarray(ranges)


def require_limits(ranges: Floats, certificate: Certificate) -> None:
    """Raise Refused if a control point leaves the range of a joint."""
    within = (certificate.curves >= ranges[:, 0]) & (certificate.curves <= ranges[:, 1])
    for column, name in enumerate(certificate.joints):
        demand(within[:, :, column].all(), f"{name} leaves its limits")


def silent(inputs: Inputs, bodies: list[Body], certificate: Certificate) -> tuple[str, ...]:
    """Return lines about what is not claimed."""
    disabled, links = inputs.robot.disabled, [body for body in bodies if not body.is_obstacle]
    held = ", ".join(f"{name} {value:g}" for name, value in certificate.held.items())
    shaped = {body.name for body in links}
    lines = {
        "links without collision shapes": ", ".join(link for link in inputs.robot.links if link not in shaped),
        "links that no joint of the path moves, with obstacles": ", ".join(
            body.name for body in links if body.frame == 0
        ),
        "links that are fixed to each other": "with each other",
        "pairs of links": f"{len(disabled)} that the SRDF disables"
        if disabled is not None
        else "neighbours, as no SRDF disables any",
        "allowed contacts": ", ".join(f"{obstacle} with {link}" for obstacle, link in sorted(inputs.scene.allowed)),
        "that other joints are where they are held": held or "at 0",
        "that what the certificate carries is the robot, or the scene, that is meant": ", ".join(
            name for name in ("robot", "scene") if getattr(certificate, name) is not None
        ),
        "that the robot is built, calibrated, placed and controlled as the files say": "and when it is where",
    }
    return tuple(f"{key}: {value}" for key, value in lines.items() if value)
