"""What ``evenroad plan --trajectory`` adds to the plan of an arm: its path with times, in files for controllers."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from evenroad._checks import require_positive
from evenroad._files import require_writable_folder
from evenroad.cli.plan import PlanArm
from evenroad.errors import InvalidValue
from evenroad.roadmap import PlanResult
from evenroad.robot import ArmWorld

_MOVEJ = ".movej.script"


def require_trajectory_options(plan: PlanArm, inputs: Iterable[Path]) -> None:
    """Refuse, before anything is planned, what would fail or overwrite an input afterwards."""
    if not plan.trajectory:
        for option in ("speed", "limits", "deviation", "step", "controller_joints"):
            if getattr(plan, option) != type(plan).__dataclass_fields__[option].default:
                raise InvalidValue(f"--{option.replace('_', '-')} goes with --trajectory only")
        return
    # Only now: a plan without times does not wait for SciPy's linear algebra.
    from evenroad.trajectory import format_of

    require_positive("speed", plan.speed, at_most=1.0)
    require_positive("deviation", plan.deviation, or_zero=True)
    require_positive("step", plan.step)
    taken = {source.resolve() for source in inputs} | ({plan.limits.resolve()} if plan.limits else set())
    for file in plan.trajectory:
        format_of(file)
        if file.resolve() in taken:
            raise InvalidValue(f"--trajectory {file} would overwrite an input")
        require_writable_folder(file)


def require_files_apart(plan: PlanArm, results: Iterable[Path]) -> None:
    """Refuse a trajectory in a file that results go to, which would take its place."""
    taken = {file.resolve() for file in results}
    for file in plan.trajectory:
        if file.resolve() in taken:
            raise InvalidValue(
                f"--trajectory {file} is where the result itself goes: name one of them otherwise"
            )


def trajectory_rows(
    plan: PlanArm, world: ArmWorld, result: PlanResult
) -> tuple[list[tuple[str, str]], dict[str, Any] | None]:
    """Write the trajectory of a solved plan; return rows for the table, and what the record says of it."""
    if not plan.trajectory:
        return [], None
    if not result.solved or result.path is None:
        # One of an earlier run must not pass for this one's.
        for file in plan.trajectory:
            file.unlink(missing_ok=True)
        return [], None
    from evenroad.trajectory import arm_trajectory, limits_of
    from evenroad.trajectory.files import save_trajectories

    joints = plan.controller_joints
    order = None if joints is None else [*map(str.strip, joints.split(","))]
    trajectory = arm_trajectory(
        world,
        result.path,
        limits_of(world.robot, plan.limits),
        speed=plan.speed,
        deviation=plan.deviation,
        step=plan.step,
        rounded_by_controller=any(file.name.lower().endswith(_MOVEJ) for file in plan.trajectory),
    )
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
    }
    return [("trajectory", about), ("", ", ".join(map(str, plan.trajectory)))], record
