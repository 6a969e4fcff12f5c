"""The tables of ``evenroad robot``."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from rich.table import Table
from rich.text import Text

from evenroad._rng import generator
from evenroad._terminal import print_table
from evenroad.robot import ArmWorld, Joint, Robot, RobotModel, held_values

_CONFIGURATIONS = 4096
_MOTIONS = 256
_MOST_SEGMENTS = 1000
"""Motions that are timed are cut off there: between limits of a million radians each would take ten seconds."""

_SECONDS = 0.2


def print_robot(model: RobotModel, world: ArmWorld) -> None:
    """Print joints, bodies, pairs, and how fast random configurations and motions are checked."""
    for table in (_joints(model.robot), _bodies(model), _summary(model, world)):
        print_table(table)
        print()


def bodiless_rows(model: RobotModel) -> list[tuple[str, str]]:
    """Return rows, name and text: what was read otherwise, links that nothing touches, pairs that always touch."""
    rows = [("note", note) for note in model.notes]
    if model.bodiless:
        rows.append(("no body", ", ".join(model.bodiless)))
    if model.drawn_only:
        text = "drawn, but without collision geometry, so that nothing is found to touch: "
        rows.append(("WARNING", text + ", ".join(model.drawn_only)))
    if model.always_touching:
        pairs = ", ".join(f"{first} and {second}" for first, second in model.always_touching)
        rows.append(
            ("WARNING", f"in collision in every sampled configuration, so that none is free: {pairs}")
        )
    elif model.never_free:
        rows.append(("WARNING", model.never_free))
    return rows


def _joints(robot: Robot) -> Table:
    table = Table("joint", "kind", "limits", "velocity", "use", box=None, pad_edge=False, header_style="bold")
    table.columns[0].no_wrap = True
    for joint in robot.joints:
        if joint.kind == "fixed":
            continue
        unit = "m" if joint.kind == "prismatic" else "rad"
        velocity = f"{joint.velocity:.4g} {unit}/s" if math.isfinite(joint.velocity) else "not given"
        table.add_row(
            Text(joint.name), joint.kind, f"{_limits(joint)} {unit}", velocity, Text(_use(robot, joint))
        )
    return table


def _limits(joint: Joint) -> str:
    if joint.kind == "continuous":
        return "any"
    if joint.lower == -joint.upper:
        return f"±{joint.upper:.5g}"
    return f"{joint.lower:.5g} .. {joint.upper:.5g}"


def _use(robot: Robot, joint: Joint) -> str:
    if joint.mimic is not None:
        offset = f" + {joint.mimic.offset:g}" if joint.mimic.offset else ""
        return f"= {joint.mimic.multiplier:g} {joint.mimic.joint}{offset}"
    if joint.name in robot.group:
        return f"planned, #{robot.group.index(joint.name) + 1}"
    return f"held at {held_values(robot)[joint.name]:g}"


def _bodies(model: RobotModel) -> Table:
    table = Table(
        "link", "given as", "capsules", "volume added", box=None, pad_edge=False, header_style="bold"
    )
    for body in model.bodies:
        exact = set(body.shapes) <= {"capsule", "sphere"} and not body.given
        added = "none: kept as they are" if exact else f"{100.0 * body.added:.0f} %"
        if body.given and not body.shapes:
            added = "nothing to compare with"
        shapes = [f"{body.shapes.count(shape)} x {shape}" for shape in dict.fromkeys(body.shapes)]
        given = "the user's" if body.given else ", ".join(shapes)
        table.add_row(Text(body.link), Text(given), str(body.capsules), added)
    return table


def _summary(model: RobotModel, world: ArmWorld) -> Table:
    robot, measured = model.robot, _measured(world)
    table = Table(show_header=False, box=None, pad_edge=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column(overflow="fold")
    for name, value in bodiless_rows(model):
        table.add_row(name, Text(value))
    table.add_row(
        "self pairs", Text(f"{len(robot.pairs)} tested ({model.pairs_from}): {_by_first(robot.pairs)}")
    )
    for reason in dict.fromkeys(reason for _, _, reason in model.dropped):
        pairs = [(first, second) for first, second, why in model.dropped if why == reason]
        table.add_row("not tested", Text(f"{reason}: {_by_first(pairs)}"))
    if robot.states:
        table.add_row("states", Text(", ".join(robot.states)))
    table.add_row("obstacles", _conservatism(model, world))
    table.add_row("checks", _speed(world, measured))
    if measured["blocking"] is not None and not (model.never_free or model.always_touching):
        text = f"no random configuration is free in {world.scene.name}; most often {measured['blocking']}"
        table.add_row("WARNING", Text(text))
    return table


def _conservatism(model: RobotModel, world: ArmWorld) -> str:
    shapes = sum(body.shape_volume for body in model.bodies)
    capsules = sum(body.capsule_volume for body in model.bodies)
    added = (
        f"{100.0 * max(capsules / shapes - 1.0, 0.0):.0f} % more volume than the URDF's shapes; "
        if shapes
        else ""
    )
    return f"{added}capsules tested as {world.spheres} spheres, up to {1e3 * world.excess:.1f} mm larger"


def _measured(world: ArmWorld) -> dict[str, Any]:
    """Return how fast random configurations and motions are checked, how many are free, and what blocks all."""
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
        a, b = free[: len(free) // 2][:_MOTIONS], free[len(free) // 2 :][:_MOTIONS]
        a, b = a[: min(len(a), len(b))], b[: min(len(a), len(b))]
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
    return f"{text.format(**measured)}, one core, with {world.checked_with}, in {world.scene.name}"


def robot_record(model: RobotModel, world: ArmWorld) -> dict[str, Any]:
    """Return all that is known of a robot as what JSON has; limits of joints that have none are null."""
    record = asdict(model) | {"file": None if model.file is None else str(model.file.path)}
    record["held"] = held_values(world.robot)
    record["robot"]["hulls"] = dict(Counter(hull.link for hull in model.robot.hulls))
    for joint in record["robot"]["joints"]:
        joint |= {key: None for key in ("lower", "upper", "velocity") if math.isinf(joint[key])}
    checks = {"scene": world.scene.name, "with": world.checked_with, **_measured(world)}
    return record | {"no_body": list(model.bodiless), "checks": checks}


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
