"""Solids: two surfaces that never touch may still lie one inside of the other, which one state shows or excludes."""

from __future__ import annotations

import numpy as np

from evenroad_verify.certificate import Certificate
from evenroad_verify.claim import Claim
from evenroad_verify.errors import Bools, Floats, Ints, Pose, demand
from evenroad_verify.nodes import Nodes
from evenroad_verify.proof import FIRST, PAIR, SECOND
from evenroad_verify.shapes import Shape

_WAYS = np.array(
    [[0.5377, 0.7211, 0.4369], [-0.3313, 0.6007, 0.7276], [0.7603, -0.3571, 0.5427], [0.2287, 0.3359, -0.9137]]
)
"""Directions of rays: the next one is tried where a ray comes too near to an edge."""
_NEAR = 1e-9
_MOST = 1_000_000


def require_outside(claim: Claim, certificate: Certificate, tasks: Ints) -> int:
    """Raise Refused where a part of a body is inside of a closed surface; return the number of open surfaces met.

    Nothing moves into a closed surface, or out of it, without touching it.  So the first state decides for all.  A pair
    that is apart as wholes at any time is not nested then.
    """
    whole = np.array([(pair.first, pair.second) for pair in claim.pairs], np.int64).reshape(-1, 2)
    apart = set(tasks[(tasks[:, FIRST : SECOND + 1] == whole[tasks[:, PAIR]]).all(axis=1), PAIR].tolist())
    rotation, origin, _ = claim.frames.at(certificate.curves[:1, 0])
    pieces, opened = dict[int, list[tuple[Floats, bool]]](), set()
    for number in sorted(set(range(len(claim.pairs))) - apart):
        both, names = (claim.pairs[number].first, claim.pairs[number].second), claim.pairs[number].names
        if _boxes_apart(claim.nodes, both, rotation[0], origin[0]):
            continue
        for inner, outer in (both, both[::-1]):
            surfaces = [shape for shape, _ in claim.nodes.parts[outer] if shape.surface]
            if not surfaces:
                continue
            turn, shift = _seen_from(claim.nodes, inner, outer, rotation[0], origin[0])
            points = np.concatenate([_points(shape, pieces) for shape, _ in claim.nodes.parts[inner]])
            points = points @ turn.T + shift
            near = np.abs(points - claim.nodes.centre[outer]) <= np.abs(claim.nodes.box[outer]).sum(0)
            points = points[near.all(axis=1)]
            solids = [solid for shape in surfaces for solid in pieces_of(shape, pieces)] if len(points) else []
            opened |= {id(triangles) for triangles, closed in solids if not closed}
            inside = any(_inside(points, triangles) for triangles, closed in solids if closed)
            demand(not inside, f"{names[0]} and {names[1]} are one inside of the other")
    return len(opened)


def _seen_from(nodes: Nodes, inner: int, outer: int, rotation: Floats, origin: Floats) -> Pose:
    """Return the pose of a node's frame in that of another one."""
    frame, other = nodes.frame[inner], nodes.frame[outer]
    return rotation[other].T @ rotation[frame], rotation[other].T @ (origin[frame] - origin[other])


def _boxes_apart(nodes: Nodes, both: tuple[int, int], rotation: Floats, origin: Floats) -> bool:
    """Return whether the boxes of two nodes are apart along an axis of a frame: then nothing is nested."""
    for inner, outer in (both, both[::-1]):
        turn, shift = _seen_from(nodes, inner, outer, rotation, origin)
        far = np.abs(turn @ nodes.centre[inner] + shift - nodes.centre[outer])
        if (far > np.abs(turn @ nodes.box[inner].T).sum(1) + np.abs(nodes.box[outer]).sum(0)).any():
            return True
    return False


def _points(shape: Shape, pieces: dict[int, list[tuple[Floats, bool]]]) -> Floats:
    """Return a point of each connected piece of a surface, of other shapes of each element, (n, 3)."""
    if not shape.surface:
        return np.asarray(shape.points[shape.corners[:, 0]])
    return np.array([piece[0, 0] for piece, _ in pieces_of(shape, pieces)])


def pieces_of(shape: Shape, known: dict[int, list[tuple[Floats, bool]]]) -> list[tuple[Floats, bool]]:
    """Return the connected pieces of a surface, each with whether it is closed: every edge is in an even number."""
    if not shape.surface:
        return []
    if id(shape) not in known:
        corner = shape.corners
        label = np.arange(len(shape.points))
        while True:
            least = label[corner].min(axis=1)
            new = label.copy()
            np.minimum.at(new, corner.ravel(), np.repeat(least, 3))
            new = new[new]
            if (new == label).all():
                break
            label = new
        edge, count = _edges(corner, len(label))
        if (count > 2).any():  # two triangles of the same corners would hide what is inside
            corner = corner[np.sort(np.unique(np.sort(corner, axis=1), axis=0, return_index=True)[1])]
            edge, count = _edges(corner, len(label))
        open_ones = set(label[edge[count % 2 == 1] // len(label)].tolist())
        of = label[corner[:, 0]]
        order = np.argsort(of, kind="stable")
        pieces = np.split(order, np.flatnonzero(np.diff(of[order])) + 1)
        known[id(shape)] = [(shape.points[corner[some]], int(of[some[0]]) not in open_ones) for some in pieces]
    return known[id(shape)]


def _edges(corner: Ints, points: int) -> tuple[Ints, Ints]:
    """Return the edges of triangles, as one number each, and how many triangles have each."""
    edges = np.sort(corner[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges = edges[edges[:, 0] != edges[:, 1]]
    edge, count = np.unique(edges[:, 0] * points + edges[:, 1], return_counts=True)
    return edge, count


def _inside(points: Floats, triangles: Floats) -> bool:
    """Return whether any of some points is inside of a closed surface, by the parity of the crossings of a ray."""
    corners = np.ascontiguousarray(triangles.reshape(-1, 3).T)
    low, high = corners.min(1), corners.max(1)
    points = points[((points >= low) & (points <= high)).all(axis=1)]
    step = max(1, _MOST // len(triangles))
    return any(are_inside(points[i : i + step], triangles).any() for i in range(0, len(points), step))


def are_inside(points: Floats, triangles: Floats) -> Bools:
    """Return which rays from points, (n, 3), cross the triangles an odd number of times."""
    odd, left = np.zeros(len(points), bool), np.arange(len(points))
    for way in _WAYS / np.linalg.norm(_WAYS, axis=1, keepdims=True):
        corners = triangles[None] - points[left, None, None]
        # Six times the volumes of the ray's unit and two corners: all of one sign where the ray meets the triangle.
        volume = np.stack([np.cross(corners[:, :, i], corners[:, :, (i + 1) % 3]) @ way for i in range(3)], axis=2)
        scale = np.linalg.norm(corners, axis=3).max(axis=2) ** 2
        unclear = (np.abs(volume) <= _NEAR * scale[..., None]).any(axis=2)
        meets = (volume > 0).all(axis=2) | (volume < 0).all(axis=2)
        normal = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
        before = (normal * corners[:, :, 0]).sum(axis=2) * (normal @ way) > 0
        # A ray that clearly passes a triangle by is clear, however near it comes to the lines of other edges.
        passes = (volume > _NEAR * scale[..., None]).any(axis=2) & (volume < -_NEAR * scale[..., None]).any(axis=2)
        clear = ~(unclear & ~passes).any(axis=1)
        odd[left[clear]] = (meets & before).sum(axis=1)[clear] % 2 == 1
        left = left[~clear]
        if not len(left):
            return odd
    demand(False, "no ray shows whether a body is inside of another one")
    raise AssertionError
