"""Bare images as maps: which pixels are obstacles, and files that are refused."""

import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from evenroad.world import GridMap, MapFrame, load_map
from evenroad.world.gridmap import load_image
from evenroad.world.gridmap.images import LARGEST_IMAGE
from tests.refused import refused


def saved(folder, image, name="map.png", **options):
    path = folder / name
    image.save(path, **options)
    return path


def grey(*levels):
    return Image.fromarray(np.array([levels], dtype=np.uint8))


def png_header(columns, rows):
    """A PNG that claims a size and announces pixels that never come."""
    header = b"IHDR" + struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
    chunk = struct.pack(">I", 13) + header + struct.pack(">I", zlib.crc32(header))
    return b"\x89PNG\r\n\x1a\n" + chunk + struct.pack(">I", 1000) + b"IDAT"


def test_dark_pixels_are_obstacles_and_the_limit_of_dark_can_be_moved(tmp_path):
    grid = load_image(saved(tmp_path, grey(0, 127, 128, 255)))
    assert grid.occupied.tolist() == [[True, True, False, False]]
    assert grid.frame == MapFrame(rows=1, cols=4)
    path = saved(tmp_path, grey(0, 50, 51, 254, 255))
    assert load_image(path, dark=51).occupied.tolist() == [[True, True, False, False, False]]
    assert load_image(path, dark=255).occupied.tolist() == [[True, True, True, True, False]]


@pytest.mark.parametrize("dark", [0, -1, 256, np.nan, "128"])
def test_a_limit_outside_the_scale_is_refused(tmp_path, dark):
    refused(InvalidValue, "dark must be", load_image, saved(tmp_path, grey(0)), dark=dark)


def test_rows_and_columns_keep_their_places(tmp_path):
    pixels = np.full((3, 5), 255, dtype=np.uint8)
    pixels[2, 1] = 0
    for name in ("a.png", "a.pgm", "A.PGM", "a.bmp"):
        occupied = load_map(saved(tmp_path, Image.fromarray(pixels), name)).occupied
        assert np.argwhere(occupied).tolist() == [[2, 1]]


def test_black_and_white_images_and_sixteen_bit_greys_are_read(tmp_path):
    image = Image.fromarray(np.array([[True, False]]))
    assert image.mode == "1"
    assert load_image(saved(tmp_path, image)).occupied.tolist() == [[False, True]]
    levels = np.array([[0, 128 * 257 - 1, 128 * 257, 65535]], dtype=np.uint16)
    for name in ("deep.png", "deep.pgm"):
        path = saved(tmp_path, Image.fromarray(levels), name)
        assert load_image(path).occupied.tolist() == [[True, True, False, False]]


def test_colours_count_by_their_luminance(tmp_path):
    # Green is bright (150), red and blue are dark (76 and 29).
    pixels = np.array([[[255, 0, 0], [0, 255, 0], [0, 0, 255], [128, 128, 128]]], dtype=np.uint8)
    image = Image.fromarray(pixels)
    for variant in (image, image.quantize(4), image.convert("RGBA")):
        assert load_image(saved(tmp_path, variant)).occupied.tolist() == [[True, False, True, False]]


def test_transparent_pixels_are_seen_on_white_paper(tmp_path):
    black_with_alpha = np.zeros((1, 4, 4), dtype=np.uint8)
    black_with_alpha[0, :, 3] = [0, 100, 200, 255]
    assert load_image(saved(tmp_path, Image.fromarray(black_with_alpha))).occupied.tolist() == [
        [False, False, True, True]
    ]
    grey_with_alpha = Image.fromarray(black_with_alpha).convert("LA")
    assert load_image(saved(tmp_path, grey_with_alpha)).occupied.tolist() == [[False, False, True, True]]


def test_a_transparent_palette_entry_or_grey_level_is_white_paper(tmp_path):
    palette = Image.fromarray(np.array([[0, 1]], dtype=np.uint8)).convert("P")
    palette.putpalette([0, 0, 0, 10, 10, 10])
    assert load_image(saved(tmp_path, palette, transparency=0)).occupied.tolist() == [[False, True]]
    assert load_image(saved(tmp_path, grey(7, 8), transparency=7)).occupied.tolist() == [[False, True]]
    deep = Image.fromarray(np.array([[7, 8]], dtype=np.uint16))
    assert load_image(saved(tmp_path, deep, transparency=7)).occupied.tolist() == [[False, True]]


@pytest.mark.parametrize("content", [
    b"P2\n# drawn by hand\n4 1\n255\n0 127 128 255\n", b"P5 4 1 255\n\x00\x7f\x80\xff",
], ids=["ascii", "binary"])  # fmt: skip
def test_both_kinds_of_pgm_are_read(tmp_path, content):
    path = tmp_path / "map.pgm"
    path.write_bytes(content)
    assert load_map(path).occupied.tolist() == [[True, True, False, False]]


def assert_refused(path, *words):
    with pytest.raises(BrokenFile) as caught:
        load_image(path)
    text = str(caught.value)
    assert "\n" not in text
    for word in (path.name, *words):
        assert word in text


def test_a_missing_image_and_a_folder_are_named(tmp_path):
    assert_refused(tmp_path / "nowhere.png", "No such file")
    (tmp_path / "folder.png").mkdir()
    assert_refused(tmp_path / "folder.png", "s a directory")


def test_what_is_no_png_pgm_or_bmp_is_refused_whatever_its_suffix_says(tmp_path):
    path = tmp_path / "garbage.png"
    for content in (b"", b"hello", b"\x89PNG\r\n\x1a\n", b"P5 4", b"P5 x y 255\n", bytes(100), png_header(0, 5)):
        path.write_bytes(content)
        assert_refused(path)
    grey(0, 255).save(path, format="GIF")
    assert_refused(path, "a GIF image, not a PNG, PGM or BMP image")


@pytest.mark.parametrize("name", ["map.png", "map.pgm", "map.bmp"])
def test_an_image_cut_short_anywhere_is_refused(tmp_path, name):
    pixels = np.random.default_rng(0).integers(0, 256, (20, 30), dtype=np.uint8)
    whole = saved(tmp_path, Image.fromarray(pixels), name).read_bytes()
    cut = tmp_path / f"cut_{name}"
    for length in range(0, len(whole) - 16, 7):  # the last 16 bytes of a PNG hold no pixels
        cut.write_bytes(whole[:length])
        assert_refused(cut)


def test_an_image_with_flipped_bytes_is_read_or_refused_but_never_another_error(tmp_path):
    rng = np.random.default_rng(1)
    whole = bytearray(saved(tmp_path, Image.fromarray(rng.integers(0, 256, (9, 9), np.uint8))).read_bytes())
    path = tmp_path / "flipped.png"
    refused = 0
    for _ in range(150):
        broken = whole.copy()
        broken[rng.integers(len(broken))] ^= int(rng.integers(1, 256))
        path.write_bytes(broken)
        try:
            load_image(path)
        except BrokenFile:
            refused += 1
    assert refused > 0


@pytest.mark.parametrize(
    ("columns", "rows"), [(LARGEST_IMAGE + 1, 1), (10_001, 10_000), (20_000, 10_000), (2**31 - 1, 2**31 - 1)]
)
def test_a_huge_size_in_the_header_is_refused_before_any_pixel_is_read(tmp_path, columns, rows):
    for name, content in (("huge.png", png_header(columns, rows)), ("huge.pgm", f"P5 {columns} {rows} 255\n".encode())):
        path = tmp_path / name
        path.write_bytes(content)
        assert_refused(path, "too large", str(LARGEST_IMAGE))


@pytest.mark.parametrize("name", ["map.jpg", "map", "map.yaml.bak"])
def test_an_unknown_suffix_is_refused_with_the_known_ones(name):
    refused(UnknownName, r"\.bmp, \.map, \.pgm, \.png, \.yaml, \.yml", load_map, name)


def test_an_array_is_a_map():
    occupied = np.zeros((20, 30), dtype=bool)
    occupied[4:9, 12] = True
    np.testing.assert_array_equal(load_map(occupied).occupied, GridMap(occupied).occupied)
    refused(InvalidValue, "occupied", load_map, np.zeros(3, dtype=bool))
