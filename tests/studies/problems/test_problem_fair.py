"""Random problems of the fair suite: the same everywhere, another every time, and no place of the space preferred."""

import csv
from pathlib import Path

import numpy as np
import pytest

from evenroad_studies.problems import PROBLEMS
from evenroad_studies.problems.fair import (
    BALLS,
    BODY,
    BODY_REACH,
    BOXES,
    CALIBRATED_AT,
    DIFFICULTIES,
    FAIR_PROBLEMS,
    SIZES,
    Family,
    Stream,
    draw_balls,
    draw_boxes,
    draw_clutter,
    draw_query,
    far_in_map,
    far_on_torus,
    instance_rng,
)
from evenroad_studies.worlds import Corridor

CALIBRATION = Path(__file__).parents[3] / "studies" / "docs" / "data" / "fair_calibration.csv"
ONE_OF_EACH = ["fair-balls-5d-50", "fair-boxes-5d-50", "fair-maze-50", "fair-se2-50", "fair-se3-50"]


@pytest.mark.parametrize("name", ONE_OF_EACH)
def test_the_same_number_makes_the_same_problem_and_another_one_another(name):
    first, again, other = (PROBLEMS[name].make(number) for number in (3, 3, 4))
    np.testing.assert_array_equal(first.start, again.start)
    np.testing.assert_array_equal(first.goal, again.goal)
    q = first.world.space.from_cube(np.random.default_rng(0).random((300, first.set_dim)))
    np.testing.assert_array_equal(first.world.valid(q), again.world.valid(q))
    assert (first.world.valid(q) != other.world.valid(q)).any()
    assert (first.start != other.start).any()


@pytest.mark.parametrize("name", ONE_OF_EACH)
def test_both_ends_are_free_and_the_straight_motion_is_not(name):
    for instance in range(4):
        problem = PROBLEMS[name].make(instance)
        ends = np.stack([problem.start, problem.goal])
        assert problem.world.valid(ends).all()
        assert not problem.world.motion_valid(ends[:1], ends[1:])[0]


def test_tuning_and_reporting_share_no_instance_and_every_part_of_an_address_counts():
    drawn = {stream: {instance_rng(stream, Family.BALLS, 5, 50, i).random() for i in range(200)} for stream in Stream}
    assert all(len(numbers) == 200 for numbers in drawn.values())
    assert len(set.union(*drawn.values())) == 3 * 200
    addresses = [
        (Family.BALLS, 5, 50, 1), (Family.BOXES, 5, 50, 1), (Family.BALLS, 7, 50, 1),
        (Family.BALLS, 5, 25, 1), (Family.BALLS, 5, 50, 2),
    ]  # fmt: skip
    assert len({instance_rng(Stream.TUNING, *each).random() for each in addresses}) == len(addresses)


def test_of_the_fair_problems_only_balls_and_boxes_are_for_tuning():
    tuning = [name for name in FAIR_PROBLEMS if name.startswith("tune-")]
    assert "tune-balls-5d-50" in tuning
    assert all(name.startswith(("tune-balls-", "tune-boxes-")) for name in tuning)
    assert {"fair-maze-25", "fair-se2-50", "fair-se3-75"} <= set(PROBLEMS)


def test_every_problem_has_its_three_difficulties_and_sizes_in_their_order():
    for (family, d), sizes in SIZES.items():
        assert (family, d) in CALIBRATED_AT
        # Large obstacles make a world hard, wide doors make a maze easy.
        assert list(sizes) == sorted(sizes, reverse=family is not Family.MAZE)
    assert {each.difficulty for each in FAIR_PROBLEMS.values()} == set(DIFFICULTIES)


def test_the_sizes_are_those_of_the_calibration_that_is_kept():
    with open(CALIBRATION, newline="") as file:
        rows = list(csv.DictReader(file))
    kept = {(Family[r["family"].upper()], int(r["d"]), int(r["difficulty"])): r for r in rows}
    for (family, d), sizes in SIZES.items():
        for difficulty, size in zip(DIFFICULTIES, sizes, strict=True):
            row = kept[family, d, difficulty]
            assert float(row["size"]) == size
            assert int(row["n"]) == CALIBRATED_AT[family, d]
            assert abs(float(row["uniform"]) - difficulty) < 7


@pytest.mark.parametrize(("draw", "dim", "cell", "worlds", "share"), [
    (draw_balls, 3, (Family.BALLS, 3), 300, 0.02), (draw_boxes, 3, (Family.BOXES, 3), 300, 0.02),
    (draw_clutter, 2, (Family.SE2, 3), 60, 0.0), (draw_clutter, 3, (Family.SE3, 6), 60, 0.0),
], ids=["balls", "boxes", "clutter in the plane", "clutter in space"])  # fmt: skip
def test_no_place_is_freer_than_another_at_the_faces_and_in_the_middle(draw, dim, cell, worlds, share):
    random, size = np.random.default_rng(5), SIZES[cell][1]
    at_face, in_middle = [], []
    for _ in range(worlds):
        world = draw(dim, size, random)
        cube = random.random((50, world.space.cube_dim))
        cube[:, 0] *= share
        at_face.append(world.valid(world.space.from_cube(cube)).mean())
        cube[:, 0] += 0.5 - share / 2
        in_middle.append(world.valid(world.space.from_cube(cube)).mean())
    difference = np.array(at_face) - in_middle
    assert abs(difference.mean()) < 4 * difference.std() / np.sqrt(len(difference))


@pytest.mark.parametrize("dim", [2, 3])
def test_the_body_reaches_no_further_than_stated(dim):
    corners = np.concatenate([box.corners for box in BODY[dim]])
    assert np.linalg.norm(corners, axis=1).max() <= BODY_REACH[dim]


def test_starts_and_goals_do_not_gather_at_the_faces():
    problems = [PROBLEMS["fair-balls-5d-50"].make(i) for i in range(150)]
    away = np.abs(np.stack([[each.start, each.goal] for each in problems]) - 0.5).mean(axis=(1, 2))
    # A uniform coordinate is 1/4 from the middle, on average.
    assert abs(away.mean() - 0.25) < 4 * away.std() / np.sqrt(len(away))


def test_far_is_by_the_short_way_round_a_torus_and_half_the_width_of_a_map():
    a = np.array([[0.05, 0.5], [0.25, 0.5], [0.0, 0.0]])
    b = np.array([[0.95, 0.5], [0.75, 0.5], [0.3, 0.3]])
    assert far_on_torus(a, b).tolist() == [False, True, True]
    a, b = np.array([[0.1, 0.5], [0.1, 0.1]]), np.array([[0.59, 0.5], [0.1, 0.8]])
    assert far_in_map(a, b).tolist() == [False, True]


def test_boxes_bound_three_different_coordinates_and_in_the_plane_both():
    for d in (2, 3, 5, 10):
        world = draw_boxes(d, 0.1, np.random.default_rng(1))
        assert world.axes.shape == (BOXES[d], min(3, d))
        assert (world.half_extents >= 0.05).all()
        assert (world.half_extents <= 0.15).all()
    assert draw_balls(7, 0.3, np.random.default_rng(1)).centres.shape == (BALLS[7], 7)


def test_a_world_without_room_for_a_query_is_replaced():
    full, roomy = Corridor(3, 1e-6), Corridor(3, 0.45)
    worlds = iter([full, full, roomy])
    world, start, goal = draw_query(
        lambda rng: next(worlds), lambda a, b: np.ones(len(a), dtype=bool), np.random.default_rng(0)
    )
    assert world is roomy
    assert world.valid(np.stack([start, goal])).all()
