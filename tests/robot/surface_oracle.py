"""What touches points and triangles, worked out slowly in double precision; see ``oracle``."""

from dataclasses import replace

import numpy as np

from evenroad.geometry.shapes import PointCloud
from tests.robot.oracle import clearance, link_poses, segment_distance


def point_clearance(robot, scene, q):
    """By how much the nearest ball of a cloud stays apart from the capsules, (n,)."""
    poses, least = link_poses(robot, q), np.full(len(q), np.inf)
    for obstacle in scene.obstacles:
        if not isinstance(obstacle.body, PointCloud):
            continue
        points = obstacle.body.points @ np.reshape(obstacle.rotation, (3, 3)).T + obstacle.xyz
        for capsule in robot.capsules:
            if (capsule.link, obstacle.name) in scene.allowed:
                continue
            rotation, origin = poses[capsule.link]
            a, b = (origin + rotation @ np.array(end) for end in (capsule.a, capsule.b))
            half, reach = 0.5 * np.linalg.norm(b[0] - a[0]), capsule.radius + obstacle.body.radius
            for i in range(len(q)):
                away = np.linalg.norm(points - 0.5 * (a[i] + b[i]), axis=1)
                if away.min() - half - reach >= least[i]:
                    continue
                # Nearest to the segment is none of those that are farther from its middle than another by its length.
                apart, along = points[away <= away.min() + 2.0 * half + 1e-9] - a[i], b[i] - a[i]
                share = np.clip(apart @ along / max(along @ along, 1e-300), 0.0, 1.0)
                squared = ((apart - share[:, None] * along) ** 2).sum(axis=1).min()
                least[i] = min(least[i], np.sqrt(squared) - reach)
    return least


def all_clearance(robot, scene, q):
    """By how much the nearest bodies of any kind stay apart, (n,)."""
    clouds = [obstacle.name for obstacle in scene.obstacles if isinstance(obstacle.body, PointCloud)]
    solid = replace(
        scene, obstacles=tuple(o for o in scene.obstacles if o.name not in clouds), allowed=frozenset()
    )
    solid = replace(solid, allowed=frozenset(pair for pair in scene.allowed if pair[1] not in clouds))
    return np.minimum(point_clearance(robot, scene, q), clearance(robot, solid, q))


def point_triangle(p, a, b, c):
    """Distances of points (n, 3) from triangles, three (n, 3): by sides, and by the plane where they are above it."""
    apart = np.inf
    for s, e in ((a, b), (b, c), (c, a)):
        share = ((p - s) * (e - s)).sum(1) / np.maximum(((e - s) ** 2).sum(1), 1e-300)
        apart = np.minimum(apart, np.linalg.norm(p - s - np.clip(share, 0, 1)[:, None] * (e - s), axis=1))
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    above = size > 0.0
    for s, e in ((a, b), (b, c), (c, a)):
        above &= (np.cross(e - s, p - s) * normal).sum(1) >= 0.0
    plane = np.abs(((p - a) * normal).sum(1)) / np.where(size > 0.0, size, 1.0)
    return np.where(above, plane, apart)


def segment_triangle(p, q, a, b, c):
    """Distances of segments, two (n, 3), from triangles, three (n, 3)."""
    least = np.minimum(point_triangle(p, a, b, c), point_triangle(q, a, b, c))
    for s, e in ((a, b), (b, c), (c, a)):
        least = np.minimum(least, segment_distance(p, q, s, e))
    u, v, w = ((np.cross(e - p, s - p) * (q - p)).sum(1) for s, e in ((a, b), (b, c), (c, a)))
    normal = np.cross(b - a, c - a)
    sides = ((p - a) * normal).sum(1) * ((q - a) * normal).sum(1) < 0.0
    through = sides & (((u > 0) & (v > 0) & (w > 0)) | ((u < 0) & (v < 0) & (w < 0)))
    return np.where(through, 0.0, least)


def windings(p, corners):
    """How often triangles wind around a place, by solid angles (A. van Oosterom and J. Strackee, 1983)."""
    a, b, c = (corners - p).transpose(1, 0, 2)
    la, lb, lc = (np.linalg.norm(each, axis=1) for each in (a, b, c))
    volume = (a * np.cross(b, c)).sum(1)
    flat = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    return 2.0 * np.arctan2(volume, flat).sum() / (4.0 * np.pi)


def mesh_clearance(robot, scene, q, solid):
    """By how much the nearest bodies stay apart, (n,); `solid`: whether what a mesh winds around is a part of it."""
    boxes = replace(
        scene, obstacles=tuple(o for o in scene.obstacles if o.shape != "mesh"), allowed=frozenset()
    )
    least, poses = clearance(robot, boxes, q), link_poses(robot, q)
    for obstacle in (each for each in scene.obstacles if each.shape == "mesh"):
        mesh = obstacle.body.triangles
        corners = obstacle.body.pose.apply(mesh.vertices)[mesh.triangles]
        low, high = corners.min(axis=1), corners.max(axis=1)
        for capsule in robot.capsules:
            if (capsule.link, obstacle.name) in scene.allowed:
                continue
            rotation, origin = poses[capsule.link]
            a, b = (origin + rotation @ np.array(end) for end in (capsule.a, capsule.b))
            for i in range(len(q)):
                bottom, top = np.minimum(a[i], b[i]), np.maximum(a[i], b[i])
                gap = np.linalg.norm(np.maximum(np.maximum(low - top, bottom - high), 0.0), axis=1)
                near = corners[gap < max(least[i], 0.0) + capsule.radius]
                if len(near):
                    p, q_ = (np.broadcast_to(end, (len(near), 3)) for end in (a[i], b[i]))
                    apart = segment_triangle(p, q_, *near.transpose(1, 0, 2)).min() - capsule.radius
                    least[i] = min(least[i], apart)
                if solid and abs(windings(0.5 * (a[i] + b[i]), corners)) > 0.5:
                    least[i] = min(least[i], -1.0)
    return least
