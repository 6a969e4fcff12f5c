"""Random mazes: always solvable, and the shipped ones are still what the generator draws."""

import json

import numpy as np
import pytest
from scipy import ndimage

from evenroad.errors import InvalidValue
from evenroad.world.gridmap.load import LEVELS, load_maze
from evenroad_studies.mazes import MazeDesign, draw_maze

SMALL = MazeDesign(cols=5, rows=4, wall=8, door=30, loops=0.2, width=300, height=240)


@pytest.mark.parametrize("seed", range(8))
def test_every_room_can_be_reached(seed):
    maze = draw_maze(SMALL, rng=seed)
    _, pieces = ndimage.label(~maze.map.occupied)
    assert pieces == 1


def test_without_loops_there_is_one_door_less_than_rooms():
    tree = draw_maze(MazeDesign(5, 4, 8, 30, loops=0.0, width=300, height=240), rng=1)
    all_open = draw_maze(MazeDesign(5, 4, 8, 30, loops=1.0, width=300, height=240), rng=1)
    opened = all_open.map.occupied.sum() - tree.map.occupied.sum()
    # 31 inner walls, 19 of them with a door; a door is 30 pixels long and 8 thick.
    assert -opened == (31 - 19) * 30 * 8


def test_a_disk_that_fits_the_doors_finds_start_and_goal_free():
    maze = draw_maze(SMALL, rng=3)
    assert maze.map.world(6.0).valid(np.array([maze.start, maze.goal])).all()


def test_the_same_seed_draws_the_same_maze_and_another_another():
    first, again, other = (draw_maze(SMALL, rng=seed).map.occupied for seed in (4, 4, 5))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()


def test_the_shipped_mazes_are_what_the_generator_draws():
    designs = {
        1: (MazeDesign(cols=7, rows=5, wall=10, door=50, loops=0.20), 12),
        2: (MazeDesign(cols=8, rows=6, wall=8, door=54, loops=0.15), 15),
        3: (MazeDesign(cols=10, rows=8, wall=8, door=32, loops=0.10), 13),
    }
    records = json.loads(load_maze(1).path.with_name("mazes.json").read_text())
    for level in LEVELS:
        design, seed = designs[level]
        drawn = draw_maze(design, rng=seed)
        np.testing.assert_array_equal(drawn.map.occupied, load_maze(level).map().occupied)
        assert [list(drawn.start), list(drawn.goal)] == [records[str(level)]["start"], records[str(level)]["goal"]]


@pytest.mark.parametrize(("change", "match"), [
    ({"cols": 0}, "cols"), ({"wall": 1}, "wall"),
    ({"wall": 60}, "thinner than a room of 60 pixels, got 60"),
    ({"door": 0}, "door"), ({"loops": 1.5}, "loops"), ({"loops": float("nan")}, "loops"),
])  # fmt: skip
def test_designs_that_cannot_be_drawn_are_refused(change, match):
    values = {"cols": 5, "rows": 4, "wall": 8, "door": 30, "loops": 0.2, "width": 300, "height": 240}
    with pytest.raises(InvalidValue, match=match):
        MazeDesign(**(values | change))
