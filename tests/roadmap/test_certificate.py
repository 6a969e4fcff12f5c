"""Certificates: their formulas by hand, their claims against brute force, and the printed bound that is false."""

import math
import tracemalloc
from dataclasses import dataclass

import numpy as np
import pytest

from evenroad.errors import InvalidValue, NotAvailable
from evenroad.planning import Status
from evenroad.points import PointSet, draw
from evenroad.points.measures import dispersion_bounds, star_discrepancy
from evenroad.roadmap import Certificate, Complete, KNearest, Radius, Reach, Rule, certify_roadmap
from evenroad.roadmap.build import roadmap_of_points
from evenroad.roadmap.certify import certify
from evenroad.roadmap.neighbours import nearest
from evenroad.space import SO3, BoxSpace, JointSpace
from evenroad.world import FunctionWorld
from tests.clear_paths import DiscWorld, Plane, shortest_around
from tests.plan_on import plan_on
from tests.points.measures.dispersion_oracle import dispersion_l2, dispersion_linf
from tests.refused import refused

SQUARE = BoxSpace([0.0, 0.0], [1.0, 1.0])
OPEN = DiscWorld(2, (Plane((0, 1), np.array([[9.0, 9.0]]), np.array([0.1])),))


@dataclass(frozen=True)
class Fewer(Rule):
    """Both of two milestones are among the k nearest of each other."""

    k: int

    def edges(self, q, space=None, *, terminals=0):
        near = nearest(q, self.k, space).tolist()
        pairs = [(i, j) for i, row in enumerate(near) for j in row if i < j and i in near[j]]
        return np.array(sorted(pairs), dtype=np.int32).reshape(-1, 2)

    def reach(self, milestones, space):
        return Reach(k=self.k)


def least_gap(q, edges):
    """Return the least distance of two points, (n, 2), that no edge joins."""
    joined = {tuple(edge) for edge in edges.tolist()}
    return min(np.linalg.norm(q[i] - q[j]) for i in range(len(q)) for j in range(i) if (j, i) not in joined)


def test_the_papers_case_costs_one_plus_its_factor():
    beta, alpha = 0.1, 3.0
    certificate = Certificate(beta, beta, 2 * alpha * beta, math.inf, True)
    enough = beta * math.hypot(1.0, alpha - 1.0)
    assert certificate.factor(1.0001 * enough) == pytest.approx(1 + 1 / (alpha - 1))
    assert certificate.factor(0.9 * enough) > 1 + 1 / (alpha - 1)
    assert certificate.clearance_for(1 + 1 / (alpha - 1) + 1e-9) == pytest.approx(enough)
    assert certificate.clearance_for(1.49) == certificate.clearance_for(1.0) == math.inf


@pytest.mark.parametrize("epsilon", [0.1, 1.0, 5.0])
def test_the_radius_and_dispersion_of_tsao_solovey_and_pavone_give_their_factor(epsilon):
    delta, root = 0.3, math.sqrt(1 + epsilon**2)
    beta, radius = delta * epsilon / root, 2 * (1 + epsilon) * delta / root
    assert Certificate(beta, beta, radius, radius, True).factor(delta) == pytest.approx(1 + epsilon)


def test_nothing_is_certified_below_the_dispersion_or_twice_it_as_a_radius():
    assert Certificate(0.1, 0.1, 0.5, 0.5, True).factor(0.1) == math.inf
    assert Certificate(0.1, 0.1, 0.2, 0.5, True).factor(1.0) == math.inf
    assert Certificate(0.1, 0.1, 0.2001, 0.5, True).complete
    assert not Certificate(0.1, 0.1, 0.1999, 0.5, True).complete


def test_each_piece_after_the_first_costs_twice_the_dispersion():
    certificate = Certificate(0.1, 0.1, 0.4, 0.4, True)
    # Pieces of 0.2: one needs no milestone, three need two.
    assert certificate.longest(0.19, 1.0) == pytest.approx(0.19)
    assert certificate.longest(0.59, 1.0) == pytest.approx(0.59 + 2 * 0.2)
    # Where the ends are tried with their nearest milestone alone, both detours are paid twice.
    assert Certificate(0.1, 0.1, 0.4, 0.1, True).longest(0.59, 1.0) == pytest.approx(0.59 + 4 * 0.2)
    # Start and goal may not be tried with one another.
    assert Certificate(0.1, 0.1, 0.4, 0.4, False).longest(0.19, 1.0) == pytest.approx(0.39)


def test_the_dispersion_is_not_bounded_by_the_star_discrepancy_as_printed():
    points = np.array([[0.0, 0.375], [0.55, 0.975]])
    printed = star_discrepancy(points) ** 0.5
    assert star_discrepancy(points) == pytest.approx(0.5)
    assert printed < 0.71 < 0.97 < dispersion_linf(points)
    # The same for the set that a planner would take: it is scaled into a quarter of holes of its own.
    assert dispersion_bounds(points).lower > dispersion_l2(points) * (1 - 1e-5) > printed


def test_the_printed_factor_would_make_paths_shorter_than_straight_lines():
    alpha = 3.0
    assert 1 / (alpha - 1) < 1
    points = draw("cover", 128, 2)
    beta = certify(points, Radius(1.0), SQUARE).dispersion
    how = dict(rule=Radius(2 * alpha * beta), smooth=False, certify=True, links=None)
    result = plan_on(OPEN, [0.05, 0.5], [0.95, 0.5], points, **how)
    assert result.milestone_cost > 0.9 / (alpha - 1)
    longest = result.certificate.longest(0.9, 1.0)
    assert result.milestone_cost <= longest < (1 + 1 / (alpha - 1)) * 0.9 + 2 * beta


def random_discs(rng, d):
    m = int(rng.integers(1, 5))
    axes = rng.permutation(d)[:2]
    plane = Plane((int(axes[0]), int(axes[1])), rng.random((m, 2)), rng.uniform(0.03, 0.25, m))
    return DiscWorld(d, (plane,))


def test_the_shortest_path_around_one_disc_is_two_tangents_and_an_arc():
    start, goal = np.array([0.1, 0.5]), np.array([0.9, 0.5])
    length = shortest_around(np.array([[0.5, 0.5]]), np.array([0.2]), start, goal)
    assert length == pytest.approx(2 * math.sqrt(0.4**2 - 0.2**2) + 0.2 * (math.pi - 2 * math.acos(0.5)))


@pytest.mark.parametrize(("d", "n", "k"), [(2, 200, 25), (3, 200, 60)])
@pytest.mark.parametrize("sampler", ["cover", "even", "uniform"])
def test_no_claim_is_false_in_random_worlds(d, n, k, sampler):
    rng = np.random.default_rng([d, n])
    points = draw(sampler, n, d, rng=1)
    space = BoxSpace([0.0] * d, [1.0] * d)
    beta = certify(points, Complete(), space).dispersion
    costs = 0
    for rule in (Radius(2.2 * beta), Radius(4 * beta), KNearest(k)):
        promised = certify(points, rule, space)
        for _ in range(15):
            world, (start, goal) = random_discs(rng, d), rng.random((2, d))
            result = plan_on(world, start, goal, points, rule=rule, search="lazy", smooth=False, certify=True)
            if result.certificate is None:
                assert result.status in (Status.START_INVALID, Status.GOAL_INVALID)
                continue
            # Of one query at least as much is known as of all.
            assert result.certificate.between >= promised.between
            least = promised.to_terminals
            assert result.certificate.to_terminals >= least * (1 - 1e-9) or least <= beta
            exists = math.isfinite(world.optimum(start, goal, beta))
            if promised.complete and not result.solved:
                assert not exists
                assert "no path has a clearance" in result.message
            for delta in (1.05 * beta, 1.5 * beta, 2.5 * beta):
                optimum = world.optimum(start, goal, delta)
                if not math.isfinite(optimum):
                    continue
                bounds = promised.longest(optimum, delta), result.certificate.longest(optimum, delta)
                if math.isfinite(min(bounds)):
                    costs += 1
                    assert result.milestone_cost <= min(bounds)
    assert costs > {"cover": 30, "even": 5, "uniform": -1}[sampler]


@pytest.mark.parametrize("sampler", ["sukharev", "cover", "uniform"])
def test_neighbours_among_any_valid_milestones_reach_as_far_as_promised(sampler):
    rng, k = np.random.default_rng(5), 9
    points = draw(sampler, 144, 2, rng=2)
    promised = certify(points, KNearest(k), SQUARE, links=None)
    for _ in range(20):
        kept = points.points[rng.random(144) < rng.uniform(0.3, 1.0)]
        q = np.concatenate([kept, rng.random((2, 2))])
        edges = {tuple(edge) for edge in KNearest(k).edges(q, SQUARE, terminals=2)}
        for i in range(len(kept)):
            for j in range(i):
                if np.linalg.norm(q[i] - q[j]) < promised.between:
                    assert (j, i) in edges
            for end in (len(kept), len(kept) + 1):
                if np.linalg.norm(q[i] - q[end]) < promised.to_terminals:
                    assert (i, end) in edges


def test_a_rule_that_is_not_known_is_certified_by_its_graph():
    points = draw("cover", 150, 2)
    world = random_discs(np.random.default_rng(1), 2)
    refused(NotAvailable, "promises nothing before the world is known", certify, points, Fewer(12), SQUARE)
    result = plan_on(world, [0.01, 0.02], [0.98, 0.97], points, rule=Fewer(12), smooth=False, certify=True)
    q = points.points[world.valid(points.points)]
    gap = least_gap(q, Fewer(12).edges(q, SQUARE))
    # Start and goal are among the neighbours, too, and take places.
    assert 0.7 * gap <= result.certificate.between <= gap


def test_an_end_that_is_not_joined_to_its_nearest_milestone_voids_the_certificate():
    points = draw("cover", 300, 2)
    result = plan_on(OPEN, points.points.mean(0), [0.98, 0.97], points, rule=Fewer(3), links=None, certify=True)
    assert result.certificate.between == 0.0 or result.certificate.to_terminals > 0.0
    assert result.certificate.factor(0.5) == math.inf


def test_a_kept_roadmap_is_certified_by_its_edges():
    points = draw("cover", 400, 2)
    roadmap = roadmap_of_points(SQUARE, points, KNearest(20))
    certificate = certify_roadmap(roadmap)
    q = points.points
    gap = least_gap(q, roadmap.edges)
    assert certificate.between == pytest.approx(gap)
    assert certificate.between < gap
    assert certificate.complete
    assert certificate.to_terminals > certificate.dispersion
    ends = np.random.default_rng(3).random((200, 2))
    away = np.sort(np.linalg.norm(ends[:, None] - q[None], axis=2), axis=1)
    # Ends are linked to their hundred nearest.
    assert certificate.to_terminals < away[:, 99].min()
    assert certify_roadmap(roadmap_of_points(SQUARE, points, Radius(0.3)), links=None).to_terminals == 0.3
    assert certify_roadmap(roadmap_of_points(SQUARE, points, Complete())).to_terminals == math.inf


def test_lengths_are_those_of_the_spaces_metric():
    points = draw("even", 64, 2)
    unit = certify(points, Radius(0.5), SQUARE)
    large = certify(points, Radius(5.0), BoxSpace([-5.0, 0.0], [0.0, 2.5], weights=[2.0, 4.0]))
    assert large.dispersion == pytest.approx(10 * unit.dispersion, rel=1e-6)


def test_on_a_torus_no_motion_longer_than_half_a_turn_counts():
    turns = JointSpace([-math.pi] * 2, [math.pi] * 2, True)
    certificate = certify(draw("even", 64, 2), Radius(100.0), turns)
    assert certificate.between == pytest.approx(math.pi)
    assert certificate.between < math.pi
    flat = certify(draw("even", 64, 2), Radius(100.0), BoxSpace([-math.pi] * 2, [math.pi] * 2))
    assert certificate.dispersion < flat.dispersion


def test_what_cannot_be_certified_is_refused():
    points = draw("even", 32, 3)
    refused(NotAvailable, "flat, not SO3", certify, points, Radius(1.0), SO3())
    refused(InvalidValue, "the points have d=3", certify, points, Radius(1.0), SQUARE)
    refused(NotAvailable, "k has to be above 3", certify, draw("even", 32, 2), KNearest(3), SQUARE, goals=3)
    refused(InvalidValue, "clearance must be", lambda: certify(draw("even", 32, 2), Radius(1.0), SQUARE).factor(0.0))
    world = FunctionWorld(SQUARE, lambda q: np.ones(len(q), dtype=bool), 0.1)
    for option in ({"success_only": True}, {"edge_cost": SQUARE.distance}):
        with pytest.raises(InvalidValue, match="certify speaks of shortest paths"):
            plan_on(world, [0.1, 0.1], [0.9, 0.9], 32, certify=True, **option)
    assert plan_on(world, [0.1, 0.1], [0.9, 0.9], PointSet(draw("even", 32, 2).points)).certificate is None


def test_many_points_are_certified_in_little_memory():
    points = draw("uniform", 3000, 2)
    certify(points, Complete(), SQUARE)
    tracemalloc.start()
    try:
        certify(points, KNearest(4), SQUARE)
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    # All distances between them would be 72 MB, and are asked for twice.
    assert most < 6e7
