"""The native search of a roadmap against Dijkstra's over (milestone, turns) in plain Python, among disks that block."""

import heapq
import itertools
import pickle
from copy import deepcopy

import numpy as np
import pytest

from evenroad._native.robot_roadmap import SceneGraph, Search
from evenroad.errors import InvalidValue

TURN = 2.0 * np.pi
KINDS = {
    "straight": ([False, False], [False, False]),
    "endless": ([False, False], [True, False]),
    "two turns": ([True, False], [False, False]),
    "both": ([False, True], [True, False]),
}


class Plane:
    """A roadmap of two joints among disks, which repeat after a turn where a joint turns further."""

    def __init__(self, kind, seed, count=24):
        rng = np.random.default_rng(seed)
        self.multi_turn, self.endless = map(np.array, KINDS[kind])
        self.limits = np.array([[-np.pi] * 2, [np.pi] * 2])
        self.limits[:, self.multi_turn] *= 2.0
        self.limits[:, self.endless] = [[-np.inf], [np.inf]]
        self.q = rng.uniform(-np.pi, np.pi, (count, 2))
        self.centres = rng.uniform(-np.pi, np.pi, (6, 2))
        self.wraps = self.multi_turn | self.endless
        edges = {}
        for i, here in enumerate(self.q):
            past = np.where(self.wraps, np.rint((here - self.q) / TURN), 0.0)
            away = np.linalg.norm(self.q + TURN * past - here, axis=1)
            for j in np.argsort(away)[1:5].tolist():
                edges.setdefault((min(i, j), max(i, j)), past[j] if i < j else -past[j])
        self.edges = np.array(sorted(edges), dtype=np.int32)
        self.turns = np.array([edges[edge] for edge in sorted(edges)], dtype=np.int8)
        ends = rng.uniform(-1.9 * np.pi, 1.9 * np.pi, (60, 2))
        ends = ends[((ends >= self.limits[0]) & (ends <= self.limits[1])).all(axis=1)]
        ends = np.where(self.endless, (ends + np.pi) % TURN - np.pi, ends)
        self.ends = ends[[self.free(end, end) for end in ends]][:9]
        self.asked = []

    def graph(self):
        joints = self.limits, np.zeros(2), self.multi_turn, self.endless
        return SceneGraph(self.q, self.edges, self.turns, joints)

    def way(self, a, b):
        return np.where(self.endless, (b - a) - TURN * np.rint((b - a) / TURN), b - a)

    def length(self, a, b):
        return float(np.linalg.norm(self.way(a, b)))

    def free(self, a, b):
        states = a + np.linspace(0.0, 1.0, 25)[:, np.newaxis] * self.way(a, b)
        apart = states[:, np.newaxis] - self.centres
        apart = np.where(self.wraps, apart - TURN * np.rint(apart / TURN), apart)
        return bool((np.linalg.norm(apart, axis=2) > 0.8).all())

    def found(self, graph, ends, *, links=24, greed=1.0):
        """The search's path, with each motion that it asks for evaluated here."""
        search = Search(graph, ends, (links, greed))
        while (check := search.next_check()) is not None:
            _, _, a, b = check
            self.asked.append((tuple(a[0]), tuple(b[0])))
            search.record(self.free(a[0], b[0]))
        assert sum(search.counts) <= len(self.asked)
        return search

    def shortest(self, start, goals):
        """The least length of a free way over milestones after turns, all of which may be linked; or inf."""
        spans = [range(-2, 3) if counted else (0,) for counted in self.multi_turn]
        lifts = [np.array(turns) for turns in itertools.product(*spans)]

        def inside(q):
            return np.all(~self.multi_turn | ((q >= self.limits[0]) & (q <= self.limits[1])))

        def nearest(i, place):
            best = min(
                (lift for lift in lifts if inside(self.q[i] + TURN * lift)),
                key=lambda lift: self.length(self.q[i] + TURN * lift, place),
            )
            return tuple(best.tolist())

        neighbours = {i: [] for i in range(len(self.q))}
        for (a, b), turns in zip(self.edges.tolist(), self.turns.astype(int), strict=True):
            past = np.where(self.multi_turn, turns, 0)
            neighbours[a].append((b, past))
            neighbours[b].append((a, -past))
        best = min((self.length(start, goal) for goal in goals if self.free(start, goal)), default=np.inf)
        queue, done = [], set()
        for i in range(len(self.q)):
            lift = nearest(i, start)
            there = self.q[i] + TURN * np.array(lift)
            if self.free(start, there):
                heapq.heappush(queue, (self.length(start, there), i, lift))
        while queue:
            cost, i, lift = heapq.heappop(queue)
            if (i, lift) in done:
                continue
            done.add((i, lift))
            here = self.q[i] + TURN * np.array(lift)
            for goal in goals:
                if nearest(i, goal) == lift and self.free(here, goal):
                    best = min(best, cost + self.length(here, goal))
            for j, past in neighbours[i]:
                there = self.q[j] + TURN * (np.array(lift) + past)
                if inside(there) and self.free(here, there):
                    turned = tuple((np.array(lift) + past).tolist())
                    heapq.heappush(queue, (cost + self.length(here, there), j, turned))
        return best

    def length_of(self, path):
        return sum(self.length(a, b) for a, b in itertools.pairwise(path))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(4))
def test_a_path_is_found_where_a_slow_search_finds_one_and_is_as_short(kind, seed):
    plane = Plane(kind, seed)
    # A greedy search finds longer paths, but finds one.
    graphs = {greed: plane.graph() for greed in (1.0, 3.0)}
    for goals in (1, 2):
        for first in range(0, len(plane.ends) - goals, goals + 1):
            ends = plane.ends[first : first + goals + 1]
            expected = plane.shortest(ends[0], ends[1:])
            for greed, graph in graphs.items():
                search = plane.found(graph, ends, greed=greed)
                assert (search.goal >= 0) == (expected < np.inf)
                if search.goal < 0:
                    assert len(search.path) == 0
                    continue
                # Links are measured in single precision.
                length = plane.length_of(search.path)
                assert length >= expected * (1.0 - 1e-6)
                assert length <= expected * (1.0 + 1e-6) or greed != 1.0
                np.testing.assert_array_equal(search.path[0], ends[0])
                np.testing.assert_array_equal(search.path[-1], ends[1 + search.goal])
                assert all(itertools.starmap(plane.free, itertools.pairwise(search.path)))


def test_nothing_is_asked_twice():
    plane = Plane("two turns", 1)
    graph = plane.graph()
    for first in range(0, len(plane.ends) - 1, 2):
        plane.found(graph, plane.ends[first : first + 2])
        known = len(plane.asked)
        # The links and the straight motion belong to a query; what is known of the roadmap stays.
        again = Search(graph, plane.ends[first : first + 2], (24, 1.0))
        while (check := again.next_check()) is not None:
            kind, is_of_roadmap, a, b = check
            assert not is_of_roadmap
            assert kind == "motion"
            again.record(plane.free(a[0], b[0]))
        assert len(plane.asked) == known
    motions = [(a, b) for a, b in plane.asked if a != b]
    assert len(motions) == len(set(motions))


def test_an_inserted_path_is_known_and_its_milestones_lead_to_eight_others():
    plane = Plane("straight", 2)
    graph, free = plane.graph(), [np.array([-3.0, -3.1]), np.array([-2.9, 3.0]), np.array([3.0, 3.1])]
    graph.insert(np.array(free))
    assert graph.size == len(plane.q) + 3
    graph.insert(np.array(free[:2]))
    assert graph.size == len(plane.q) + 3
    # No check but that of the straight motion is needed along what was inserted.
    search = Search(graph, np.array([free[0], free[2]]), (5, 1.0))
    assert search.next_check()[0] == "motion"
    search.record(False)
    kinds = []
    while (check := search.next_check()) is not None:
        kinds.append(check[0])
        search.record(False)
    assert search.goal == 0
    np.testing.assert_array_equal(search.path[1:-1], free)
    assert len(kinds) <= 8


def test_what_is_inserted_in_one_scene_is_not_in_another_and_too_many_turns_in_none():
    plane = Plane("two turns", 0)
    one = plane.graph()
    one.insert(plane.ends[:2])
    other = plane.graph().within(plane.limits[0], plane.limits[1])
    assert (one.size, other.size) == (len(plane.q) + 2, len(plane.q))
    for far in ([[0.0, 0.0], [4.0 * TURN, 0.0]], [[8.0 * TURN, 0.0]]):
        other.insert(np.array(far))
    assert other.size == len(plane.q)


@pytest.mark.parametrize("copied", [deepcopy, lambda graph: pickle.loads(pickle.dumps(graph))])
def test_a_copy_knows_what_was_known_and_goes_its_own_way(copied):
    plane = Plane("both", 3)
    graph = plane.graph()
    plane.found(graph, plane.ends[:3])
    graph.insert(plane.ends[:2])
    copy = copied(graph)
    assert copy.size == graph.size
    before = len(plane.asked)
    asked = []
    for each in (graph, copy):
        search = plane.found(each, plane.ends[3:5])
        asked.append((plane.asked[before:], search.path.tolist()))
        before = len(plane.asked)
    assert asked[0] == asked[1]
    copy.insert(plane.ends[5:6])
    assert copy.size == graph.size + 1


def graph_with(**changed):
    given = {
        "milestones": np.zeros((3, 2)),
        "edges": np.array([[0, 1]], dtype=np.int32),
        "turns": np.zeros((1, 2), dtype=np.int8),
        "joints": (np.array([[-1.0] * 2, [1.0] * 2]), np.zeros(2), np.zeros(2, bool), np.zeros(2, bool)),
    } | changed
    return SceneGraph(*given.values())


@pytest.mark.parametrize(
    ("changed", "text"),
    [
        ({"milestones": np.zeros((0, 2))}, "milestones must be one or more"),
        ({"milestones": np.full((3, 2), np.nan)}, "milestones must be finite"),
        ({"milestones": np.zeros((3, 2), np.float32)}, "milestones must be a .*float64"),
        ({"edges": np.array([[0, 3]], dtype=np.int32)}, "edges must be from 0 to below 3, got 3"),
        ({"edges": np.array([[-1, 0]], dtype=np.int32)}, "edges must be from 0 to below 3, got -1"),
        ({"turns": np.full((1, 2), 2, dtype=np.int8)}, "turns must be -1, 0 or 1"),
        ({"turns": np.zeros((2, 2), dtype=np.int8)}, r"turns must have shape \(1, 2\)"),
        ({"joints": (np.zeros((2, 2)),)}, "joints must be"),
    ],
)
def test_a_roadmap_that_does_not_fit_is_refused(changed, text):
    with pytest.raises(InvalidValue, match=text):
        graph_with(**changed)


@pytest.mark.parametrize(
    ("ends", "rules", "text"),
    [
        (np.zeros((1, 2)), (1, 1.0), "a start and one goal or more"),
        (np.zeros((2, 3)), (1, 1.0), r"start_and_goals must have shape \(2, 2\)"),
        (np.full((2, 2), np.inf), (1, 1.0), "start_and_goals must be finite"),
        (np.zeros((2, 2)), (0, 1.0), "links must be 1 or more"),
        (np.zeros((2, 2)), (1, 1.0, 1.0), "rules must be"),
    ],
)
def test_a_question_that_makes_no_sense_is_refused(ends, rules, text):
    with pytest.raises(InvalidValue, match=text):
        Search(graph_with(), ends, rules)


def test_a_search_refuses_results_that_it_did_not_ask_for_and_milestones_that_came_later():
    graph = graph_with()
    search = Search(graph, np.array([[0.1, 0.1], [0.2, 0.2]]), (3, 1.0))
    with pytest.raises(InvalidValue, match="nothing is to be evaluated"):
        search.record(True)
    assert search.next_check() is not None
    graph.insert(np.array([[0.3, 0.3]]))
    for call in (search.next_check, lambda: search.record(True)):
        with pytest.raises(InvalidValue, match="inserted since"):
            call()
