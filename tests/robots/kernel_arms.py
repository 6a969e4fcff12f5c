"""Robots and scenes to test with: a UR5 written down by hand, a 7-joint arm, random trees."""

import math
from dataclasses import replace

import numpy as np

from evenroad.geometry.shapes import Capsule
from evenroad.robots.joint import Joint, Mimic
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Obstacle, Scene

STRAIGHT = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
PITCHED = (0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0)
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)

LINKS = ("base", "shoulder", "upperarm", "forearm", "wrist1", "wrist2", "wrist3")
CAPSULES = (
    (0, (-0.0183, -0.0145), (-0.0183, 0.0285), 0.0919),
    (1, (-0.0004, -0.0201), (-0.0004, 0.0185), 0.0741),
    (1, (-0.0003, -0.0001), (0.0319, -0.0001), 0.0722),
    (2, (-0.0207, -0.0005), (0.0218, -0.0005), 0.0739),
    (2, (-0.0008, -0.0003), (-0.0008, 0.4265), 0.0595),
    (2, (-0.0216, 0.4231), (0.0179, 0.4231), 0.0745),
    (3, (-0.0153, 0.0007), (0.0226, 0.0007), 0.0672),
    (3, (0.0007, -0.0005), (0.0007, 0.3666), 0.0403),
    (3, (-0.0292, 0.3924), (0.0225, 0.3924), 0.0456),
    (4, (0.0798, -0.0001), (0.0799, -0.0001), 0.0506),
    (4, (0.0925, -0.0210), (0.0925, 0.0116), 0.0524),
    (5, (0.0023, 0.0603), (0.0023, 0.1113), 0.0408),
    (5, (-0.0189, 0.0946), (0.0143, 0.0946), 0.0510),
    (6, (0.0630, 0.0013), (0.0630, 0.0013), 0.0420),
)
PAIRS = ("03", "04", "05", "06", "13", "14", "15", "16", "24", "25", "26", "35", "36")


def ur5(limits=math.tau, joints=6):
    """The UR5 with `joints` planned joints, the others held at 0; all of them from -limits to limits."""
    pi = math.pi
    rows = (
        ("shoulder_pan_joint", (0.0, 0.0, 0.089159), STRAIGHT, Z, (-limits, limits), 3.15),
        ("shoulder_lift_joint", (0.0, 0.13585, 0.0), PITCHED, Y, (-limits, limits), 3.15),
        ("elbow_joint", (0.0, -0.1197, 0.425), STRAIGHT, Y, (-pi, pi), 3.15),
        ("wrist_1_joint", (0.0, 0.0, 0.39225), PITCHED, Y, (-limits, limits), 3.2),
        ("wrist_2_joint", (0.0, 0.093, 0.0), STRAIGHT, Z, (-limits, limits), 3.2),
        ("wrist_3_joint", (0.0, 0.0, 0.09465), STRAIGHT, Y, (-limits, limits), 3.2),
    )
    chain = tuple(
        Joint(name, "revolute", LINKS[i], LINKS[i + 1], xyz, rotation, axis, *ends, speed)
        for i, (name, xyz, rotation, axis, ends, speed) in enumerate(rows)
    )
    capsules = tuple(Capsule((0.0, *a), (0.0, *b), radius, link=LINKS[i]) for i, a, b, radius in CAPSULES)
    pairs = tuple((LINKS[int(a)], LINKS[int(b)]) for a, b in PAIRS)
    return Robot("ur5", LINKS, chain, capsules, pairs, tuple(row[0] for row in rows[:joints]))


def box_scene(inner=0.36):
    """A table, and on it a box with its open face towards the robot: the scenes "c" (0.36) and "a" (0.30)."""
    wall, depth, x, z = 0.01, 0.40, 0.70, 0.191
    half = inner / 2 + wall / 2
    obstacles = (
        Obstacle.of("table", "box", (1.0, 1.2, 0.05), (0.25, 0.0, -0.025), cell=True),
        Obstacle.of("left", "box", (depth, wall, inner + 2 * wall), (x, half, z)),
        Obstacle.of("right", "box", (depth, wall, inner + 2 * wall), (x, -half, z)),
        Obstacle.of("floor", "box", (depth, inner, wall), (x, 0.0, z - half)),
        Obstacle.of("roof", "box", (depth, inner, wall), (x, 0.0, z + half)),
        Obstacle.of("back", "box", (wall, inner + 2 * wall, inner + 2 * wall), (x + depth / 2 + wall / 2, 0.0, z)),
    )
    allowed = frozenset({("base", "table"), ("shoulder", "table")})
    return Scene(obstacles, name="box", allowed=allowed)


TABLE = Scene(
    (Obstacle.of("table", "box", (1.0, 1.2, 0.05), (0.25, 0.0, -0.025), cell=True),),
    name="cell",
    allowed=frozenset({("base", "table"), ("shoulder", "table")}),
)
"""The cell of a UR5 on its table."""


def random_rotation(rng):
    """A rotation (9 floats), uniform."""
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    return (
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
    )  # fmt: skip


def seven_joint_arm():
    """An arm of seven joints in the proportions of common ones: 1.2 m of reach, joints turn about z and y."""
    lengths = (0.34, 0.0, 0.40, 0.0, 0.40, 0.0, 0.126)
    links = ("base", *(f"link{i}" for i in range(1, 8)))
    joints = tuple(
        Joint(
            f"joint{i + 1}", "revolute", links[i], links[i + 1],
            (0.0, 0.0, lengths[i]), STRAIGHT, Y if i % 2 else Z, -2.9, 2.9, 1.7,
        )
        for i in range(7)
    )  # fmt: skip
    above = (*lengths[1:], 0.08)
    capsules = [Capsule((0.0, 0.0, 0.06), (0.0, 0.0, 0.16), 0.09, link="base")]
    for i, link in enumerate(links[1:]):
        radius = 0.085 - 0.006 * i
        capsules.append(Capsule((0.0, 0.0, 0.0), (0.0, 0.0, 0.55 * above[i]), radius, link=link))
        if above[i] > 0.1:
            capsules.append(Capsule((0.0, 0.0, 0.55 * above[i]), (0.0, 0.0, 0.8 * above[i]), 0.9 * radius, link=link))
    pairs = tuple((links[a], links[b]) for a in range(8) for b in range(a + 3, 8))
    return Robot("seven", links, joints, tuple(capsules), pairs, tuple(joint.name for joint in joints))


def as_balls(robot, of_each=3):
    """The robot with balls in place of its capsules: a link then has many, which the kernel looks at together."""
    balls = []
    for capsule in robot.capsules:
        a, b = np.array(capsule.a), np.array(capsule.b)
        places = [tuple((a + (i + 0.5) / of_each * (b - a)).tolist()) for i in range(of_each)]
        balls += [Capsule(place, place, capsule.radius, link=capsule.link) for place in places]
    return replace(robot, capsules=tuple(balls))


def random_tree(seed):
    """A robot as files may bring: a branching tree of every kind of joint, some of them held or mimics."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(6, 12))
    links, joints = ["root"], []
    kinds = ["revolute", "revolute", "continuous", "prismatic", "fixed"]
    for i in range(count):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        kind = "revolute" if i == 0 else str(rng.choice(kinds))
        parent = links[max(0, len(links) - 1 - int(rng.integers(0, 3)))]
        lower, upper = {
            "revolute": (-rng.uniform(0.5, 3.0), rng.uniform(0.5, 3.0)),
            "continuous": (-math.inf, math.inf),
            "prismatic": (-rng.uniform(0.0, 0.1), rng.uniform(0.1, 0.3)),
            "fixed": (0.0, 0.0),
        }[kind]
        mimic = None
        movable = [j.name for j in joints if j.kind in ("revolute", "prismatic") and j.mimic is None]
        if kind in ("revolute", "prismatic") and movable and rng.random() < 0.2:
            mimic = Mimic(str(rng.choice(movable)), rng.uniform(-1.5, 1.5), rng.uniform(-0.2, 0.2))
        links.append(f"link{i}")
        joints.append(
            Joint(
                f"joint{i}", kind, parent, links[-1], tuple(rng.uniform(-0.15, 0.15, 3)),
                random_rotation(rng), tuple(axis), lower, upper, 1.0, mimic,
            )
        )  # fmt: skip
    capsules = []
    for link in links:
        for _ in range(int(rng.integers(0, 3)) or int(link == links[-1])):
            a = rng.uniform(-0.05, 0.05, 3)
            b = a if rng.random() < 0.25 else a + rng.uniform(-0.15, 0.15, 3)
            capsules.append(Capsule(tuple(a), tuple(b), rng.uniform(0.015, 0.04), link=link))
    # Far enough apart along the tree that a movable joint is in between: others would always or never touch.
    apart = [(a, b) for a in range(count + 1) for b in range(a + 1, count + 1) if b - a >= 3]
    carried = {joint.child: joint for joint in joints}
    pairs = tuple(
        (links[a], links[b])
        for a, b in apart
        if rng.random() < 0.3 and carried[links[b]].kind in ("revolute", "continuous")
    )
    free = [j.name for j in joints if j.kind != "fixed" and j.mimic is None]
    group = tuple(free[:1] + [name for name in free[1:] if rng.random() < 0.85])
    return Robot(f"tree{seed}", tuple(links), tuple(joints), tuple(capsules), pairs, group, {})


def random_scene(seed, count=12, spread=0.8, sizes=(0.05, 0.2), clear=0.3):
    """Obstacles of every shape, turned or not, at random places `clear` from the origin."""
    rng = np.random.default_rng(seed)
    obstacles = []
    while len(obstacles) < count:
        shape = str(rng.choice(["box", "sphere", "cylinder", "capsule"]))
        size = tuple(rng.uniform(*sizes, {"box": 3, "sphere": 1}.get(shape, 2)))
        rotation = STRAIGHT if rng.random() < 0.4 else random_rotation(rng)
        place = rng.uniform(-spread, spread, 3)
        if np.linalg.norm(place) > clear:
            obstacles.append(Obstacle.of(f"obstacle{len(obstacles)}", shape, size, tuple(place), rotation))
    return Scene(tuple(obstacles), name=f"random{seed}")


def edge(world, q, most=2_000, least=40):
    """Return configurations that a world calls free and others, each next to one, that it calls blocked: by bisection.

    Random configurations are never so near to contact that a rounding decides; these all are.
    """
    valid = world.valid(q)
    count = min(valid.sum(), (~valid).sum(), most)
    assert count > least
    free, blocked = q[valid][:count], q[~valid][:count]
    for _ in range(60):
        middle = 0.5 * (free + blocked)
        valid = world.valid(middle)[:, np.newaxis]
        free, blocked = np.where(valid, middle, free), np.where(valid, blocked, middle)
    return free, blocked


def proof_edge(world, a, b, tolerance=1e-6, steps=30):
    """Ends of the longest beginnings of motions that are proved, from `a` towards `b`, by bisection.

    They end as near to contact as proofs go: where those are wrong by little, it shows there.
    """
    low, high = np.zeros(len(a)), np.ones(len(a))
    low[world.motion_certified(a, b, tolerance)] = 1.0
    for _ in range(steps):
        middle = 0.5 * (low + high)
        proved = world.motion_certified(a, world.space.interpolate(a, b, middle), tolerance)
        low, high = np.where(proved, middle, low), np.where(proved, high, middle)
    return world.space.interpolate(a, b, low)


def states_along(world, a, b, rng, count=12):
    """States of motions at random, half of them near their ends, which come first and last: (motions * count, dim)."""
    shares = rng.random((len(a), count))
    shares[:, 1::2] = 1.0 - shares[:, 1::2] ** 6
    shares[:, 0], shares[:, -1] = 0.0, 1.0
    ends = (np.repeat(each, count, axis=0) for each in (a, b))
    return world.space.interpolate(*ends, shares.ravel())


def through_contact(world, apart, rng, edges=150, count=500):
    """Motions with free ends through places that touch by less than 5 mm, two (n, dim): none may be proved.

    `apart` says by how much configurations are clear of contact.  Half of the motions are of one joint alone.
    """
    space = world.space
    x = np.repeat(edge(world, space.from_cube(rng.random((4000, space.dim))), edges)[0], 3, axis=0)
    x += rng.normal(size=x.shape) * 10.0 ** rng.uniform(-6.0, -2.0, (len(x), 1))
    x = x[space.contains(x)]
    depth = -apart(x)
    x = x[(depth > 1e-7) & (depth < 5e-3)]
    x = x[rng.integers(len(x), size=20 * count)]
    way, alone = rng.normal(size=x.shape), rng.integers(2 * space.dim, size=(len(x), 1))
    way[(alone < space.dim) & (np.arange(space.dim) != alone)] = 0.0
    way *= 10.0 ** rng.uniform(-2.0, 0.3, (len(x), 1)) / np.linalg.norm(way, axis=1, keepdims=True)
    share = rng.random((len(x), 1))
    a, b = x - share * way, x + (1.0 - share) * way
    free = space.contains(a) & space.contains(b)
    free[free] = world.valid(a[free]) & world.valid(b[free])
    return a[free][:count], b[free][:count]


def walk(world, rng, start, steps):
    """Ends of motions that are proved free, one after the other, and places between them."""
    here, seen = start, [start]
    for _ in range(steps):
        there = world.space.from_cube(rng.random((8, world.space.dim)))
        far = rng.uniform(0.05, 1.0, (8, 1))
        there = world.space.interpolate(np.broadcast_to(here, there.shape), there, far[:, 0])
        free = world.motion_certified(np.broadcast_to(here, there.shape), there, 1e-6)
        if free.any():
            end = there[free][0]
            shares = np.linspace(0.0, 1.0, 8)
            seen += list(world.space.interpolate(*np.broadcast_arrays(here, np.tile(end, (8, 1))), shares))
            here = end
    return np.array(seen)
