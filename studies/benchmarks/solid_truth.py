"""Whether anything inside of a solid is called free: solids of every kind of obstacle, against closed forms and coal.

    python -m studies.benchmarks.solid_truth [--count 100000]

The first rows are the scenes of ``tests/collision/solid_bodies.py``, in a place each: a ball on an arm that reaches
everywhere within a metre.  Those after them are drawn: closed meshes of boxes and of convex hulls, alone and several in
one mesh, of any size, at any distance of the reach and turned at random, with hulls also by coal's signed distances;
and a UR5 whose gripper hangs behind a gap.  A row says how many states there were, how many of them are inside, how
many of those were called free, and how many that are clear of contact by 20 micrometres were blocked.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull
from studies.benchmarks.rows import parser_of
from tests.collision.solid_bodies import LONG, RADIUS, SOLIDS, Solid, at, ball_arm, distance, places_of
from tests.robots.surface_scenes import half_turned

import evenroad as er
from evenroad.geometry import Mesh, Pose, rotation_from_rpy
from evenroad.geometry.mesh import convex_hull, merged
from evenroad.loading import find
from evenroad.robots.kinematics import link_poses

BAND = 2e-5
"""What is clear by this must be free [m]."""
DRAWN = 40
"""Number of scenes of each drawn kind."""

Row = tuple[str, int, int, int, int]


def judged(name: str, world: er.ArmWorld, places: np.ndarray, apart: np.ndarray) -> Row:
    """Return the row of a ball at places, (n, 3), that are so far apart from solids, (n,)."""
    free, apart = world.valid(at(places)), apart - RADIUS
    inside = apart < 0.0
    return name, len(places), int(inside.sum()), int((free & inside).sum()), int((~free & (apart > BAND)).sum())


def random_pose(rng: np.random.Generator, away: float) -> Pose:
    """Return a pose whose origin is that far away, turned at random."""
    way = rng.normal(size=3)
    return Pose(tuple(away * way / np.linalg.norm(way)), rotation_from_rpy(*rng.uniform(-3.0, 3.0, 3)))


def random_box(rng: np.random.Generator) -> Solid:
    """Return a box, and where it is large enough a hollow one, that reaches into the arm's reach or around it."""
    size = tuple(np.exp(rng.uniform(np.log(0.05), np.log(20.0), 3)))
    away = rng.uniform(0.0, LONG + 0.5 * max(size))
    hollow = tuple(0.8 * extent for extent in size) if rng.random() < 0.3 else ()
    return Solid(size, random_pose(rng, away), hollow)


def lies_within(one: Solid, other: Solid) -> bool:
    """Return whether a box lies within another."""
    return bool((other.distance(one.mesh().vertices) < 0.0).all())


def boxes(rng: np.random.Generator, count: int) -> Row:
    """Return the row of one to four boxes in one mesh, some inside out, or facing both ways."""
    solids = [random_box(rng) for _ in range(rng.integers(1, 5))]
    if len(solids) > 1:
        # What lies within another one would be a hollow where it faces the other way.
        plain = [Solid(each.size, each.pose) for each in solids]
        solids = [each for each in plain if not any(lies_within(each, other) for other in plain if other is not each)]
    parts = [each.mesh(inverted=bool(rng.random() < 0.3)) for each in solids]
    mesh = half_turned(merged(tuple(parts))) if rng.random() < 0.2 else merged(tuple(parts))
    places = places_of(solids, rng, count)
    return judged("boxes in a mesh", er.ArmWorld(ball_arm(), er.Scene([Mesh(mesh)])), places, distance(solids, places))


def hull(rng: np.random.Generator, count: int) -> Row:
    """Return the row of a convex hull: inside by its half spaces, the distance by coal."""
    import coal

    size = np.exp(rng.uniform(np.log(0.1), np.log(8.0)))
    pose = random_pose(rng, rng.uniform(0.0, LONG + 0.5 * size))
    mesh = convex_hull(pose.apply(rng.uniform(-0.5, 0.5, (rng.integers(5, 60), 3)) * size * rng.uniform(0.2, 1.0, 3)))
    places = places_of([Solid((size,) * 3, pose)], rng, count)
    sides = ConvexHull(mesh.vertices).equations
    deep = (places @ sides[:, :3].T + sides[:, 3]).max(axis=1)
    points = coal.StdVec_Vec3s()
    for vertex in mesh.vertices:
        points.append(vertex)
    body, ball = coal.Convex.convexHull(points, False, "Qt"), coal.Sphere(RADIUS)
    request, result = coal.DistanceRequest(True), coal.DistanceResult()
    free = er.ArmWorld(ball_arm(), er.Scene([Mesh(mesh)])).valid(at(places))
    inside = deep < RADIUS * 0.999
    # Beside an edge half spaces say less than the distance: coal tells how far it is.
    open_, clear = np.flatnonzero(deep >= 0.0), np.zeros(len(places), dtype=bool)
    inside[open_] = False
    for row in open_:
        result.clear()
        apart = coal.distance(body, coal.Transform3s(), ball, coal.Transform3s(np.eye(3), places[row]), request, result)
        inside[row], clear[row] = apart < -1e-6, apart > BAND
    return "a convex hull", len(places), int(inside.sum()), int((free & inside).sum()), int((~free & clear).sum())


def behind_a_gap(rng: np.random.Generator, count: int) -> Row:
    """Return the row of a UR5 whose gripper hangs 9 cm behind its flange, before a wall that is a mesh."""
    grip = (
        '<link name="grip"><collision><origin xyz="0 0 0.12"/><geometry><box size="0.05 0.05 0.06"/></geometry>'
        '</collision></link><joint name="g" type="fixed"><parent link="tool0"/><child link="grip"/></joint></robot>'
    )
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "gripping.urdf"
        file.write_text((find.DATA / "ur5.urdf").read_text().replace("</robot>", grip))
        robot = er.load_robot(file)
    face = rng.uniform(0.2, 0.95)
    wall = Solid((3.0, 6.0, 6.0), Pose((face + 1.5, 0.0, 0.0)))
    q = rng.uniform(-3.1, 3.1, (count, 6))
    pose = link_poses(robot, q)[:, robot.links.index("grip")]
    corners = np.array([(x, y, z) for x in (-0.025, 0.025) for y in (-0.025, 0.025) for z in (0.09, 0.15)])
    reached = np.einsum("nij,kj->nki", pose[:, :3, :3], corners) + pose[:, np.newaxis, :3, 3]
    inside = reached[:, :, 0].max(axis=1) > face
    free = er.ArmWorld(robot, er.Scene([Mesh(wall.mesh())])).valid(q)
    boxed = er.ArmWorld(robot, er.Scene([er.Box(wall.size, pose=wall.pose)])).valid(q)
    # A box's capsules are covered by spheres: a mesh may leave more free, and never less.
    return "a gripper behind a gap", count, int(inside.sum()), int((free & inside).sum()), int((boxed & ~free).sum())


def rows(count: int) -> Iterator[Row]:
    """Yield the rows of `count` states each, about so many."""
    rng = np.random.default_rng(0)
    with tempfile.TemporaryDirectory() as folder:
        for name, (make, solids) in SOLIDS.items():
            places = places_of(solids, rng, count // (2 + sum(1 + bool(each.hollow) for each in solids)))
            yield judged(name, er.ArmWorld(ball_arm(), make(Path(folder))), places, distance(solids, places))
    for drawn in (boxes, hull, behind_a_gap):
        found = [drawn(rng, count // DRAWN) for _ in range(DRAWN)]
        yield found[0][0], *np.sum([row[1:] for row in found], axis=0).tolist()


def main() -> None:
    """Print the rows as they come."""
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=100_000)
    given = parser.parse_args()
    os.nice(5)
    print(f"{'solid':42} {'states':>8} {'inside':>8} {'inside, free':>13} {'clear, blocked':>15}")
    for name, *numbers in rows(given.count):
        print(f"{name:42} {numbers[0]:8} {numbers[1]:8} {numbers[2]:13} {numbers[3]:15}", flush=True)


if __name__ == "__main__":
    main()
