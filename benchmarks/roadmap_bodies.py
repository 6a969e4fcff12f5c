"""Roadmaps made for rigid bodies: a mobile base and a flying body, as robots whose first joints slide and then turn.

    python -m benchmarks.roadmap_bodies --problems 100 --draws 2

Problems: boxes at random in a room, start and goal free at random, the straight motion blocked, solved by trees.
`owen` are scrambled Sobol points of the joint box, `control` the first that are free, in the roadmap's metric; all are
joined to k = 10 and linked alike, without trees.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from evenroad.points import draw
from evenroad.roadmap import Budget
from evenroad.roadmap.find_path import find_path
from evenroad.robot import ArmWorld, Obstacle, Robot, Scene, load_robot
from evenroad.robot_roadmap.make import joined, make_roadmap
from evenroad.robot_roadmap.pockets import links_of
from evenroad.robot_roadmap.robot_roadmap import RobotRoadmap
from evenroad_studies.arms.roadmaps import first_free

ROOM = 2.0
"""Half of the room's sides [m]."""

FIRST_SEED = 70_000
K = 10
BODY = """
<collision><origin xyz="0.15 0 0" rpy="0 1.5707963 0"/><geometry><capsule radius="0.08" length="0.5"/></geometry>
</collision>
<collision><origin xyz="-0.1 0.15 0" rpy="1.5707963 0 0"/><geometry><capsule radius="0.08" length="0.3"/></geometry>
</collision>"""


def body(turning: str, sliding: str = "xy") -> Robot:
    """Return an L-shaped body that slides along some axes and then turns about others, one after the other."""
    axes = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}
    links, joints = ['<link name="room"/>'], []
    before = "room"
    for kind, letters in (("slide", sliding), ("turn", turning)):
        for letter in letters:
            name = f"{kind}_{letter}"
            last = kind == "turn" and letter == turning[-1]
            links.append(f'<link name="{name}">{BODY if last else ""}</link>')
            # The middle one of three turns has half of its range: each rotation once.
            half = kind == "turn" and len(turning) == 3 and letter == turning[1]
            limit = ROOM if kind == "slide" else 0.5 * np.pi
            of = "prismatic" if kind == "slide" else "revolute" if half else "continuous"
            joints.append(
                f'<joint name="{name}" type="{of}"><parent link="{before}"/><child link="{name}"/>'
                f'<axis xyz="{axes[letter]}"/>'
                f'<limit lower="{-limit}" upper="{limit}" velocity="1" effort="1"/></joint>'
            )
            before = name
    text = "\n".join(['<robot name="body">', *links, *joints, "</robot>"])
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "body.urdf").write_text(text)
        return load_robot(Path(folder) / "body.urdf")


BODIES = {"mobile base": lambda: body("z"), "flying body": lambda: body("zyx", "xyz")}


def problems(robot: Robot, count: int, flat: bool) -> Iterator[tuple[Scene, np.ndarray, np.ndarray]]:
    """Yield scenes with start and goal."""
    for seed in range(FIRST_SEED, FIRST_SEED + 50 * count):
        rng = np.random.default_rng(seed)
        boxes = []
        for i in range(int(rng.integers(12, 25)) * (1 if flat else 2)):
            size = rng.uniform(0.2, 0.9, 3)
            place = rng.uniform(-ROOM, ROOM, 3) * (1.0, 1.0, 0.0 if flat else 1.0)
            boxes.append(Obstacle.of(f"box {i}", "box", tuple(size), tuple(place)))
        world = ArmWorld(robot, Scene(f"boxes {seed}", tuple(boxes)))
        q = world.space.from_cube(rng.random((200, world.space.dim)))
        q = q[world.valid(q)]
        if len(q) < 2 or world.motion_valid(q[:1], q[1:2])[0]:
            continue
        if find_path(world, q[0], q[1], budget=Budget(seconds=0.5), shorten=False).solved:
            count -= 1
            yield world.scene, q[0], q[1]
        if count == 0:
            return


def solved(roadmap: RobotRoadmap, some: list[tuple[Scene, np.ndarray, np.ndarray]]) -> np.ndarray:
    """Return which problems the roadmap solves without trees, (p,)."""
    links = links_of(len(roadmap.milestones))
    return np.array(
        [
            roadmap.in_scene(scene).connect(start, goal[np.newaxis], links=links).goal >= 0
            for scene, start, goal in some
        ],
        dtype=float,
    )


def owen(made: RobotRoadmap, n: int, rng: np.random.Generator) -> RobotRoadmap:
    """Return a roadmap of points of the joint box in the metric of the joints."""
    points = made.world.space.from_cube(draw("sobol", n, made.world.space.dim, rng=rng).points)
    return joined(replace(made, weights=np.ones(made.world.space.dim)), points, K)


def main() -> None:
    """Print percent solved, and differences paired by problem."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--problems", type=int, default=100)
    parser.add_argument("--draws", type=int, default=2)
    parser.add_argument("--counts", type=int, nargs="+", default=[64, 128, 256])
    parser.add_argument("--bodies", nargs="+", default=[*BODIES], choices=BODIES)
    options = parser.parse_args()
    print("| body | N | owen | control | roadmap | roadmap - owen | roadmap - control |")
    print("|---|---|---|---|---|---|---|", flush=True)
    for name in options.bodies:
        robot = BODIES[name]()
        some = list(problems(robot, options.problems, name == "mobile base"))
        for n in options.counts:
            by: dict[str, list[np.ndarray]] = {"owen": [], "control": [], "roadmap": []}
            for run in range(options.draws):
                made = make_roadmap(robot, Scene("room"), n, k=K, rng=run)
                free = first_free(made.world, n, np.random.default_rng(1000 + run))
                by["roadmap"].append(solved(made, some))
                by["control"].append(solved(joined(made, free, K), some))
                by["owen"].append(solved(owen(made, n, np.random.default_rng(2000 + run)), some))
            share = {title: np.mean(rows, axis=0) for title, rows in by.items()}
            cells = [f"{100 * rows.mean():.0f}" for rows in share.values()]
            for other in ("owen", "control"):
                apart = 100.0 * (share["roadmap"] - share[other])
                cells.append(f"{apart.mean():+.1f} ± {apart.std(ddof=1) / np.sqrt(len(apart)):.1f}")
            print(f"| {name} | {n} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
