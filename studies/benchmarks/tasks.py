"""Tasks in scenes of their own: pick from a shelf, carry upright, place, retreat, with 24 grasps; curves of 1000 poses.

    python -m studies.benchmarks.tasks ur5 PANDA.urdf --count 100 [--check]

The can stands on a board, the flange (of a Panda its closed fingers) comes to it from one of 24 directions, pulls it
out, carries it with its axis within 0.1 rad of the vertical, puts it onto a table, and goes home.  Boards, can and
table are at random places.  Times are processor time of ``Task.plan``, from a world that exists.  With ``--check`` all
paths are tried at ten states of each motion by coal, on the files' triangles and boxes with what is held, and by
MuJoCo, on what is no mesh (needs coal and mujoco).  The last row follows splines of 1000 poses from a free posture.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from studies.benchmarks.rows import parser_of

import evenroad as er
from evenroad.collision.coal_world import CoalWorld, original_shapes, tests_of
from evenroad.constraints.constrained_world import KeptWorld
from evenroad.geometry.curve import spline
from evenroad.geometry.pose import IDENTITY
from evenroad.geometry.shapes import Mesh
from evenroad.poses.cartesian_path import Follower
from evenroad.poses.chain import chain_of, default_tip
from evenroad.poses.inverse_kinematics import reach
from evenroad.poses.posture_layers import follow
from evenroad.robot import Robot
from evenroad.robots.kinematics import link_poses
from evenroad.task import Attach, Detach, MoveTo, Task
from evenroad.task.contact import core_of
from evenroad.task.steps import DEPTH

GRASPS = 24
HOMES = {"ur5": (0.0, -2.0, 1.9, -1.5, -np.pi / 2, 0.0), "panda": (0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785)}
TIPS, STANDOFF = {"ur5": "tool0", "panda": "panda_hand"}, {"ur5": 0.033, "panda": 0.146}
"""The link that takes the can, and how far its origin is from the can's axis then [m]."""


def robot_of(source: str) -> Robot:
    """Return a robot without its fingers' joints."""
    robot = er.load_robot(source)
    arm = [name for name in robot.group if "finger" not in name]
    return er.load_robot(source, group=arm) if len(arm) < len(robot.group) else robot


def problem(robot: Robot, seed: int) -> tuple[er.Scene, Task]:
    """Return the scene and the task of a seed."""
    rng = np.random.default_rng([seed, 38])
    kind = "panda" if "panda" in robot.name else "ur5"
    x, y, floor = rng.uniform(0.55, 0.7), rng.uniform(-0.15, 0.15), rng.uniform(0.2, 0.35)
    side, above = rng.uniform(0.3, 0.45), rng.uniform(0.35, 0.45)
    table = rng.choice([-1.0, 1.0]) * rng.uniform(0.45, 0.55), rng.uniform(0.0, 0.2)
    boxes = [
        ("table", (0.5, 0.4, 0.04), (table[1], table[0], 0.08)),
        ("board", (0.3, 2.0 * side, 0.02), (x + 0.08, y, floor)),
        ("upper board", (0.3, 2.0 * side, 0.02), (x + 0.08, y, floor + above)),
        ("left side", (0.3, 0.02, above), (x + 0.08, y + side, floor + 0.5 * above)),
        ("right side", (0.3, 0.02, above), (x + 0.08, y - side, floor + 0.5 * above)),
        ("back", (0.02, 2.0 * side, above), (x + 0.24, y, floor + 0.5 * above)),
        ("can", (0.06, 0.06, 0.16), (x, y, floor + 0.091)),
    ]
    scene = er.Scene([er.Box(size, xyz=xyz, name=name) for name, size, xyz in boxes], name=f"shelf{seed}")
    grasps, off = [], STANDOFF[kind]
    for angle in np.linspace(-1.2, 1.2, GRASPS):
        xyz = x - off * np.cos(angle), y - off * np.sin(angle), floor + 0.1
        grasps.append(er.PoseGoal(er.Pose(xyz, rpy=(0.0, np.pi / 2, angle)), TIPS[kind], free_axis="z"))
    place = er.PoseGoal(er.Pose((table[1], table[0], 0.181)), tip="can", free_axis="z")
    upright = er.constraints.KeepUpright(0.1, "z", tip="can")
    steps = [
        MoveTo(grasps, approach=0.12),
        Attach("can", TIPS[kind]),
        MoveTo(place, retreat=0.05, approach=0.05, away="up", constraints=upright),
        Detach("can", onto="table"),
        MoveTo(list(HOMES[kind]), retreat=0.1),
    ]
    return scene, Task(steps)


def touching(source: str, part: er.PlanResult) -> tuple[int, int, int]:
    """Return at how many states of a part something touches by coal, and by MuJoCo, and how many states there are."""
    world = part.world.world if isinstance(part.world, KeptWorld) else part.world
    q = np.linspace(part.path[:-1], part.path[1:], 10).reshape(-1, world.dim)
    robot = world.robot
    held = {each.name: replace(each.body, pose=IDENTITY, link=each.name) for each in world.scene.attached}
    for name in robot.holds:
        # On a line the can may touch what it stands on, and this smaller one may not.
        held.setdefault(name, replace(core_of(held["can"], DEPTH, as_capsule=False), link=name))
    shapes = [held.pop(each.link, each) for each in original_shapes(source, robot) if each.link not in robot.holds]
    shapes += held.values()
    coal = CoalWorld(robot, world.scene, tuple(shapes))
    blocked = ~coal.valid(q)
    return int(blocked.sum()), int(in_mujoco(robot, world.scene, shapes, q).sum()), len(q)


def in_mujoco(robot: Robot, scene: er.Scene, shapes: list, q: np.ndarray) -> np.ndarray:
    """Return at which configurations, (n, dim), convex bodies touch in MuJoCo."""
    import mujoco

    spec = mujoco.MjSpec()
    bodies = [*shapes, *(each.body for each in scene.obstacles)]
    half = {"box": 0.5, "cylinder": (1.0, 0.5), "capsule": (1.0, 0.5)}
    known, reaches = [], []
    for body in bodies:
        if isinstance(body, Mesh):
            corners = body.triangles.vertices
            reaches.append(float(np.linalg.norm(corners, axis=1).max()))
            known.append(False)
            spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[1e-3] * 3)
            continue
        size = np.multiply(body.size, half.get(body.kind, 1.0)).tolist()
        reaches.append(float(np.linalg.norm(body.size)))
        known.append(True)
        kind = getattr(mujoco.mjtGeom, f"mjGEOM_{body.kind.upper()}")
        spec.worldbody.add_geom(type=kind, size=[*size, 1.0, 1.0][:3])
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    links = link_poses(robot, q)
    number = {link: i for i, link in enumerate(robot.links)}
    placed = [links[:, number[each.link]] @ each.pose.matrix for each in shapes]
    placed += [np.broadcast_to(each.body.pose.matrix, (len(q), 4, 4)) for each in scene.obstacles]
    hits = np.zeros(len(q), dtype=bool)
    for a, b, is_obstacle in tests_of(robot, scene, shapes):
        b = b + len(shapes) * is_obstacle
        if not (known[a] and known[b]):
            continue
        far = np.linalg.norm(placed[a][:, :3, 3] - placed[b][:, :3, 3], axis=1)
        for row in np.flatnonzero(~hits & (far < reaches[a] + reaches[b])).tolist():
            for geom in (a, b):
                data.geom_xpos[geom] = placed[geom][row, :3, 3]
                data.geom_xmat[geom] = placed[geom][row, :3, :3].ravel()
            hits[row] |= mujoco.mj_geomDistance(model, data, a, b, 1e-3, None) < -1e-6
    return hits


def curves(robot: Robot, count: int) -> Iterator[tuple[float, float]]:
    """Yield the processor time of splines of 1000 poses, and which share of each can be followed."""
    world, tip, seed = er.ArmWorld(robot), default_tip(robot) if "panda" not in robot.name else "panda_hand", 0
    while count:
        rng = np.random.default_rng([seed, 39])
        seed += 1
        middle = rng.uniform([0.3, -0.4, 0.2], [0.5, 0.4, 0.6])
        t = np.linspace(0.0, 2.0 * np.pi, 1000)
        wave = 0.08 * np.column_stack([np.sin(t), np.sin(2.0 * t + rng.uniform(0, 6)), np.cos(t)])
        turns = 0.2 * np.sin(t + rng.uniform(0, 6))
        poses = [er.Pose(middle + at, rpy=(np.pi + turn, turn, 0.0)) for at, turn in zip(wave, turns, strict=True)]
        starts = reach(world, er.PoseGoal(poses[0], tip), np.zeros(world.dim)).configurations
        if not len(starts):
            continue
        count -= 1
        began = time.process_time()
        done = follow(Follower(world, chain_of(robot, tip), spline(poses)), starts[0])
        yield 1e3 * (time.process_time() - began), 1.0 if not done.why else done.share


def main() -> None:
    """Plan all, print a row a robot."""
    parser = parser_of(__doc__)
    parser.add_argument("robots", nargs="+", help="ur5, or a URDF of a Panda")
    parser.add_argument("--count", type=int, default=100, help="tasks of each robot")
    parser.add_argument("--check", action="store_true", help="try all paths by coal and MuJoCo")
    options = parser.parse_args()
    for source in options.robots:
        robot, times, reasons, touched = robot_of(source), [], [], np.zeros(3, dtype=int)
        for seed in range(2_000, 2_000 + options.count):
            scene, task = problem(robot, seed)
            world = er.ArmWorld(robot, scene)
            began = time.process_time()
            # Processor time is measured: a busy machine may take its time.
            done = task.plan(world, list(HOMES["panda" if "panda" in robot.name else "ur5"]), seconds=60.0)
            times.append(1e3 * (time.process_time() - began))
            if not done.solved:
                reasons.append(done.message)
            elif options.check:
                for part in done.parts:
                    touched += touching(source, part)
        print(
            f"{Path(source).stem}: {options.count - len(reasons)} of {options.count} solved;"
            f" {np.median(times):.1f} ms in the median, {np.quantile(times, 0.95):.1f} at 95 %"
            + (f"; of {touched[2]} states {touched[0]} touch by coal, {touched[1]} by MuJoCo" if options.check else "")
        )
        for reason in reasons[:3]:
            print("   ", reason[:200])
        rows = np.array(list(curves(robot, 20)))
        print(f"    1000 poses: {np.median(rows[:, 0]):.1f} ms in the median; {np.mean(rows[:, 1] == 1.0):.0%} whole")


if __name__ == "__main__":
    main()
