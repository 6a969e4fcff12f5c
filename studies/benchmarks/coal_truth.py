"""Whether coal misses contacts, by how a mesh is given to it: corners of the mesh that lie in the other body decide.

    python -m studies.benchmarks.coal_truth [--count 20000]        # needs the extra [mesh]

A ball of triangles, 19 cm long, is placed at random where some of its corners lie deeper than `DEEP` in a box, a
cylinder, a capsule, a sphere or another such ball, so that the two are in contact whatever coal says.  The ball has
corners that its triangles share, or, as in an STL, three of its own for each triangle.  coal takes it as a tree of
triangles, or as the convex body of ``buildConvexHull`` and ``buildConvexRepresentation``, with contacts and without.  A
row says how many of these poses coal calls free, how deep a corner is in the worst of them, and how many corners are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import coal
import numpy as np
from scipy.spatial import ConvexHull
from studies.benchmarks.rows import parser_of

from evenroad._arrays import Floats, Ints
from evenroad.collision.coal_world import tree_of
from evenroad.geometry.mesh import TriangleMesh
from evenroad.geometry.rotation import rotation_from_quaternion

DEEP = 1e-6
"""How deep a corner lies in the other body [m]: coal's own tolerance."""
RADII = (0.06, 0.095, 0.05)
Depth = Callable[[Floats], Floats]
"""How deep points, (n, 3), are in a body [m]; less than 0 outside."""


def ball(rows: int = 5, columns: int = 8) -> tuple[Floats, Ints]:
    """Return corners and triangles of an ellipsoid, as degrees of latitude and longitude cut it."""
    angles = np.pi * np.arange(1, rows) / rows, 2.0 * np.pi * np.arange(columns) / columns
    down, around = (each.ravel() for each in np.meshgrid(*angles, indexing="ij"))
    ring = np.column_stack([np.sin(down) * np.cos(around), np.sin(down) * np.sin(around), np.cos(down)])
    corners = np.concatenate([ring, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]]) * RADII
    triangles = ConvexHull(corners).simplices
    outward = np.einsum("ij,ij->i", np.cross(*(corners[triangles[:, i]] for i in (1, 2))), corners[triangles[:, 0]])
    triangles[outward < 0.0] = triangles[outward < 0.0][:, ::-1]
    return corners, triangles.astype(np.int64)


def soup(corners: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    """Return the same triangles with three corners of its own for each."""
    return corners[triangles].reshape(-1, 3), np.arange(triangles.size).reshape(-1, 3)


def others() -> dict[str, tuple[Any, Depth, float]]:
    """Return other bodies by name: coal's, how deep points are in it, and the radius of a ball around it."""
    half = np.array([0.01, 0.01, 0.3])
    radius, length = 0.03, 0.2

    def in_cylinder(points: Floats) -> Floats:
        return np.minimum(radius - np.linalg.norm(points[:, :2], axis=1), 0.5 * length - np.abs(points[:, 2]))

    def in_capsule(points: Floats) -> Floats:
        z = np.clip(points[:, 2], -0.5 * length, 0.5 * length)
        return radius - np.linalg.norm(np.column_stack([points[:, :2], points[:, 2] - z]), axis=1)

    return {
        "bar": (coal.Box(*(2.0 * half)), lambda points: (half - np.abs(points)).min(axis=1), 0.3),
        "plate": (coal.Box(0.6, 0.4, 0.02), lambda p: (np.array([0.3, 0.2, 0.01]) - np.abs(p)).min(axis=1), 0.3),
        "cylinder": (coal.Cylinder(radius, length), in_cylinder, 0.1),
        "capsule": (coal.Capsule(radius, length), in_capsule, 0.1),
        "sphere": (coal.Sphere(0.06), lambda points: 0.06 - np.linalg.norm(points, axis=1), 0.06),
    }


def given(corners: Floats, triangles: Ints) -> dict[str, Any]:
    """Return a mesh as coal takes it, by name."""
    kept = [tree_of(coal, TriangleMesh(corners, triangles)) for _ in range(3)]
    kept[1].buildConvexRepresentation(False)
    kept[2].buildConvexHull(True, "Qt")
    named = {"triangles": kept[0], "convex representation": kept[1].convex, "convex hull": kept[2].convex}
    return {"_kept": kept, **named}


def poses_in(corners: Floats, depth: Depth, size: float, count: int) -> Iterator[tuple[Any, Floats]]:
    """Yield poses of the other body in which a corner is in it, with the depths of those that are."""
    rng = np.random.default_rng(0)
    while count:
        turn = np.array(rotation_from_quaternion(xyzw=rng.normal(size=4))).reshape(3, 3)
        shift = corners[rng.integers(len(corners))] + turn @ rng.uniform(-size, size, 3)
        depths = depth((corners - shift) @ turn)
        if depths.max() > DEEP:
            count -= 1
            yield coal.Transform3s(turn, shift), depths[depths > DEEP]


def main() -> None:
    """Print a row for each mesh, each way to give it to coal, and each other body."""
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=20_000)
    count = parser.parse_args().count
    here, result = coal.Transform3s.Identity(), coal.CollisionResult()
    shared = ball()
    print(f"coal {coal.__version__}, {count} poses a row")
    for mesh, (corners, triangles) in {"shared corners": shared, "corners of their own": soup(*shared)}.items():
        ways = given(corners, triangles)
        for other, (body, depth, size) in others().items():
            placed = list(poses_in(shared[0], depth, size, count))
            for way in ("triangles", "convex hull", "convex representation"):
                for contact in (True, False):
                    request = coal.CollisionRequest()
                    request.enable_contact = contact
                    missed = []
                    for pose, depths in placed:
                        result.clear()
                        if not coal.collide(ways[way], here, body, pose, request, result):
                            missed.append(depths)
                    worst = max(missed, key=np.max, default=np.zeros(0))
                    said = f"{1e3 * worst.max():.1f} mm deep, {len(worst)} corners in it" if missed else ""
                    asked = "with contacts" if contact else "without"
                    print(f"{mesh:21}{way:22}{other:9} {asked:14}{len(missed):6} missed  {said}", flush=True)


if __name__ == "__main__":
    main()
