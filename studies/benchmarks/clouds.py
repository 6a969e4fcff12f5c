"""Clouds and meshes as obstacles: checks a second beside the same scene of six boxes, build times, and what they add.

    python -m studies.benchmarks.clouds

The UR5 with five joints in front of the open box on its table: as the boxes themselves, as points on their surfaces,
and as triangles.  Rates are of processor time, all scenes in turn in one process, so that what else runs on the machine
touches them alike: the median of the repeats, and the standard error of the ratio to the boxes.  `beyond` is how far
configurations next to contact are from it in double precision: what verdicts keep clear of it.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import trimesh
from studies.benchmarks.arm_speed import ur5_world
from tests.robots.kernel_arms import edge
from tests.robots.surface_oracle import all_clearance

from evenroad.collision.arm_world import ArmWorld
from evenroad.collision.native_surfaces import make_surface
from evenroad.geometry import Mesh, PointCloud, TriangleMesh
from evenroad.geometry.mesh import merged
from evenroad.loading.load import load_robot
from evenroad.planning import plan
from evenroad.scenes.scene import Obstacle, Scene

Floats = npt.NDArray[np.float64]
RADIUS = 0.005


def points_on(boxes: Scene, count: int, rng: np.random.Generator) -> Floats:
    """Return points on the surfaces of boxes, (n, 3), about so many, evenly by area."""
    triangles = np.concatenate([_corners(triangles_of(box, 0)) for box in boxes.obstacles])
    areas = 0.5 * np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)
    chosen = triangles[rng.choice(len(triangles), count, p=areas / areas.sum())]
    u, v = rng.random((2, count, 1))
    u, v = np.where(u + v > 1.0, 1.0 - u, u), np.where(u + v > 1.0, 1.0 - v, v)
    return chosen[:, 0] + u * (chosen[:, 1] - chosen[:, 0]) + v * (chosen[:, 2] - chosen[:, 0])


def triangles_of(box: Obstacle, halvings: int) -> TriangleMesh:
    """Return a box as triangles, each side divided so often."""
    mesh = trimesh.creation.box(box.size)
    for _ in range(halvings):
        mesh = mesh.subdivide()
    return TriangleMesh(box.body.pose.apply(mesh.vertices), mesh.faces)


def in_pieces(box: Obstacle, count: int) -> list[Obstacle]:
    """Return meshes that make up a box, cut across its longest side."""
    sizes, turn = np.array(box.size), np.reshape(box.rotation, (3, 3))
    longest = int(np.argmax(sizes))
    shifts = ((np.arange(count) + 0.5) / count - 0.5) * sizes[longest]
    sizes[longest] /= count
    pieces = [
        Obstacle.of(f"{box.name} {i}", "box", tuple(sizes), tuple(box.xyz + shift * turn[:, longest]), box.rotation)
        for i, shift in enumerate(shifts)
    ]
    return [Obstacle(piece.name, Mesh(triangles_of(piece, 4))) for piece in pieces]


def _corners(mesh: TriangleMesh) -> Floats:
    return mesh.vertices[mesh.triangles]


def bookshelf(halvings: int = 4) -> TriangleMesh:
    """Return a shelf of three boards, two sides and a back: 18 432 triangles, or a quarter for each halving less."""
    parts = [((0.35, 0.9, 0.02), (0.75, 0.0, z)) for z in (0.05, 0.4, 0.75)]
    parts += [((0.35, 0.02, 0.8), (0.75, y, 0.4)) for y in (-0.45, 0.45)]
    parts += [((0.02, 0.9, 0.8), (0.93, 0.0, 0.4))]
    boxes = [Obstacle.of(str(i), "box", size, place) for i, (size, place) in enumerate(parts)]
    return merged(tuple(triangles_of(box, halvings) for box in boxes))


def rate(work: Callable[[], object], count: int) -> float:
    """Return how many a second of processor time."""
    begin = time.process_time()
    work()
    return count / (time.process_time() - begin)


def build_time(body: PointCloud | Mesh, reach: float) -> float:
    """Return the least of five times to make a surface of a body [ms]."""
    best = np.inf
    for _ in range(5):
        begin = time.process_time()
        make_surface(body, reach)
        best = min(best, time.process_time() - begin)
    return 1e3 * best


def compare(worlds: dict[str, ArmWorld], repeats: int, count: int) -> None:
    """Print what each world does a second, beside the first."""
    rng = np.random.default_rng(1)
    first = next(iter(worlds.values()))
    q = first.space.from_cube(rng.random((10 * count, first.space.dim)))
    free = q[np.logical_and.reduce([world.valid(q) for world in worlds.values()])]
    a, b = free[: len(free) // 2][:count], free[len(free) // 2 :][:count]
    a, near = a[: len(b)], first.space.interpolate(a[: len(b)], b, 0.15)
    clear = np.logical_and.reduce([world.motion_certified(a, near, 1e-3) for world in worlds.values()])
    tasks: dict[str, Callable[[ArmWorld], object]] = {
        "configurations": lambda world: world.valid(q),
        "motions": lambda world: world.motion_valid(a, b),
        "short motions": lambda world: world.motion_valid(a, near),
        "proofs of short free ones": lambda world: world.motion_certified(a[clear], near[clear], 1e-3),
    }
    sizes = {"configurations": len(q), "motions": len(a), "short motions": len(a)}
    print(f"{'a second':<26}" + "".join(f"{name:>24}" for name in worlds))
    for task, work in tasks.items():
        for world in worlds.values():
            work(world)
        rates = np.array(
            [
                [rate(lambda w=world, f=work: f(w), sizes.get(task, int(clear.sum()))) for world in worlds.values()]
                for _ in range(repeats)
            ]
        )
        ratios = rates / rates[:, :1]
        cells = [f"{np.median(rates[:, 0]):.3g}"]
        for k in range(1, len(worlds)):
            error = ratios[:, k].std(ddof=1) / np.sqrt(repeats)
            cells.append(f"{np.median(rates[:, k]):.3g} {np.median(ratios[:, k]):.2f} ± {error:.3f}")
        print(f"{task:<26}" + "".join(f"{cell:>24}" for cell in cells))


def beyond(world: ArmWorld, solid: bool | None, count: int) -> Floats:
    """Return how far free configurations next to contact are from it in double precision, (n,) [m]."""
    q = world.space.from_cube(np.random.default_rng(2).random((4_000, world.space.dim)))
    free, _ = edge(world, q, most=count)
    return all_clearance(world.robot, world.scene, free, solid is not False)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=100_000)
    parser.add_argument("--repeats", type=int, default=15)
    parser.add_argument("--count", type=int, default=10_000, help="motions")
    args = parser.parse_args()
    boxes = ur5_world("box-reach")
    base = {link for link, _ in boxes.scene.allowed}
    few, many = (merged(tuple(triangles_of(box, n) for box in boxes.scene.obstacles)) for n in (0, 4))
    bodies = {
        f"{args.points} points": PointCloud(points_on(boxes.scene, args.points, np.random.default_rng(0)), RADIUS),
        f"{len(few.triangles)} triangles": Mesh(few),
        f"{len(many.triangles)} triangles": Mesh(many),
    }
    worlds = {"six boxes": boxes}
    for name, body in bodies.items():
        scene = Scene((Obstacle("scan", body),), name=name, allowed=frozenset((link, "scan") for link in base))
        worlds[name] = ArmWorld(boxes.robot, scene)
    # Each box a mesh of its own, or four, with a grid around all of them.
    for name, parts in (("6 meshes", 1), ("24 meshes", 4)):
        each = tuple(piece for box in boxes.scene.obstacles for piece in in_pieces(box, parts))
        allowed = frozenset((link, piece.name) for link in base for piece in each)
        worlds[name] = ArmWorld(boxes.robot, Scene(each, name=name, allowed=allowed))
    compare(worlds, args.repeats, args.count)
    print(f"\n{'':<28}{'built [ms]':>12}{'beyond contact [um], median / most of 60':>44}")
    for name, body in bodies.items():
        kept = 1e6 * beyond(worlds[name], None if isinstance(body, PointCloud) else True, 60)
        assert (kept > 0.0).all(), "a verdict was freer than the balls"
        made = build_time(body, boxes.robot_tables.reach)
        print(f"{name:<28}{made:>12.1f}{f'{np.median(kept):.1f} / {kept.max():.1f}':>44}")
    shelf = bookshelf()
    scene = Scene((Obstacle("shelf", Mesh(shelf)),), name="bookshelf")
    robot = load_robot("ur5")
    ends = [0.0, -1.57, 0.0, -1.57, 0.0, 0.0], [-0.3, -0.9, 1.4, -2.0, -1.5, 0.0]
    result = plan(scene, *ends, robot=robot)
    times = []
    for _ in range(5):
        begin = time.process_time()
        result = plan(scene, *ends, robot=robot)
        times.append(1e3 * (time.process_time() - begin))
    found = f"{result.status}, {result.proof}, {np.median(times):.1f} ms again in the scene"
    print(f"\nbookshelf of {len(shelf.triangles)} triangles: {found}")


if __name__ == "__main__":
    main()
