"""The parts of ``python -m benchmarks.sequences_rrt``: tunnels, trees and the network's objective."""

import itertools
import math

import numpy as np
import pytest
from benchmarks.chain_rrt import JOINTS, TURN, Setting, grow, problem, tunnel

SETTING = Setting(step=0.9, turned=True)


def sides(p, q, r):
    """On which side of the line from p to q the points r lie."""
    return np.sign((q[0] - p[0]) * (r[..., 1] - p[1]) - (q[1] - p[1]) * (r[..., 0] - p[0]))


def cross(a, b, c, d):
    """Whether the segments from a to b and from c to d cross, by the sides on which their ends lie."""
    return sides(a, b, c) * sides(a, b, d) < 0 and sides(c, d, a) * sides(c, d, b) < 0


def is_free(q, walls, shrunk=1e-6):
    """Whether a chain of angles q touches neither itself nor the walls: another formula, end pieces left out."""
    heading = np.cumsum(q)
    joints = np.vstack(
        [[0.0, 0.0], np.cumsum(np.column_stack([np.cos(heading), np.sin(heading)]), axis=0) / JOINTS]
    )
    links = list(itertools.pairwise(joints))
    obstacles = [(walls[:2, i], walls[:2, i] + walls[2:, i]) for i in range(walls.shape[1])]
    inner = [(a + shrunk * (b - a), b - shrunk * (b - a)) for a, b in links]
    if any(cross(*one, *other) for one, other in itertools.combinations(inner, 2)):
        return False
    return not any(cross(*link, *wall) for link in inner for wall in obstacles)


def states(path, spacing, wraps=True):
    for first, second in itertools.pairwise(path):
        turn = second - first
        turn = turn - TURN * np.rint(turn / TURN) if wraps else turn
        count = math.ceil(np.linalg.norm(turn) / spacing)
        yield from (first + turn * i / count for i in range(count + 1))


@pytest.mark.parametrize("width", [0.64, 0.40])
def test_paths_are_free_between_the_states_that_were_tested(width):
    touching, solved = 0, 0
    for number in range(4):
        task = problem(width, number, 5, SETTING)
        assert is_free(task.start, task.walls)
        assert is_free(task.goal, task.walls)
        tree = grow(np.random.default_rng(number).random((2048, JOINTS)), task, SETTING)
        if not tree.draws:
            continue
        solved += 1
        path = tree.path()
        np.testing.assert_array_equal(path[0], task.start)
        np.testing.assert_array_equal(path[-1], task.goal)
        assert all(is_free(q, task.walls) for q in path)
        turns = np.diff(path, axis=0)
        turns -= TURN * np.rint(turns / TURN)
        assert np.linalg.norm(turns, axis=1).max() <= SETTING.step * (1 + 1e-12)
        touching += not all(is_free(q, task.walls) for q in states(path, 0.01))
    assert solved >= 3
    assert touching == 0


def test_the_number_of_draws_is_the_least_that_solves():
    task = problem(0.64, 3, 5, SETTING)
    points = np.random.default_rng(3).random((2048, JOINTS))
    draws = grow(points, task, SETTING).draws
    assert draws > 1
    assert grow(points[:draws], task, SETTING).draws == draws
    assert grow(points[: draws - 1], task, SETTING).draws == 0


def test_every_node_is_a_step_towards_a_draw_from_the_nearest_node():
    task = problem(0.40, 1, 5, SETTING)
    points = np.random.default_rng(4).random((60, JOINTS))
    tree = grow(points, task, SETTING)
    targets = iter((points - 0.5) * TURN)
    for child in range(1, len(tree.nodes)):
        for target in targets:
            away = target - tree.nodes[:child]
            away -= TURN * np.rint(away / TURN)
            length = np.linalg.norm(away, axis=1)
            near = int(np.argmin(length))
            end = tree.nodes[near] + away[near] * min(1.0, SETTING.step / length[near])
            off = end - tree.nodes[child]
            if np.abs(off - TURN * np.rint(off / TURN)).max() < 1e-9:
                assert tree.parents[child] == near
                break
        else:
            pytest.fail(f"node {child} is no step towards any draw")


def test_a_turned_scene_is_the_same_problem():
    moved = Setting(step=0.9)
    task, turned = problem(0.5, 2, 5, moved), problem(0.5, 2, 5, SETTING)
    angle = turned.start[0] - task.start[0]
    points = np.random.default_rng(6).random((1500, JOINTS))
    there = points.copy()
    there[:, 0] = (there[:, 0] + angle / TURN) % 1.0
    assert abs(angle) > 0.1
    assert grow(points, task, moved).draws == grow(there, turned, SETTING).draws > 0


@pytest.mark.parametrize(
    ("width", "lengths"), [(0.4, [1 + 0.2 * math.pi, 1 - 0.2 * math.pi]), (2.0 / math.pi, [2.0])]
)
def test_the_widest_tunnel_has_no_inner_wall(width, lengths):
    found = JOINTS * np.linalg.norm(tunnel(width)[2:], axis=0)
    np.testing.assert_allclose(found, np.repeat(lengths, 3), rtol=1e-6)


def test_the_goal_is_drawn_when_the_setting_says_so():
    task = problem(0.64, 0, 5, SETTING)
    points = np.random.default_rng(8).random((2048, JOINTS))
    biased = Setting(step=0.9, turned=True, every=9)
    assert 0 < grow(points, task, biased).draws < grow(points, task, SETTING).draws


def brute_mean(points, top=1.0):
    """Mean L2 discrepancy of the beginnings; `top` 1 is the star discrepancy, 2 Hickernell's."""
    found, d = [], points.shape[1]
    for n in range(2, len(points) + 1):
        x = points[:n]
        linear = np.prod((2.0 * top - 1.0 - x * x) / 2.0, axis=1).sum()
        pairs = np.prod(top - np.maximum(x[:, None], x[None]), axis=2).sum()
        found.append(math.sqrt((top - 2.0 / 3.0) ** d - 2.0 * linear / n + pairs / n**2))
    return np.mean(found)


@pytest.mark.parametrize(("measure", "top"), [("star", 1.0), ("hickernell", 2.0)])
def test_the_networks_objective_is_the_mean_discrepancy_and_its_slope(measure, top):
    neural = pytest.importorskip("benchmarks.neural_sequence", exc_type=ImportError)
    points = np.random.default_rng(1).random((20, JOINTS))
    value, gradient = neural.mean_prefix(points, measure)
    assert value == pytest.approx(brute_mean(points, top), rel=1e-12)
    for row, column in ((0, 0), (7, 2), (19, 3)):
        above, below = points.copy(), points.copy()
        above[row, column] += 1e-6
        below[row, column] -= 1e-6
        slope = (brute_mean(above, top) - brute_mean(below, top)) / 2e-6
        assert gradient[row, column] == pytest.approx(slope, rel=1e-5, abs=1e-9)


def test_the_network_learns_sobols_points_and_then_lowers_the_discrepancy(monkeypatch):
    neural = pytest.importorskip("benchmarks.neural_sequence", exc_type=ImportError)
    monkeypatch.setattr(neural, "WIDTH", 64)
    points, found = neural.train(0, points=50, steps=(150, 100))
    assert points.shape == (50, JOINTS)
    assert points.min() > 0.0
    assert points.max() < 1.0
    assert found["tuned"] < found["learnt"]
    assert found["tuned"] == pytest.approx(brute_mean(points), rel=1e-4)
