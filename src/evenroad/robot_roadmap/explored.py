"""A scene that is explored before queries come: ways to ends in its narrow places, and how far it is along them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from evenroad._arrays import Floats, Ints, Ints32
from evenroad._clock import now
from evenroad.robot import ArmWorld
from evenroad.robot.arm_world import RECHECK_TOLERANCE
from evenroad.robot.trees import tighten
from evenroad.robot_roadmap import search_memory as at
from evenroad.robot_roadmap.ask import ask
from evenroad.robot_roadmap.known_graph import KnownGraph
from evenroad.robot_roadmap.known_motions import KnownMotions
from evenroad.robot_roadmap.narrow_places import ends_between_obstacles
from evenroad.robot_roadmap.search_memory import BLOCKED, FOUND, FREE, PROVED, UNKNOWN
from evenroad.robot_roadmap.ways_out import learn_ways_out
from evenroad.space.path import path_length

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

LINKS, MOTIONS, GREED = 40, 90, 3.0
"""From each end a way to some milestone is searched with so many links and motions, as for a query."""

SOON = 12
"""An end that leads there by fewer motions need not be known: too many ends beside each other make ways longer."""

OUT = 5000
"""So many motions a way out may take."""

JOINED, IN_A_SEARCH = 300, 30
"""What was learned is joined to those of so many of the nearest that it reaches; to fewer where ways are searched, not
looked up, and each edge costs time."""

FEW = 10
"""What is joined to fewer lies in a narrow place: it is joined to all that it reaches, if there are not too many."""

MOST_PAIRS = 1_000_000
"""Milestones in narrow places are tried with all others, those with the fewest edges first, until so many pairs are
used up: a second or two.  In a roadmap of few neighbours nearly all would count as narrow."""

AT_ONCE = 64
"""Of so many it is found out at once which are nearest: tables of all would take gigabytes."""

_LONG = 1e8
"""Seconds that stand for no limit."""

TIGHT = 400
"""Ways are drawn tight with so many batches of checks before it is learned where they bend."""

BESIDE = 1500
"""For a way from one end to another, beside that of the roadmap, trees may take so many motions."""

THIN = 0.4
"""Bends are learned that are farther than this from all that is known, as a share of how far milestones are apart."""

MOST_TOLD = 3000
"""Of so many milestones at most it is worked out how far they are from each other: 54 MB; no more bends are learned
then.  Of more free ones none is joined to all: there are millions of pairs."""

OF_A_WAY = 60
"""A way out has fewer waypoints: with no room for it no more are learned, or there would be no table."""

CLOSE = 20
"""An end that none of its links joins is tried to be linked to so many milestones that are nearest in displacement."""


def explore(
    roadmap: KnownMotions,
    world: ArmWorld,
    day: ArmWorld,
    graph: KnownGraph,
    count: int,
    rng: np.random.Generator,
) -> list[Floats]:
    """Learn ways to so many ends in narrow places, and what joins them; return those that trees found, (p, dim) each.

    Of what the roadmap knows to be free of robot and cell, `day` is asked.
    """
    settle(graph, world, day)
    before, ways = int(graph.desk[at.NODES]), list[Floats]()
    hubs = np.flatnonzero(graph.nodes[: len(roadmap.milestones)] >= FREE)
    if not len(hubs):
        return ways
    ends = ends_between_obstacles(world, count, rng)
    for end in ends:
        if before <= MOST_TOLD < graph.desk[at.NODES] + OF_A_WAY:
            break
        goal = roadmap.milestones[rng.choice(hubs)][np.newaxis]
        asked = ask(
            world, day, graph, end, goal, links=LINKS, greed=GREED, most_motions=MOTIONS, deadline=math.inf
        )
        if asked.ended == FOUND:
            if asked.motions >= SOON:
                graph.learn(asked.path[:2])
        else:
            ways += learn_ways_out(world, graph, roadmap.weights, (end, goal[0]), OUT, now() + _LONG).ways
    _settle_and_join(graph, world, day, len(roadmap.milestones))
    graph.guide(*_distances(graph), roadmap.weights, CLOSE)
    if graph.desk[at.TOLD]:
        known = int(graph.desk[at.NODES])
        _learn_bends(graph, world, day, ends, roadmap.milestones[hubs], rng)
        _settle_and_join(graph, world, day, known)
        graph.guide(*_distances(graph), roadmap.weights, CLOSE)
    return ways


def _learn_bends(
    graph: KnownGraph, world: ArmWorld, day: ArmWorld, ends: Floats, hubs: Floats, rng: np.random.Generator
) -> None:
    """Learn where ways bend that were drawn tight, from each end to another one and to a milestone.

    Others will bend there, too.  Between two ends trees find ways that the roadmap does not have: bends are those of
    the shorter one.
    """
    thin = THIN * _spacing(hubs)
    for start in ends:
        for others in (ends, hubs):
            goal = others[rng.integers(len(others))][np.newaxis]
            asked = ask(
                world,
                day,
                graph,
                start,
                goal,
                links=LINKS,
                greed=GREED,
                most_motions=MOTIONS,
                deadline=math.inf,
            )
            ways = [asked.path] if asked.ended == FOUND else []
            if others is ends:
                grown = world.connect(start, goal, most_motions=BESIDE, seconds=_LONG)
                ways += [grown.path] if grown.goal >= 0 else []
            if not ways:
                continue
            tight = [tighten(world, way, batches=TIGHT)[0] for way in ways]
            best = min(tight, key=lambda way: path_length(way, world.space))
            for bend in best[1:-1]:
                known = graph.milestones[: int(graph.desk[at.NODES])]
                if len(known) >= MOST_TOLD:
                    return
                if np.linalg.norm(known - bend, axis=1).min() > thin:
                    graph.learn(bend[np.newaxis])


def _spacing(q: Floats) -> float:
    """Return how far the nearest one of some milestones is: the median, inf for a single one."""
    if len(q) < 2:
        return math.inf
    away = np.concatenate(
        [
            np.partition(np.linalg.norm(q - some[:, np.newaxis], axis=2), 1, axis=1)[:, 1]
            for some in np.array_split(q, -(-len(q) // AT_ONCE))
        ]
    )
    return float(np.median(away))


def _settle_and_join(graph: KnownGraph, world: ArmWorld, day: ArmWorld, first: int) -> None:
    """Settle what is open, and join the milestones from the first one on to near ones, and those in narrow places."""
    settle(graph, world, day)
    free = np.flatnonzero(graph.nodes[: int(graph.desk[at.NODES])] >= FREE)
    new = free[free >= first]
    if len(new):
        some = np.array_split(new, -(-len(new) // AT_ONCE))
        searched = graph.desk[at.LIFTING] or len(free) > MOST_TOLD
        most = IN_A_SEARCH if searched else JOINED
        near = np.concatenate([_nearest(graph.milestones, each, free, most) for each in some])
        _join(graph, world, np.repeat(new, near.shape[1]), near.ravel())
    if len(free) > MOST_TOLD:
        return
    a, b, _ = graph.motions()
    known = graph.edges[: len(a)] >= FREE
    joined = np.bincount(np.concatenate([a[known], b[known]]), minlength=len(graph.nodes))
    narrow = free[joined[free] < FEW]
    narrow = narrow[np.argsort(joined[narrow], kind="stable")][: MOST_PAIRS // max(len(free), 1)]
    _join(graph, world, np.repeat(narrow, len(free)), np.tile(free, len(narrow)))


def settle(graph: KnownGraph, world: ArmWorld, day: ArmWorld) -> None:
    """Ask about all milestones that nobody has asked about, and edges that are not proved, but for those that turn."""
    n, nodes = int(graph.desk[at.NODES]), graph.nodes
    q = graph.milestones[:n]
    unknown = np.flatnonzero(nodes[:n] == UNKNOWN)
    # What is out of limits may be within them after a turn.
    nodes[unknown] = np.where(world.valid(q[unknown]), FREE, UNKNOWN if graph.desk[at.LIFTING] else BLOCKED)
    a, b, turns = graph.motions()
    verdicts = graph.edges[: len(a)]
    open_ = ~np.isin(verdicts, (BLOCKED, PROVED)) & ~turns & (nodes[a] >= FREE) & (nodes[b] >= FREE)
    old = np.arange(len(a)) < graph.desk[at.BASE]
    for asked, rows in ((day, np.flatnonzero(open_ & old)), (world, np.flatnonzero(open_ & ~old))):
        free = asked.motion_certified(q[a[rows]], q[b[rows]], RECHECK_TOLERANCE)
        verdicts[rows] = np.where(free, PROVED, BLOCKED)
    # Imported late, as below: plans do without.
    from scipy.sparse.csgraph import connected_components

    groups = connected_components(_known(graph, np.ones(len(a))), directed=False)[1]
    graph.groups[:n] = np.unique(groups, return_index=True)[1][groups]


def _join(graph: KnownGraph, world: ArmWorld, a: Ints, b: Ints) -> None:
    """Join pairs of free milestones, where there is no edge yet and the motion is free."""
    # Each pair is one number.
    n, q, (known, others, _) = len(graph.nodes), graph.milestones, graph.motions()
    pairs = np.unique(np.minimum(a, b)[a != b] * n + np.maximum(a, b)[a != b])
    pairs = pairs[~np.isin(pairs, np.minimum(known, others) * n + np.maximum(known, others))]
    pairs = np.stack(np.divmod(pairs, n), axis=1)
    pairs = pairs[world.motion_certified(q[pairs[:, 0]], q[pairs[:, 1]], RECHECK_TOLERANCE)]
    graph.join(pairs, world.space.distance(q[pairs[:, 0]], q[pairs[:, 1]]))


def _nearest(q: Floats, some: Ints, free: Ints, most: int) -> Ints:
    """Return the numbers of so many free milestones that are nearest to some of them, without the first: itself."""
    apart = np.linalg.norm(q[some][:, np.newaxis] - q[free], axis=2)
    return free[np.argsort(apart, axis=1, kind="stable")[:, 1 : most + 1]]


def _known(graph: KnownGraph, lengths: Floats) -> csr_matrix:
    """Return the lengths of the edges that are known to be free, (n, n); of two the shorter one."""
    from scipy.sparse import csr_matrix

    n, (a, b, _) = int(graph.desk[at.NODES]), graph.motions()
    rows = np.flatnonzero(graph.edges[: len(a)] >= FREE)
    rows = rows[np.lexsort((lengths[rows], a[rows] * n + b[rows]))]
    rows = rows[np.unique(a[rows] * n + b[rows], return_index=True)[1]]
    return csr_matrix((lengths[rows], (a[rows], b[rows])), shape=(n, n))


def _distances(graph: KnownGraph) -> tuple[Floats, Ints32]:
    """Return how far milestones are from each other, (n, n), and the next one on the way, as `guide` takes them.

    Of joints of several turns nothing is said: how far it is depends on the turns.
    """
    from scipy.sparse.csgraph import dijkstra

    if graph.desk[at.LIFTING] or graph.desk[at.NODES] > MOST_TOLD:
        return np.empty((0, 0)), np.empty((0, 0), dtype=np.int32)
    a, _, _ = graph.motions()
    lengths = np.empty(len(a))
    made = int(graph.desk[at.HALVES_MADE])
    lengths[graph.halves[:made, at.NUMBER]] = np.maximum(graph.lengths[:made], 1e-9)
    far, steps = dijkstra(_known(graph, lengths), directed=False, return_predecessors=True)
    return far, steps
