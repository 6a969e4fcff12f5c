"""What touches points and triangles, worked out slowly in double precision; see ``oracle``."""

import numpy as np
from scipy.spatial import cKDTree

from tests.robots.oracle import clearance, link_poses, point_segment_distance, segment_distance


def all_clearance(robot, scene, q, solid=True):
    """By how much the nearest bodies of any kind stay apart, (n,); negative where they touch.

    `solid`: whether what a mesh winds around is a part of it.
    """
    surfaces = [obstacle for obstacle in scene.obstacles if obstacle.shape in ("cloud", "mesh")]
    plain = scene.without(*(obstacle.name for obstacle in surfaces))
    least, poses = clearance(robot, plain, q), link_poses(robot, q)
    for obstacle in surfaces:
        tree = cKDTree(obstacle.body.pose.apply(obstacle.body.points)) if obstacle.shape == "cloud" else None
        for capsule in robot.capsules:
            if (capsule.link, obstacle.name) in scene.allowed:
                continue
            rotation, origin = poses[capsule.link]
            ends = [origin + rotation @ np.array(end) for end in (capsule.a, capsule.b)]
            if tree is not None:
                _nearer_to_points(least, *ends, capsule.radius + obstacle.body.radius, tree)
            else:
                _nearer_to_triangles(least, *ends, capsule.radius, obstacle.body, solid)
    return least


def _nearer_to_points(least, a, b, reach, tree):
    """Lower `least` to how far segments, two (n, 3), are from any point beyond `reach`."""
    middle, length = 0.5 * (a + b), np.linalg.norm(b - a, axis=1).max()
    nearest = tree.query(middle)[0]
    some = np.flatnonzero(nearest - 0.5 * length - reach < least)
    # Nearest to the segment is none of those that are farther from its middle than another by its length.
    near = tree.query_ball_point(middle[some], nearest[some] + length + 1e-9)
    rows = np.repeat(some, [len(each) for each in near])
    points = tree.data[np.concatenate([*near, []]).astype(int)]
    np.minimum.at(least, rows, point_segment_distance(points, a[rows], b[rows]) - reach)


def _nearer_to_triangles(least, a, b, radius, body, solid):
    """Lower `least` to how far capsules around segments, two (n, 3), are from the triangles of a mesh."""
    corners = body.pose.apply(body.triangles.vertices)[body.triangles.triangles]
    low, high, middle = corners.min(axis=1), corners.max(axis=1), 0.5 * (a + b)
    bottom, top = np.minimum(a, b)[:, np.newaxis], np.maximum(a, b)[:, np.newaxis]
    gap = np.linalg.norm(np.maximum(np.maximum(low - top, bottom - high), 0.0), axis=2)
    at_corner = np.linalg.norm(corners[:, 0] - middle[:, np.newaxis], axis=2).min(axis=1)
    least[:] = np.minimum(least, at_corner - radius)
    rows, near = np.nonzero(gap < np.maximum(least, 0.0)[:, np.newaxis] + radius)
    apart = segment_triangle(a[rows], b[rows], *corners[near].transpose(1, 0, 2)) - radius
    np.minimum.at(least, rows, apart)
    if solid:
        within = np.flatnonzero(((middle >= low.min(axis=0)) & (middle <= high.max(axis=0))).all(axis=1))
        inside = within[np.abs(windings(middle[within], corners)) > 0.5]
        least[inside] = np.minimum(least[inside], -1.0)


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
    """How often triangles wind around places (n, 3), by solid angles (A. van Oosterom and J. Strackee, 1983)."""
    a, b, c = (corners - p[:, np.newaxis, np.newaxis]).transpose(2, 0, 1, 3)
    la, lb, lc = (np.linalg.norm(each, axis=-1) for each in (a, b, c))
    volume = (a * np.cross(b, c)).sum(axis=-1)
    flat = la * lb * lc + (a * b).sum(axis=-1) * lc + (b * c).sum(axis=-1) * la + (c * a).sum(axis=-1) * lb
    return 2.0 * np.arctan2(volume, flat).sum(axis=-1) / (4.0 * np.pi)
