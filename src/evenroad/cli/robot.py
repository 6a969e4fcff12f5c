"""``evenroad robot``: the parts of an arm, how conservative its model is, and how fast it is checked."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from json import dumps
from pathlib import Path
from typing import Any

import numpy as np

from evenroad._files import atomic_write
from evenroad._rng import generator
from evenroad._terminal import print_table
from evenroad.cli.options import Positional
from evenroad.cli.outputs import require_output
from evenroad.cli.plan import RobotOptions
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import Undecided
from evenroad.loading.find import find_robot
from evenroad.loading.groups import EVERY
from evenroad.loading.model import RobotModel
from evenroad.loading.written_srdf import srdf_text
from evenroad.robots.joint import Joint
from evenroad.robots.kinematics import held_values
from evenroad.robots.robot import Robot as Arm
from evenroad.scenes.robot_in_scene import in_scene
from evenroad.scenes.scene import Scene
from evenroad.scenes.scene_file import load_scene

_CONFIGURATIONS = 4096
_MOTIONS = 256
_MOST_SEGMENTS = 1000
"""Largest number of segments of a timed motion: between limits of a million radians each would take ten seconds."""
_SECONDS = 0.2
_UNLIMITED = ("lower", "upper", "velocity", "acceleration", "deceleration", "jerk")
"""Limits that a joint may lack."""


@dataclass(frozen=True, kw_only=True)
class Robot(RobotOptions):
    """Show the joints, limits, shapes and self-collision pairs of an arm, and how many checks a second it allows.

    Example: evenroad robot ur5
    """

    robot: Positional[str]
    """A URDF, xacro or MJCF file, or a name: ur5, arm7; with the extra [robots] panda and others."""
    scene: Path | None = None
    """Count checks a second in this scene, such as box-reach.yaml, instead of in empty space."""
    write_srdf: Path | None = None
    """Write an SRDF to start from: groups, named states, and the pairs of links that are not tested, with reasons."""
    json: bool = False
    """Print JSON instead of tables."""

    def run(self) -> int:
        """Load, measure, print; return 0."""
        if self.write_srdf is not None:
            require_output(
                "--write-srdf", self.write_srdf, (*find_robot(self.robot), self.srdf, self.bodies, self.scene)
            )
        try:
            model = self.read_robot(self.robot)
        except Undecided:
            # This command is how to learn the groups.
            model = replace(self, group=(EVERY,)).read_robot(self.robot)
        scene = Scene((), name="empty space") if self.scene is None else load_scene(self.scene)
        # Without a path, contacts near start and goal are not allowed.
        scene = replace(scene, near_ends=frozenset())
        world = ArmWorld(in_scene(model.robot, scene), scene)
        if self.write_srdf is not None:
            with atomic_write(self.write_srdf) as file:
                file.write(srdf_text(model).encode())
        if self.json:
            print(dumps(_record(model, world), indent=2, allow_nan=False))
            return 0
        print_table(_joints(model.robot), ("joint", "kind", "limits", "velocity", "use"))
        print()
        print_table(_bodies(model), ("link", "given as", "capsules", "volume added"))
        print()
        written = [] if self.write_srdf is None else [("files", str(self.write_srdf))]
        print_table([*_summary(model, world), *written])
        return 0


def decided_by(robot: Arm) -> str:
    """Return what decides whether a robot touches an obstacle: its capsules, or shapes of its file and their kinds."""
    return f"shapes of the file where capsules touch ({robot.bodies})" if robot.shapes else "capsules"


def padding_row(robot: Arm) -> list[tuple[str, str]]:
    """Return a row about the links that are larger against obstacles, if there are any."""
    links: dict[float, list[str]] = {}
    for link, metres in robot.padding:
        links.setdefault(metres, []).append(link)
    of_all = set(links) if len(robot.padding) == len(robot.links) and len(links) == 1 else set()
    text = ", ".join(f"{1e3 * metres:.4g} mm: {'all' if of_all else ' '.join(on)}" for metres, on in links.items())
    return [("padding", text)] if links else []


def bodiless_rows(model: RobotModel) -> list[tuple[str, str]]:
    """Return rows, name and text: notes of the loader, links without a body, pairs that always touch."""
    rows = [("note", note) for note in model.notes]
    if model.bodiless:
        rows.append(("no body", f"{', '.join(model.bodiless)} (without a shape: nothing is found to touch)"))
    if model.drawn_only:
        text = "drawn, but without collision geometry, so that nothing is found to touch: "
        rows.append(("WARNING", text + ", ".join(model.drawn_only)))
    if model.always_touching:
        text = "in collision in every sampled configuration, so that none is free: "
        pairs = (f"{first} and {second}" for first, second in model.always_touching)
        rows.append(("WARNING", text + ", ".join(pairs)))
    elif model.never_free:
        rows.append(("WARNING", model.never_free))
    return rows


def _joints(robot: Arm) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for joint in robot.joints:
        if joint.kind != "fixed":
            unit = "m" if joint.kind == "prismatic" else "rad"
            velocity = f"{joint.velocity:.4g} {unit}/s" if math.isfinite(joint.velocity) else "not given"
            rows.append((joint.name, joint.kind, f"{_limits(joint)} {unit}", velocity, _use(robot, joint)))
    return rows


def _limits(joint: Joint) -> str:
    if joint.kind == "continuous":
        return "any"
    both = f"±{joint.upper:.5g}"
    return both if joint.lower == -joint.upper else f"{joint.lower:.5g} .. {joint.upper:.5g}"


def _use(robot: Arm, joint: Joint) -> str:
    if joint.mimic is not None:
        offset = f" + {joint.mimic.offset:g}" if joint.mimic.offset else ""
        return f"= {joint.mimic.multiplier:g} {joint.mimic.joint}{offset}"
    if joint.name in robot.group:
        return f"planned, #{robot.group.index(joint.name) + 1}"
    return f"held at {held_values(robot)[joint.name]:g}"


def _bodies(model: RobotModel) -> list[tuple[str, str, str, str]]:
    rows = []
    for body in model.bodies:
        exact = set(body.shapes) <= {"capsule", "sphere"} and not body.given
        added = "none: kept as they are" if exact else f"{100.0 * body.added:.0f} %"
        if body.given and not body.shapes:
            added = "nothing to compare with"
        shapes = [f"{body.shapes.count(shape)} x {shape}" for shape in dict.fromkeys(body.shapes)]
        given = "the user's" if body.given else ", ".join(shapes)
        rows.append((body.link, given, str(body.capsules), added))
    return rows


def _summary(model: RobotModel, world: ArmWorld) -> list[tuple[str, str]]:
    robot = model.robot
    tested = f"{len(robot.pairs)} tested ({model.pairs_from}): {_by_first(robot.pairs)}"
    rows = [*bodiless_rows(model), ("self pairs", tested)]
    for reason in dict.fromkeys(reason for _, _, reason in model.dropped):
        pairs = [(first, second) for first, second, why in model.dropped if why == reason]
        rows.append(("not tested", f"{reason}: {_by_first(pairs)}"))
    if robot.states:
        rows.append(("states", ", ".join(robot.states)))
    measured = _measured(world)
    rows += [("decided by", decided_by(robot)), *padding_row(robot), ("obstacles", _conservatism(model, world))]
    rows.append(("checks", _speed(world, measured)))
    if measured["blocking"] is not None and not (model.never_free or model.always_touching):
        text = f"no random configuration is free in {world.scene.name}; most often {measured['blocking']}"
        rows.append(("WARNING", text))
    return rows


def _conservatism(model: RobotModel, world: ArmWorld) -> str:
    text = f"capsules tested as {world.spheres} spheres, up to {1e3 * world.excess:.1f} mm larger"
    shapes = sum(body.shape_volume for body in model.bodies)
    if not shapes:
        return text
    more = max(sum(body.capsule_volume for body in model.bodies) / shapes - 1.0, 0.0)
    return f"{100.0 * more:.0f} % more volume than the URDF's shapes; {text}"


def _measured(world: ArmWorld) -> dict[str, Any]:
    """Return the speed of checks of random configurations and motions, the free share, and what blocks all."""
    q = world.space.from_cube(generator(0).random((_CONFIGURATIONS, world.space.cube_dim)))
    free = q[world.valid(q)]
    found: dict[str, Any] = {
        "configurations_per_second": _per_second(lambda: world.valid(q), len(q)),
        "free_percent": 100.0 * len(free) / len(q),
        "motions_per_second": None,
        "free_motions_percent": None,
        "blocking": None,
    }
    if len(free) > 1:
        half = min(len(free) // 2, _MOTIONS)
        a, b = free[:half], free[len(free) // 2 :][:half]
        lengths = np.maximum(world.space.distance(a, b), world.resolution)
        b = world.space.interpolate(a, b, np.minimum(_MOST_SEGMENTS * world.resolution / lengths, 1.0))
        found["free_motions_percent"] = 100.0 * float(np.mean(world.motion_valid(a, b)))
        found["motions_per_second"] = _per_second(lambda: world.motion_valid(a, b), len(a))
    elif len(free) == 0:
        ((found["blocking"], _),) = Counter(map(world.explain, q[:_MOTIONS])).most_common(1)
    return found


def _speed(world: ArmWorld, measured: dict[str, Any]) -> str:
    text = "{configurations_per_second:,.0f} random configurations/s ({free_percent:.0f} % free)"
    if measured["motions_per_second"] is not None:
        text += ", {motions_per_second:,.0f} motions/s between free ones ({free_motions_percent:.0f} % free)"
    return f"{text.format(**measured)}, one core, in {world.scene.name}"


def _record(model: RobotModel, world: ArmWorld) -> dict[str, Any]:
    """Return a robot as plain JSON values; missing limits of joints are null."""
    record = asdict(model) | {"file": None if model.file is None else str(model.file.path)}
    record["held"] = held_values(world.robot)
    record["robot"]["hulls"] = dict(Counter(hull.link for hull in model.robot.hulls))
    for joint in record["robot"]["joints"]:
        joint |= {key: None for key in _UNLIMITED if math.isinf(joint[key])}
        joint["hard"] = joint["hard"] and [end if math.isfinite(end) else None for end in joint["hard"]]
    checks = {"scene": world.scene.name, **_measured(world)}
    return record | {"no_body": list(model.bodiless), "checks": checks}


def _per_second(call: Callable[[], object], count: int) -> float:
    """Return the number of checks per second, the median of repeats after a first one."""
    call()
    times: list[float] = []
    start = time.perf_counter()
    while len(times) < 3 or (time.perf_counter() - start < _SECONDS and len(times) < 1000):
        before = time.perf_counter()
        call()
        times.append(time.perf_counter() - before)
    return count / float(np.median(times))


def _by_first(pairs: Iterable[Sequence[str]]) -> str:
    partners: dict[str, list[str]] = {}
    for first, second in pairs:
        partners.setdefault(first, []).append(second)
    return "; ".join(f"{first} with {', '.join(seconds)}" for first, seconds in partners.items()) or "none"
