"""The last checks of a result: a second proof, the meshes of the robot's file, and notes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from evenroad._arrays import Floats
from evenroad._time_limit import BudgetSpent
from evenroad.collision.arm_world import ArmWorld
from evenroad.collision.validate import MeshCheck, has_meshes, unseen_pairs, validate
from evenroad.planning.answer import apart_in
from evenroad.planning.problem import Problem
from evenroad.planning.result import PlanResult, Status
from evenroad.scenes.scan import allowed_everywhere
from evenroad.world import ValidatesPaths


def finished(problem: Problem, result: PlanResult) -> PlanResult:
    """Return a result with its notes, the name of its goal, and its status after the last checks."""
    given = problem.given
    if notes := problem.notes:
        result = replace(result, notes=notes)
    if given is not None and given.poses and not given.unreached:
        result = replace(result, timings={"goals": given.seconds, **result.timings})
    if result.path is None:
        return _with_proof(problem, result)
    if given is not None and len(problem.goals) > 1:
        result = _with_name(given.names, result)
    if untested := _not_tested(problem):
        result = replace(result, message=f"{result.message}; not tested, as the scene allows: {untested}")
    if problem.certified:
        result = _certified(problem, result)
    return result if problem.model is None or not result.solved else _with_meshes(problem, result)


def mesh_check(problem: Problem, path: Floats) -> MeshCheck | None:
    """Check a path, (p, dim), with the meshes of the robot's URDF; None if it has none."""
    model = problem.model
    if model is None or model.file is None:
        return None
    world, unseen = problem.arm, unseen_pairs(model)
    if not (has_meshes(model) or unseen):
        return None
    return validate(model.file, world.robot, world.scene, path, world.resolution, unseen)


def _with_proof(problem: Problem, result: PlanResult) -> PlanResult:
    """Return a result without a path, with a proof, if one is found, that more points would not help."""
    if result.status is not Status.NOT_CONNECTED or "points" not in result.counts:
        return result
    try:
        found = apart_in(problem)
    except BudgetSpent:
        return replace(result, message=f"{result.message}; there was no time for a proof that there is no path")
    if found is None or not found.proved:
        return result
    return replace(result, message=f"{found.message}; {result.message.partition(': try')[0]}")


def _with_name(names: tuple[str, ...], result: PlanResult) -> PlanResult:
    """Return a result whose message names its goal, if the goal has a name."""
    if result.goal_index is None or not names or not (name := names[result.goal_index]):
        return result
    to = f"to goal {result.goal_index}"
    return replace(result, message=result.message.replace(to, f"{to} ({name})", 1))


def _not_tested(problem: Problem) -> str:
    """Return in words which links the scene allows to touch whole point clouds; an empty text if none."""
    world = problem.world
    if not isinstance(world, ArmWorld) or not (pairs := allowed_everywhere(world.robot, world.scene)):
        return ""
    return ", ".join(f"{link!r} against the whole cloud {cloud!r}" for link, cloud in pairs)


def _certified(problem: Problem, result: PlanResult) -> PlanResult:
    """Return the plan if a separate check proves all motions of its path free, else ``not_certified``.

    The message then names the first motion that is not proved; the path stays in the result.
    """
    world = problem.world
    if result.path is None or result.proof == "exact":
        return result
    if not (isinstance(world, ValidatesPaths) and world.proof == "certified"):
        message = "the path is free at the states tested; motions of this world cannot be proved free"
        return replace(result, status=Status.NOT_CERTIFIED, message=message)
    try:
        failed = np.flatnonzero(~world.validate(result.path))
    except BudgetSpent:
        message = f"{result.message}; there was no time to prove it once more"
        return replace(result, status=Status.NOT_CERTIFIED, message=message)
    if not len(failed):
        return replace(result, proof="certified")
    first, last = ("(" + ", ".join(f"{x:.6g}" for x in result.path[failed[0] + i]) + ")" for i in (0, 1))
    message = (
        f"motion {failed[0] + 1} of {len(result.path) - 1} is not proved free, from {first} to {last}:"
        " it may touch, or pass too near to contact for a proof"
    )
    return replace(result, status=Status.NOT_CERTIFIED, message=message, proof="resolution")


def _with_meshes(problem: Problem, result: PlanResult) -> PlanResult:
    """Return a plan after a check of its path with the meshes of the robot's file, if it has any."""
    assert result.path is not None, "only of a path"
    try:
        meshes = mesh_check(problem, result.path)
    except BudgetSpent:
        message = f"{result.message}, but there was no time to check it with the meshes of the robot's file"
        no_time = MeshCheck("not checked", message="no time")
        return replace(result, status=Status.BUDGET_SPENT, message=message, meshes=no_time)
    if meshes is None:
        return result
    if meshes.verdict != "in collision":
        return replace(result, meshes=meshes)
    message = (
        "the path is free for the bodies of the plan, but not for the shapes that they stand for: in collision"
        f" {meshes.message}"
    )
    return replace(result, status=Status.MESH_COLLISION, message=message, meshes=meshes)
