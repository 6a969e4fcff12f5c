"""ROS map_server files: what each pixel means in each mode, and files that are refused."""

import math

import numpy as np
import pytest
from PIL import Image

from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from evenroad.world import load_map
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


def verdicts(path):
    """One letter a pixel of the first row: o(ccupied), u(nknown) or f(ree)."""
    obstacles = load_ros_map(path).occupied[0]
    occupied = load_ros_map(path, unknown_is_free=True).occupied[0]
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


def test_a_value_equal_to_a_threshold_is_unknown(tmp_path):
    # 51 / 255 and 204 / 255 are the thresholds 0.2 and 0.8 themselves.
    path = written(tmp_path, row(50, 51, 204, 205), negate=1, free_thresh=0.2, occupied_thresh=0.8)
    assert verdicts(path) == "fuuo"


def test_the_shade_is_the_plain_mean_of_the_colours(tmp_path):
    # Green is bright to the eye (0.587), but one third here: occupancy 2/3 > 0.65.
    pixels = np.array([[[0, 255, 0], [255, 255, 0], [255, 255, 102]]], dtype=np.uint8)
    assert verdicts(written(tmp_path, pixels)) == "ouu"


def test_alpha_is_one_more_channel_of_the_mean_in_trinary_mode(tmp_path):
    pixels = np.zeros((1, 4, 4), dtype=np.uint8)
    pixels[0, 0] = [0, 0, 0, 255]  # shade 1/4
    pixels[0, 1] = [60, 60, 60, 255]  # shade 0.426
    pixels[0, 2] = [255, 255, 255, 0]  # shade 3/4
    pixels[0, 3] = [255, 255, 255, 255]
    assert verdicts(written(tmp_path, pixels)) == "ouuf"


def test_grey_with_alpha_counts_its_grey_three_times(tmp_path):
    image = Image.fromarray(np.array([[[0, 255], [255, 0], [255, 255]]], dtype=np.uint8))
    path = written(tmp_path, None)
    image.save(tmp_path / "map.png")
    assert image.mode == "LA"
    assert verdicts(path) == "ouf"


def test_in_scale_mode_graded_cells_and_pixels_that_are_not_opaque_are_unknown(tmp_path):
    path = written(tmp_path, row(0, 89, 90, 127, 205, 206, 255), mode="scale")
    assert verdicts(path) == "oouuuff"
    pixels = np.zeros((1, 5, 4), dtype=np.uint8)
    pixels[0, :, :3] = [[0] * 3, [255] * 3, [0] * 3, [255] * 3, [127] * 3]
    pixels[0, :, 3] = [255, 255, 254, 0, 255]
    assert verdicts(written(tmp_path, pixels, mode="scale")) == "ofuuu"


def test_in_raw_mode_the_pixel_is_the_occupancy_in_percent(tmp_path):
    path = written(tmp_path, row(0, 19, 20, 65, 66, 100, 101, 205, 255), mode="raw")
    assert verdicts(path) == "ffuuoouuu"
    assert verdicts(written(tmp_path, None, mode="raw", negate=1)) == "ffuuoouuu"


def test_sixteen_bit_images_mean_the_same_as_eight_bit_ones(tmp_path):
    levels = [0, 89, 90, 205, 206, 255]
    deep = row(*(257 * level for level in levels), dtype=np.uint16)
    assert verdicts(written(tmp_path, deep)) == "oouuff"
    assert verdicts(written(tmp_path, deep, mode="raw")) == "foouuu"


def test_every_grey_level_agrees_with_the_rule_written_out(tmp_path):
    for negate in (0, 1):
        path = written(tmp_path, np.arange(256, dtype=np.uint8)[None], negate=negate)
        expected = ""
        for level in range(256):
            occupancy = level / 255 if negate else 1 - level / 255
            expected += "o" if occupancy > 0.65 else "f" if occupancy < 0.196 else "u"
        assert verdicts(path) == expected


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
    text = refusal(written(tmp_path, row(0), mode="Trinary"), UnknownName)
    assert "'Trinary'; did you mean 'trinary'?" in text
    text = refusal(written(tmp_path, row(0), mode="all"), UnknownName)
    assert "'all'; known: raw, scale, trinary" in text


def test_keys_of_newer_map_servers_are_passed_over_and_named(tmp_path):
    path = written(tmp_path, row(0), unknown_thresh=0.3, color_space="gray")
    with pytest.warns(UserWarning, match="map.yaml: passed over: .*unknown_thresh"):
        newer = load_map(path)
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
    ("occupied_thresh", "0.196", "free_thresh < occupied_thresh"),
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
