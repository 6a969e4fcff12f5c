"""Maps of the MovingAI benchmarks: which letters are free, and files that are refused."""

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import BrokenFile
from evenroad.world import MapFrame, load_map
from tests.refused import refused

ARENA = "type octile\nheight 4\nwidth 6\nmap\n......\n.@OTW.\n..GS..\n@@@@@@\n"


def saved(folder, text=ARENA, name="arena.map"):
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_ground_and_swamp_are_free_and_trees_water_and_what_is_out_of_bounds_are_not(tmp_path):
    grid = load_map(saved(tmp_path))
    rows = ["......", ".####.", "......", "######"]
    np.testing.assert_array_equal(grid.occupied, [[each == "#" for each in row] for row in rows])
    assert grid.frame == MapFrame(rows=4, cols=6)
    assert grid.world(0.4).valid((0.5, 2.5))
    assert not grid.world(0.4).valid((0.5, 3.5))


@pytest.mark.parametrize("change", [
    lambda text: text.replace("\n", "\r\n"), lambda text: text + "\n\n", lambda text: text.rstrip(),
    lambda text: text.replace("octile", "tile"), lambda text: text.replace("width 6", "width  6 "),
])  # fmt: skip
def test_ends_of_lines_and_spaces_make_no_difference(tmp_path, change):
    np.testing.assert_array_equal(
        load_map(saved(tmp_path, change(ARENA), "changed.map")).occupied, load_map(saved(tmp_path)).occupied
    )


@pytest.mark.parametrize(("change", "said"), [
    (("octile", "hex"), "must begin with the lines type octile"), (("height 4", "height -4"), "must begin"),
    (("width 6", "width six"), "must begin"), (("height 4\n", ""), "must begin"), ((ARENA, ""), "is empty"),
    (("height 4", "height 5"), "has 4 rows of cells, but its header says height 5"),
    (("height 4", "height 3"), "has 4 rows"), (("width 6", "width 7"), "row 1 of .* has 6 cells, .* says width 7"),
    ((".@OT", ".@XT"), "has 'X' in row 2, column 3; known"), (("height 4", "height 0"), "must begin"),
    (("height 4\nwidth 6", "height 20000\nwidth 20000"), "too large: 20000 x 20000 cells"),
    (("height 4", "height 99999999999999999999"), "must begin"), (("GS", "\0S"), "in row 3, column 3"),
])  # fmt: skip
def test_what_is_no_such_map_is_named(tmp_path, change, said):
    refused(BrokenFile, said, load_map, saved(tmp_path, ARENA.replace(*change)))


def test_binary_and_missing_files_are_named(tmp_path):
    refused(BrokenFile, "no text", load_map, saved(tmp_path, bytes(range(256)) * 9))
    refused(BrokenFile, "No such file", load_map, tmp_path / "nowhere.map")


def test_a_path_is_planned_on_one_by_its_name(tmp_path):
    path = saved(tmp_path, "type octile\nheight 20\nwidth 30\nmap\n" + ("." * 30 + "\n") * 20)
    assert er.plan(str(path), (2, 2), (28, 18), radius=1.0).solved
