"""ROS map_server files: what each pixel means in each mode, and files that are refused."""

import math
import re

import numpy as np
import pytest
from PIL import Image

import evenroad as er
from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from evenroad.world import GridMap, load_map
from evenroad.world.gridmap import load_ros_map
from evenroad.world.gridmap.load import map_files

META = {
    "image": "map.png",
    "resolution": 0.05,
    "origin": "[-1.0, 2.0, 0.0]",
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}


def written(folder, pixels, *, drop=(), **changes):
    """Write map.png and map.yaml with META, changed; return the YAML file's path."""
    if pixels is not None:
        Image.fromarray(np.array(pixels)).save(folder / "map.png")
    values = {key: value for key, value in {**META, **changes}.items() if key not in drop}
    path = folder / "map.yaml"
    path.write_text("".join(f"{key}: {value}\n" for key, value in values.items()))
    return path


def verdicts(path, rules="nav2"):
    """One letter a pixel of the first row: o(ccupied), u(nknown) or f(ree)."""
    obstacles = load_ros_map(path, rules=rules).occupied[0]
    occupied = load_ros_map(path, unknown_is_free=True, rules=rules).occupied[0]
    assert not (occupied & ~obstacles).any()
    return "".join("o" if o else "u" if b else "f" for o, b in zip(occupied, obstacles, strict=True))


def row(*levels, dtype=np.uint8):
    return np.array([levels], dtype=dtype)


def test_trinary_is_the_default_and_has_map_servers_usual_levels(tmp_path):
    # 0, 205 and 254 are what map_saver writes; 89 and 90 lie on both sides of occupancy 0.65.
    path = written(tmp_path, row(0, 89, 90, 205, 206, 254, 255))
    assert verdicts(path) == "oouufff"
    assert verdicts(written(tmp_path, None, mode="trinary")) == "oouufff"
    assert verdicts(written(tmp_path, None, free_thresh=0.25)) == "oouffff"


@pytest.mark.parametrize("negate", [1, "true"])
def test_negate_makes_white_the_obstacle(tmp_path, negate):
    assert verdicts(written(tmp_path, row(0, 49, 50, 165, 166, 255), negate=negate)) == "ffuuoo"


def test_a_value_equal_to_a_threshold_is_beyond_it_for_nav2_and_unknown_for_ros1(tmp_path):
    # 51 / 255 and 204 / 255 are the thresholds 0.2 and 0.8 themselves.
    path = written(tmp_path, row(50, 51, 52, 203, 204, 205), negate=1, free_thresh=0.2, occupied_thresh=0.8)
    assert verdicts(path) == "ffuuoo"
    assert verdicts(path, "ros1") == "fuuuuo"


def test_thresholds_may_be_at_their_ends_or_equal_where_free_counts_more(tmp_path):
    assert verdicts(written(tmp_path, row(0, 1, 254, 255), free_thresh=0, occupied_thresh=1)) == "ouuf"
    assert verdicts(written(tmp_path, row(0, 203, 204, 205, 255), free_thresh=0.2, occupied_thresh=0.2)) == "oofff"


def test_a_threshold_on_a_level_is_decided_in_single_precision(tmp_path):
    # nav2's own test: 129 / 255 is below 1 - 126 / 255 in double precision, and equal in single.
    assert verdicts(written(tmp_path, row(126, 127), occupied_thresh=129 / 255)) == "ou"


def test_the_shade_is_the_luminance_for_nav2_and_the_mean_of_the_colours_for_ros1(tmp_path):
    # Green is bright to the eye (0.587): occupancy 0.41; as one third of the mean it is 2/3 > 0.65.
    pixels = np.array([[[0, 255, 0], [255, 255, 0], [255, 255, 102], [0, 0, 255]]], dtype=np.uint8)
    path = written(tmp_path, pixels)
    assert verdicts(path) == "uffo"
    assert verdicts(path, "ros1") == "ouuo"


def test_alpha_makes_a_pixel_unknown_for_nav2_and_is_one_more_channel_for_ros1(tmp_path):
    pixels = np.zeros((1, 5, 4), dtype=np.uint8)
    pixels[0, 0] = [0, 0, 0, 255]  # with alpha shade 1/4
    pixels[0, 1] = [60, 60, 60, 255]  # shade 0.426
    pixels[0, 2] = [255, 255, 255, 0]  # shade 3/4
    pixels[0, 3] = [255, 255, 255, 255]
    pixels[0, 4] = [0, 0, 0, 254]
    path = written(tmp_path, pixels)
    assert verdicts(path) == "ooufu"
    assert verdicts(path, "ros1") == "ouufo"
    dark = written(tmp_path, pixels, occupied_thresh=0.8)
    assert verdicts(dark)[0] == "o"
    assert verdicts(dark, "ros1")[0] == "u"


@pytest.mark.parametrize("name", ["two levels", "sixteen bits", "a palette"])
def test_transparent_pixels_of_any_kind_of_image_are_unknown(tmp_path, name):
    path = written(tmp_path, None)
    if name == "two levels":
        image, options = Image.fromarray(np.array([[[255, 0], [255, 255], [0, 255]]], dtype=np.uint8)), {}
        assert image.mode == "LA"
    elif name == "sixteen bits":
        image, options = Image.fromarray(row(7 * 257, 65535, 0, dtype=np.uint16)), {"transparency": 7 * 257}
    else:
        image, options = Image.fromarray(row(2, 1, 0)).convert("P"), {"transparency": 2}
        image.putpalette([0, 0, 0, 255, 255, 255, 255, 255, 255])
    image.save(tmp_path / "map.png", **options)
    assert verdicts(path) == "ufo"


def test_in_scale_mode_what_is_graded_between_0_and_100_is_unknown(tmp_path):
    # nav2's own test has the grades 100, 99, 50, 1 and 0 for the levels 89, 90, 147, 204 and 205.
    path = written(tmp_path, row(0, 89, 90, 147, 204, 205, 206, 255), mode="scale")
    assert verdicts(path) == "oouuufff"
    assert verdicts(path, "ros1") == "oouuuuff"
    pixels = np.zeros((1, 5, 4), dtype=np.uint8)
    pixels[0, :, :3] = [[0] * 3, [255] * 3, [0] * 3, [255] * 3, [127] * 3]
    pixels[0, :, 3] = [255, 255, 254, 0, 255]
    path = written(tmp_path, pixels, mode="scale")
    assert verdicts(path) == verdicts(path, "ros1") == "ofuuu"


def test_in_raw_mode_the_pixel_is_the_occupancy_in_percent(tmp_path):
    path = written(tmp_path, row(0, 19, 20, 65, 66, 100, 101, 205, 255), mode="raw")
    assert verdicts(path) == "ffuooouuu"
    assert verdicts(path, "ros1") == "ffuuoouuu"
    assert verdicts(written(tmp_path, None, mode="raw", negate=1)) == "ffuooouuu"


def test_sixteen_bit_images_mean_the_same_as_eight_bit_ones(tmp_path):
    levels = [0, 89, 90, 205, 206, 255]
    deep = row(*(257 * level for level in levels), dtype=np.uint16)
    assert verdicts(written(tmp_path, deep)) == "oouuff"
    assert verdicts(written(tmp_path, deep, mode="raw")) == "foouuu"
    assert verdicts(written(tmp_path, None, mode="raw"), "ros1") == "foouuu"


def test_every_grey_level_agrees_with_the_rules_written_out(tmp_path):
    for negate in (0, 1):
        path = written(tmp_path, np.arange(256, dtype=np.uint8)[None], negate=negate)
        expected = {"nav2": "", "ros1": ""}
        for level in range(256):
            occupancy = level / 255 if negate else 1 - level / 255
            expected["nav2"] += "f" if occupancy <= 0.196 else "o" if occupancy >= 0.65 else "u"
            expected["ros1"] += "o" if occupancy > 0.65 else "f" if occupancy < 0.196 else "u"
        assert {rules: verdicts(path, rules) for rules in expected} == expected


def test_where_the_rules_differ_a_warning_and_a_note_say_so_until_one_is_chosen(tmp_path):
    pixels = np.zeros((2, 3, 4), dtype=np.uint8)
    pixels[..., 3] = 255
    pixels[1] = 255
    path = written(tmp_path, pixels, occupied_thresh=0.8)
    said = r"map.yaml: .* by rules='nav2' 3 pixels occupied \(else unknown\); known: nav2, ros1"
    with pytest.warns(UserWarning, match=said):
        grid = load_map(path)
    assert len(grid.notes) == len(grid.cropped().notes) == 1
    assert load_map(path, rules="nav2").notes == grid.notes
    (note,) = load_map(path, rules="ros1").notes
    assert "3 pixels unknown (else occupied)" in note
    planned = er.plan(path, (-0.96, 2.02), (-0.9, 2.03), radius=0.001, rules="nav2")
    assert (planned.status, planned.notes) == ("solved", grid.notes)
    np.testing.assert_array_equal(load_map(path, rules="nav2").occupied, grid.occupied)
    with pytest.raises(UnknownName, match="'ros2'; did you mean 'ros1'"):
        load_map(path, rules="ros2")
    with pytest.raises(InvalidValue, match="not of .*map.png"):
        load_map(tmp_path / "map.png", rules="ros1")


def test_of_a_map_as_map_saver_writes_it_both_rules_read_the_same_and_nothing_is_said(tmp_path):
    for free in (0.196, 0.25):
        path = written(tmp_path, row(0, 205, 254), free_thresh=free)
        assert load_map(path).notes == ()
        assert verdicts(path) == verdicts(path, "ros1") == ("ouf" if free == 0.196 else "off")


@pytest.mark.parametrize("name", ["map.bmp", "map.pgm", "map.png"])
def test_all_three_formats_of_map_saver_are_read(tmp_path, name):
    path = written(tmp_path, None, image=name)
    Image.fromarray(row(0, 205, 254)).save(tmp_path / name)
    assert verdicts(path) == "ouf"


def test_the_frame_is_the_files_and_the_first_row_of_the_image_the_top(tmp_path):
    grid = load_map(written(tmp_path, np.zeros((4, 6), np.uint8), origin="[-1, 2.5, 0.3]"))
    assert (grid.frame.origin, grid.frame.yaw, grid.frame.resolution) == ((-1.0, 2.5), 0.3, 0.05)
    assert grid.frame.y_up
    assert math.isclose(grid.space.area, 0.3 * 0.2)
    pixels = np.full((4, 6), 254, dtype=np.uint8)
    pixels[0, 0] = 0
    world = load_map(written(tmp_path, pixels)).world(0.001)
    np.testing.assert_array_equal(world.valid([[-0.975, 2.175], [-0.975, 2.025]]), [False, True])


def test_the_image_is_looked_for_beside_the_yaml_file(tmp_path, monkeypatch):
    (tmp_path / "maps").mkdir()
    path = written(tmp_path / "maps", row(0, 255))
    monkeypatch.chdir(tmp_path)
    assert load_map("maps/map.yaml").occupied.tolist() == [[True, False]]
    absolute = written(tmp_path, None, image=f'"{tmp_path / "maps" / "map.png"}"')
    np.testing.assert_array_equal(load_map(absolute).occupied, load_map(path).occupied)


def test_the_files_of_a_map_are_its_own_and_its_image(tmp_path):
    path = written(tmp_path, None, image="pictures/office.pgm")
    assert map_files(path) == (path, tmp_path / "pictures" / "office.pgm")
    assert map_files(tmp_path / "maze.png") == (tmp_path / "maze.png",)


def refusal(path, kind):
    with pytest.raises(kind) as caught:
        load_map(path)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("key", META)
def test_a_missing_key_is_named(tmp_path, key):
    text = refusal(written(tmp_path, row(0), drop=[key]), BrokenFile)
    assert f"map.yaml lacks {key};" in text


def test_an_unknown_key_or_mode_is_named_with_what_was_meant_or_is_known(tmp_path):
    text = refusal(written(tmp_path, row(0), ocupied_thresh=0.7), UnknownName)
    assert "'ocupied_thresh'; did you mean 'occupied_thresh'?" in text
    text = refusal(written(tmp_path, row(0), mode="Trinry"), UnknownName)
    assert "'trinry'; did you mean 'trinary'?" in text
    text = refusal(written(tmp_path, row(0), mode="all"), UnknownName)
    assert "'all'; known: raw, scale, trinary" in text


def test_a_mode_may_have_capitals(tmp_path):
    assert verdicts(written(tmp_path, row(0, 205, 254), mode="Trinary")) == "ouf"
    assert verdicts(written(tmp_path, row(0, 147, 255), mode="SCALE")) == "ouf"


def test_keys_of_newer_map_servers_are_passed_over_and_named(tmp_path):
    path = written(tmp_path, row(0), unknown_thresh=0.3, color_space="gray")
    with pytest.warns(UserWarning, match="map.yaml: passed over: .*unknown_thresh"):
        newer = load_map(path)
    assert "unknown_thresh" in newer.notes[0]
    np.testing.assert_array_equal(newer.occupied, load_map(written(tmp_path, row(0))).occupied)


def test_a_key_that_is_there_twice_is_refused(tmp_path):
    path = written(tmp_path, row(0))
    path.write_text(path.read_text() + "occupied_thresh: 0.9\n")
    assert "map.yaml has the key 'occupied_thresh' twice, in lines 5 and 7" in refusal(path, BrokenFile)


@pytest.mark.parametrize(("key", "value", "words"), [
    ("resolution", "0", "resolution"), ("resolution", "-0.05", "-0.05"), ("resolution", ".nan", "nan"),
    ("resolution", "1" + "0" * 400, "resolution"), ("resolution", "fine", "'fine'"),
    ("resolution", "5e-2", "1.0e-2, not 1e-2"), ("resolution", "true", "True"), ("resolution", "", "None"),
    ("origin", "[0, 0]", "[x, y, yaw]"), ("origin", "[0, 0, 0, 0]", "[x, y, yaw]"), ("origin", "0", "[x, y, yaw]"),
    ("origin", "[0, .inf, 0]", "inf"), ("origin", "[0, 1e3, 0]", "'1e3'"), ("negate", "2", "negate"),
    ("negate", "1.0", "negate"), ("negate", "maybe", "'maybe'"), ("occupied_thresh", "1.01", "1.01"),
    ("occupied_thresh", "0.195", "free_thresh <= occupied_thresh"),
    ("occupied_thresh", "high", "'high'"), ("free_thresh", "-0.1", "-0.1"), ("free_thresh", "0.7", "0.7"),
    ("image", "''", "name of a file"), ("image", "[a.png]", "name of a file"), ("image", "7", "name of a file"),
    ("mode", "7", "known: raw, scale, trinary"), ("mode", "", "known: raw, scale, trinary"),
    ("mode", "[raw]", "known: raw, scale, trinary"),
])  # fmt: skip
def test_a_value_of_the_wrong_type_or_range_is_named(tmp_path, key, value, words):
    text = refusal(written(tmp_path, row(0), **{key: value}), (InvalidValue, UnknownName))
    assert words in text
    assert "map.yaml" in text


@pytest.mark.parametrize("content", [
    *(b"", b"just text", b"- a\n- b\n", b"a: [1", b"a: b: c", b"a: 2001-99-99", b"[" * 5000),
    b"image: !!python/object:os.system x",
    b"\xff\xfe\x00image: \x80",
    b"image: map.png\n7: x\n[1, 2]: y\n",
])  # fmt: skip
def test_a_file_that_is_no_yaml_mapping_with_keys_of_text_is_refused(tmp_path, content):
    path = tmp_path / "map.yaml"
    path.write_bytes(content)
    assert "map.yaml" in refusal(path, (BrokenFile, UnknownName))


def test_a_missing_yaml_file_or_image_is_named(tmp_path):
    assert "nowhere.yaml" in refusal(tmp_path / "nowhere.yaml", BrokenFile)
    assert "gone.png: No such file" in refusal(written(tmp_path, row(0), image="gone.png"), BrokenFile)


def test_shipped_maps_are_found_by_name_and_a_file_of_that_name_goes_before_them(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("maze1", "maze2.png", "maze3", "office", "office.yaml"):
        assert load_map(name).shape in ((480, 640), (160, 240))
    with pytest.raises(UnknownName, match="maze4"):
        load_map("maze4")
    assert load_map(written(tmp_path, row(0, 255)).rename("office.yaml")).shape == (1, 2)
    assert [file.name for file in map_files("office")] == ["office.yaml", "office.png"]


def test_in_the_office_a_robot_gets_from_a_room_to_the_other_side_of_the_corridor():
    world = load_map("office.yaml").world(radius=0.25)
    for goal in ((8.5, 3.0), (1.0, 6.0), (6.0, 7.5), (9.3, 6.5), (11.0, 0.6)):
        assert world.valid(goal)
        assert world.may_connect((1.0, 2.0), goal)
    assert not world.motion_valid((1.0, 2.0), (8.5, 3.0))


def test_a_start_in_or_near_unknown_cells_says_so_and_how_they_become_free():
    unknown, occupied = np.zeros((20, 30), dtype=bool), np.zeros((20, 30), dtype=bool)
    unknown[:, 20:] = True
    occupied[5, 10] = True
    world = GridMap(occupied | unknown, resolution=0.1, unknown=unknown).world(0.2)
    option = "unless unknown_is_free=True or --unknown-is-free says otherwise"
    assert world.explain((2.5, 1.0)).startswith(
        f"its centre lies in an unknown cell (unknown cells count as obstacles {option})"
    )
    near = world.explain((1.9, 1.0))
    assert near.startswith("the unknown cell at (2, 1) is 0.1 away, the disk needs 0.2 (unknown cells")
    for known in ((1.05, 1.45), (0.1, 1.0), (1.05, 1.6), (-5.0, 1.0), (0.1, 3.0)):
        assert "unknown" not in world.explain(known)
    assert world.explain((-5.0, 1.0)).startswith("its centre lies outside the map")
    blocked = er.plan(world, (0.5, 1.0), (2.95, 1.0))
    assert option in blocked.message
    free = GridMap(occupied, resolution=0.1, unknown=unknown).world(0.2)
    assert "unknown" not in free.explain((2.95, 1.0))


def test_a_proof_that_there_is_no_path_says_that_unknown_cells_are_obstacles():
    unknown = np.zeros((20, 30), dtype=bool)
    unknown[:, 14] = True
    parted = er.plan(GridMap(unknown, unknown=unknown).world(2.0), (5, 5), (25, 5))
    assert parted.status == "not_connected"
    assert "unknown cells count as obstacles" in parted.message
    assert "unknown" not in er.plan(GridMap(unknown).world(2.0), (5, 5), (25, 5)).message


@pytest.mark.parametrize("short", [1e-9, 1e-13, 1e-16])
def test_two_numbers_that_differ_are_shown_with_digits_that_differ(short):
    world = GridMap(np.zeros((40, 60), dtype=bool), resolution=0.05).world(0.1)
    text = world.explain((0.1 * (1.0 - 10.0 * short), 0.5))
    away, needs = re.search(r"is (\S+) away, the disk needs ([0-9.]+)", text).groups()
    assert float(away) < float(needs)
