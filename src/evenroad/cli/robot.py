"""``evenroad robot``: what an arm is made of, how conservative its model is, and how fast it is checked."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tyro

from evenroad._compiled import say_if_compiling
from evenroad._rng import generator
from evenroad._terminal import print_table
from evenroad.robot import (
    ArmWorld,
    Joint,
    RobotModel,
    Scene,
    held_values,
    in_scene,
    load_model,
    load_scene,
)
from evenroad.robot import Robot as Arm

_CONFIGURATIONS = 4096
_MOTIONS = 256
_MOST_SEGMENTS = 1000
"""Motions that are timed are cut off there: between limits of a million radians each would take ten seconds."""

_SECONDS = 0.2


@dataclass(frozen=True, kw_only=True)
class Robot:
    """Show the joints, limits, bodies and self-collision pairs of an arm, and checks per second."""

    robot: tyro.conf.Positional[str]
    """A URDF file, or the name of a shipped robot (ur5, arm7)."""
    srdf: Path | None = None
    """Its SRDF, with groups, named states and pairs of links that need no test."""
    group: str | None = None
    """A group of the SRDF, or joints with commas between them; the others are held."""
    bodies: Path | None = None
    """A YAML file of capsules and spheres in place of the URDF's collision geometry."""
    scene: Path | None = None
    """Count checks per second in this scene (a file or box-reach.yaml) instead of in empty space."""

    def run(self) -> int:
        """Load, measure, print; return 0."""
        model = load_model(self.robot, srdf=self.srdf, group=self.group, bodies=self.bodies)
        say_if_compiling("evenroad.robot.kernel.batch", "check_configurations", 30)
        scene = Scene("empty space", ()) if self.scene is None else load_scene(self.scene)
        world = ArmWorld(in_scene(model.robot, scene), scene)
        print_table(_joints(model.robot), ("joint", "kind", "limits", "velocity", "use"))
        print()
        print_table(_bodies(model), ("link", "given as", "capsules", "volume added"))
        print()
        print_table(_summary(model, world))
        return 0


def bodiless_rows(model: RobotModel) -> list[tuple[str, str]]:
    """Return rows, name and text, about links that nothing is found to touch and pairs that always touch."""
    rows = []
    if model.bodiless:
        rows.append(("no body", ", ".join(model.bodiless)))
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
    return [*rows, ("obstacles", _conservatism(model, world)), ("checks", _speed(world))]


def _conservatism(model: RobotModel, world: ArmWorld) -> str:
    text = f"capsules tested as {world.spheres} spheres, up to {1e3 * world.excess:.1f} mm larger"
    shapes = sum(body.shape_volume for body in model.bodies)
    if not shapes:
        return text
    more = max(sum(body.capsule_volume for body in model.bodies) / shapes - 1.0, 0.0)
    return f"{100.0 * more:.0f} % more volume than the URDF's shapes; {text}"


def _speed(world: ArmWorld) -> str:
    q = world.space.from_cube(generator(0).random((_CONFIGURATIONS, world.space.cube_dim)))
    free = q[world.valid(q)]
    configurations = _per_second(lambda: world.valid(q), len(q))
    text = f"{configurations:,.0f} random configurations/s ({100.0 * len(free) / len(q):.0f} % free)"
    if len(free) > 1:
        half = min(len(free) // 2, _MOTIONS)
        a, b = free[:half], free[len(free) // 2 :][:half]
        lengths = np.maximum(world.space.distance(a, b), world.resolution)
        b = world.space.interpolate(a, b, np.minimum(_MOST_SEGMENTS * world.resolution / lengths, 1.0))
        passed = float(np.mean(world.motion_valid(a, b)))
        motions = _per_second(lambda: world.motion_valid(a, b), len(a))
        text += f", {motions:,.0f} motions/s between free ones ({100.0 * passed:.0f} % free)"
    return f"{text}, one core, with {world.checked_with}, in {world.scene.name}"


def _per_second(call: Callable[[], object], count: int) -> float:
    """Return how many are done a second; the median of repeats, after one that loads compiled code."""
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
