"""Solids: two surfaces that never touch may still lie one inside of the other, which one state shows or excludes."""

from __future__ import annotations

import numpy as np

from evenroad_verify.certificate import Certificate
from evenroad_verify.claim import Claim
from evenroad_verify.errors import Ints, demand
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
    nodes, opened = claim.nodes, set[tuple[int, int]]()
    for number in sorted(set(range(len(claim.pairs))) - apart):
        pair = claim.pairs[number]
        for inner, outer in ((pair.first, pair.second), (pair.second, pair.first)):
            surfaces = [shape for shape, _ in nodes.parts[outer] if shape.surface]
            frame, other = nodes.frame[inner], nodes.frame[outer]
            turn = rotation[0, other].T @ rotation[0, frame]
            shift = rotation[0, other].T @ (origin[0, frame] - origin[0, other])
            away, reach = turn @ nodes.centre[inner] + shift - nodes.centre[outer], np.abs(nodes.box[outer]).sum(0)
            if not surfaces or (np.abs(away) > np.abs(turn @ nodes.box[inner].T).sum(1) + reach).any():
                continue
            # A point of each connected piece of a surface, of other shapes of each element.
            shapes = [shape for shape, _ in nodes.parts[inner]]
            starts = [each.pieces.first if each.surface else each.points[each.corners[:, 0]] for each in shapes]
            points = np.concatenate(starts) @ turn.T + shift
            near = (np.abs(points - nodes.centre[outer]) <= reach).all(axis=1)
            for shape in surfaces if near.any() else ():
                for piece, some in shape.pieces.holding(points):
                    triangles = shape.pieces.closed(piece)
                    opened |= {(id(shape), piece)} if triangles is None else set()
                    nested = triangles is not None and any_inside(some, triangles)
                    demand(not nested, f"{pair.names[0]} and {pair.names[1]} are one inside of the other")
    return len(opened)
