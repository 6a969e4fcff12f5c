"""Verdicts on robots among obstacles against coal, on the triangles of the makers' files.

    python -m studies.benchmarks.obstacle_truth OUT.csv ROBOT.urdf FOLDER ...

For each robot, in three scenes of twenty boxes, balls and cylinders at random: how many configurations that we call
free touch an obstacle by more than `DEEP` in coal (uniform ones, others bisected to our edge of contact), how many
that coal calls free by `CLEAR` are blocked here, with the makers' shapes and with capsules, and the time of a verdict.
Links are not tested against each other.
"""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import coal
import numpy as np
import pinocchio
from studies.benchmarks.robot_truth import Truth, at_contact
from studies.benchmarks.rows import row_per_robot

from evenroad.geometry import rotation_from_rpy
from evenroad.robot import ArmWorld, Scene, load_robot
from evenroad.robot.scene import Obstacle

COUNT, SCENES = 700, 3
DEEP, CLEAR = 6e-6, 5e-4
"""What single precision may cost is some micrometres; what coal calls free by this must be free [m]."""
FIELDS = (
    *("robot", "dim", "parts", "configurations", "blocked", "truth_blocked", "free_that_touch"),
    *("at_contact", "at_contact_that_touch", "beyond", "beyond_capsules", "us", "us_capsules", "note"),
)


def random_scene(seed: int, reach: float, floor: float) -> Scene:
    """Return twenty obstacles around a robot, none near its base."""
    rng = np.random.default_rng(seed)
    made: list[Obstacle] = []
    while len(made) < 20:
        kind = ("box", "sphere", "cylinder")[len(made) % 3]
        size = tuple(rng.uniform(0.01, 0.12, {"box": 3, "sphere": 1}.get(kind, 2)) * reach)
        place = rng.uniform(-0.8, 0.8, 3) * reach
        if np.linalg.norm(place) > floor + float(np.linalg.norm(size)):
            turn = rotation_from_rpy(*rng.uniform(-3.0, 3.0, 3))
            made.append(Obstacle.of(f"obstacle{len(made)}", kind, size, tuple(place), turn))
    return Scene(tuple(made), name=f"random{seed}")


def solid(obstacle: Obstacle, margin: float) -> tuple[coal.CollisionGeometry, coal.Transform3s]:
    """Return an obstacle as coal has it, by a negative margin smaller, of which coal's meshes know nothing."""
    less = min(margin, 0.0)
    more = {"box": (2 * less,) * 3, "sphere": (less,), "cylinder": (less, 2 * less)}[obstacle.shape]
    size = np.add(obstacle.size, more).tolist()
    made = {"box": coal.Box, "sphere": coal.Sphere, "cylinder": coal.Cylinder}[obstacle.shape](*size)
    return made, coal.Transform3s(np.reshape(obstacle.rotation, (3, 3)), np.array(obstacle.xyz))


def touching(truth: Truth, scene: Scene, q: np.ndarray, margin: float) -> np.ndarray:
    """Return which configurations come within `margin` of an obstacle in coal, or deeper than a negative one, (n,)."""
    request, result = coal.CollisionRequest(), coal.CollisionResult()
    request.security_margin = max(margin, 0.0)
    request.enable_contact = True
    items, solids = truth.geometry.geometryObjects, [solid(each, margin) for each in scene.obstacles]
    for item in items:
        item.geometry.computeLocalAABB()
    hits = np.zeros(len(q), dtype=bool)
    for row, values in enumerate(q):
        pinocchio.framesForwardKinematics(truth.model, truth.data, truth._state(values))
        for item in items:
            place = truth.data.oMi[item.parentJoint] * item.placement
            here = coal.Transform3s(place.rotation, place.translation)
            middle = place.act(np.array(item.geometry.aabb_center))
            for made, there in solids:
                result.clear()
                if np.linalg.norm(middle - there.getTranslation()) > item.geometry.aabb_radius + 2.0:
                    continue
                if coal.collide(item.geometry, here, made, there, request, result):
                    hits[row] = True
                    break
            if hits[row]:
                break
    return hits


def measured(file: Path, rng: np.random.Generator) -> dict[str, object]:
    """Return the row of one robot."""
    robot = load_robot(file)
    robot = replace(robot, pairs=(), pairs_given=True)
    capsules = replace(robot, shapes=())
    held = {
        joint.name: robot.held.get(joint.name, joint.neutral)
        for joint in robot.joints
        if joint.kind != "fixed" and joint.mimic is None and joint.name not in robot.group
    }
    truth = Truth(file, robot.group, held)
    total: dict[str, float] = dict.fromkeys(FIELDS[3:-1], 0)
    for seed in range(SCENES):
        reach = min(ArmWorld(robot).robot_tables.reach, 1.5)
        scene = random_scene(seed, reach, 0.35 * reach)
        world, of_capsules = ArmWorld(robot, scene), ArmWorld(capsules, scene)
        q = world.space.from_cube(rng.random((COUNT, world.space.cube_dim)))
        free, wide = world.valid(q), of_capsules.valid(q)
        for key, each in (("us", world), ("us_capsules", of_capsules)):
            began = time.perf_counter()
            each.valid(q)
            total[key] += 1e6 * (time.perf_counter() - began) / COUNT / SCENES
        clear = ~touching(truth, scene, q, CLEAR)
        total["configurations"] += COUNT
        total["blocked"] += int((~free).sum())
        total["truth_blocked"] += int(touching(truth, scene, q, 0.0).sum())
        total["free_that_touch"] += int(touching(truth, scene, q[free], -DEEP).sum())
        total["beyond"] += int((clear & ~free).sum())
        total["beyond_capsules"] += int((clear & ~wide).sum())
        if free.any() and not free.all():
            edge = at_contact(world, q[free], q[~free], COUNT, rng)
            total["at_contact"] += len(edge)
            total["at_contact_that_touch"] += int(touching(truth, scene, edge, -DEEP).sum())
    parts = sum(len(each.corners) for each in robot.shapes)
    return {"robot": file.stem, "dim": len(robot.group), "parts": parts, **{k: round(v, 2) for k, v in total.items()}}


def main() -> None:
    """Write a row for each robot as soon as it is there."""
    row_per_robot(FIELDS, "*.urdf", lambda file: measured(file, np.random.default_rng(0)), lambda file: file.stem)


if __name__ == "__main__":
    main()
