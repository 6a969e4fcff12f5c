"""What touches what, worked out slowly in double precision from the values that make a robot and a scene.

Nothing here is shared with the kernel but the places of the covering spheres: links are placed as URDF has it,
joint by joint, with Rodrigues' formula, and every capsule is tested against everything.
"""

import numpy as np

from evenroad.collision.placed_capsules import cover_capsule


def joint_values(robot, q):
    """Joint name -> values (n,), for configurations (n, dim)."""
    joints = {joint.name: joint for joint in robot.joints}

    def value(name):
        joint = joints[name]
        if joint.mimic is not None:
            return joint.mimic.multiplier * value(joint.mimic.joint) + joint.mimic.offset
        if name in robot.group:
            return q[:, robot.group.index(name)]
        nearest = min(max(0.0, joint.lower), joint.upper)
        return np.full(len(q), robot.held.get(name, nearest))

    return {name: value(name) for name in joints}


def link_poses(robot, q):
    """Link name -> rotations (n, 3, 3) and origins (n, 3) in the root's frame."""
    n = len(q)
    values = joint_values(robot, q)
    poses = {robot.links[0]: (np.broadcast_to(np.eye(3), (n, 3, 3)), np.zeros((n, 3)))}
    for joint in robot.joints:
        rotation, origin = poses[joint.parent]
        origin = origin + rotation @ np.array(joint.xyz)
        rotation = rotation @ np.array(joint.rotation).reshape(3, 3)
        axis, value = np.array(joint.axis), values[joint.name]
        if joint.kind == "prismatic":
            origin = origin + value[:, None] * (rotation @ axis)
        elif joint.kind != "fixed":
            x, y, z = axis
            cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            sine, cosine = np.sin(value)[:, None, None], np.cos(value)[:, None, None]
            rotation = rotation @ (np.eye(3) + sine * cross + (1.0 - cosine) * (cross @ cross))
        poses[joint.child] = rotation, origin
    return poses


def obstacle_distance(points, obstacle):
    """Distances of points (n, 3) from an obstacle, 0 inside."""
    local = (points - np.array(obstacle.xyz)) @ np.array(obstacle.rotation).reshape(3, 3)
    aside = np.hypot(local[:, 0], local[:, 1])
    match obstacle.shape:
        case "box":
            return np.linalg.norm(np.maximum(np.abs(local) - np.array(obstacle.size) / 2, 0.0), axis=1)
        case "sphere":
            return np.maximum(np.linalg.norm(local, axis=1) - obstacle.size[0], 0.0)
        case "capsule":
            above = np.maximum(np.abs(local[:, 2]) - obstacle.size[1] / 2, 0.0)
            return np.maximum(np.hypot(aside, above) - obstacle.size[0], 0.0)
        case "cylinder":
            above = np.maximum(np.abs(local[:, 2]) - obstacle.size[1] / 2, 0.0)
            return np.hypot(np.maximum(aside - obstacle.size[0], 0.0), above)
    raise AssertionError(obstacle.shape)


def point_segment_distance(point, a, b):
    """Distances of points (n, 3) from segments, two (n, 3)."""
    along = b - a
    squared = (along**2).sum(axis=1)
    share = ((point - a) * along).sum(axis=1) / np.where(squared > 0.0, squared, 1.0)
    return np.linalg.norm(point - a - np.clip(share, 0.0, 1.0)[:, None] * along, axis=1)


def segment_distance(a, b, c, d):
    """Distances between segments a-b and c-d, four (n, 3): at an end of either, or inside of both."""
    nearest = np.minimum.reduce(
        [
            point_segment_distance(a, c, d),
            point_segment_distance(b, c, d),
            point_segment_distance(c, a, b),
            point_segment_distance(d, a, b),
        ]
    )
    normal = np.cross(b - a, d - c)
    squared = (normal**2).sum(axis=1)
    sizes = ((b - a) ** 2).sum(axis=1) * ((d - c) ** 2).sum(axis=1)
    skew = squared > 1e-12 * sizes
    divisor = np.where(skew, squared, 1.0)
    s = (np.cross(c - a, d - c) * normal).sum(axis=1) / divisor
    t = (np.cross(c - a, b - a) * normal).sum(axis=1) / divisor
    inside = skew & (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0)
    between = np.linalg.norm(a + s[:, None] * (b - a) - c - t[:, None] * (d - c), axis=1)
    return np.where(inside, np.minimum(nearest, between), nearest)


def clearance(robot, scene, q, samples=None):
    """By how much the nearest bodies stay apart, (n,); negative where they touch.

    Against obstacles a capsule is the spheres that cover it or, where `samples` is given, that many spheres
    of its own radius, spread evenly along it.
    """
    poses = link_poses(robot, q)
    ends = {}
    for capsule in robot.capsules:
        rotation, origin = poses[capsule.link]
        ends[capsule] = origin + rotation @ np.array(capsule.a), origin + rotation @ np.array(capsule.b)
    least = np.full(len(q), np.inf)
    for capsule, (a, b) in ends.items():
        length = float(np.linalg.norm(np.array(capsule.b) - np.array(capsule.a)))
        cover = cover_capsule(length / 2, capsule.radius)
        places, radius = np.array(cover.positions), cover.radius
        if samples is not None:
            places, radius = np.linspace(-1.0, 1.0, samples), capsule.radius
        for obstacle in scene.obstacles:
            if (capsule.link, obstacle.name) in scene.allowed:
                continue
            # Where even a ball around the capsule is farther than something else, it changes nothing.
            middle = obstacle_distance(0.5 * (a + b), obstacle) - length / 2 - radius
            near = np.flatnonzero(middle < least)
            for place in places if near.size else ():
                point = 0.5 * (a[near] + b[near]) + 0.5 * place * (b[near] - a[near])
                least[near] = np.minimum(least[near], obstacle_distance(point, obstacle) - radius)
    for first, second in robot.pairs:
        for capsule, (a, b) in ends.items():
            if capsule.link == first:
                for other, (c, d) in ends.items():
                    if other.link == second:
                        radii = capsule.radius + other.radius
                        middle = np.linalg.norm(a + b - c - d, axis=1) - np.linalg.norm(b - a, axis=1)
                        near = np.flatnonzero(0.5 * (middle - np.linalg.norm(d - c, axis=1)) - radii < least)
                        if near.size:
                            apart = segment_distance(a[near], b[near], c[near], d[near]) - radii
                            least[near] = np.minimum(least[near], apart)
    return least


def motions_proved(robot, scene, a, way, deepest=26):
    """Whether bodies stay apart all along motions that begin at `a` and go `way`, two (n, dim); by halving.

    Within half an interval nothing moves by more than half of what the whole moves it at most: by as much a body may
    come nearer to an obstacle, and by twice as much two bodies may come nearer to each other.
    """
    values, ends = joint_values(robot, a), joint_values(robot, a + way)
    slides = {name: np.abs([values[name], ends[name]]).max() for name in values}
    moved = np.zeros(len(a))
    for joint in robot.joints:
        lever = 1.0 if joint.kind == "prismatic" else farthest_from(robot, joint.child, slides)
        moved += np.abs(ends[joint.name] - values[joint.name]) * lever
    motion, middle, half = np.arange(len(a)), np.full(len(a), 0.5), 0.5
    proved = np.ones(len(a), dtype=bool)
    for _ in range(deepest):
        apart = clearance(robot, scene, a[motion] + middle[:, None] * way[motion])
        proved[motion[apart <= 0.0]] = False
        left = proved[motion] & (apart <= 2.0 * half * moved[motion])
        half *= 0.5
        motion, middle = np.repeat(motion[left], 2), np.repeat(middle[left], 2)
        middle[::2] -= half
        middle[1::2] += half
    proved[motion] = False
    return proved


def farthest_from(robot, link, slides):
    """How far from a link's origin what it carries can be at most, joint for joint."""
    far = [np.linalg.norm(end) for capsule in robot.capsules if capsule.link == link for end in (capsule.a, capsule.b)]
    for joint in robot.joints:
        if joint.parent == link:
            slide = slides[joint.name] if joint.kind == "prismatic" else 0.0
            far.append(np.linalg.norm(joint.xyz) + slide + farthest_from(robot, joint.child, slides))
    return max(far, default=0.0)
