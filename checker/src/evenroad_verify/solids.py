"""Solids: two surfaces that never touch may still lie one inside of the other, which one state shows or excludes."""

from __future__ import annotations

import numpy as np

from evenroad_verify.certificate import Certificate
from evenroad_verify.claim import Claim
from evenroad_verify.errors import Floats, Ints, Pose, demand
from evenroad_verify.nodes import Nodes
from evenroad_verify.pieces import any_inside
from evenroad_verify.proof import FIRST, PAIR, SECOND


def require_outside(claim: Claim, certificate: Certificate, tasks: Ints) -> int:
    """Raise Refused where a part of a body is inside of a closed surface; return the number of open surfaces met.

    Nothing moves into a closed surface, or out of it, without touching it.  So the first state decides for all.  A pair
    that is apart as wholes at any time is not nested then.
    """
    whole = np.array([(pair.first, pair.second) for pair in claim.pairs], np.int64).reshape(-1, 2)
    apart = set(tasks[(tasks[:, FIRST : SECOND + 1] == whole[tasks[:, PAIR]]).all(axis=1), PAIR].tolist())
    rotation, origin, _ = claim.frames.at(certificate.curves[:1, 0])
    opened = set[tuple[int, int]]()
    for number in sorted(set(range(len(claim.pairs))) - apart):
        both, names = (claim.pairs[number].first, claim.pairs[number].second), claim.pairs[number].names
        if _boxes_apart(claim.nodes, both, rotation[0], origin[0]):
            continue
        for inner, outer in (both, both[::-1]):
            surfaces = [shape for shape, _ in claim.nodes.parts[outer] if shape.surface]
            if not surfaces:
                continue
            turn, shift = _seen_from(claim.nodes, inner, outer, rotation[0], origin[0])
            # A point of each connected piece of a surface, of other shapes of each element.
            shapes = [shape for shape, _ in claim.nodes.parts[inner]]
            starts = [each.pieces.first if each.surface else each.points[each.corners[:, 0]] for each in shapes]
            points = np.concatenate(starts) @ turn.T + shift
            near = np.abs(points - claim.nodes.centre[outer]) <= np.abs(claim.nodes.box[outer]).sum(0)
            points = points[near.all(axis=1)]
            for shape in surfaces if len(points) else ():
                for piece, some in shape.pieces.holding(points):
                    triangles = shape.pieces.closed(piece)
                    opened |= {(id(shape), piece)} if triangles is None else set()
                    nested = triangles is not None and any_inside(some, triangles)
                    demand(not nested, f"{names[0]} and {names[1]} are one inside of the other")
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
