"""``evenroad plan --trajectory``: the path of an arm with times, in files for controllers."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from evenroad._checks import require_positive
from evenroad._files import require_writable_folder
from evenroad.cli.plan import PlanArm
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.planning.read_request import mesh_check
from evenroad.planning.request import Request
from evenroad.roadmap import PlanResult
from evenroad.robot.constraint import Constraint, with_tip

if TYPE_CHECKING:
    from evenroad.trajectory import Trajectory

_MOVEJ = ".movej.script"


def require_trajectory_options(plan: PlanArm, inputs: Iterable[Path], outputs: Iterable[Path]) -> None:
    """Raise InvalidValue for options that would fail after planning, or overwrite an input or another result."""
    if not (plan.trajectory or plan.timed):
        for option in ("speed", "limits", "deviation", "step", "controller_joints"):
            if getattr(plan, option) != type(plan).__dataclass_fields__[option].default:
                raise InvalidValue(f"--{option.replace('_', '-')} goes with --trajectory or --timed only")
        return
    # Imported late: plans without times do not need SciPy's linear algebra.
    from evenroad.trajectory import format_of

    require_positive("speed", plan.speed, at_most=1.0)
    require_positive("deviation", plan.deviation, or_zero=True)
    require_positive("step", plan.step)
    taken = {source.resolve() for source in inputs} | ({plan.limits.resolve()} if plan.limits else set())
    results = {output.resolve() for output in outputs}
    for file in plan.trajectory:
        format_of(file)
        if plan.via and file.name.lower().endswith(_MOVEJ):
            raise InvalidValue(f"--via goes without {file}: a controller would round the path where it is to pass")
        if file.resolve() in taken:
            raise InvalidValue(f"--trajectory {file} would overwrite an input")
        if file.resolve() in results:
            raise InvalidValue(f"--trajectory {file} is a file of another result of this plan; name another one")
        results.add(file.resolve())
        require_writable_folder(file)


def _remove_earlier(plan: PlanArm) -> None:
    """Remove the trajectories of an earlier run."""
    for file in plan.trajectory:
        file.unlink(missing_ok=True)


def trajectory_rows(
    plan: PlanArm,
    request: Request,
    result: PlanResult,
    constraints: Constraint | None,
    make: Callable[..., Trajectory] | None = None,
) -> tuple[list[tuple[str, str]], dict[str, Any] | None]:
    """Write the trajectory of a solved plan; return rows for the table, and its record.

    `make` makes it in place of :func:`evenroad.trajectory.arm_trajectory`, from the options.
    """
    if not (plan.trajectory or plan.timed):
        return [], None
    stays = result.path is not None and bool(np.all(result.path == result.path[0]))
    if not result.solved or result.path is None or stays:
        _remove_earlier(plan)
        return [("trajectory", "none: the start is the goal")] if stays else [], None
    from evenroad.trajectory import arm_trajectory, limits_of
    from evenroad.trajectory.files import save_trajectories, trajectory_record

    world = request.world
    joints = plan.controller_joints
    order = None if joints is None else [*map(str.strip, joints.split(","))]
    limits = limits_of(world.robot, plan.limits)
    try:
        options: dict[str, Any] = {
            "limits": limits,
            "speed": plan.speed,
            "deviation": plan.deviation,
            "step": plan.step,
        }
        by_controller = any(file.name.lower().endswith(_MOVEJ) for file in plan.trajectory)
        if make is not None:
            trajectory = make(**options)
        else:
            kept = with_tip(constraints, request.tip)
            trajectory = arm_trajectory(
                world, result.path, rounded_by_controller=by_controller, constraints=kept, **options
            )
        meshes = mesh_check(request, trajectory.positions)
        if meshes is not None and meshes.verdict == "in collision":
            raise NotAvailable(
                "the trajectory is free for the bodies of the plan, but not for the shapes that they stand for:"
                f" in collision {meshes.message}; a smaller --deviation may help"
            )
    except NotAvailable:
        _remove_earlier(plan)
        raise
    save_trajectories(plan.trajectory, trajectory, order)
    used = ", ".join(f"{100 * share:.0f} % of {kind}" for kind, share in trajectory.highest.items())
    stops = f", {trajectory.stops} stops" if trajectory.stops else ""
    about = (
        f"{trajectory.duration:.3f} s, at most {used}; {trajectory.deviation:.2g} off the path{stops};"
        f" {trajectory.proof}"
    )
    record = {
        "files": [str(file) for file in plan.trajectory],
        **{name: getattr(trajectory, name) for name in ("duration", "deviation", "stops", "proof")},
        "highest": dict(trajectory.highest),
        "states": trajectory_record(trajectory, order),
    }
    files = [("", ", ".join(map(str, plan.trajectory)))] if plan.trajectory else []
    return [("trajectory", about), *files], record
