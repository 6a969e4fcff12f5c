"""Certificates of pairs: two links never touch, whatever the joints between them do."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np

from evenroad_verify.certificate import Certificate, count_of, directions_of, head_of, read_file, tables_of, unpacked
from evenroad_verify.claim import Claim, Inputs, Pair, bodies_of, ranges_of, require_bounded, silent
from evenroad_verify.errors import Floats, Ints, demand
from evenroad_verify.frames import frames_of
from evenroad_verify.no_path import ranges_of_cells
from evenroad_verify.nodes import Nodes
from evenroad_verify.overlaps import between
from evenroad_verify.proof import FINEST, Motions, expand, require_apart, shares
from evenroad_verify.solids import require_outside

MAGIC = b"evenroad certificate of pairs 1\n"
MOST_JOINTS = 6
"""Between two links are at most so many joints that move by themselves: a cell has 2^6 corners then."""


def read_pairs(data: bytes) -> Certificate:
    """Return the certificate that some bytes are, whose `pairs` say what it is about; Refused for any others."""
    return read_file(data, MAGIC, _pairs)


def _pairs(said: dict[str, list[str]], body: memoryview) -> Certificate:
    once = ("answers", "directions")
    head = head_of(said, once, ("pair",))
    demand(not head["clearance"] and not head["padding"], "links keep no distance from each other")
    answers, directions = (count_of(said[key][0]) for key in once)
    (packed, table), head["carried"] = tables_of(said, body, [(answers + 2) // 3, 12 * directions])
    head["pairs"] = tuple(tuple(map(count_of, line.split(" "))) for line in said.get("pair", ()))
    demand(head["pairs"] and min(map(len, head["pairs"])) > 1, "it is about no pairs, or about a link alone")
    none = np.zeros((0, 3, len(head["joints"])))
    return Certificate(**head, curves=none, answers=unpacked(packed, answers), directions=directions_of(table))


def verify_pairs(data: bytes, inputs: Inputs) -> tuple[Certificate, Claim, float, int]:
    """Return what a certificate proves, with a curve to the ends of all ranges, as paths do; Refused if it does not."""
    with np.errstate(all="ignore"):
        return _verified(read_pairs(data), inputs)


def _verified(read: Certificate, inputs: Inputs) -> tuple[Certificate, Claim, float, int]:
    demand(read.inputs == inputs.digest, "robot or meshes are not the files that it was written for")
    frames, nodes = frames_of(inputs.robot, read), Nodes()
    bodies, ranges = bodies_of(inputs, frames, read), ranges_of(inputs, frames, read)
    low, high = np.where(np.isinf(ranges), (-np.pi, np.pi), ranges).T
    read = replace(read, curves=np.array([[low, low, high]]))
    require_bounded(inputs, frames, bodies, read)
    pairs, proved, least = list[Pair](), list[Ints](), np.inf
    left, directions, claim = read.answers, read.directions, Claim(frames, nodes, (), ())
    for first, second, *columns in read.pairs:
        demand(max(first, second) < len(bodies) and max(columns, default=0) < len(low), "an unknown body or column")
        one, two = bodies[first], bodies[second]
        demand(not (one.is_obstacle or two.is_obstacle), f"{one.name} and {two.name} are no two links")
        moving = np.unique(frames.column[between(frames, one.frame, two.frame)])
        demand(0 < len(moving) <= MOST_JOINTS, f"{one.name} and {two.name} have no joints between them, or too many")
        ranges_of_cells(frames, ranges, moving, read.joints)
        whole = nodes.whole(one.frame, one.shapes), nodes.whole(two.frame, two.shapes)
        pairs.append(Pair(*whole, 0.0, (one.name, two.name)))
        claim = replace(claim, pairs=tuple(pairs))
        tasks, answers, left = expand(nodes, np.array([[0, 0, 0, *whole, len(pairs) - 1]]), left)
        cells = Cells(claim, read, columns, moving)
        gap, directions = require_apart(claim, cells, tasks, answers, directions)
        least = min(least, gap)
        proved.append(tasks)
    demand(not len(left) and not len(directions), "there are answers or directions without a task")
    conditions = tuple(line for line in silent(inputs, bodies, read) if line.startswith("that "))
    opened = require_outside(claim, read, np.concatenate(proved))
    return read, replace(claim, silent=("pairs that are not listed", *conditions)), least, opened


class Cells(Motions):
    """How nodes move within cells of all values of the joints: along each diagonal, where some columns go backwards.

    A task is about the cell that halving a box along some `columns`, one after the other, comes to.
    """

    def __init__(self, claim: Claim, certificate: Certificate, columns: list[int], moving: Ints) -> None:
        super().__init__(claim, certificate)
        (self._low, _, self._high), self._columns, self._moving = certificate.curves[0], columns, moving

    def gaps(self, tasks: Ints, answers: Ints, given: Floats) -> Floats:
        """Return by how much the directions of tasks separate their nodes in all states of their cells [m]."""
        least = np.full(len(tasks), np.inf)
        for signs in itertools.product((1.0, -1.0), repeat=len(self._moving) - 1):
            self._signs = np.ones(len(self._low))
            self._signs[self._moving[1:]] = signs
            least = np.minimum(least, super().gaps(tasks, answers, given))
        return least

    def _middle_states(self, key: Ints) -> tuple[Floats, ...]:
        share, low, side = (
            shares(key),
            np.tile(self._low, (len(key), 1)),
            np.tile(self._high - self._low, (len(key), 1)),
        )
        level = FINEST - np.log2(share & -share).astype(np.int64)  # the last digit of a share that is not 0
        for i, column in enumerate(self._columns):
            side[i < level, column] *= 0.5
            low[:, column] += side[:, column] * ((i < level) & (share >> FINEST - i & 1))
        # Tasks are half as long as a cell of their level: of all rates only this product counts.
        rate = (self._signs * side * 2.0 ** level[:, None])[:, self._frames.column] * self._frames.factor
        return self._states(low + 0.5 * side, rate, np.zeros_like(rate))
