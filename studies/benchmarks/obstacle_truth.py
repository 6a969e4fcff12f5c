"""Verdicts on robots among obstacles against coal, on the triangles of the makers' files, and against MuJoCo's hulls.

    python -m studies.benchmarks.obstacle_truth OUT.csv ROBOT.urdf FOLDER ... [--count 2000]
    python -m studies.benchmarks.obstacle_truth OUT.csv --table

For each robot, in three scenes of twenty boxes, balls and cylinders at random: how many configurations that we call
free touch an obstacle by more than `DEEP` (uniform ones, others bisected to our edge of contact), how many that coal
calls free are blocked here, with the makers' shapes and with capsules, the volume of what stands for the robot, and
the time of a verdict.  Links are not tested against each other.  ``--table`` prints the rows as docs/guides/robots.md
has them.
"""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from studies.benchmarks.rows import given_or_table, parser_of, row_per_robot

from evenroad.geometry import rotation_from_rpy
from evenroad.robot import ArmWorld, Robot, Scene, load_model
from evenroad.scenes.scene import Obstacle

SCENES = 3
DEEP, CLEAR = 6e-6, 5e-4
"""What single precision may cost is some micrometres; what coal calls free by this must be free [m]."""
FIELDS = (
    *("robot", "dim", "parts", "configurations", "truth_blocked", "blocked", "blocked_capsules"),
    *("beyond", "beyond_capsules", "clear_yet_blocked", "clear_yet_blocked_capsules"),
    *("free_that_touch", "at_contact", "at_contact_that_touch", "hulls_that_touch"),
    *("volume", "volume_capsules", "us", "us_capsules", "load_s", "note"),
)


def random_scene(seed: int, reach: float, floor: float) -> Scene:
    """Return twenty obstacles around a robot, none near its base."""
    rng = np.random.default_rng(seed)
    made: list[Obstacle] = []
    while len(made) < 20:
        kind = ("box", "sphere", "cylinder")[len(made) % 3]
        size = tuple(rng.uniform(0.02, 0.25, {"box": 3, "sphere": 1}.get(kind, 2)) * reach)
        place = rng.uniform(-0.8, 0.8, 3) * reach
        if np.linalg.norm(place) > floor + float(np.linalg.norm(size)):
            turn = rotation_from_rpy(*rng.uniform(-3.0, 3.0, 3))
            made.append(Obstacle.of(f"obstacle{len(made)}", kind, size, tuple(place), turn))
    return Scene(tuple(made), name=f"random{seed}")


def solid(obstacle: Obstacle, margin: float):
    """Return an obstacle as coal has it, by a negative margin smaller, of which coal's meshes know nothing."""
    import coal

    less = min(margin, 0.0)
    more = {"box": (2 * less,) * 3, "sphere": (less,), "cylinder": (less, 2 * less)}[obstacle.shape]
    size = np.add(obstacle.size, more).tolist()
    made = {"box": coal.Box, "sphere": coal.Sphere, "cylinder": coal.Cylinder}[obstacle.shape](*size)
    return made, coal.Transform3s(np.reshape(obstacle.rotation, (3, 3)), np.array(obstacle.xyz))


def touching(truth, scene: Scene, q: np.ndarray, margin: float) -> np.ndarray:
    """Return which configurations come within `margin` of an obstacle in coal, or deeper than a negative one, (n,).

    A mesh is a surface for coal; an obstacle that is wholly inside of a closed one touches, too.
    """
    import coal

    from evenroad.geometry.hulls import winding_number

    request, result = coal.CollisionRequest(), coal.CollisionResult()
    request.security_margin = max(margin, 0.0)
    request.enable_contact = True
    items, solids = truth.geometry.geometryObjects, [solid(each, margin) for each in scene.obstacles]
    rotation, shift = truth.places(q)
    hits = np.zeros(len(q), dtype=bool)
    for row, i, k in near_pairs(truth, scene, rotation, shift):
        if not hits[row]:
            result.clear()
            here = coal.Transform3s(rotation[row, i], shift[row, i])
            hits[row] = bool(coal.collide(items[i].geometry, here, *solids[k], request, result))
            if not hits[row] and i in truth.surfaces:
                middle = rotation[row, i].T @ (solids[k][1].getTranslation() - shift[row, i])
                low, high = truth.boxes[i]
                if (middle >= low).all() and (middle <= high).all():
                    hits[row] = abs(winding_number(truth.surfaces[i], middle)) > 0.5
    return hits


def near_pairs(truth, scene: Scene, rotation: np.ndarray, shift: np.ndarray) -> list[list[int]]:
    """Return configurations, bodies and obstacles, a row each, whose balls come within a millimetre."""
    middles, radii = truth.balls()
    centres = np.einsum("nbij,bj->nbi", rotation, middles) + shift
    places = np.array([each.xyz for each in scene.obstacles])
    # A ball around a cylinder of this radius and length is smaller than that of a box of these sides.
    around = np.array([np.linalg.norm(each.size) for each in scene.obstacles])
    apart = np.linalg.norm(centres[:, :, np.newaxis] - places, axis=3)
    return np.argwhere(apart < radii[:, np.newaxis] + around + 1e-3).tolist()


class Hulls:
    """The convex bodies of a robot among obstacles in MuJoCo, which knows the convex hull of a mesh."""

    def __init__(self, truth, scene: Scene) -> None:
        import coal
        import mujoco

        spec, self.geoms = mujoco.MjSpec(), {}
        for i, item in enumerate(truth.geometry.geometryObjects):
            shape, kind, size, name = item.geometry, None, [1.0] * 3, ""
            if isinstance(shape, coal.BVHModelBase):
                if i in truth.convex:
                    kind, name = mujoco.mjtGeom.mjGEOM_MESH, f"mesh{i}"
                    spec.add_mesh(name=name, uservert=shape.vertices().ravel().tolist())
            elif isinstance(shape, coal.Box):
                kind, size = mujoco.mjtGeom.mjGEOM_BOX, shape.halfSide.tolist()
            elif isinstance(shape, coal.Sphere):
                kind, size = mujoco.mjtGeom.mjGEOM_SPHERE, [shape.radius] * 3
            elif isinstance(shape, coal.Cylinder):
                kind, size = mujoco.mjtGeom.mjGEOM_CYLINDER, [shape.radius, shape.halfLength, 1.0]
            if kind is not None:
                self.geoms[i] = len(self.geoms)
                spec.worldbody.add_geom(type=kind, size=size, **({"meshname": name} if name else {}))
        for each in scene.obstacles:
            size = np.multiply(each.size, {"box": 0.5, "cylinder": (1.0, 0.5)}.get(each.shape, 1.0)).tolist()
            kind = getattr(mujoco.mjtGeom, f"mjGEOM_{each.shape.upper()}")
            quaternion = np.zeros(4)
            mujoco.mju_mat2Quat(quaternion, np.array(each.rotation))
            spec.worldbody.add_geom(type=kind, size=[*size, 1.0, 1.0][:3], pos=each.xyz, quat=quaternion)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        mujoco.mj_kinematics(self.model, self.data)
        self.own = [(self.data.geom_xmat[g].reshape(3, 3).copy(), self.data.geom_xpos[g].copy())
                    for g in range(len(self.geoms))]  # fmt: skip
        self.truth, self.scene = truth, scene

    def touching(self, q: np.ndarray) -> np.ndarray:
        """Return which configurations have a convex body deeper than `DEEP` in an obstacle, (n,)."""
        import mujoco

        rotation, shift = self.truth.places(q)
        hits = np.zeros(len(q), dtype=bool)
        for row, i, k in near_pairs(self.truth, self.scene, rotation, shift):
            if not hits[row] and i in self.geoms:
                g = self.geoms[i]
                turn, place = self.own[g]
                self.data.geom_xmat[g] = (rotation[row, i] @ turn).ravel()
                self.data.geom_xpos[g] = rotation[row, i] @ place + shift[row, i]
                hits[row] = mujoco.mj_geomDistance(self.model, self.data, g, len(self.own) + k, 1e-3, None) < -DEEP
        return hits


def volumes(model) -> tuple[float, float]:
    """Return what stands for the robot with shapes, and with capsules, in parts of its shapes' volume."""
    from scipy.spatial import ConvexHull

    own = sum(body.shape_volume for body in model.bodies)
    wider = 0.0
    for part in model.robot.shapes:
        if part.of == "hull":
            # The hull without its least corners, and what lies within its radius of it.
            hull = ConvexHull(part.corners[0])
            wider += hull.area * part.radius
    return 1.0 + wider / own, sum(body.capsule_volume for body in model.bodies) / own


def seconds(world: ArmWorld, q: np.ndarray) -> float:
    """Return the processor's seconds of one verdict: the least of three passes."""
    took = []
    for _ in range(3):
        began = time.process_time()
        world.valid(q)
        took.append(time.process_time() - began)
    return min(took) / len(q)


def held_joints(robot: Robot) -> dict[str, float]:
    """Return the values of the joints that are not planned for."""
    return {
        joint.name: robot.held.get(joint.name, joint.neutral)
        for joint in robot.joints
        if joint.kind != "fixed" and joint.mimic is None and joint.name not in robot.group
    }


def measured(file: Path, count: int) -> dict[str, object]:
    """Return the row of one robot."""
    from studies.benchmarks.robot_truth import Truth, at_contact

    rng = np.random.default_rng(0)
    began = time.process_time()
    model = load_model(file)
    wide = [joint.name for joint in model.robot.joints if joint.kind == "prismatic" and joint.upper - joint.lower > 5.0]
    if not set(wide).isdisjoint(model.robot.group):
        # A base that drives metres away from all obstacles is not planned for.
        model = load_model(file, group=[name for name in model.robot.group if name not in wide])
    loaded = time.process_time() - began
    robot = replace(model.robot, pairs=(), pairs_given=True, resting=())
    capsules = replace(robot, shapes=())
    truth = Truth(file, robot.group, held_joints(robot))
    total: dict[str, float] = dict.fromkeys(FIELDS[3:15], 0)
    took: list[tuple[float, float]] = []
    for seed in range(SCENES):
        reach = min(ArmWorld(robot).robot_tables.reach, 1.5)
        scene = random_scene(seed, reach, 0.35 * reach)
        world, of_capsules = ArmWorld(robot, scene), ArmWorld(capsules, scene)
        q = world.space.from_cube(rng.random((count // SCENES, world.space.cube_dim)))
        free, wide = world.valid(q), of_capsules.valid(q)
        took.append((seconds(world, q), seconds(of_capsules, q)))
        # What is farther than the margin touches neither, and what does not touch is nowhere deep.
        near = touching(truth, scene, q, CLEAR)
        hits = near.copy()
        hits[near] = touching(truth, scene, q[near], 0.0)
        total["configurations"] += len(q)
        for key, value in (
            ("truth_blocked", hits), ("blocked", ~free), ("blocked_capsules", ~wide),
            ("beyond", ~free & ~hits), ("beyond_capsules", ~wide & ~hits),
            ("clear_yet_blocked", ~free & ~near), ("clear_yet_blocked_capsules", ~wide & ~near),
        ):  # fmt: skip
            total[key] += int(value.sum())
        hulls = Hulls(truth, scene)
        total["free_that_touch"] += int(touching(truth, scene, q[free & hits], -DEEP).sum())
        total["hulls_that_touch"] += int(hulls.touching(q[free]).sum())
        if free.any() and not free.all():
            edge = at_contact(world, q[free], q[~free], count // SCENES, rng)
            total["at_contact"] += len(edge)
            total["at_contact_that_touch"] += int(touching(truth, scene, edge, -DEEP).sum())
            total["hulls_that_touch"] += int(hulls.touching(edge).sum())
    of = total["configurations"]
    shares = {key: round(100.0 * total[key] / of, 2) for key in FIELDS[4:9]}
    volume, volume_capsules = volumes(model)
    us, us_capsules = 1e6 * np.mean(took, axis=0)
    return {
        "robot": file.stem, "dim": len(robot.group), "parts": sum(len(each.corners) for each in robot.shapes),
        **{key: int(value) for key, value in total.items()}, **shares,
        "volume": round(volume, 3), "volume_capsules": round(volume_capsules, 2),
        "us": round(float(us), 3), "us_capsules": round(float(us_capsules), 3), "load_s": round(loaded, 1),
        "note": "; ".join(truth.notes),
    }  # fmt: skip


def table(rows: Sequence[dict[str, str]]) -> str:
    """Return the rows as a table of a page: percent blocked, in truth and beyond it; volume and time in parts."""
    head = ("robot", "joints", "in truth", "capsules", "shapes", "volume", "time", "touching")
    lines = [f"| {' | '.join(head)} |", "|" + "---|" * len(head)]
    for row in (row for row in rows if row["us"]):
        wrong = sum(int(row[key] or 0) for key in ("free_that_touch", "at_contact_that_touch", "hulls_that_touch"))
        cells = (
            *(row["robot"], row["dim"], f"{float(row['truth_blocked']):.1f}"),
            *(f"+{float(row[key]):.2f}" for key in ("beyond_capsules", "beyond")),
            f"{float(row['volume_capsules']):.2f}, {float(row['volume']):.3f}",
            f"{float(row['us']) / float(row['us_capsules']):.2f}",
            f"{wrong} of {int(row['configurations']) + int(row['at_contact'] or 0)}",
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    """Write a row for each robot as soon as it is there, or print the table of a file's rows."""
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=2000)
    given = given_or_table(parser, table)
    os.nice(5)
    paths = [given.out, *given.robots]
    row_per_robot(FIELDS, "*.urdf", lambda file: measured(file, given.count), lambda file: file.stem, paths)


if __name__ == "__main__":
    main()
